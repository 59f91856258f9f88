//! Which pictures a model accepts: those like the pictures of its training.

use ndarray::{Array1, ArrayView1, ArrayView2, Axis};
use serde::{Deserialize, Serialize};

use crate::reduce::{Components, Pca};
use crate::validate::Folds;
use crate::{Error, Result};

/// Share of honest pictures that may be refused, as far as the number of pictures of the training allows.
pub const FALSE_ALARM_RATE: f64 = 0.01;

/// Least share of the variance that counts as more than rounding.
const ROUNDING: f64 = 1e-20;

/// How far a picture may be from the principal subspace of the training and, within it, from the centre.
///
/// Two squares tell how unlike a PSF is: Hotelling's `T²`, the sum over the components of its squared coordinate divided
/// by their variance, and `Q`, the squared length of what the components leave of it. Their combination is
/// `T² / mean T² + Q / mean Q`, with means over pictures that were held out: the components were fitted five times to
/// four fifths of the pictures, since the pictures of a fit are always near their own components.
///
/// The limit is the `k`-th largest combination among the `n` held-out pictures, with the largest `k` for which
/// `k / (n + 1)` is at most [`FALSE_ALARM_RATE`], or else 1. A further picture that is taken like the others exceeds it
/// with the probability `k / (n + 1)`: all `n + 1` ranks are equally likely.
///
/// Like the others means of the same scenes, too: the PSF of another scene deviates in its own way. On the virtual rig, a
/// model of four posters accepts all pictures of a fifth that resembles them and none of one that is drawn. Nor does a
/// small distance prove a prediction: where the blur's length told the acceleration in the training, pictures of the same
/// lengths and other accelerations pass.
///
/// # Reference
/// J. E. Jackson and G. S. Mudholkar, "Control procedures for residuals associated with principal component analysis",
/// Technometrics 21(3), 1979; H. H. Yue and S. J. Qin, "Reconstruction-based fault identification using a combined
/// index", Ind. Eng. Chem. Res. 40, 2001; the limit: V. Vovk, A. Gammerman and G. Shafer, "Algorithmic learning in a
/// random world", 2005, section 4.2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    /// Mean `T²` of held-out pictures.
    mean_t_squared: f64,
    /// Mean `Q` of held-out pictures; 0 when the components leave nothing.
    mean_q: f64,
    /// Largest combination that is accepted.
    limit: f64,
    false_alarm_rate: f64,
}

impl Domain {
    pub(super) fn learn(pca: &Pca, inputs: ArrayView2<'_, f64>, components: Components, folds: &Folds) -> Result<Self> {
        let pictures = inputs.nrows();
        let mut squares = Vec::with_capacity(pictures);
        for (known, held_out) in folds.splits() {
            let others = Pca::fit(inputs.select(Axis(0), &known).view(), components)?;
            for &row in held_out {
                squares.push(self::squares(&others, inputs.row(row))?);
            }
        }
        let mean = |pick: fn(&(f64, f64)) -> f64| squares.iter().map(pick).sum::<f64>() / pictures as f64;
        let mean_q = mean(|squares| squares.1);
        let total: f64 = pca.variances().sum();
        let mut domain = Self {
            mean_t_squared: mean(|squares| squares.0),
            mean_q: if mean_q > ROUNDING * total { mean_q } else { 0.0 },
            limit: 1.0,
            false_alarm_rate: 0.0,
        };
        let mut combined: Vec<f64> = squares.into_iter().map(|squares| domain.combine(squares)).collect();
        combined.sort_by(|a, b| b.total_cmp(a));
        let rank = ((FALSE_ALARM_RATE * (pictures + 1) as f64) as usize).max(1);
        domain.limit = combined[rank - 1];
        domain.false_alarm_rate = rank as f64 / (pictures + 1) as f64;
        domain.check()?;
        Ok(domain)
    }

    /// Probability that a picture taken like those of the training is refused.
    pub fn false_alarm_rate(&self) -> f64 {
        self.false_alarm_rate
    }

    /// Distance of a PSF from those of the training, in units of the largest that is accepted.
    pub(super) fn distance(&self, pca: &Pca, psf: ArrayView1<'_, f64>) -> Result<f64> {
        Ok((self.combine(squares(pca, psf)?) / self.limit).sqrt())
    }

    fn combine(&self, (t_squared, q): (f64, f64)) -> f64 {
        let off_subspace = if self.mean_q > 0.0 { q / self.mean_q } else { 0.0 };
        t_squared / self.mean_t_squared + off_subspace
    }

    pub(super) fn check(&self) -> Result<()> {
        if !(self.mean_q.is_finite() && self.mean_q >= 0.0) {
            let (name, value) = ("mean Q of the training", self.mean_q);
            return Err(Error::Parameter { name, value, expected: "at least 0" });
        }
        for (name, value) in
            [("limit of the distance to the training", self.limit), ("mean T² of the training", self.mean_t_squared)]
        {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::Parameter { name, value, expected: "above 0; pictures that all differ are needed" });
            }
        }
        Ok(())
    }
}

/// `T²` and `Q` of an observation.
fn squares(pca: &Pca, observation: ArrayView1<'_, f64>) -> Result<(f64, f64)> {
    let observation = observation.insert_axis(Axis(0));
    let scores = pca.apply(observation)?;
    let least = ROUNDING * pca.variances().sum();
    let scaled = |(score, variance): (&f64, &f64)| if *variance > least { score * score / variance } else { 0.0 };
    let rest: Array1<f64> = pca.residuals(observation)?.remove_axis(Axis(0));
    Ok((scores.iter().zip(pca.variances()).map(scaled).sum(), rest.dot(&rest)))
}
