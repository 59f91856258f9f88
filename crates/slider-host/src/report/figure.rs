//! The two figures of a run.

use crate::axis::{range, widened};
use crate::outcome::{Outcome, Value};
use crate::text::significant;

use super::plot::{Mark, Plot};

/// Coverage factor where a run has none.
const COVERAGE_K: f64 = 2.0;
/// Most marks in a figure; more than this are a line to the eye.
const MOST_MARKS: usize = 1000;

/// The value that a run is about: its acceleration or its speed.
pub(crate) fn main_value(outcome: &Outcome) -> Option<(&'static str, &'static str, Value)> {
    let accel = outcome.accel_m_s2.map(|value| ("a", "m/s²", value));
    accel.or_else(|| outcome.speed_m_s.map(|value| ("v", "m/s", value)))
}

/// The coverage factor of a run.
pub(super) fn coverage_k(outcome: &Outcome) -> f64 {
    main_value(outcome)
        .map(|(_, _, value)| value.coverage_k)
        .filter(|k| k.is_finite() && *k > 0.0)
        .unwrap_or(COVERAGE_K)
}

/// The fitted position at a time, m.
pub(crate) fn fitted_m(outcome: &Outcome, t_s: f64) -> f64 {
    outcome.coefficients.iter().rev().fold(0.0, |sum, c| sum * t_s + c)
}

/// Position against time with the fit.
pub(super) fn position(outcome: &Outcome) -> String {
    let (t_unit, t_scale) = time_unit(outcome);
    let times = range(outcome.t_s.iter().copied());
    let curve: Vec<(f64, f64)> = samples(times).map(|t| (t * t_scale, fitted_m(outcome, t) * 1e3)).collect();
    let points: Vec<(f64, f64)> = outcome.t_s.iter().zip(&outcome.x_m).map(|(t, x)| (t * t_scale, x * 1e3)).collect();
    let ordinates = points.iter().chain(&curve).map(|p| p.1);
    let mut plot = Plot::new((times.0 * t_scale, times.1 * t_scale), range(ordinates));
    plot.line("fit", &curve);
    marks(&mut plot, outcome, &points, |i, (t, x)| {
        format!("point {i}: {} {t_unit}, {} mm", significant(t, 6), significant(x, 5))
    });
    let label = format!("Run {}: position in mm against time, with the fitted curve", outcome.run);
    plot.svg(&format!("t / {t_unit}"), "x / mm", &label)
}

/// Position less fit against time, with the band of their uncertainty; and what the band is.
pub(super) fn residuals(outcome: &Outcome) -> (String, String) {
    let (t_unit, t_scale) = time_unit(outcome);
    // A point that was left out has no expectation; the band passes it by.
    let expected: Vec<(f64, f64)> = outcome
        .t_s
        .iter()
        .copied()
        .zip(outcome.residual_stds_m.iter().copied())
        .filter(|(_, s)| s.is_finite())
        .collect();
    let largest = outcome.residuals_m.iter().copied().chain(expected.iter().map(|(_, s)| COVERAGE_K * s)).fold(
        0.0_f64,
        |most, r| match r.abs() {
            size if size.is_finite() => most.max(size),
            _ => most,
        },
    );
    let (unit, scale) = if largest < 0.5e-3 { ("µm", 1e6) } else { ("mm", 1e3) };
    let half = |sign: f64| -> Vec<(f64, f64)> {
        expected.iter().map(|(t, s)| (t * t_scale, sign * COVERAGE_K * s * scale)).collect()
    };
    let times = range(outcome.t_s.iter().copied());
    let times = (times.0 * t_scale, times.1 * t_scale);
    let mut plot = Plot::new(times, (-largest * scale, largest * scale));
    plot.band(&half(-1.0), &half(1.0));
    let times = widened(times);
    plot.line("zero", &[(times.0, 0.0), (times.1, 0.0)]);
    let points: Vec<(f64, f64)> =
        outcome.t_s.iter().zip(&outcome.residuals_m).map(|(t, r)| (t * t_scale, r * scale)).collect();
    marks(&mut plot, outcome, &points, |i, (t, r)| {
        format!("point {i}: {} {t_unit}, {} {unit}", significant(t, 6), significant(r, 3))
    });
    let caption = format!(
        "Residuals; the band is {COVERAGE_K} times what the uncertainties of the points let them be after the fit. Edges \
         share the widths before them, so neighbours err together."
    );
    let label = format!("Run {}: residuals in {unit} against time, with their band", outcome.run);
    (plot.svg(&format!("t / {t_unit}"), &format!("residual / {unit}"), &label), caption)
}

fn marks(plot: &mut Plot, outcome: &Outcome, points: &[(f64, f64)], what: impl Fn(usize, (f64, f64)) -> String) {
    let step = points.len().div_ceil(MOST_MARKS).max(1);
    for (i, &point) in points.iter().enumerate() {
        if outcome.outliers.contains(&i) {
            plot.mark(Mark::Cross, point, &format!("{}, left out", what(i, point)));
        } else if i % step == 0 {
            plot.mark(Mark::Dot, point, &what(i, point));
        }
    }
}

fn samples((low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    (0..=60).map(move |i| low + (high - low) * f64::from(i) / 60.0)
}

/// Milliseconds for runs below two seconds.
fn time_unit(outcome: &Outcome) -> (&'static str, f64) {
    let (low, high) = range(outcome.t_s.iter().copied());
    if low.abs().max(high.abs()) < 2.0 { ("ms", 1e3) } else { ("s", 1.0) }
}
