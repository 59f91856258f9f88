//! Likelihood of the whole spectrum along a known direction.

use ndarray::ArrayView2;

use crate::estimate::joint::WhittleAlong;
use crate::estimate::{AxialAngle, LengthEstimate, LengthEstimator, Settings};
use crate::{Error, Result, image};

/// Least extent of a picture along the motion, in pixels.
const LEAST_ALONG_PX: f64 = 16.0;

/// `whittle`: maximum likelihood of the length and the scene along a known direction.
///
/// The model is that of the joint method of this name, with the angle fixed. Fits start from every length of the range, six
/// percent apart, in the first five dark lines and go on in the whole spectrum; the most likely one is reported. All rows
/// of a strip count, down to a single one: across the motion it may be as narrow as it likes, because what the window
/// smears there stays on the dark line. Along the motion it must measure at least 16 pixels, and should measure twice
/// the blur.
///
/// # Rows
///
/// In segments of up to 256 pixels along the motion, when that follows their rows or columns so closely that the longest blur of
/// the range leaves them by half a pixel at most, the exact likelihood of the samples is asked too: rows are normal vectors with
/// unknown means, whose covariance is that of a power law seen through the blur, and noise. There is no window (the setting
/// counts for nothing) and nothing leaks, so that on pictures with little noise even rows a third longer than the blur tell
/// it. Lengths are tried a quarter of a pixel or a percent apart. Rows of up to 64 pixels alone decide. In longer ones the
/// spectrum does, which knows both directions of a scene, when it raises no doubt and the segment is 2.5 times as long as the
/// blur, unless the rows raise none either against a length that differs by an eighth; and where both sides are longer than
/// 64 pixels it tells that a picture is sharp, or out of focus.
///
/// # Uncertainty
///
/// The inverse of the expected information, everything else profiled out, for bins as independent as the window
/// leaves them. In strips of photographs 256 pixels long and 2 to 256 high, blurred by 30 pixels, 95 to 100 % of the
/// errors were within two standard uncertainties. Of rows: the variance of the rows' contributions to the score,
/// neighbours correlated as they are found to be, so that scenes that are not normal are accounted for; times 1.6 for what a
/// power law leaves out. An error of the angle is not in it.
///
/// # When it fails
///
/// Long blurs in strips of fewer than eight rows show too few bins: other lengths are then nearly as likely, and the answer
/// is called doubtful. In short rows noise soon covers the few dark lines there are: where the blur then gains too little over
/// no blur, or another length as much, the answer is called doubtful. Rows of up to 64 pixels are not held against a lens out
/// of focus.
///
/// # Reference
///
/// That of [`joint::Whittle`](crate::estimate::joint::Whittle); for strips, thesis chapter 7; for rows H. D. Patterson,
/// R. Thompson, Biometrika 58 (1971) 545 (the likelihood), and H. White, Econometrica 50 (1982) 1 with W. K. Newey, K. D. West,
/// Econometrica 55 (1987) 703 (its uncertainty).
#[derive(Debug)]
pub struct Whittle(WhittleAlong);

impl Whittle {
    /// A new estimator; plans are made when the first picture comes.
    pub fn new(settings: &Settings) -> Self {
        Self(WhittleAlong::new(settings))
    }
}

impl LengthEstimator for Whittle {
    fn estimate(&mut self, image: ArrayView2<'_, f32>, angle: AxialAngle) -> Result<LengthEstimate> {
        let (height, width) = image.dim();
        let (sin, cos) = angle.rad().sin_cos();
        let along_px = (width as f64 / cos.abs()).min(height as f64 / sin.abs());
        if along_px < LEAST_ALONG_PX {
            return Err(Error::TooShort { along_px, min_px: LEAST_ALONG_PX });
        }
        image::check_pixels(image)?;
        Ok(self.0.estimate(image, angle))
    }
}
