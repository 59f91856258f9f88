//! Points that do not fit the others.

use metrology::f_tail;

use super::EdgeShift;
use super::motion::free_degree;
use super::system::System;
use crate::Error;

/// At most this share of the points is left out: where more do not fit, it is the model that does not.
const MOST: f64 = 0.2;
/// Residuals that are smaller than this share of the path are rounding.
const ROUNDING: f64 = 1e-11;

/// A point that was left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Its index among the points.
    pub index: usize,
    /// Its externally studentised residual.
    pub studentised: f64,
    /// Probability of one so large among all points if none is an outlier (Bonferroni).
    pub probability: f64,
}

/// Leaves out the worst point as long as it is an outlier at the significance `alpha`.
///
/// A point i of which only its own position or time is wrong moves `C^-1 r` most at i. `w_i` is that element over its
/// standard deviation, which for independent points is the studentised residual; the scale is told by the others, so that
/// `t_i = w_i / s_(i)` has Student's distribution whatever the scale of C.
///
/// # Reference
///
/// W. Baarda, *A testing procedure for use in geodetic networks*, Netherlands Geodetic Commission 2(5), 1968; R. D. Cook,
/// S. Weisberg, *Residuals and Influence in Regression*, 1982, section 2.2.
pub(super) fn left_out(mut system: System<'_>, alpha: f64) -> Result<(System<'_>, Vec<Outlier>), Error> {
    let mut outliers = Vec::new();
    let most = (MOST * system.len() as f64) as usize;
    while outliers.len() < most {
        match worst(&system)? {
            Some((place, outlier)) if outlier.probability < alpha => {
                system = system.without(place);
                outliers.push(outlier);
            }
            _ => break,
        }
    }
    outliers.sort_by_key(|outlier| outlier.index);
    Ok((system, outliers))
}

fn worst(system: &System<'_>) -> Result<Option<(usize, Outlier)>, Error> {
    let n = system.len();
    let Some(degree) = free_degree(n) else { return Ok(None) };
    // The shift is in the model whether it is wanted or not: without it every edge is off.
    let (fit, design) = system.fit_scaled(degree, EdgeShift::Fitted)?;
    let dof = fit.dof as f64;
    let Some(cholesky) = system.covariance().clone().cholesky() else { return Ok(None) };
    let span = (&design * &fit.coefficients).amax();
    let inverse = cholesky.inverse();
    let white = &inverse * &fit.residuals;
    let carried = &inverse * &design;
    let variances = &inverse - &carried * &fit.covariance_prior * carried.transpose();
    let studentised = |place: usize| {
        let w = white[place] / variances[(place, place)].sqrt();
        w / ((fit.chi2 - w * w).max(0.0) / (dof - 1.0)).sqrt()
    };
    let candidates = (0..n)
        .filter(|&place| fit.residuals[place].abs() > ROUNDING * span)
        .map(|place| (place, studentised(place)))
        .filter(|(_, t)| !t.is_nan());
    let largest = candidates.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    Ok(largest.map(|(place, studentised)| {
        let probability = (n as f64 * f_tail(studentised * studentised, 1, dof - 1.0)).min(1.0);
        (place, Outlier { index: system.kept()[place], studentised, probability })
    }))
}
