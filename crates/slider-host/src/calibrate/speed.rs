//! Speeds: the calibration tooth over the time of its passage.

use metrology::{Budget, Combined, Correlation, Coverage, Distribution, Dual, Input, coverage, propagate};

use super::direct::{Direct, PROBABILITY, standard};
use super::instrument::Instruments;
use super::readings::Pairs;
use crate::Error;

/// The evaluation of one speed, m/s.
#[derive(Debug, Clone)]
pub struct Speed {
    /// Number of the speed.
    pub index: f64,
    /// The time of passage, s, with its type A, B1 and B2 (eq. 8.2, 8.7 in 8.3, 8.4).
    pub time: Direct,
    /// Speed v = x / t (eq. 8.8).
    pub value: f64,
    /// Sensitivity to the time, -x / t^2, m/s^2 (eq. 8.9).
    pub c_t: f64,
    /// Sensitivity to the width, 1 / t, 1/s (eq. 8.10).
    pub c_x: f64,
    /// Combined standard uncertainty (eq. 8.11).
    pub combined: f64,
    /// What the time contributes, `U_1` (eq. 8.12).
    pub u_1: f64,
    /// What the rest contributes, `U_R` (eq. 8.13).
    pub u_r: f64,
    /// Expanded by the coverage factor of the instruments, 1.65 in the thesis (eq. 8.6).
    pub expanded: f64,
    /// The largest of the six contributions and whether it is a rectangle that dominates; `None` if nothing contributes.
    pub dominance: Option<coverage::Dominance>,
    /// The whole budget, expanded by Student's t of 95 % and the effective degrees of freedom.
    pub budget: Budget,
    /// The same by the time of the standard, that is, with the deviation corrected instead of called an uncertainty
    /// (GUM 3.2.4).
    pub corrected: Budget,
}

impl Speed {
    /// Evaluates the passes at one speed. `tooth` is the calibration tooth, mm.
    pub fn new(pairs: &Pairs, tooth: &Direct, instruments: &Instruments) -> Result<Self, Error> {
        let label = format!("speed {}", pairs.setting);
        let time = Direct::compared(label.clone(), "s", pairs, &instruments.timer, instruments.coverage_k)?;
        let (inputs, combined) = quotient(&tooth.inputs, &time.inputs)?;
        let root = |sum: f64| sum.sqrt();
        let contributions = combined.contributions();
        let (x, t) = contributions.split_at(tooth.inputs.len());
        let square_sum = |part: &[f64]| part.iter().map(|u| u * u).sum::<f64>();
        let shapes: Vec<Distribution> = inputs.iter().map(Input::distribution).collect();
        let by_standard = standard(pairs, &instruments.photogate, "s")?;
        let (corrected_inputs, corrected) = quotient(&tooth.inputs, &by_standard)?;
        let coverage = Coverage::Probability(PROBABILITY);
        let width_m = tooth.mean / 1e3;
        Ok(Self {
            index: pairs.setting,
            value: combined.value(),
            c_t: -width_m / (time.mean * time.mean),
            c_x: 1.0 / time.mean,
            combined: combined.std(),
            u_1: root(square_sum(t)),
            u_r: root(square_sum(x)),
            expanded: combined.expanded(instruments.coverage_k),
            dominance: coverage::dominance(contributions, &shapes),
            budget: Budget::new(&label, "m/s", &inputs, &combined, coverage)?,
            corrected: Budget::new(label, "m/s", &corrected_inputs, &corrected, coverage)?,
            time,
        })
    }
}

/// The sum of the widths (mm) over the sum of the times (s), m/s.
fn quotient(widths: &[Input], times: &[Input]) -> Result<(Vec<Input>, Combined), Error> {
    let named = |what: &str, input: &Input| input.clone().with_label(format!("{what}: {}", input.label()));
    let inputs: Vec<Input> = widths.iter().map(|x| named("x", x)).chain(times.iter().map(|t| named("t", t))).collect();
    let model = |q: &[Dual]| {
        let sum = |part: &[Dual]| part.iter().fold(Dual::constant(0.0), |sum, &term| sum + term);
        let (x, t) = q.split_at(widths.len().min(q.len()));
        sum(x) / sum(t) * 1e-3
    };
    let combined = propagate(&inputs, &Correlation::independent(inputs.len()), model)?;
    Ok((inputs, combined))
}
