//! The spectrum along the motion, with the model's.

use blur_core::spectrum::{PowerBin, PowerSpectrum};

use crate::Result;
use crate::report::html::Figure;
use crate::report::section::Subject;
use crate::report::svg::{Axis, Chart};

/// Steps of the profile from 0 to the end of the band, at most; each is at least two bins wide.
const MOST_STEPS: f64 = 160.0;
const LEAST_BINS: f64 = 2.0;
/// Room above and below the curves, in decades.
const ROOM: f64 = 0.15;

/// Points of the picture, curve of the model, lines at the zeros.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let (band, angle) = (subject.band(), subject.record.angle_deg.to_radians());
    let step = (band / MOST_STEPS).max(LEAST_BINS / subject.region.width.min(subject.region.height) as f64);
    let profile = |value: &dyn Fn(usize, &PowerBin) -> f64| -> Vec<(f64, f64)> {
        let whitened = |i: usize, bin: &PowerBin| value(i, bin) * PowerSpectrum::whitening(bin.u, bin.v);
        let means = subject.spectrum.along(angle, step, band, whitened);
        means.into_iter().enumerate().map(|(k, mean)| ((k as f64 + 0.5) * step, mean.log10())).collect()
    };
    let observed = profile(&|_, bin| f64::from(bin.power));
    let model = subject.diagnosis.as_ref().map(|diagnosis| {
        let all = profile(&|i, _| diagnosis.expected[i].0 + diagnosis.expected[i].1);
        (all, profile(&|i, _| diagnosis.expected[i].1))
    });
    let heights =
        || observed.iter().chain(model.iter().flat_map(|(all, _)| all)).map(|p| p.1).filter(|y| y.is_finite());
    let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    let x = Axis { label: "frequency along the motion, cycles/px", from: 0.0, to: band };
    let y = Axis { label: "log\u{2081}\u{2080} power (flattened)", from: low - ROOM, to: high + ROOM };
    let mut chart = Chart::new(x, y, 0.62);
    for zero in subject.zeros(band) {
        chart.vertical("zero", zero);
    }
    let model_words = match &model {
        Some((all, noise)) => {
            chart.line("noise", noise.iter().copied());
            chart.line("curve", all.iter().copied());
            "The curve is the fitted model, the dashed one its noise: where both meet, the picture tells nothing more."
        }
        None => "This method fits no model, so no curve is drawn.",
    };
    chart.dots("dot", observed);
    let zeros_words = if subject.has_blur() {
        "Vertical lines: the zeros k/L of a uniform blur of the length found."
    } else {
        "No zeros are marked, since no blur was found."
    };
    Ok(Figure {
        title: "Along the motion",
        content: chart.finish("Mean power against the frequency along the motion, with the zeros of the blur"),
        caption: format!(
            "The same spectrum summed across the motion: each dot is the mean power of the picture at one frequency along \
             the direction found. A blur of constant speed pulls the dots down at equal distances. {zeros_words} \
             {model_words}"
        ),
        is_wide: false,
    })
}
