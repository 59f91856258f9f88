//! Charts as SVG: scales, axes, and what is drawn between them.

use std::fmt::Write;

use crate::report::html::Text;

/// Width of a chart in its own units; it is scaled to the width of the page.
const WIDTH: f64 = 426.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 48.0;
/// Marks on an axis, about.
const TICKS: f64 = 5.0;

/// One axis of a chart.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// Quantity and unit.
    pub label: &'static str,
    /// Value at the left or at the bottom.
    pub from: f64,
    /// Value at the right or at the top.
    pub to: f64,
}

impl Axis {
    fn share(&self, value: f64) -> f64 {
        (value - self.from) / (self.to - self.from)
    }

    /// Marks at round numbers, with as many decimals as these have.
    fn ticks(&self) -> Vec<(f64, String)> {
        let span = (self.to - self.from).abs();
        let least = span / TICKS;
        let magnitude = 10.0_f64.powf(least.log10().floor());
        if !(magnitude.is_finite() && magnitude > 0.0) {
            return Vec::new();
        }
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * magnitude).into_iter().find(|&s| s >= least).unwrap_or(least);
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let (low, high) = (self.from.min(self.to), self.from.max(self.to));
        let first = (low / step - 1e-9).ceil();
        let marks = (0..).map(|i| (first + f64::from(i)) * step).take_while(|&value| value <= high + 1e-9 * span);
        marks.map(|value| (value, format!("{:.decimals$}", value + 0.0).replace('-', "\u{2212}"))).collect()
    }
}

/// A chart in the making. Coordinates given are those of the axes; points that are not finite are left out.
#[derive(Debug)]
pub struct Chart {
    x: Axis,
    y: Axis,
    height: f64,
    body: String,
}

