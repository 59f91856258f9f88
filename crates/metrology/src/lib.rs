//! Measured values and their uncertainties after the *Guide to the expression of uncertainty in measurement*.
//!
//! # From readings to a result
//!
//! ```text
//! TypeA, type_b -> Input (+ Correlation) -> propagate -> Combined -> Coverage -> Budget -> text, Markdown, JSON
//!                                       \-> monte_carlo -> Sample -> validate
//! ```
//!
//! ```
//! use metrology::{Budget, Correlation, Coverage, Input, propagate};
//!
//! // v = L s / T: a blur of L pixels, s metres per pixel, exposed for T seconds.
//! let inputs = [
//!     Input::new("L", 23.40, 0.20)?.with_unit("px").with_dof(9.0)?,
//!     Input::new("s", 0.4120e-3, 0.0015e-3)?.with_unit("m/px"),
//!     Input::new("T", 1.0 / 60.0, 2e-5)?.with_unit("s"),
//! ];
//! let v = propagate(&inputs, &Correlation::independent(3), |q| q[0] * q[1] / q[2])?;
//! let budget = Budget::new("v", "m/s", &inputs, &v, Coverage::Probability(0.95))?;
//! assert_eq!(v.measurement()?.to_string(), "0.5784(54)");
//! assert!((v.dof() - 13.0).abs() < 0.05);
//! println!("{}", budget.to_text());
//! # Ok::<(), metrology::Error>(())
//! ```
//!
//! # Conventions
//!
//! - `std` is a standard uncertainty `u`, one standard deviation, in the unit of its value. An expanded uncertainty `U`
//!   is always called so and comes with its coverage factor `k`.
//! - Units are text for the reader of a budget. Nothing converts them: a model gets the numbers as they were given.
//! - Degrees of freedom are real numbers greater than 0; `f64::INFINITY` means that the standard uncertainty is known
//!   exactly. JSON has no infinity: there it is `null`.
//! - Probabilities, shares and correlation coefficients are fractions of 1. Only what is called `percent` is per cent.
//! - [`propagate`] is first order. Where a model is not nearly linear within the uncertainties,
//!   [`monte_carlo`](monte_carlo::monte_carlo) is the answer, and [`validate`](monte_carlo::validate) or [`second_order_std`] tells.
//!
//! # References
//!
//! - "GUM": JCGM 100:2008, *Guide to the expression of uncertainty in measurement*.
//! - JCGM 101:2008, *Supplement 1: Propagation of distributions using a Monte Carlo method*.
//! - JCGM 102:2011, *Supplement 2: Extension to any number of output quantities*.
//! - "Thesis": chapter 8, equations 8.2 to 8.14, the calibration of the slider.

pub mod budget;
mod concise;
mod correlation;
pub mod coverage;
mod distribution;
mod dof;
mod dual;
mod error;
mod input;
pub mod joint;
pub mod least_squares;
mod measurement;
#[cfg(feature = "monte-carlo")]
pub mod monte_carlo;
mod propagate;
mod quantile;
mod second_order;
mod type_a;
pub mod type_b;

pub use budget::{Budget, Row};
pub use concise::{concise, rounded};
pub use correlation::Correlation;
pub use coverage::{Coverage, coverage_factor};
pub use distribution::Distribution;
pub use dof::welch_satterthwaite;
pub use dual::Dual;
pub use error::Error;
pub use input::Input;
pub use joint::{Joint, propagate_joint};
pub use measurement::{Measurement, combined_std};
pub use propagate::{Combined, propagate, propagate_numeric, sensitivities, sensitivities_numeric, values_of};
pub use quantile::{chi_squared_quantile, f_tail, normal_quantile, student_t_quantile};
pub use second_order::second_order_std;
pub use type_a::{TypeA, correlation_of_means};
