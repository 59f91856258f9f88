//! Boxplots as SVG.

use std::fmt::Write as _;
use std::path::Path;

use super::report::Boxplot;
use crate::{Error, Result};

const HEIGHT: f64 = 420.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 372.0;
const LEFT: f64 = 76.0;
/// Least width of one box with its surroundings, and what a letter of its label needs.
const STRIDE: f64 = 110.0;
const LETTER: f64 = 7.5;
const HALF_BOX: f64 = 28.0;
const FONT: &str = r#"font-family="sans-serif" font-size="13""#;

/// Writes every boxplot into `folder`, which is made if it is missing: `NAME.svg`.
///
/// # Errors
/// [`Error::Write`] when a file cannot be written.
pub fn write_all(boxplots: &[Boxplot], folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(Error::Write)?;
    boxplots
        .iter()
        .try_for_each(|plot| std::fs::write(folder.join(format!("{}.svg", plot.name)), svg(plot)).map_err(Error::Write))
}

/// The drawing: for each level a box from the lower to the upper quartile with the median in it and whiskers to the
/// least and the greatest error, on a logarithmic axis.
pub fn svg(plot: &Boxplot) -> String {
    let longest = plot.boxes.iter().map(|(level, _)| level.chars().count()).max().unwrap_or(0);
    let stride = STRIDE.max(LETTER * (longest + 2) as f64);
    let width = LEFT + stride * plot.boxes.len().max(1) as f64 + 20.0;
    let axis = Axis::over(plot);
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {HEIGHT}" {FONT} text-anchor="middle">"#
    );
    let _ = writeln!(out, r#"<rect width="{width}" height="{HEIGHT}" fill="white"/>"#);
    let _ = writeln!(out, r#"<text x="{:.1}" y="24" font-size="15">{}</text>"#, 0.5 * width, escaped(&plot.title));
    let middle = 0.5 * (TOP + BOTTOM);
    let _ = writeln!(
        out,
        r#"<text x="18" y="{middle:.1}" transform="rotate(-90 18 {middle:.1})">{}</text>"#,
        escaped(&plot.axis)
    );
    for decade in axis.first..=axis.last {
        let (y, right) = (axis.y(10_f64.powi(decade)), width - 20.0);
        let _ = writeln!(out, r##"<path d="M{LEFT} {y:.1}H{right:.1}" stroke="#ccc"/>"##);
        let label = 10_f64.powi(decade);
        let _ = writeln!(out, r#"<text x="{:.1}" y="{:.1}" text-anchor="end">{label}</text>"#, LEFT - 8.0, y + 4.5);
    }
    for (i, (level, errors)) in plot.boxes.iter().enumerate() {
        let x = LEFT + stride * (i as f64 + 0.5);
        let [min, q1, median, q3, max] =
            [errors.min, errors.q1, errors.median, errors.q3, errors.max].map(|e| axis.y(e));
        let (left, right) = (x - HALF_BOX, x + HALF_BOX);
        let (cap_left, cap_right) = (x - 0.4 * HALF_BOX, x + 0.4 * HALF_BOX);
        for (end, quartile) in [(min, q1), (max, q3)] {
            let _ = writeln!(
                out,
                r##"<path d="M{cap_left:.1} {end:.1}H{cap_right:.1}M{x:.1} {end:.1}V{quartile:.1}" stroke="#333"/>"##
            );
        }
        let _ = writeln!(
            out,
            r##"<path d="M{left:.1} {q1:.1}H{right:.1}V{q3:.1}H{left:.1}Z" stroke="#333" fill="#9ecae1"/>"##
        );
        let _ = writeln!(out, r##"<path d="M{left:.1} {median:.1}H{right:.1}" stroke="#d55e00" stroke-width="2"/>"##);
        let below = BOTTOM + 20.0;
        let _ = writeln!(out, r#"<text x="{x:.1}" y="{below:.1}">{}</text>"#, escaped(level));
        let below = BOTTOM + 37.0;
        let _ = writeln!(out, r##"<text x="{x:.1}" y="{below:.1}" fill="#666">n = {}</text>"##, errors.n);
    }
    out.push_str("</svg>\n");
    out
}

/// Whole decades from bottom to top.
struct Axis {
    first: i32,
    last: i32,
}

impl Axis {
    /// At most this many decades below the greatest error: an error of nothing at all has no logarithm.
    const MOST_DECADES: i32 = 7;

    fn over(plot: &Boxplot) -> Self {
        let greatest = plot.boxes.iter().map(|(_, errors)| errors.max).fold(0.0, f64::max);
        let least = plot.boxes.iter().map(|(_, errors)| errors.min).fold(greatest, f64::min);
        let last = if greatest > 0.0 { greatest.log10().ceil() as i32 } else { 0 };
        let first = if least > 0.0 { least.log10().floor() as i32 } else { i32::MIN };
        Self { first: first.clamp(last - Self::MOST_DECADES, last - 1), last }
    }

    fn y(&self, error: f64) -> f64 {
        let share = (error.log10() - f64::from(self.first)) / f64::from(self.last - self.first);
        BOTTOM - (BOTTOM - TOP) * share.clamp(0.0, 1.0)
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::super::statistics::Summary;
    use super::*;

    fn plot(errors: &[f64]) -> Boxplot {
        let boxes = Summary::of(errors, 1.0).map(|summary| ("36 dB".to_owned(), summary)).into_iter().collect();
        Boxplot { name: "n".to_owned(), title: "a < b".to_owned(), axis: "error".to_owned(), boxes }
    }

    #[test]
    fn decades_are_equally_far_apart() {
        let axis = Axis::over(&plot(&[0.02, 0.5, 3.0]));
        assert_eq!((axis.first, axis.last), (-2, 1));
        assert_eq!((axis.y(0.01), axis.y(10.0)), (BOTTOM, TOP));
        assert!((axis.y(0.1) - axis.y(1.0) - (axis.y(1.0) - axis.y(10.0))).abs() < 1e-9);
    }

    #[test]
    fn any_errors_can_be_drawn() {
        for errors in [&[][..], &[0.0], &[0.0, 0.0, 2.0], &[1e-12, 5.0]] {
            let drawn = svg(&plot(errors));
            assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>\n"));
            assert!(!drawn.contains("NaN") && !drawn.contains("inf") && drawn.contains("a &lt; b"), "{drawn}");
        }
    }
}
