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

/// Why a result is not certain. A new reason comes last: places of variants are part of what is promised.
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
    /// The likelihood gains too little over no blur.
    WeakEvidence {
        /// Gain in log-likelihood for each bin of signal.
        per_bin: f64,
        /// Least gain of a trusted answer.
        needed: f64,
    },
    /// The likelihood as a whole gains too little over no blur.
    SmallGain {
        /// Gain in log-likelihood.
        gain: f64,
        /// Least gain of a trusted answer.
        needed: f64,
    },
    /// A lens out of focus explains the spectrum as well as a motion.
    Defocus {
        /// Gain in log-likelihood of the motion over the best disk.
        gain: f64,
        /// Least gain of a trusted answer.
        needed: f64,
    },
    /// Much of the light does not share the motion: it differs over the picture, or it is none.
    Incoherent {
        /// Share of the light that the kernel does not explain.
        share: f64,
        /// Largest share of a trusted answer.
        most: f64,
    },
    /// The scene is a periodic texture, whose own lines may stand for those of a blur.
    PeriodicTexture {
        /// Mean square over squared mean of the powers in a small part of the spectrum, 1 for a smooth one.
        peakedness: f64,
        /// Largest value that raises no doubt.
        most: f64,
    },
    /// Another blur explains the spectrum nearly as well.
    RivalBlur {
        /// Evidence for the other one relative to the one found.
        share: f64,
        /// Largest share at which an answer is trusted.
        most: f64,
    },
    /// Much of the picture's contrast is neither that of the blurred stills nor noise: another scene, or another motion.
    Unexplained {
        /// Share of the contrast.
        share: f64,
        /// Largest share of a trusted answer.
        most: f64,
    },
    /// The length found is hardly longer than none.
    ShortLength {
        /// The length found in pixels.
        length_px: f64,
        /// Least length of a motion blur in pixels, by itself or by the uncertainty.
        needed_px: f64,
    },
    /// The answer is too uncertain to be of use.
    Uncertain {
        /// Standard uncertainty.
        std: f64,
        /// Largest one of a trusted answer.
        most: f64,
        /// Unit of both.
        unit: &'static str,
    },
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
    /// A part of a picture is told from the rest by its low frequencies alone, as smooth parts of a still picture are too.
    NarrowBand {
        /// Up to here the blur explains the spectrum, in cycles per pixel.
        cycles_per_px: f64,
        /// Up to here it has to.
        needed: f64,
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
            Self::WeakEvidence { per_bin, needed } => {
                write!(f, "hardly more likely than no blur: gain {per_bin:.4} a bin, {needed:.3} needed")
            }
            Self::SmallGain { gain, needed } => {
                write!(f, "hardly more likely than no blur: gain {gain:.1} in all, {needed:.0} needed")
            }
            Self::Defocus { gain, needed } => {
                write!(f, "a lens out of focus explains it as well: gain {gain:.0} over a disk, {needed:.0} needed")
            }
            Self::Incoherent { share, most } => {
                write!(
                    f,
                    "{:.0} % of the light does not follow one motion, at most {:.0} % allowed",
                    100.0 * share,
                    100.0 * most
                )
            }
            Self::PeriodicTexture { peakedness, most } => {
                write!(f, "periodic texture: peakedness {peakedness:.2} of the spectrum, beyond {most:.2} in doubt")
            }
            Self::NarrowBand { cycles_per_px, needed } => {
                write!(
                    f,
                    "the blur explains frequencies up to {cycles_per_px:.2} cycles/px only, {needed:.2} needed of a part"
                )
            }
            Self::RivalBlur { share, most } => {
                write!(
                    f,
                    "another blur is nearly as good: {share:.2} of the evidence for the best, at most {most:.2} allowed"
                )
            }
            Self::Unexplained { share, most } => {
                write!(
                    f,
                    "the stills do not explain {:.0} % of the contrast, at most {:.0} % allowed",
                    100.0 * share,
                    100.0 * most
                )
            }
            Self::ShortLength { length_px, needed_px } => {
                write!(f, "length {length_px:.1} px, at least {needed_px:.1} px needed for a motion blur")
            }
            Self::Uncertain { std, most, unit } => {
                write!(f, "standard uncertainty {std:.1} {unit}, at most {most:.1} {unit} allowed")
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
    /// Where the content of the picture moved, in degrees counter-clockwise from +x as seen, in `[0, 360)`; `None` when the
    /// method cannot tell a motion from its opposite.
    pub direction_deg: Option<f64>,
    /// How far to trust the result.
    pub status: Status,
    /// What speaks for and against the result; `None` when the method weighs no likelihoods.
    pub evidence: Option<Evidence>,
    /// The acceleration; `None` unless the settings ask for it and the method can tell.
    pub acceleration: Option<Acceleration>,
}

/// What speaks for and against a result. Gains are natural logarithms of ratios of likelihoods.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Evidence {
    /// Gain over no blur, in the band of frequencies in which the blur was found.
    pub gain: f64,
    /// That gain for each bin of signal.
    pub gain_per_bin: f64,
    /// Evidence for a bin of the best other blur, relative to this one; 0 when there is no other.
    pub rival_share: f64,
    /// Gain over the best defocused disk.
    pub gain_over_defocus: f64,
    /// Share of the light that does not follow the motion: it fills the dark lines.
    pub incoherent_share: f64,
    /// Mean square over squared mean of the powers in small parts of the spectrum, relative to a smooth one.
    pub peakedness: f64,
    /// Mean squared standardised residual of the spectrum: at most about 1 for a model that is right.
    pub misfit: f64,
    /// Highest frequency that the result rests on, in cycles per pixel.
    pub band_cycles_per_px: f64,
    /// Rows and columns of the part of the picture that the result rests on.
    pub rows: usize,
    /// See `rows`.
    pub columns: usize,
}

