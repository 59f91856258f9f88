//! The blur kernel along the motion.

use blur_core::psf::{AcceleratedBlur, UniformBlur};

use crate::Result;
use crate::report::html::Figure;
use crate::report::section::Subject;
use crate::report::svg::{Axis, Chart};

const TITLE: &str = "Blur kernel (PSF)";
/// Points of a curve over the length.
const POINTS: u32 = 400;
/// Highest density drawn, relative to the uniform one: an accelerated kernel may be infinite where the motion rests.
const MOST: f64 = 4.0;

/// The density of the light along the path: uniform, and accelerated where that was seen.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    if !subject.has_blur() {
        return Ok(Figure::absent(TITLE, "No motion blur was found, so there is no kernel."));
    }
    let record = subject.record;
    let length = record.length_px;
    let uniform = UniformBlur::new(length)?;
    let detected = record.acceleration.filter(|found| found.detected);
    let accelerated = match detected {
        Some(found) => Some(AcceleratedBlur::new(length, found.ratio.clamp(-1.0, 1.0))?),
        None => None,
    };
    let height = uniform.psf(0.0).max(uniform.psf(0.5 * length));
    let positions = || (0..=POINTS).map(|i| 1.2 * length * (f64::from(i) / f64::from(POINTS) - 0.5));
    let most = accelerated.map_or(1.35, |kernel| {
        let ends = [1e-3, 1.0 - 1e-3].map(|p| kernel.psf(p * length) / height);
        (1.15 * ends[0].max(ends[1])).clamp(1.35, MOST)
    }) * height;
    let x = Axis { label: "position along the motion, px", from: -0.6 * length, to: 0.6 * length };
    let y = Axis { label: "share of the light per px", from: 0.0, to: most };
    let mut chart = Chart::new(x, y, 0.62);
    if let Some(std) = record.length_std_px {
        for end in [-0.5 * length, 0.5 * length] {
            chart.rectangle("shade", (end - std, 0.0), (end + std, most), 0.25);
        }
    }
    let flat = [(-0.6, 0.0), (-0.5, 0.0), (-0.5, height), (0.5, height), (0.5, 0.0), (0.6, 0.0)];
    let class = if accelerated.is_some() { "noise" } else { "curve" };
    chart.line(class, flat.map(|(share, density)| (share * length, density)));
    let words = match (accelerated, detected) {
        (Some(kernel), Some(found)) => {
            chart.line("curve", positions().map(|x| (x, kernel.psf(x + 0.5 * length).min(2.0 * most))));
            let side = if found.is_signed {
                "The sign is known from the sharp pictures: time runs to the right."
            } else {
                "It may as well be the other way round, since a power spectrum cannot tell speeding up from slowing down."
            };
            format!(
                "The motion accelerated (ratio {:.3}): where it was slow it left more light, so the kernel leans. {side} \
                 Dashed: a uniform motion of the same length.",
                found.ratio
            )
        }
        _ => String::from("A motion of constant speed spreads the light evenly over its length: a box."),
    };
    let band = if record.length_std_px.is_some() {
        " The shaded ends are one standard uncertainty of the length either way."
    } else {
        ""
    };
    Ok(Figure {
        title: TITLE,
        content: chart.finish(&format!("Blur kernel of {length:.1} pixels along the motion")),
        caption: format!(
            "Over which path one point of the scene was smeared, and how much of its light fell where; the area is 1. \
             {words}{band}"
        ),
        is_wide: false,
    })
}
