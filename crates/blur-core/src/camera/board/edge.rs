//! The edges of a dark square, to a fraction of a pixel.

use nalgebra::{Matrix2, Vector2};
use ndarray::ArrayView2;

use super::smooth;

/// Part of a side, from its middle, along which the edge is read: near the corners the neighbouring edge blurs it.
const USED: f64 = 0.7;
/// Reach across the edge as a part of the side, and its bounds in pixels.
const REACH: f64 = 0.2;
const REACH_PX: (f64, f64) = (2.0, 8.0);
/// Distance between samples across an edge in pixels, and along it.
const ACROSS_PX: f64 = 0.25;
const ALONG_PX: f64 = 0.5;
/// Part of the reach at each end that is taken for plain dark or plain bright.
const PLATEAU: f64 = 0.25;
const STEPS: usize = 3;

/// Corners of a dark quadrilateral: where the lines along its edges cross. `corners` are near, in turn around it.
pub(super) fn refine(picture: ArrayView2<'_, f32>, corners: [Vector2<f64>; 4]) -> Option<[Vector2<f64>; 4]> {
    let mut corners = corners;
    for _ in 0..STEPS {
        let centre = corners.iter().sum::<Vector2<f64>>() / 4.0;
        let mut lines = [Line::default(); 4];
        for (side, line) in lines.iter_mut().enumerate() {
            *line = Line::along(picture, corners[side], corners[(side + 1) % 4], centre)?;
        }
        for (side, corner) in corners.iter_mut().enumerate() {
            *corner = lines[(side + 3) % 4].cross(&lines[side])?;
        }
    }
    Some(corners)
}

/// A straight line: a point on it and its direction.
#[derive(Clone, Copy, Default)]
struct Line {
    point: Vector2<f64>,
    direction: Vector2<f64>,
}

impl Line {
    /// The line that is nearest to the edge found at places from `start` to `end` of a side of a square around `centre`.
    fn along(
        picture: ArrayView2<'_, f32>,
        start: Vector2<f64>,
        end: Vector2<f64>,
        centre: Vector2<f64>,
    ) -> Option<Self> {
        let side = end - start;
        let length = side.norm();
        let along = side.try_normalize(0.0)?;
        let across = Vector2::new(-along.y, along.x);
        let middle = 0.5 * (start + end);
        // From dark to bright.
        let outwards = across * (middle - centre).dot(&across).signum();
        let reach = (REACH * length).clamp(REACH_PX.0, REACH_PX.1);
        let count = (USED * length / ALONG_PX).floor().max(2.0) as usize;
        let edge: Option<Vec<Vector2<f64>>> = (0..count)
            .map(|i| {
                let at = middle + along * (USED * length * ((i as f64 + 0.5) / count as f64 - 0.5));
                Some(at + outwards * edge_offset(picture, at, outwards, reach)?)
            })
            .collect();
        let edge = edge?;
        let point = edge.iter().sum::<Vector2<f64>>() / edge.len() as f64;
        let scatter: Matrix2<f64> = edge.iter().map(|p| p - point).map(|d| d * d.transpose()).sum();
        let eigen = scatter.symmetric_eigen();
        let direction = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into();
        Some(Self { point, direction })
    }

    fn cross(&self, other: &Self) -> Option<Vector2<f64>> {
        let sine = self.direction.perp(&other.direction);
        let along = (other.point - self.point).perp(&other.direction) / sine;
        along.is_finite().then(|| self.point + self.direction * along)
    }
}

/// Where the brightness steps from dark to bright, from `at` outwards: the place of the sharp step with the same light.
fn edge_offset(picture: ArrayView2<'_, f32>, at: Vector2<f64>, outwards: Vector2<f64>, reach: f64) -> Option<f64> {
    let count = (2.0 * reach / ACROSS_PX).round() as usize;
    let step = 2.0 * reach / count as f64;
    let profile: Option<Vec<f64>> =
        (0..count).map(|i| smooth::at(picture, at + outwards * ((i as f64 + 0.5) * step - reach))).collect();
    let profile = profile?;
    let plateau = ((PLATEAU * count as f64) as usize).max(1);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let (dark, bright) = (mean(&profile[..plateau]), mean(&profile[count - plateau..]));
    let lit: f64 = profile.iter().map(|value| (value - dark) / (bright - dark)).sum::<f64>() * step;
    let offset = reach - lit;
    (bright > dark && offset.abs() <= reach).then_some(offset)
}
