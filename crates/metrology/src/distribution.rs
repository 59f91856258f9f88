use std::fmt;

use crate::Error;
use crate::error::check;

/// Shape of the state of knowledge about an input; its place and width are the input's value and standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Distribution {
    /// Normal.
    Normal,
    /// Student's t with the degrees of freedom of the input, scaled by its standard uncertainty `s / sqrt(n)` and
    /// shifted (JCGM 101 6.4.9). Its standard deviation is larger by `sqrt(dof / (dof - 2))`.
    StudentT,
    /// Rectangular (JCGM 101 6.4.2).
    Rectangular,
    /// Symmetric triangular (JCGM 101 6.4.5).
    Triangular,
    /// Arcsine, U-shaped (JCGM 101 6.4.6).
    Arcsine,
    /// Symmetric trapezoidal (JCGM 101 6.4.4).
    Trapezoidal {
        /// Width of the top divided by that of the base, 0..=1.
        beta: f64,
    },
    /// Rectangular with inexactly known limits, curvilinear trapezoid (JCGM 101 6.4.3).
    Curvilinear {
        /// Inexactness `d` of the limits divided by the half-width, 0..=1.
        inexactness: f64,
    },
}

impl Distribution {
    /// Half-width of the limits of a distribution of standard deviation 1; 1 for the unbounded ones. For
    /// [`Distribution::Curvilinear`] it is the half-width between the best estimates of the limits.
    pub fn half_width_per_std(self) -> f64 {
        match self {
            Self::Normal | Self::StudentT => 1.0,
            Self::Rectangular => 3.0_f64.sqrt(),
            Self::Triangular => 6.0_f64.sqrt(),
            Self::Arcsine => 2.0_f64.sqrt(),
            Self::Trapezoidal { beta } => (6.0 / (1.0 + beta * beta)).sqrt(),
            Self::Curvilinear { inexactness } => 3.0 / (3.0 + inexactness * inexactness).sqrt(),
        }
    }

    pub(crate) fn checked(self) -> Result<Self, Error> {
        match self {
            Self::Trapezoidal { beta } => check((0.0..=1.0).contains(&beta), "beta of a trapezoid", beta, "in 0..=1")?,
            Self::Curvilinear { inexactness: d } => {
                check((0.0..=1.0).contains(&d), "inexactness of the limits", d, "in 0..=1")?
            }
            _ => 0.0,
        };
        Ok(self)
    }
}

/// The name of the shape, as a budget prints it.
impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Normal => "normal",
            Self::StudentT => "t",
            Self::Rectangular => "rectangular",
            Self::Triangular => "triangular",
            Self::Arcsine => "arcsine",
            Self::Trapezoidal { .. } => "trapezoidal",
            Self::Curvilinear { .. } => "curvilinear",
        })
    }
}
