//! The settings of thesis table 6.2.

use linfa::traits::Fit;
use ndarray::{ArrayView1, ArrayView2};

use super::gaussian_process::{GaussianProcessRegression, Kernel};
use super::linear::{LeastSquares, Robust, Stepwise, Terms};
use super::support_vector::{self, SupportVectorMachine};
use super::tree::{Bagging, Boosting, Cart};
use super::{Fitted, Samples};
use crate::{Error, Result};

/// What the thesis states in a row of table 6.2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThesisRow {
    /// m/s².
    pub rmse: f64,
    /// Coefficient of determination.
    pub r_squared: f64,
    /// m/s².
    pub mae: f64,
}

impl ThesisRow {
    const fn of(rmse: f64, r_squared: f64, mae: f64) -> Self {
        Self { rmse, r_squared, mae }
    }
}

/// A regression with all its settings.
pub struct Preset {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Name in thesis table 6.2.
    pub title: &'static str,
    /// Its row there.
    pub thesis: ThesisRow,
    fit: fn(&Samples<'_>, u64) -> Result<Fitted>,
}

impl Preset {
    /// The preset called `name`.
    ///
    /// # Errors
    /// [`Error::UnknownRegression`].
    pub fn named(name: &str) -> Result<&'static Self> {
        PRESETS.iter().find(|preset| preset.name == name).ok_or_else(|| Error::UnknownRegression {
            name: name.to_owned(),
            known: PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>().join(" "),
        })
    }

    /// Fits `targets` to `inputs`, one observation a row, columns standardised; what is drawn is drawn with `seed`.
    ///
    /// # Errors
    /// For data that are not finite, of different sizes or too few.
    pub fn fit(&self, inputs: ArrayView2<'_, f64>, targets: ArrayView1<'_, f64>, seed: u64) -> Result<Fitted> {
        // One lifetime for both.
        (self.fit)(&Samples::new(inputs.reborrow(), targets.reborrow()), seed)
    }
}

const SMALL_LEAF: Cart = Cart { least_leaf: 4 };
const MEDIUM_LEAF: Cart = Cart { least_leaf: 12 };
const LARGE_LEAF: Cart = Cart { least_leaf: 36 };
const ENSEMBLE_LEAF: Cart = Cart { least_leaf: 8 };
const ENSEMBLE: usize = 30;
const RATE: f64 = 0.1;

fn gaussian_process(kernel: Kernel, samples: &Samples<'_>) -> Result<Fitted> {
    GaussianProcessRegression { kernel }.fit(samples).map(Fitted::GaussianProcess)
}

fn least_squares(terms: Terms, samples: &Samples<'_>) -> Result<Fitted> {
    LeastSquares { terms }.fit(samples).map(Fitted::Linear)
}

fn polynomial_machine(degree: i32, samples: &Samples<'_>) -> Result<Fitted> {
    let kernel = support_vector::Kernel::Polynomial { degree };
    SupportVectorMachine { kernel }.fit(samples).map(Fitted::SupportVectors)
}

fn gaussian_machine(scale: f64, samples: &Samples<'_>) -> Result<Fitted> {
    let kernel = support_vector::Kernel::Gaussian { scale };
    SupportVectorMachine { kernel }.fit(samples).map(Fitted::SupportVectors)
}

