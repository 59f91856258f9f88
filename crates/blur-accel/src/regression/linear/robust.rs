//! Least squares that outliers do not pull.

use linfa::traits::Fit;
use nalgebra::DVector;
use ndarray::{ArrayView1, ArrayView2};

use super::{Linear, PivotedQr, Samples, Terms, design, targets};
use crate::regression::samples;
use crate::{Error, Result};

/// Width of the bisquare in standard deviations that keeps 95 % of the efficiency on Gaussian errors.
const TUNING: f64 = 4.685;
/// Median of the magnitude of a standard normal number.
const NORMAL_MEDIAN: f64 = 0.6745;
/// The leverage of an observation may come this near to 1.
const MOST_LEVERAGE: f64 = 0.9999;
const MOST_ITERATIONS: usize = 50;

/// Settings of the robust linear regression: iteratively reweighted least squares with bisquare weights of width 4.685,
/// on residuals adjusted for their leverage and scaled by their median magnitude, as MATLAB's `robustfit`. It stops after
/// 50 steps if the weights come to no rest, as that does.
///
/// *Reference*: Holland & Welsch, Communications in Statistics A 6 (1977) 813; `DuMouchel` & O'Brien, Computer Science and
/// Statistics 21 (1989) 297.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Robust;

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for Robust {
    type Object = Linear;

    fn fit(&self, samples: &Samples<'a>) -> Result<Linear> {
        samples::check(samples)?;
        let inputs = samples.records().view();
        let terms = Terms::Linear.of(inputs.ncols());
        let (x, y) = (design(inputs, &terms), targets(samples));
        let first = PivotedQr::of(x.clone());
        let leverage = first.basis().row_iter().map(|row| row.norm_squared().min(MOST_LEVERAGE)).collect::<Vec<_>>();
        let mut coefficients = first.solve(&y);
        let mut rank = first.rank();
        let spread = y.variance() * y.len() as f64 / (y.len() - 1) as f64;
        // Residuals of nothing but rounding are not outliers of each other.
        let least_scale = if spread > 0.0 { 1e-6 * spread.sqrt() } else { 1.0 };
        for _ in 0..MOST_ITERATIONS {
            let mut residuals = &y - &x * &coefficients;
            residuals.iter_mut().zip(&leverage).for_each(|(residual, h)| *residual /= (1.0 - h).sqrt());
            let scale = median_scale(&residuals, rank).max(least_scale);
            let root_weights = residuals.map(|residual| {
                let u = residual / (scale * TUNING);
                if u.abs() < 1.0 { 1.0 - u * u } else { 0.0 }
            });
            let mut weighted = x.clone();
            for mut column in weighted.column_iter_mut() {
                column.component_mul_assign(&root_weights);
            }
            let factors = PivotedQr::of(weighted);
            let next = factors.solve(&y.component_mul(&root_weights));
            rank = factors.rank();
            let still = coefficients
                .iter()
                .zip(next.iter())
                .all(|(old, new): (&f64, &f64)| (old - new).abs() <= f64::EPSILON.sqrt() * old.abs().max(new.abs()));
            coefficients = next;
            if still {
                break;
            }
        }
        Ok(Linear::of(inputs.ncols(), &terms, &coefficients))
    }
}

/// Standard deviation from the median magnitude of residuals, of which the `rank` smallest are left out: so many can be
/// made 0.
fn median_scale(residuals: &DVector<f64>, rank: usize) -> f64 {
    let mut magnitudes: Vec<f64> = residuals.iter().map(|residual| residual.abs()).collect();
    magnitudes.sort_by(f64::total_cmp);
    let kept = &magnitudes[rank.clamp(1, magnitudes.len()) - 1..];
    f64::midpoint(kept[(kept.len() - 1) / 2], kept[kept.len() / 2]) / NORMAL_MEDIAN
}
