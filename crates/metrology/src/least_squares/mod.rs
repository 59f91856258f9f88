//! Linear least squares: coefficients b that make `A b` come closest to data y, and how well they are known.
//!
//! [`ordinary`] takes data of equal variance, [`weighted`] independent data, [`generalised`] data of any covariance,
//! singular ones included. All go through a Householder QR with column pivoting of a [`Design`] matrix whose columns are
//! scaled; normal equations, which square the condition, are never formed. Residuals and coefficients are then refined
//! together with residuals in double-double, so that the digits which are lost to the condition come back.
//!
//! ```
//! use metrology::least_squares::{Design, ordinary};
//! let (t_s, x_m) = ([0.0, 1.0, 2.0, 3.0], [0.1, 2.0, 4.1, 6.0]);
//! let fit = ordinary(&Design::polynomial(&t_s, 1), &x_m)?;
//! assert!((fit.coefficients[1] - 1.98).abs() < 1e-12); // m/s
//! assert!((fit.chi2 - 0.008).abs() < 1e-12 && fit.dof == 2);
//! # Ok::<(), metrology::Error>(())
//! ```
//!
//! # Reference
//!
//! Å. Björck, "Iterative refinement of linear least squares solutions I", BIT 7 (1967) 257-278; JCGM 102:2011, section 6
//! for covariance matrices. The accuracy is measured with the NIST Statistical Reference Datasets, whose certified values
//! the tests of this project reproduce.

mod augmented;
mod constrained;
mod design;
mod double_double;
mod householder;
mod whiten;

use nalgebra::{DMatrix, DVector};

pub use design::Design;

use crate::Error;
use augmented::Augmented;
use constrained::Conditions;
use double_double::DoubleDouble;
use whiten::Whitening;

/// A fit. `n` points, `p` coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The `p` coefficients b.
    pub coefficients: DVector<f64>,
    /// The `n` residuals `y - A b`, in the unit of y.
    pub residuals: DVector<f64>,
    /// Covariance of the coefficients if the variances of the data are what was given: `(A' C^-1 A)^-1`, with 1 for C in
    /// [`ordinary`] and the inverse weights in [`weighted`] (JCGM 102, 6.2: a priori).
    pub covariance_prior: DMatrix<f64>,
    /// Weighted sum of squares of the residuals, `r' C^-1 r`.
    pub chi2: f64,
    /// Degrees of freedom: points less coefficients.
    pub dof: usize,
    /// Diagonal of the hat matrix: how far each residual is drawn to 0, from 0 to 1 for independent data.
    pub leverage: DVector<f64>,
    /// The matrix, `p` by `n`, that makes coefficients of data: by it an uncertainty of any datum is propagated.
    pub gain: DMatrix<f64>,
    /// Share of the (weighted) scatter about the mean that the fit explains; NaN when there is no scatter. Right for models
    /// with a constant. Of [`generalised`], that of the data without weights.
    pub r_squared: f64,
    /// Share of the (weighted) sum of squares that the fit explains: what NIST certifies for models without a constant.
    pub r_squared_about_zero: f64,
}

impl Fit {
    /// Standard deviation of the residuals at unit weight, `sqrt(chi2 / dof)`: the Birge ratio, if variances were given.
    /// NaN without degrees of freedom.
    pub fn residual_std(&self) -> f64 {
        (self.chi2 / self.dof as f64).sqrt()
    }

    /// Covariance of the coefficients from the scatter of the residuals: a posteriori. NaN without degrees of freedom.
    pub fn covariance_posterior(&self) -> DMatrix<f64> {
        &self.covariance_prior * self.residual_std().powi(2)
    }

    /// Standard uncertainties of the coefficients from the given variances.
    pub fn std_errors_prior(&self) -> DVector<f64> {
        self.covariance_prior.diagonal().map(f64::sqrt)
    }

    /// Standard uncertainties of the coefficients from the scatter of the residuals.
    pub fn std_errors_posterior(&self) -> DVector<f64> {
        self.std_errors_prior() * self.residual_std()
    }
}

/// Fits data of equal, unknown variance: minimises `|y - A b|`.
pub fn ordinary(design: &Design, y: &[f64]) -> Result<Fit, Error> {
    weighted(design, y, &vec![1.0; y.len()])
}

/// Fits independent data: minimises the sum of `w (y - A b)^2`. A weight is an inverse variance, or proportional to it;
/// then only what is a posteriori has a meaning.
pub fn weighted(design: &Design, y: &[f64], weights: &[f64]) -> Result<Fit, Error> {
    check(design, y)?;
    if weights.len() != y.len() {
        return Err(Error::Shape { what: "weights", expected: y.len(), found: weights.len() });
    }
    for (index, &weight) in weights.iter().enumerate() {
        if !(weight.is_finite() && weight > 0.0) {
            return Err(Error::Weight { index, weight });
        }
    }
    let roots: Vec<f64> = weights.iter().map(|weight| weight.sqrt()).collect();
    let mut scaled = design.clone();
    scaled.scale_rows(&roots);
    let right: Vec<_> = y.iter().zip(&roots).map(|(&y, &root)| DoubleDouble::product(y, root)).collect();
    let system = Augmented::new(&scaled)?;
    let (white_residuals, coefficients) = system.fit(&right);
    let residuals = white_residuals.iter().zip(&roots).map(|(&r, &root)| (r / root).rounded());
    let mut gain = system.gain();
    for (mut column, root) in gain.column_iter_mut().zip(&roots) {
        column *= *root;
    }
    let chi2 = sum_of_squares(&white_residuals);
    let shares = shares(y, weights, chi2);
    Ok(Fit {
        residuals: DVector::from_iterator(y.len(), residuals),
        covariance_prior: system.inverse_gram(),
        chi2,
        dof: y.len() - coefficients.len(),
        leverage: leverage(design, &gain),
        gain,
        r_squared: shares.0,
        r_squared_about_zero: shares.1,
        coefficients,
    })
}

