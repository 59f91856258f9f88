//! Richardson and Lucy's iteration with total variation.

use ndarray::{Array2, ArrayView2, Zip};

use super::canvas::Canvas;
use super::wiener::{Wiener, flat};

/// Buffers of the iteration for one size.
#[derive(Debug)]
pub(super) struct RichardsonLucy {
    /// The observed whole and the scene, both lifted above 0.
    observed: Array2<f32>,
    scene: Array2<f32>,
    /// Divergence of the scene's normalised gradient.
    divergence: Array2<f32>,
}

const STEPS: usize = 40;
/// Weight of the total variation in units of the reciprocal mean gradient of the scene. A Laplacian density of gradients
/// would have the weight 2; the best on photographs is far less, since their gradients have heavier tails.
const WEIGHT: f32 = 0.15;
/// The observed picture is lifted by this share of its range, so that the noise of dark pixels counts little more than
/// that of bright ones.
const LIFT: f32 = 0.5;
/// Gradients below this share of the range are as good as flat.
const FLAT: f32 = 0.004;
/// The total variation counts as quadratic below this many times weight and brightness: a step at the full weight would
/// overshoot where the scene is flat.
const STABLE: f32 = 6.0;
/// Least denominator of the correction.
const LEAST: f32 = 0.1;

impl RichardsonLucy {
    pub(super) fn new(canvas: &Canvas) -> Self {
        let zeros = || Array2::zeros(canvas.layout().whole);
        Self { observed: zeros(), scene: zeros(), divergence: zeros() }
    }

    /// The scene of `picture`, less `level`, with noise of variance `noise`; starts from that of `wiener`.
    pub(super) fn restore(
        &mut self,
        wiener: &mut Wiener,
        picture: ArrayView2<'_, f32>,
        level: f32,
        noise: f64,
    ) -> ArrayView2<'_, f32> {
        self.scene.assign(&wiener.restore(picture, level));
        wiener.lay_observed(picture, level);
        let (canvas, transfer, _) = wiener.parts();
        let transfer = flat(transfer);
        self.observed.assign(canvas.input());
        let (low, high) = self.observed.iter().fold((f32::MAX, f32::MIN), |(a, b), &x| (a.min(x), b.max(x)));
        let range = high - low;
        if range <= 0.0 {
            return self.scene.view();
        }
        let lift = LIFT * range - low;
        let floor = 1e-3 * range;
        self.observed += lift;
        self.scene.mapv_inplace(|x| (x + lift).max(floor));

        let flat_gradient = FLAT * range;
        let gradient = self.mean_gradient().max(flat_gradient);
        let weight = WEIGHT * (noise as f32) / (gradient * lift);
        let flat_gradient = flat_gradient.max(STABLE * weight * lift);
        for _ in 0..STEPS {
            canvas.input().assign(&self.scene);
            let blurred = canvas.filter(|i, bin| bin * transfer[i]);
            Zip::from(&mut self.divergence).and(blurred).and(&self.observed).for_each(|ratio, &expected, &seen| {
                *ratio = seen / expected.max(floor);
            });
            canvas.input().assign(&self.divergence);
            divergence(&self.scene, flat_gradient, &mut self.divergence);
            let correction = canvas.filter(|i, bin| bin * transfer[i].conj());
            Zip::from(&mut self.scene).and(correction).and(&self.divergence).for_each(|scene, &correction, &div| {
                *scene = (*scene * correction / (1.0 - weight * div).max(LEAST)).max(floor);
            });
        }
        self.scene -= lift;
        self.scene.view()
    }

    fn mean_gradient(&self) -> f32 {
        let (rows, columns) = self.scene.dim();
        let mut sum = 0.0;
        for row in 1..rows {
            for column in 1..columns {
                let here = self.scene[[row, column]];
                sum += f64::from((here - self.scene[[row - 1, column]]).hypot(here - self.scene[[row, column - 1]]));
            }
        }
        (sum / (rows * columns) as f64) as f32
    }
}

/// Writes the divergence of `grad x / |grad x|` on the periodic plane into `out`.
fn divergence(x: &Array2<f32>, flat_gradient: f32, out: &mut Array2<f32>) {
    let (rows, columns) = x.dim();
    out.fill(0.0);
    for row in 0..rows {
        let below = if row + 1 < rows { row + 1 } else { 0 };
        for column in 0..columns {
            let right = if column + 1 < columns { column + 1 } else { 0 };
            let here = x[[row, column]];
            let (across, down) = (x[[row, right]] - here, x[[below, column]] - here);
            let scale = 1.0 / (across * across + down * down + flat_gradient * flat_gradient).sqrt();
            let (across, down) = (across * scale, down * scale);
            out[[row, column]] += across + down;
            out[[row, right]] -= across;
            out[[below, column]] -= down;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_divergence_sums_to_nothing_and_points_into_peaks() {
        let mut x = Array2::zeros((9, 11));
        x[[4, 5]] = 10.0;
        let mut out = Array2::zeros((9, 11));
        divergence(&x, 1e-3, &mut out);
        assert!(out.sum().abs() < 1e-4);
        // Four unit gradients end in the peak, two of them sharing one vector at its own pixel.
        assert!((out[[4, 5]] + 2.0 + 2.0_f32.sqrt()).abs() < 1e-3, "{}", out[[4, 5]]);
    }
}
