//! Answers beside the truth, residuals and response as SVG, as in thesis figures 6.7 to 6.11.

use std::fmt::Display;
use std::fs;
use std::path::Path;

use blur_core::motion::COVERAGE_K;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::evaluate::{Line, Point};
use crate::{Error, Result};

const SIZE: (u32, u32) = (560, 440);
const ANSWER: RGBColor = RGBColor(0, 114, 178);
const TRUTH: RGBColor = RGBColor(213, 94, 0);
const BAR: RGBAColor = RGBAColor(0, 114, 178, 0.35);
/// What the horizontal axis of two of the plots shows.
const TRUE_AXIS: &str = "true acceleration, m/s2";

/// Writes the three plots of every line into `folder`, which is made if it is missing: `NAME-predicted.svg` (answers over
/// the truth), `NAME-residuals.svg` (errors over the truth) and `NAME-response.svg` (both over the number of the picture,
/// sorted by truth). Bars are two standard uncertainties.
///
/// # Errors
/// [`Error::InFile`] when a file cannot be written, [`Error::Plot`] when it cannot be drawn.
pub fn write_all(lines: &[Line], folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|error| Error::Write(error).in_file(folder))?;
    for line in lines.iter().filter(|line| !line.points.is_empty()) {
        for (name, drawn) in
            [("predicted", predicted(line)?), ("residuals", residuals(line)?), ("response", response(line)?)]
        {
            let path = folder.join(format!("{}-{name}.svg", line.name));
            fs::write(&path, drawn).map_err(|error| Error::Write(error).in_file(&path))?;
        }
    }
    Ok(())
}

/// Answers over the truth, with the line where both agree.
pub fn predicted(line: &Line) -> Result<String> {
    let range = widened(line.points.iter().flat_map(|point| [point.truth_m_s2, low(point), high(point)]));
    let axes = Axes { x: range, y: range, x_label: TRUE_AXIS, y_label: "answer, m/s2" };
    let diagonal = vec![(range.0, range.0), (range.1, range.1)];
    let marks = line.points.iter().map(|point| Mark { at: point.truth_m_s2, low: low(point), high: high(point) });
    draw(&format!("{}: predicted and actual", line.title), &axes, diagonal, marks)
}

/// Errors over the truth.
pub fn residuals(line: &Line) -> Result<String> {
    let x = widened(line.points.iter().map(|point| point.truth_m_s2));
    let y =
        widened(line.points.iter().flat_map(|point| [low(point) - point.truth_m_s2, high(point) - point.truth_m_s2]));
    let axes = Axes { x, y, x_label: TRUE_AXIS, y_label: "answer - truth, m/s2" };
    let marks = line.points.iter().map(|point| {
        let truth = point.truth_m_s2;
        Mark { at: truth, low: low(point) - truth, high: high(point) - truth }
    });
    draw(&format!("{}: residuals", line.title), &axes, vec![(x.0, 0.0), (x.1, 0.0)], marks)
}

/// Truth and answers over the number of the picture, sorted by truth.
pub fn response(line: &Line) -> Result<String> {
    let mut points = line.points.clone();
    points.sort_by(|a, b| a.truth_m_s2.total_cmp(&b.truth_m_s2));
    let x = (0.0, points.len() as f64 + 1.0);
    let y = widened(points.iter().flat_map(|point| [point.truth_m_s2, low(point), high(point)]));
    let axes = Axes { x, y, x_label: "picture, sorted by truth", y_label: "acceleration, m/s2" };
    let number = |index: usize| index as f64 + 1.0;
    let truth = points.iter().enumerate().map(|(index, point)| (number(index), point.truth_m_s2)).collect();
    let marks =
        points.iter().enumerate().map(|(index, point)| Mark { at: number(index), low: low(point), high: high(point) });
    draw(&format!("{}: response", line.title), &axes, truth, marks)
}

/// An answer with its uncertainty, which may be none.
struct Mark {
    at: f64,
    low: f64,
    high: f64,
}

struct Axes {
    x: (f64, f64),
    y: (f64, f64),
    x_label: &'static str,
    y_label: &'static str,
}

fn low(point: &Point) -> f64 {
    point.answer_m_s2 - COVERAGE_K * point.std_m_s2.unwrap_or(0.0)
}

fn high(point: &Point) -> f64 {
    point.answer_m_s2 + COVERAGE_K * point.std_m_s2.unwrap_or(0.0)
}

/// The range of finite values, a twentieth wider on either side.
fn widened(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return (0.0, 1.0);
    }
    let margin = if high > low { 0.05 * (high - low) } else { 0.5 };
    (low - margin, high + margin)
}

fn draw(title: &str, axes: &Axes, truth: Vec<(f64, f64)>, marks: impl Iterator<Item = Mark>) -> Result<String> {
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    fill(&root, title, axes, truth, marks)?;
    drop(root);
    Ok(svg)
}

fn fill(
    root: &DrawingArea<SVGBackend<'_>, Shift>,
    title: &str,
    axes: &Axes,
    truth: Vec<(f64, f64)>,
    marks: impl Iterator<Item = Mark>,
) -> Result<()> {
    root.fill(&WHITE).map_err(failed)?;
    let mut chart = ChartBuilder::on(root)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(58)
        .build_cartesian_2d(axes.x.0..axes.x.1, axes.y.0..axes.y.1)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .x_desc(axes.x_label)
        .y_desc(axes.y_label)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .label_style(("sans-serif", 13))
        .draw()
        .map_err(failed)?;
    chart.draw_series(LineSeries::new(truth, TRUTH.stroke_width(2))).map_err(failed)?;
    for Mark { at, low, high } in marks.filter(|mark| mark.low.is_finite() && mark.high.is_finite()) {
        if high > low {
            chart.draw_series([PathElement::new(vec![(at, low), (at, high)], BAR)]).map_err(failed)?;
        }
        chart.draw_series([Circle::new((at, f64::midpoint(low, high)), 3, ANSWER.filled())]).map_err(failed)?;
    }
    root.present().map_err(failed)
}

fn failed(error: impl Display) -> Error {
    Error::Plot { reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::evaluate::Kind;

    fn line(points: Vec<Point>) -> Line {
        let n = points.len();
        Line {
            name: "x",
            title: "a < b",
            kind: Kind::Regression,
            thesis: None,
            n,
            metrics: None,
            coverage: None,
            comparison: None,
            points,
            speed: None,
        }
    }

    fn point(truth_m_s2: f64, answer_m_s2: f64, std_m_s2: Option<f64>) -> Point {
        Point { truth_m_s2, answer_m_s2, std_m_s2, detected: None }
    }

    #[test]
    fn every_answer_is_a_dot_and_every_uncertainty_a_bar() {
        let line = line(vec![point(1.0, 1.1, Some(0.1)), point(2.0, 1.8, None), point(0.5, 0.5, Some(0.2))]);
        for drawn in [predicted(&line), residuals(&line), response(&line)] {
            let drawn = drawn.unwrap();
            assert_eq!(drawn.matches("<circle").count(), 3);
            assert!(drawn.contains("a &lt; b") && drawn.trim_end().ends_with("</svg>"), "{drawn}");
            assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
        }
    }

    #[test]
    fn any_answers_can_be_drawn() {
        for points in
            [vec![], vec![point(1.0, 1.0, None)], vec![point(1.0, f64::NAN, Some(1.0)), point(1.0, 1.0, None)]]
        {
            assert!(predicted(&line(points.clone())).is_ok());
            assert!(residuals(&line(points.clone())).is_ok());
            assert!(response(&line(points)).is_ok());
        }
    }
}
