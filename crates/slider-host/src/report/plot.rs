//! Axes and curves of a figure as inline SVG.
//!
//! Colours and strokes are classes of the page's style, so that they follow light and dark.

use std::fmt::Write;

use super::escape;
use crate::axis::{ticks, widened};

/// Size of a figure in its own units; small, so that text stays readable on a phone.
const WIDTH: f64 = 440.0;
const HEIGHT: f64 = 270.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 42.0;

/// A mark at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    /// A point that was fitted.
    Dot,
    /// A point that was left out.
    Cross,
}

/// A figure that grows by curves and marks.
#[derive(Debug)]
pub(super) struct Plot {
    x: (f64, f64),
    y: (f64, f64),
    body: String,
}

impl Plot {
    /// A plot of these ranges.
    pub(super) fn new(x: (f64, f64), y: (f64, f64)) -> Self {
        Self { x: widened(x), y: widened(y), body: String::new() }
    }

    /// A curve through points, as `class` says.
    pub(super) fn line(&mut self, class: &str, points: &[(f64, f64)]) {
        let points = self.points(points.iter().copied());
        let _ = write!(self.body, r#"<polyline class="{class}" points="{points}"/>"#);
    }

    /// The area between two curves over the same abscissas.
    pub(super) fn band(&mut self, below: &[(f64, f64)], above: &[(f64, f64)]) {
        let points = self.points(above.iter().copied().chain(below.iter().rev().copied()));
        let _ = write!(self.body, r#"<polygon class="band" points="{points}"/>"#);
    }

    /// A mark at a point; `what` is told when a pointer rests on it.
    pub(super) fn mark(&mut self, mark: Mark, (x, y): (f64, f64), what: &str) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        let (x, y) = (self.px(x), self.py(y));
        let title = escape(what);
        let _ = match mark {
            Mark::Dot => {
                write!(
                    self.body,
                    r#"<circle class="dot" cx="{x:.1}" cy="{y:.1}" r="2.6"><title>{title}</title></circle>"#
                )
            }
            Mark::Cross => write!(
                self.body,
                r#"<path class="cross" d="M{:.1} {:.1}l8 8m0-8l-8 8"><title>{title}</title></path>"#,
                x - 4.0,
                y - 4.0
            ),
        };
    }

    /// The figure with its axes; `label` is what a screen reader says.
    pub(super) fn svg(&self, x_label: &str, y_label: &str, label: &str) -> String {
        let mut svg = format!(
            r#"<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{}" preserveAspectRatio="xMidYMid meet">"#,
            escape(label)
        );
        let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
        for (x, text) in ticks(self.x, 6) {
            let px = self.px(x);
            let _ = write!(
                svg,
                r#"<path class="grid" d="M{px:.1} {TOP}V{bottom}"/><text x="{px:.1}" y="{}" text-anchor="middle">{text}</text>"#,
                bottom + 16.0
            );
        }
        for (y, text) in ticks(self.y, 5) {
            let py = self.py(y);
            let _ = write!(
                svg,
                r#"<path class="grid" d="M{LEFT} {py:.1}H{right}"/><text x="{}" y="{:.1}" text-anchor="end">{text}</text>"#,
                LEFT - 6.0,
                py + 4.0
            );
        }
        svg.push_str(&self.body);
        let _ = write!(
            svg,
            r#"<path class="frame" d="M{LEFT} {TOP}V{bottom}H{right}"/><text x="{}" y="{}" text-anchor="middle">{}</text><text transform="translate(13 {}) rotate(-90)" text-anchor="middle">{}</text></svg>"#,
            f64::midpoint(LEFT, right),
            HEIGHT - 6.0,
            escape(x_label),
            f64::midpoint(TOP, bottom),
            escape(y_label)
        );
        svg
    }

    fn points(&self, points: impl Iterator<Item = (f64, f64)>) -> String {
        let mut text = String::new();
        for (x, y) in points.filter(|(x, y)| x.is_finite() && y.is_finite()) {
            let _ = write!(text, "{:.1},{:.1} ", self.px(x), self.py(y));
        }
        text.trim_end().to_owned()
    }

    fn px(&self, x: f64) -> f64 {
        LEFT + (x - self.x.0) / (self.x.1 - self.x.0) * (WIDTH - LEFT - RIGHT)
    }

    fn py(&self, y: f64) -> f64 {
        HEIGHT - BOTTOM - (y - self.y.0) / (self.y.1 - self.y.0) * (HEIGHT - TOP - BOTTOM)
    }
}
