//! What the model leaves unexplained: over the plane of frequencies, and as a distribution.

use blur_core::estimate::joint::Diagnosis;

use super::spectrum::Plane;
use crate::Result;
use crate::report::html::Figure;
use crate::report::raster;
use crate::report::section::Subject;
use crate::report::svg::{Axis, Chart};

const MAP: &str = "Residuals in the spectrum";
const HISTOGRAM: &str = "Residuals as a distribution";
/// Residuals of this many standard deviations have the full colour.
const FULL: f64 = 4.0;
/// Warm for more than expected, cold for less.
const MORE: [u8; 3] = [217, 95, 14];
const LESS: [u8; 3] = [37, 99, 178];
/// Classes of the histogram, and their width in units of the expected power.
const CLASSES: usize = 32;
const CLASS: f64 = 0.25;

/// Ratio of power to expectation of each bin in the band.
fn ratios<'a>(subject: &'a Subject<'_>, diagnosis: &'a Diagnosis) -> impl Iterator<Item = f64> + 'a {
    let band = diagnosis.band_cycles_per_px;
    subject.spectrum.bins().iter().zip(&diagnosis.expected).filter_map(move |(bin, (scene, noise))| {
        let is_inside = f64::from(bin.u).hypot(f64::from(bin.v)) <= band;
        is_inside.then(|| f64::from(bin.power) / (scene + noise))
    })
}

/// Standardised residuals over the plane of frequencies.
pub fn map(subject: &Subject<'_>) -> Result<Figure> {
    let diagnosis = match subject.likelihood(MAP) {
        Ok(diagnosis) => diagnosis,
        Err(absent) => return Ok(absent),
    };
    let plane = Plane::of(subject);
    let band = diagnosis.band_cycles_per_px;
    let ratio = subject.spectrum.map(plane.side, plane.edge, |i, bin| {
        let (scene, noise) = diagnosis.expected[i];
        if f64::from(bin.u).hypot(f64::from(bin.v)) > band { f64::NAN } else { f64::from(bin.power) / (scene + noise) }
    });
    // The mean of m independent exponential variables of mean 1 has the standard deviation 1 / sqrt(m).
    let scale = diagnosis.independent_powers.sqrt() * 2.0 * plane.edge / plane.side as f64;
    let mut chart = plane.chart();
    chart.picture(&raster::values(&ratio, |ratio| {
        if ratio.is_nan() {
            return [0; 4];
        }
        let residual = (ratio - 1.0) * scale;
        let [red, green, blue] = if residual > 0.0 { MORE } else { LESS };
        [red, green, blue, (255.0 * (residual.abs() / FULL).min(1.0)) as u8]
    })?);
    Plane::ring(&mut chart, band);
    let misfit = subject.blur.evidence.map_or_else(String::new, |evidence| {
        format!(" The mean squared residual of the fit is {:.2}; about 1 or less is expected.", evidence.misfit)
    });
    Ok(Figure {
        title: MAP,
        content: chart.finish("Standardised residuals of the power spectrum over the plane of frequencies"),
        caption: format!(
            "Power divided by what the model expects, minus 1, in standard deviations: orange where the picture holds more, \
             blue where it holds less, full colour at {FULL}. Even grain means that the model explains the picture; \
             stripes along the dark lines would speak against the length, bright spokes show structure of the scene that \
             the model does not know.{misfit}"
        ),
        is_wide: false,
    })
}

/// How the residuals are distributed, beside the exponential law.
pub fn histogram(subject: &Subject<'_>) -> Result<Figure> {
    let diagnosis = match subject.likelihood(HISTOGRAM) {
        Ok(diagnosis) => diagnosis,
        Err(absent) => return Ok(absent),
    };
    let mut counts = [0.0_f64; CLASSES];
    let (mut all, mut beyond) = (0.0_f64, 0.0_f64);
    for ratio in ratios(subject, diagnosis) {
        all += 1.0;
        match counts.get_mut((ratio / CLASS) as usize) {
            Some(count) => *count += 1.0,
            None => beyond += 1.0,
        }
    }
    let end = CLASSES as f64 * CLASS;
    // One bin in the last class, or one in a million where there are many.
    let floor = (1.0 / (all.max(1.0) * CLASS)).log10().max(-6.0) - 0.2;
    let x = Axis { label: "power / expected power", from: 0.0, to: end };
    let y = Axis { label: "log\u{2081}\u{2080} density", from: floor, to: 0.25 };
    let mut chart = Chart::new(x, y, 0.62);
    for (class, count) in counts.into_iter().enumerate() {
        let from = class as f64 * CLASS;
        let density = (count / (all * CLASS)).log10();
        if density.is_finite() {
            chart.rectangle("bar", (from, floor), (from + CLASS, density), 1.0);
        }
    }
    chart.line("curve", [(0.0, 0.0), (end, -end * std::f64::consts::LOG10_E)]);
    Ok(Figure {
        title: HISTOGRAM,
        content: chart.finish("Histogram of power over expected power beside the exponential law"),
        caption: format!(
            "Each power of a spectrum scatters about its expectation by the exponential law e<sup>\u{2212}x</sup>, the straight line \
             (logarithmic scale). Bars along the line: the model is right on average and in its scatter. Bars above it at \
             the right: single strong frequencies, as periodic textures have. Of {all:.0} powers {:.2} % lie beyond {end:.0}; \
             the law expects {:.2} %.",
            100.0 * beyond / all.max(1.0),
            100.0 * (-end).exp()
        ),
        is_wide: false,
    })
}
