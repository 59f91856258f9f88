//! The likelihood around the result, with the ellipse of the stated uncertainty.

use blur_core::estimate::joint::Surface;

use crate::Result;
use crate::report::html::Figure;
use crate::report::section::Subject;
use crate::report::svg::{Axis, Chart};

const TITLE: &str = "Likelihood and uncertainty";
/// Contours at these numbers of standard deviations.
const CONTOURS: [f64; 3] = [1.0, 2.0, 3.0];
/// Coverage factors of the ellipses.
const ELLIPSES: [f64; 2] = [1.0, 2.0];
/// Fainter points are not drawn.
const LEAST_OPACITY: f64 = 0.01;

/// Shades, contours and ellipses over length and direction.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let diagnosis = match subject.likelihood(TITLE) {
        Ok(diagnosis) => diagnosis,
        Err(absent) => return Ok(absent),
    };
    let surface = &diagnosis.surface;
    let (lengths, angles) = (&surface.lengths_px, &surface.angles_deg);
    let ends = |values: &[f64]| {
        let (first, last) = (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(1.0));
        (first, last, (last - first) / (values.len().max(2) - 1) as f64)
    };
    let ((l0, l1, dl), (a0, a1, da)) = (ends(lengths), ends(angles));
    let x = Axis { label: "blur length, px", from: l0 - 0.5 * dl, to: l1 + 0.5 * dl };
    let y = Axis { label: "direction, degrees", from: a0 - 0.5 * da, to: a1 + 0.5 * da };
    let mut chart = Chart::new(x, y, 0.86);
    for ((row, column), &value) in surface.log_likelihood.indexed_iter() {
        let opacity = value.exp();
        if opacity >= LEAST_OPACITY {
            let (l, a) = (lengths[column], angles[row]);
            chart.rectangle("shade", (l - 0.5 * dl, a - 0.5 * da), (l + 0.5 * dl, a + 0.5 * da), 0.75 * opacity);
        }
    }
    for k in CONTOURS {
        chart.pieces("contour", contour(surface, -0.5 * k * k));
    }
    let record = subject.record;
    if let (Some(length_std), Some(angle_std), Some(correlation)) =
        (record.length_std_px, record.angle_std_deg, record.correlation)
    {
        let across = (1.0 - correlation * correlation).max(0.0).sqrt();
        for k in ELLIPSES {
            let turns = (0..=90).map(|i| (f64::from(i) * 4.0).to_radians().sin_cos());
            chart.line(
                "ellipse",
                turns.map(|(sin, cos)| {
                    let (l, a) = (k * cos, k * (correlation * cos + across * sin));
                    (record.length_px + l * length_std, record.angle_deg + a * angle_std)
                }),
            );
        }
    }
    chart.ring("best", (record.length_px, record.angle_deg), 3.0);
    let held = if record.acceleration.is_some_and(|found| found.detected) {
        "; only the acceleration is held at its value, so that the shade is narrower than the uncertainty, which counts it in"
    } else {
        ""
    };
    Ok(Figure {
        title: TITLE,
        content: chart.finish(&format!(
            "Likelihood over length and direction with its maximum at {:.2} pixels and {:.2} degrees",
            record.length_px, record.angle_deg
        )),
        caption: format!(
            "How likely each pair of length and direction is: the darker the likelier, relative to the best (shade \
             exp \u{394}ln\u{2009}\u{2112}). Thin contours at \u{394}ln\u{2009}\u{2112} = \u{2212}1/2, \u{2212}2 and \
             \u{2212}9/2, one, two and three standard deviations of the likelihood alone. At each point all other \
             parameters (noise, incoherent light, spectrum of the scene) are fitted anew, a profile likelihood{held}. The \
             strong ellipses are the stated uncertainty, k = 1 and k = 2, from the covariance of the result; it is {:.2} \
             times as wide as the likelihood alone says, because the spectrum of the scene is rough in ways that the \
             model does not follow. A lean ellipse means that an error of the length goes with one of the direction.",
            diagnosis.widening
        ),
        is_wide: false,
    })
}

/// Pieces of the line where the surface has the value `level`, by linear interpolation along the sides of the triangles
/// that the lattice is cut into: no case is ambiguous.
fn contour(surface: &Surface, level: f64) -> Vec<[(f64, f64); 2]> {
    let (lengths, angles, values) = (&surface.lengths_px, &surface.angles_deg, &surface.log_likelihood);
    let (rows, columns) = values.dim();
    let mut pieces = Vec::new();
    for row in 1..rows {
        for column in 1..columns {
            let corner = |r: usize, c: usize| (lengths[c], angles[r], values[[r, c]]);
            let [a, b, c, d] =
                [corner(row - 1, column - 1), corner(row - 1, column), corner(row, column - 1), corner(row, column)];
            for triangle in [[a, b, d], [a, c, d]] {
                let mut ends = Vec::with_capacity(2);
                for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                    let (p, q) = (triangle[from], triangle[to]);
                    if (p.2 > level) != (q.2 > level) {
                        let share = (level - p.2) / (q.2 - p.2);
                        ends.push((p.0 + share * (q.0 - p.0), p.1 + share * (q.1 - p.1)));
                    }
                }
                if let [from, to] = ends[..] {
                    pieces.push([from, to]);
                }
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;

    #[test]
    fn the_contour_of_a_paraboloid_is_its_circle() {
        let axis: Vec<f64> = (-20..=20).map(|i| f64::from(i) * 0.1).collect();
        let log_likelihood = Array2::from_shape_fn((41, 41), |(r, c)| -0.5 * (axis[r] * axis[r] + axis[c] * axis[c]));
        let surface = Surface { angles_deg: axis.clone(), lengths_px: axis, log_likelihood };
        let pieces = contour(&surface, -0.5);
        let total: f64 = pieces.iter().map(|[a, b]| (a.0 - b.0).hypot(a.1 - b.1)).sum();
        assert!((total / std::f64::consts::TAU - 1.0).abs() < 0.01, "{total}");
        for point in pieces.iter().flatten() {
            assert!((point.0.hypot(point.1) - 1.0).abs() < 0.005, "{point:?}");
        }
    }
}