/// How strongly the motion accelerated, as far as one picture can tell: the ratio `r = a T / (2 vbar)` without its sign.
///
/// A blur and its reverse have the same power spectrum, so speeding up looks like slowing down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acceleration {
    /// `|r|`, 0 for a uniform motion, 1 for one that starts or ends at rest.
    pub ratio: f64,
    /// Standard uncertainty of `|r|`, first order in that of `r^2`; near `r = 0` no more than the detection limit.
    pub ratio_std: f64,
    /// The root of three standard uncertainties of `r^2` at a uniform motion: few uniform motions are read as more.
    pub detection_limit: f64,
    /// Correlation coefficient of `|r|` and the length; 0 when the two come from different fits, as that of a motion
    /// which counts as uniform.
    pub length_correlation: f64,
    /// Standard uncertainty of `r^2`, what a power spectrum is a function of.
    square_std: f64,
    /// The ratio with its sign; `None` when the method cannot tell speeding up from slowing down.
    pub signed: Option<SignedRatio>,
}

/// An acceleration ratio whose sign is known: positive where the content speeds up along
/// [`MotionBlur::direction_deg`] or, where that is not known, along the axis [`MotionBlur::angle`] in `[0, 180)`.
///
/// With the stated uncertainties of length and angle and their correlation it makes up the covariance of the three; the
/// acceleration `2 r k L / T^2` needs that of ratio and length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignedRatio {
    /// `r`, from -1 to 1.
    pub ratio: f64,
    /// Its standard uncertainty.
    pub std: f64,
    /// Its correlation coefficient with the length.
    pub length_correlation: f64,
    /// Its correlation coefficient with the angle.
    pub angle_correlation: f64,
}

impl Acceleration {
    /// Standard deviations of `r^2` from a uniform motion to the detection limit. Two would do for an error that is normal;
    /// near 0 the structure of the scene adds to it.
    const LIMIT: f64 = 3.0;

    /// From `r^2`, 0 to 1, its standard uncertainty, that at a uniform motion, and its correlation with the length: the
    /// spectrum is a function of the square.
    pub(crate) fn from_square(ratio2: f64, std: f64, uniform_std: f64, length_correlation: f64) -> Self {
        let ratio = ratio2.clamp(0.0, 1.0).sqrt();
        let detection_limit = (Self::LIMIT * uniform_std).sqrt();
        let ratio_std = if ratio > 0.0 { (0.5 * std / ratio).min(detection_limit) } else { detection_limit };
        // What is not detected counts as uniform, and its length is that of another fit.
        let length_correlation = if ratio > detection_limit { length_correlation } else { 0.0 };
        Self { ratio, ratio_std, detection_limit, length_correlation, square_std: std, signed: None }
    }

    /// From a ratio whose sign is known; its error is normal, near 0 too.
    pub(crate) fn from_signed(signed: SignedRatio) -> Self {
        Self {
            ratio: signed.ratio.abs(),
            ratio_std: signed.std,
            detection_limit: Self::LIMIT * signed.std,
            length_correlation: signed.length_correlation * signed.ratio.signum(),
            square_std: 2.0 * signed.ratio.abs() * signed.std,
            signed: Some(signed),
        }
    }

    /// Whether the acceleration stands out from a uniform motion.
    pub fn is_detected(&self) -> bool {
        self.ratio > self.detection_limit
    }

    /// The least and the largest `|r|` within `k` standard uncertainties, cut to 0..1: of `r^2` where the sign is not
    /// known, which holds at any ratio, while `ratio` and `ratio_std` do only far from 0.
    pub fn interval(&self, k: f64) -> (f64, f64) {
        if self.signed.is_some() {
            let end = |ratio: f64| ratio.clamp(0.0, 1.0);
            return (end(self.ratio - k * self.ratio_std), end(self.ratio + k * self.ratio_std));
        }
        let square = self.ratio * self.ratio;
        let end = |square: f64| square.clamp(0.0, 1.0).sqrt();
        (end(square - k * self.square_std), end(square + k * self.square_std))
    }
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
    #[test]
    fn an_acceleration_is_the_root_of_its_square() {
        // At 0 the square's uncertainty bounds the ratio from above: sqrt(3 std).
        let none = Acceleration::from_square(0.0, 0.01, 0.01, 0.0);
        assert_eq!(none.ratio, 0.0);
        assert!((none.detection_limit - 0.03_f64.sqrt()).abs() < 1e-12);
        assert_eq!(none.ratio_std, none.detection_limit);
        assert!(!none.is_detected());
        // Of a small one the first order, std / (2 r) = 0.5, says more than there is to know.
        let small = Acceleration::from_square(1e-4, 0.01, 0.01, 0.0);
        assert!((small.ratio - 0.01).abs() < 1e-12);
        assert_eq!(small.ratio_std, small.detection_limit);
        assert!(!small.is_detected());
        let full = Acceleration::from_square(1.0, 0.01, 0.01, 0.0);
        assert_eq!(full.ratio, 1.0);
        assert!((full.ratio_std - 0.005).abs() < 1e-12);
        assert!(full.is_detected());
    }

    #[test]
    fn a_square_out_of_range_is_cut() {
        assert_eq!(Acceleration::from_square(-0.1, 0.01, 0.01, 0.0).ratio, 0.0);
        assert_eq!(Acceleration::from_square(1.1, 0.01, 0.01, 0.0).ratio, 1.0);
    }
}
