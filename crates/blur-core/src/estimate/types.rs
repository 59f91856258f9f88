//! Results of the estimators.

use std::fmt;

/// The direction of a motion as far as one picture can tell: an axis, not an arrow.
///
/// Degrees counter-clockwise from +x as seen (y up), always in `[0, 180)`. The magnitude spectrum of a picture is the
/// same for a motion and its opposite, so `theta` and `theta + 180` are one value here.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct AxialAngle(f64);

impl AxialAngle {
    /// The axis at `deg` degrees; any finite number is folded into `[0, 180)`. NaN and infinities give the axis 0.
    pub fn from_deg(deg: f64) -> Self {
        let folded = if deg.is_finite() { deg.rem_euclid(180.0) } else { 0.0 };
        // rem_euclid rounds tiny negative numbers up to 180 itself.
        Self(if folded >= 180.0 { 0.0 } else { folded })
    }

    /// Degrees in `[0, 180)`.
    pub fn deg(self) -> f64 {
        self.0
    }

    /// Radians in `[0, pi)`.
    pub fn rad(self) -> f64 {
        self.0.to_radians()
    }

    /// Signed difference `self - other` folded into `[-90, 90)` degrees.
    ///
    /// ```
    /// use blur_core::estimate::AxialAngle;
    /// let difference = AxialAngle::from_deg(179.0).minus_deg(AxialAngle::from_deg(2.0));
    /// assert_eq!(difference, -3.0);
    /// ```
    pub fn minus_deg(self, other: Self) -> f64 {
        (self.0 - other.0 + 90.0).rem_euclid(180.0) - 90.0
    }

    /// Distance to another axis in `[0, 90]` degrees.
    pub fn distance_deg(self, other: Self) -> f64 {
        self.minus_deg(other).abs()
    }
}

/// Why a result is not certain.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// Another direction explains the spectrum nearly as well as the one found.
    RivalAngle {
        /// Response of the best other direction relative to the one found.
        share: f64,
        /// Largest share at which an answer is trusted.
        most: f64,
    },
    /// No pattern of a blur was found at all.
    NoPattern,
    /// The feature that gives the length hardly stands out from its surroundings.
    WeakLengthPeak {
        /// Height of the peak in robust standard deviations of its surroundings.
        contrast: f64,
        /// Least contrast of a trusted peak.
        needed: f64,
    },
    /// Another lag, of another direction or length, explains the picture nearly as well as the one found.
    RivalLag {
        /// Contrast of the best other lag relative to the one found.
        share: f64,
        /// Largest share at which an answer is trusted.
        most: f64,
    },
    /// The length found is an end of the range searched, so the true one may lie outside.
    LengthAtRangeEnd {
        /// The length found in pixels.
        length_px: f64,
        /// Shortest length searched in pixels.
        min_px: f64,
        /// Longest length searched in pixels.
        max_px: f64,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RivalAngle { share, most } => {
                write!(
                    f,
                    "another direction is nearly as good: {share:.2} of the best response, at most {most:.2} allowed"
                )
            }
            Self::NoPattern => write!(f, "no pattern of a motion blur in the spectrum"),
            Self::WeakLengthPeak { contrast, needed } => {
                write!(f, "weak length peak: contrast {contrast:.1}, {needed:.1} needed")
            }
            Self::RivalLag { share, most } => {
                write!(f, "another lag is nearly as good: {share:.2} of the best contrast, at most {most:.2} allowed")
            }
            Self::LengthAtRangeEnd { length_px, min_px, max_px } => {
                write!(f, "length {length_px:.1} px is an end of the range {min_px:.1}..{max_px:.1} px searched")
            }
        }
    }
}

/// How far a result can be trusted.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Status {
    /// The method's own checks passed.
    Ok,
    /// There is an answer, and a reason not to trust it.
    LowConfidence(Doubt),
    /// The picture shows no motion blur that the method can see.
    NoMotionBlur(Doubt),
}

impl Status {
    /// The name used in machine-readable output: `ok`, `low_confidence` or `no_motion_blur`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::LowConfidence(_) => "low_confidence",
            Self::NoMotionBlur(_) => "no_motion_blur",
        }
    }

    /// Why the status is not `ok`.
    pub fn doubt(self) -> Option<Doubt> {
        match self {
            Self::Ok => None,
            Self::LowConfidence(doubt) | Self::NoMotionBlur(doubt) => Some(doubt),
        }
    }

    /// The more doubtful of two statuses; on a tie, the first.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        if other.rank() > self.rank() { other } else { self }
    }

    fn rank(self) -> u8 {
        match self {
            Self::Ok => 0,
            Self::LowConfidence(_) => 1,
            Self::NoMotionBlur(_) => 2,
        }
    }
}

/// What an angle method found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngleEstimate {
    /// The axis of the motion.
    pub angle: AxialAngle,
    /// Standard uncertainty in degrees; `None` when the method states none.
    pub std_deg: Option<f64>,
    /// How far to trust it.
    pub status: Status,
}

/// What a length method found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthEstimate {
    /// Width of the uniform line PSF in pixels.
    pub length_px: f64,
    /// Standard uncertainty in pixels; `None` when the method states none.
    pub std_px: Option<f64>,
    /// How far to trust it.
    pub status: Status,
}

/// Direction and length of the motion blur of one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MotionBlur {
    /// The axis of the motion.
    pub angle: AxialAngle,
    /// Standard uncertainty of the angle in degrees; `None` when the method states none.
    pub angle_std_deg: Option<f64>,
    /// Width of the uniform line PSF in pixels.
    pub length_px: f64,
    /// Standard uncertainty of the length in pixels; `None` when the method states none.
    pub length_std_px: Option<f64>,
    /// Correlation coefficient of angle and length; `None` when the method states none.
    pub correlation: Option<f64>,
    /// How far to trust the result.
    pub status: Status,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_the_same_every_half_turn() {
        for deg in [-180.0, -1e-18, 0.0, 180.0, 360.0] {
            assert_eq!(AxialAngle::from_deg(deg).deg(), 0.0, "{deg}");
        }
        assert_eq!(AxialAngle::from_deg(-30.0).deg(), 150.0);
        assert_eq!(AxialAngle::from_deg(f64::NAN).deg(), 0.0);
    }

    #[test]
    fn the_distance_of_axes_crosses_the_seam() {
        let (a, b) = (AxialAngle::from_deg(179.5), AxialAngle::from_deg(0.5));
        assert_eq!(a.distance_deg(b), 1.0);
        assert_eq!(a.minus_deg(b), -1.0);
        assert_eq!(AxialAngle::from_deg(90.0).distance_deg(AxialAngle::from_deg(0.0)), 90.0);
    }

    #[test]
    fn the_worse_status_wins() {
        let doubt = Doubt::WeakLengthPeak { contrast: 1.0, needed: 4.0 };
        let low = Status::LowConfidence(doubt);
        assert_eq!(Status::Ok.worse(low), low);
        assert_eq!(Status::NoMotionBlur(doubt).worse(low), Status::NoMotionBlur(doubt));
    }
}
