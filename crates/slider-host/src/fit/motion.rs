//! Whether the motion was uniform, uniformly accelerated, or neither.

use metrology::{chi_squared_quantile, f_tail};

use super::system::System;
use super::{EdgeShift, PLAUSIBLE};
use crate::Error;
use crate::outcome::Kind;

/// Degree of the polynomial that stands for any smooth motion: it follows a start, a stop and a kink between.
const FREE: usize = 5;

/// The tests and what they led to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decision {
    /// What the motion was.
    pub kind: Kind,
    /// Probability of so much gain by the terms above the parabola if there are none; 1 if there are too few points to tell.
    pub higher_p: f64,
    /// Probability of so much gain by the parabola over the line if there is no acceleration.
    pub acceleration_p: f64,
    /// Significance of both together.
    pub significance: f64,
}

/// Highest degree for which `n` points leave some to judge by; `None` for so few that nothing can be judged.
pub(super) fn free_degree(n: usize) -> Option<usize> {
    // One more for the shift, three degrees of freedom for the scale.
    n.checked_sub(5).filter(|&degree| degree > 2).map(|degree| degree.min(FREE))
}

/// Tests nested polynomials: 5 against 2 for a motion that is neither, 2 against 1 for an acceleration.
///
/// Each test has half of the significance, and they are independent: the gains by further terms are squares of orthogonal
/// normal variables. So a uniform motion is called something else with the probability `significance`, and an accelerated
/// one is called neither with half of it. The gains are chi-squared of the given covariance; F against what degree 5
/// leaves if nothing is known of the points, or if that is more than their uncertainties allow.
///
/// A shift of edges is among the terms whenever there are edges: it is not a matter of the motion.
pub(super) fn decide(system: &System<'_>, significance: f64) -> Result<Decision, Error> {
    let mut decision = Decision { kind: Kind::Uniform, higher_p: 1.0, acceleration_p: 1.0, significance };
    let n = system.len();
    let Some(free) = free_degree(n) else { return few(system, decision) };
    let chi2_of = |degree: usize| system.fit_scaled(degree, EdgeShift::Fitted).map(|(fit, _)| (fit.chi2, fit.dof));
    let (free_chi2, dof) = chi2_of(free)?;
    let dof_real = dof as f64;
    let believed = system.is_known() && free_chi2 <= chi_squared_quantile(PLAUSIBLE, dof_real)?;
    let (scale, denominator) = if believed { (1.0, f64::INFINITY) } else { (free_chi2 / dof_real, dof_real) };
    let p = |gain: f64, terms: usize| f_tail(gain.max(0.0) / terms as f64 / scale, terms, denominator);
    let (parabola, _) = chi2_of(2)?;
    decision.higher_p = p(parabola - free_chi2, free - 2);
    decision.acceleration_p = p(chi2_of(1)?.0 - parabola, 1);
    decide_by(&mut decision);
    Ok(decision)
}

fn decide_by(decision: &mut Decision) {
    let alpha = decision.significance / 2.0;
    decision.kind = if decision.higher_p < alpha {
        Kind::Neither
    } else if decision.acceleration_p < alpha {
        Kind::Accelerated
    } else {
        Kind::Uniform
    };
}

/// Too few points for a free polynomial: only the parabola against the line.
fn few(system: &System<'_>, mut decision: Decision) -> Result<Decision, Error> {
    if system.len() < 4 {
        return Ok(decision);
    }
    let (line, _) = system.fit_scaled(1, EdgeShift::None)?;
    let (parabola, _) = system.fit_scaled(2, EdgeShift::None)?;
    let gain = (line.chi2 - parabola.chi2).max(0.0);
    decision.acceleration_p = if system.is_known() {
        f_tail(gain, 1, f64::INFINITY)
    } else {
        let dof = parabola.dof as f64;
        f_tail(gain / (parabola.chi2 / dof), 1, dof)
    };
    decide_by(&mut decision);
    Ok(decision)
}