impl Chart {
    /// A chart whose plot is so many times as high as wide.
    pub fn new(x: Axis, y: Axis, aspect: f64) -> Self {
        Self { x, y, height: (WIDTH - LEFT - RIGHT) * aspect, body: String::new() }
    }

    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        ((WIDTH - LEFT - RIGHT) * self.x.share(x), self.height * (1.0 - self.y.share(y)))
    }

    /// A line through points.
    pub fn line(&mut self, class: &str, points: impl IntoIterator<Item = (f64, f64)>) {
        let mut path = String::new();
        let mut is_down = false;
        for (x, y) in points {
            let (x, y) = self.place(x, y);
            if x.is_finite() && y.is_finite() {
                // Writing to a String cannot fail, here and below.
                let _ = write!(path, "{}{x:.1} {y:.1}", if is_down { 'L' } else { 'M' });
                is_down = true;
            } else {
                is_down = false;
            }
        }
        let _ = write!(self.body, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    /// Straight pieces, each from its first to its second point.
    pub fn pieces(&mut self, class: &str, pieces: impl IntoIterator<Item = [(f64, f64); 2]>) {
        let mut path = String::new();
        for [from, to] in pieces {
            let ((x1, y1), (x2, y2)) = (self.place(from.0, from.1), self.place(to.0, to.1));
            let _ = write!(path, "M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}");
        }
        let _ = write!(self.body, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    /// A dot at each point.
    pub fn dots(&mut self, class: &str, points: impl IntoIterator<Item = (f64, f64)>) {
        for (x, y) in points {
            let (x, y) = self.place(x, y);
            if x.is_finite() && y.is_finite() {
                let _ = write!(self.body, "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"1.7\"/>");
            }
        }
    }

    /// A ring of so many units of the chart around a point.
    pub fn ring(&mut self, class: &str, (x, y): (f64, f64), radius: f64) {
        let (x, y) = self.place(x, y);
        let _ = write!(self.body, "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>");
    }

    /// A rectangle between two corners, with this opacity.
    pub fn rectangle(&mut self, class: &str, from: (f64, f64), to: (f64, f64), opacity: f64) {
        let ((x1, y1), (x2, y2)) = (self.place(from.0, from.1), self.place(to.0, to.1));
        let (x, y, width, height) = (x1.min(x2), y1.min(y2), (x2 - x1).abs(), (y2 - y1).abs());
        let _ = write!(
            self.body,
            "<rect class=\"{class}\" x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\""
        );
        if opacity < 1.0 {
            let _ = write!(self.body, " opacity=\"{opacity:.3}\"");
        }
        self.body.push_str("/>");
    }

    /// A line over the whole height at `x`.
    pub fn vertical(&mut self, class: &str, x: f64) {
        let ends = [(x, self.y.from), (x, self.y.to)];
        self.pieces(class, [ends]);
    }

    /// A picture over the whole plot.
    pub fn picture(&mut self, uri: &str) {
        let (width, height) = (WIDTH - LEFT - RIGHT, self.height);
        let _ = write!(
            self.body,
            "<image href=\"{uri}\" width=\"{width}\" height=\"{height:.1}\" preserveAspectRatio=\"none\"/>"
        );
    }

    /// A few words at a point.
    pub fn words(&mut self, class: &str, (x, y): (f64, f64), words: &str) {
        let (x, y) = self.place(x, y);
        let _ = write!(self.body, "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", Text(words));
    }

    /// The chart as SVG; `description` says in words what it shows.
    pub fn finish(self, description: &str) -> String {
        let (width, height) = (WIDTH - LEFT - RIGHT, self.height);
        let mut axes = String::new();
        for (value, label) in self.x.ticks() {
            let x = LEFT + width * self.x.share(value);
            let bottom = TOP + height;
            let _ = write!(
                axes,
                "<path class=\"tick\" d=\"M{x:.1} {bottom:.1}v4\"/><text class=\"mark\" text-anchor=\"middle\" x=\"{x:.1}\" \
                 y=\"{:.1}\">{label}</text>",
                bottom + 17.0
            );
        }
        for (value, label) in self.y.ticks() {
            let y = TOP + height * (1.0 - self.y.share(value));
            let _ = write!(
                axes,
                "<path class=\"tick\" d=\"M{LEFT} {y:.1}h-4\"/><text class=\"mark\" text-anchor=\"end\" x=\"{}\" y=\"{:.1}\">\
                 {label}</text>",
                LEFT - 7.0,
                y + 4.0
            );
        }
        let (middle_x, middle_y) = (LEFT + 0.5 * width, TOP + 0.5 * height);
        let total = TOP + height + BOTTOM;
        format!(
            "<svg class=\"chart\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {WIDTH} {total:.0}\">{axes}\
             <text class=\"label\" text-anchor=\"middle\" x=\"{middle_x:.1}\" y=\"{:.1}\">{}</text>\
             <text class=\"label\" text-anchor=\"middle\" transform=\"translate(13 {middle_y:.1}) rotate(-90)\">{}</text>\
             <svg x=\"{LEFT}\" y=\"{TOP}\" width=\"{width}\" height=\"{height:.1}\">{}</svg>\
             <rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{width}\" height=\"{height:.1}\"/></svg>",
            Text(description),
            total - 8.0,
            Text(self.x.label),
            Text(self.y.label),
            self.body
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(from: f64, to: f64) -> Vec<String> {
        Axis { label: "", from, to }.ticks().into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_axis() {
        assert_eq!(marks(0.0, 0.5), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(marks(-1.2, 1.2), ["\u{2212}1.0", "\u{2212}0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(marks(3.0, 3.0), Vec::<String>::new());
        assert_eq!(marks(101.3, 163.0), ["120", "140", "160"]);
    }

    #[test]
    fn points_lie_where_the_axes_say_and_gaps_stay_open() {
        let axis = |to| Axis { label: "a<b", from: 0.0, to };
        let mut chart = Chart::new(axis(10.0), axis(2.0), 0.5);
        chart.line("curve", [(0.0, 0.0), (5.0, 1.0), (6.0, f64::NAN), (10.0, 2.0)]);
        let svg = chart.finish("said \"so\"");
        // The plot is 344 wide and 172 high, y upwards.
        assert!(svg.contains("d=\"M0.0 172.0L172.0 86.0M344.0 0.0\""), "{svg}");
        assert!(svg.contains("a&lt;b") && svg.contains("aria-label=\"said &quot;so&quot;\""), "{svg}");
    }
}
