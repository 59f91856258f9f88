//! The corner where two edges cross, to a fraction of a pixel.

use nalgebra::{Matrix2, Vector2};
use ndarray::ArrayView2;

use super::smooth;

const MAX_STEPS: usize = 40;
/// A step shorter than this, in pixels, is the last.
const CONVERGED_PX: f64 = 1e-4;

/// The point whose directions to all pixels around it are perpendicular to the gradients there (Förstner and Gülch 1987):
/// gradients stand across the edges, and the edges run through the corner. `None` when it leads away from `start` by more
/// than `reach_px`, or out of the picture.
pub(super) fn refine(picture: ArrayView2<'_, f32>, start: Vector2<f64>, reach_px: f64) -> Option<Vector2<f64>> {
    iterate(start, reach_px, |corner| once(picture, corner, reach_px))
}

/// The same in a square of `2 half_px + 1` samples a side about the corner, as `OpenCV`'s `cornerSubPix`: samples between the
/// pixels, weights `exp(-(x / half_px)^2)` each way.
pub(super) fn refine_in_square(
    picture: ArrayView2<'_, f32>,
    start: Vector2<f64>,
    half_px: usize,
) -> Option<Vector2<f64>> {
    iterate(start, half_px as f64, |corner| once_in_square(picture, corner, half_px))
}

/// Steps until they are small; `None` when they lead farther than `reach_px` from `start`.
fn iterate(
    start: Vector2<f64>,
    reach_px: f64,
    step: impl Fn(Vector2<f64>) -> Option<Vector2<f64>>,
) -> Option<Vector2<f64>> {
    let mut corner = start;
    for _ in 0..MAX_STEPS {
        let found = step(corner)?;
        let moved = (found - corner).norm();
        corner = found;
        if (corner - start).norm() > reach_px {
            return None;
        }
        if moved < CONVERGED_PX {
            break;
        }
    }
    Some(corner)
}

fn once_in_square(picture: ArrayView2<'_, f32>, corner: Vector2<f64>, half_px: usize) -> Option<Vector2<f64>> {
    let (rows, columns) = picture.dim();
    // Beyond the border the picture goes on as it ends, as in `OpenCV`.
    let last = Vector2::new((columns - 1) as f64 - 1e-9, (rows - 1) as f64 - 1e-9);
    let half = half_px as isize;
    let offset = |i: isize, j: isize| Vector2::new(i as f64, j as f64);
    let value = |offset: Vector2<f64>| smooth::at(picture, (corner + offset).sup(&Vector2::zeros()).inf(&last));
    let mut normal = Matrix2::zeros();
    let mut moment = Vector2::zeros();
    for j in -half..=half {
        for i in -half..=half {
            let here = offset(i, j);
            let gradient = Vector2::new(
                value(offset(i + 1, j))? - value(offset(i - 1, j))?,
                value(offset(i, j + 1))? - value(offset(i, j - 1))?,
            );
            let weight = (-here.norm_squared() / (half * half) as f64).exp();
            let weighted = gradient * gradient.transpose() * weight;
            normal += weighted;
            moment += weighted * here;
        }
    }
    Some(corner + normal.try_inverse()? * moment)
}

fn once(picture: ArrayView2<'_, f32>, corner: Vector2<f64>, reach_px: f64) -> Option<Vector2<f64>> {
    let (rows, columns) = picture.dim();
    let (left, right) = ((corner.x - reach_px).ceil(), (corner.x + reach_px).floor());
    let (top, bottom) = ((corner.y - reach_px).ceil(), (corner.y + reach_px).floor());
    if !(left >= 1.0 && top >= 1.0 && right < columns as f64 - 1.0 && bottom < rows as f64 - 1.0) {
        return None;
    }
    let mut normal = Matrix2::zeros();
    let mut moment = Vector2::zeros();
    for v in top as usize..=bottom as usize {
        for u in left as usize..=right as usize {
            // From the corner, so that large coordinates cost no digits.
            let offset = Vector2::new(u as f64, v as f64) - corner;
            let distance2 = offset.norm_squared() / (reach_px * reach_px);
            if distance2 >= 1.0 {
                continue;
            }
            let gradient = Vector2::new(
                f64::from(picture[[v, u + 1]]) - f64::from(picture[[v, u - 1]]),
                f64::from(picture[[v + 1, u]]) - f64::from(picture[[v - 1, u]]),
            );
            // Fades out towards the rim, so that no pixel comes or goes with a jump.
            let weighted = gradient * gradient.transpose() * (1.0 - distance2).powi(2);
            normal += weighted;
            moment += weighted * offset;
        }
    }
    Some(corner + normal.try_inverse()? * moment)
}