/// Fits data of covariance C (`n` by `n`, in the unit of y squared): minimises `(y - A b)' C^-1 (y - A b)`.
///
/// C may be singular: in the directions without variance the fit goes exactly through the data, which takes a coefficient
/// from the others or, where the data contradict each other, is an error.
///
/// # Reference
///
/// JCGM 102:2011, 6.2 and appendix D.2; for singular C C. C. Paige, SIAM J. Numer. Anal. 16 (1979) 165-171.
pub fn generalised(design: &Design, y: &[f64], covariance: &DMatrix<f64>) -> Result<Fit, Error> {
    check(design, y)?;
    let (n, p) = (y.len(), design.columns());
    if covariance.nrows() != n || covariance.ncols() != n {
        return Err(Error::Shape { what: "rows of the covariance", expected: n, found: covariance.nrows() });
    }
    let Whitening { white, exact } = Whitening::of(covariance)?;
    let data = DVector::from_column_slice(y);
    let conditions = Conditions::new(&(&exact * design.rounded()), &(&exact * &data))?;
    // b = fixed d + free c; the white data less what the conditions explain are left to c.
    let fixed = &conditions.fixed * &exact;
    let (rows, free) = (white.nrows(), conditions.free.ncols());
    if rows < free {
        return Err(Error::TooFewPoints { points: rows, coefficients: free });
    }
    let white_design = &white * design.rounded();
    let projection = &white - &white_design * &fixed;
    let right: Vec<_> = (&projection * &data).iter().map(|&y| y.into()).collect();
    let (white_residuals, gain, covariance_prior) = if free == 0 {
        (right, fixed, DMatrix::zeros(p, p))
    } else {
        let reduced = Design::from(white_design * &conditions.free);
        let system = Augmented::new(&reduced)?;
        let (residuals, _) = system.fit(&right);
        let gain = fixed + &conditions.free * system.gain() * projection;
        (residuals, gain, &conditions.free * system.inverse_gram() * conditions.free.transpose())
    };
    let coefficients = &gain * &data;
    let residuals = DVector::from_fn(n, |row, _| {
        let sum = (0..p).fold(DoubleDouble::from(y[row]), |sum, column| {
            sum - design.get(row, column) * DoubleDouble::from(coefficients[column])
        });
        sum.rounded()
    });
    let shares = shares(y, &vec![1.0; n], residuals.norm_squared());
    Ok(Fit {
        chi2: sum_of_squares(&white_residuals),
        dof: rows - free,
        leverage: leverage(design, &gain),
        r_squared: shares.0,
        r_squared_about_zero: shares.1,
        coefficients,
        residuals,
        covariance_prior,
        gain,
    })
}

fn check(design: &Design, y: &[f64]) -> Result<(), Error> {
    let (n, p) = (design.rows(), design.columns());
    if y.len() != n {
        return Err(Error::Shape { what: "data", expected: n, found: y.len() });
    }
    if n < p {
        return Err(Error::TooFewPoints { points: n, coefficients: p });
    }
    for (index, y) in y.iter().enumerate() {
        if !y.is_finite() {
            return Err(Error::NotFinite { what: "data", index });
        }
        if !design.rounded().row(index).iter().all(|element| element.is_finite()) {
            return Err(Error::NotFinite { what: "elements of the design matrix", index });
        }
    }
    Ok(())
}

fn sum_of_squares(residuals: &[DoubleDouble]) -> f64 {
    residuals.iter().fold(DoubleDouble::default(), |sum, &r| sum + r * r).rounded()
}

fn leverage(design: &Design, gain: &DMatrix<f64>) -> DVector<f64> {
    DVector::from_fn(design.rows(), |row, _| design.rounded().row(row).transpose().dot(&gain.column(row)))
}

/// R^2 about the weighted mean, and about zero.
fn shares(y: &[f64], weights: &[f64], unexplained: f64) -> (f64, f64) {
    let sum = |term: &dyn Fn(f64) -> f64| y.iter().zip(weights).map(|(&y, w)| w * term(y)).sum::<f64>();
    let mean = sum(&|y| y) / weights.iter().sum::<f64>();
    // 0 / 0 is NaN on purpose: there is nothing to explain.
    let share = |total: f64| if total > 0.0 { 1.0 - unexplained / total } else { f64::NAN };
    (share(sum(&|y| (y - mean).powi(2))), share(sum(&|y| y * y)))
}