/// All of table 6.2, in its order.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "trees-bagged",
        title: "Bagged Trees",
        thesis: ThesisRow::of(0.4124, 0.60, 0.3396),
        fit: |samples, seed| Bagging { trees: ENSEMBLE, tree: ENSEMBLE_LEAF, seed }.fit(samples).map(Fitted::Bagged),
    },
    Preset {
        name: "trees-boosted",
        title: "Boosted Trees",
        thesis: ThesisRow::of(0.3507, 0.71, 0.2452),
        fit: |samples, _| {
            Boosting { trees: ENSEMBLE, rate: RATE, tree: ENSEMBLE_LEAF }.fit(samples).map(Fitted::Boosted)
        },
    },
    Preset {
        name: "gpr-exponential",
        title: "GPR Exponential",
        thesis: ThesisRow::of(0.3187, 0.76, 0.2501),
        fit: |samples, _| gaussian_process(Kernel::Exponential, samples),
    },
    Preset {
        name: "gpr-matern52",
        title: "GPR Matern 5/2",
        thesis: ThesisRow::of(0.2547, 0.85, 0.1921),
        fit: |samples, _| gaussian_process(Kernel::Matern52, samples),
    },
    Preset {
        name: "gpr-rational-quadratic",
        title: "GPR Rational Quadratic",
        thesis: ThesisRow::of(0.2553, 0.85, 0.1924),
        fit: |samples, _| gaussian_process(Kernel::RationalQuadratic, samples),
    },
    Preset {
        name: "gpr-squared-exponential",
        title: "GPR Squared Exponential",
        thesis: ThesisRow::of(0.2553, 0.85, 0.1924),
        fit: |samples, _| gaussian_process(Kernel::SquaredExponential, samples),
    },
    Preset {
        name: "linear-interactions",
        title: "Interactions Linear",
        thesis: ThesisRow::of(0.3371, 0.74, 0.2378),
        fit: |samples, _| least_squares(Terms::Interactions, samples),
    },
    Preset {
        name: "linear",
        title: "Linear",
        thesis: ThesisRow::of(0.2553, 0.85, 0.1978),
        fit: |samples, _| least_squares(Terms::Linear, samples),
    },
    Preset {
        name: "linear-robust",
        title: "Robust Linear",
        thesis: ThesisRow::of(0.2558, 0.85, 0.1993),
        fit: |samples, _| Robust.fit(samples).map(Fitted::Linear),
    },
    Preset {
        name: "linear-stepwise",
        title: "Stepwise Linear",
        thesis: ThesisRow::of(0.2956, 0.80, 0.2251),
        fit: |samples, _| Stepwise.fit(samples).map(Fitted::Linear),
    },
    Preset {
        name: "svm-coarse-gaussian",
        title: "SVM Coarse Gaussian",
        thesis: ThesisRow::of(0.6607, -0.02, 0.5669),
        fit: |samples, _| gaussian_machine(4.0, samples),
    },
    Preset {
        name: "svm-cubic",
        title: "SVM Cubic",
        thesis: ThesisRow::of(0.3256, 0.75, 0.2764),
        fit: |samples, _| polynomial_machine(3, samples),
    },
    Preset {
        name: "svm-fine-gaussian",
        title: "SVM Fine Gaussian",
        thesis: ThesisRow::of(0.4611, 0.51, 0.3532),
        fit: |samples, _| gaussian_machine(0.25, samples),
    },
    Preset {
        name: "svm-medium-gaussian",
        title: "SVM Medium Gaussian",
        thesis: ThesisRow::of(0.5243, 0.36, 0.4265),
        fit: |samples, _| gaussian_machine(1.0, samples),
    },
    Preset {
        name: "svm-linear",
        title: "SVM Linear",
        thesis: ThesisRow::of(0.3747, 0.67, 0.3043),
        fit: |samples, _| polynomial_machine(1, samples),
    },
    Preset {
        name: "svm-quadratic",
        title: "SVM Quadratic",
        thesis: ThesisRow::of(0.2843, 0.80, 0.2446),
        fit: |samples, _| polynomial_machine(2, samples),
    },
    Preset {
        name: "tree-coarse",
        title: "Coarse Tree",
        thesis: ThesisRow::of(0.6327, 0.07, 0.5279),
        fit: |samples, _| LARGE_LEAF.fit(samples).map(Fitted::Tree),
    },
    Preset {
        name: "tree-fine",
        title: "Fine Tree",
        thesis: ThesisRow::of(0.4915, 0.44, 0.3202),
        fit: |samples, _| SMALL_LEAF.fit(samples).map(Fitted::Tree),
    },
    Preset {
        name: "tree-medium",
        title: "Medium Tree",
        thesis: ThesisRow::of(0.4604, 0.51, 0.3416),
        fit: |samples, _| MEDIUM_LEAF.fit(samples).map(Fitted::Tree),
    },
];
