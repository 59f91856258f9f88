//! Whether undoing a blur makes a picture sharper.

use std::f64::consts::PI;

use ndarray::ArrayView2;
use rustfft::num_complex::Complex32;

use super::LineBlur;
use super::power::Power;
use super::wiener::Wiener;
use crate::image::{centre_square, check};
use crate::{Error, Result};

/// Longest side of the middle of the picture that is judged, in pixels.
const MIDDLE_PX: usize = 1024;
/// Standard deviation in pixels of the Gaussian under which the picture is differentiated: finer detail is mostly noise.
const GAUSSIAN_PX: f64 = 1.5;
/// A blur that blurs nothing.
const NO_BLUR_PX: f64 = 1e-3;

/// By how much undoing `blur` sharpens the picture: the gain in the natural logarithm of the kurtosis of its derivative along
/// the motion, from the picture with its noise filtered out to the picture with its noise filtered out and the blur undone.
///
/// Sharp pictures have few strong edges and much that is flat, so their derivatives have a high kurtosis. Blur and noise lower
/// it, and so do the echoes that a wrong blur leaves. A positive value therefore speaks for the blur, and a negative one against
/// it. The kurtosis rests on the phases of the picture's spectrum, the estimate on its powers: the one checks the other. It is a
/// check and no proof; on a periodic texture it says little.
///
/// # Errors
/// [`Error::TooSmall`], [`Error::NotFinite`] and [`Error::Constant`] for a picture that cannot be judged, and
/// [`Error::BlurTooLong`] when the blur is longer than the picture.
///
/// # Reference
/// D. Krishnan, T. Tay and R. Fergus, *Blind deconvolution using a normalized sparsity measure*, CVPR 2011, for measures of
/// derivatives that blur and noise both change to the same side; the kurtosis is that of D. J. Field (1987).
pub fn sharpness_change(picture: ArrayView2<'_, f32>, blur: &LineBlur) -> Result<f64> {
    check(picture)?;
    let middle = centre_square(picture, MIDDLE_PX);
    blur.check_fits(middle.dim())?;
    let nothing = blur.with_length(NO_BLUR_PX);
    let undone = log_kurtosis(middle, blur, blur);
    let filtered = log_kurtosis(middle, &nothing, blur);
    // Without any contrast left there is nothing to compare.
    undone.zip(filtered).map(|(undone, filtered)| undone - filtered).ok_or(Error::Constant { value: picture[[0, 0]] })
}

/// The logarithm of the kurtosis of the derivative along `motion` after undoing `blur`.
fn log_kurtosis(picture: ArrayView2<'_, f32>, blur: &LineBlur, motion: &LineBlur) -> Option<f64> {
    let (rows, columns) = picture.dim();
    let mut wiener = Wiener::new((rows, columns), blur);
    wiener.set(&Power::fit(&[picture], blur));
    let scene = wiener.restore(picture, picture.mean().unwrap_or(0.0)).to_owned();
    let (canvas, ..) = wiener.parts();
    let response: Vec<f32> = canvas
        .frequencies()
        .map(|(u, v)| {
            let gaussian = (-2.0 * (PI * GAUSSIAN_PX).powi(2) * (u * u + v * v)).exp();
            (2.0 * PI * motion.along(u, v) * gaussian) as f32
        })
        .collect();
    canvas.input().assign(&scene);
    let derivative = canvas.filter(|i, bin| Complex32::new(-bin.im, bin.re) * response[i]);

    // Half a blur at the borders is more guessed than seen.
    let (down, across) = motion.extent_px();
    let (top, left) = (down / 2 + 1, across / 2 + 1);
    let (mut squares, mut fourths, mut count) = (0.0, 0.0, 0.0);
    for row in derivative.rows().into_iter().take(rows - top).skip(top) {
        for &x in row.iter().take(columns - left).skip(left) {
            let square = f64::from(x).powi(2);
            squares += square;
            fourths += square * square;
            count += 1.0;
        }
    }
    (squares > 0.0).then(|| (count * fourths / (squares * squares)).ln())
}
