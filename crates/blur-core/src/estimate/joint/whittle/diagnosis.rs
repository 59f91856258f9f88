//! A look behind a result: spectrum, model, residuals and the likelihood around the maximum.

use ndarray::{Array2, ArrayView2};

use super::point::Kernel;
use super::view::View;
use super::weighted::Part;
use super::{ACCELERATION_WINDOW, MIDDLE_PX, WHOLE_PX, WHOLE_WINDOW};
use crate::estimate::{AxialAngle, Evidence, MotionBlur, Settings};
use crate::image::{Region, Window, centre_square};
use crate::spectrum::PowerSpectrum;
use crate::{Result, image};

/// The surface of the likelihood reaches this many standard uncertainties either way ...
const REACH: f64 = 4.0;
/// ... at so many points a standard uncertainty, ...
const POINTS_PER_STD: usize = 3;
/// ... but no farther than this share of the length, and this angle in radians.
const MOST_OF_LENGTH: f64 = 0.8;
const MOST_ANGLE: f64 = 0.7;

/// The log-likelihood over direction and length, everything else at its best for each pair (the profile likelihood); only
/// an acceleration that was detected stays as it was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Directions of the rows, in degrees; not folded, so that they increase.
    pub angles_deg: Vec<f64>,
    /// Lengths of the columns, in pixels.
    pub lengths_px: Vec<f64>,
    /// Log-likelihood with the priors of the scene, relative to the maximum: 0 at best. The contour of `-k^2/2` is that of
    /// `k` standard uncertainties where the likelihood is normal, before the uncertainty is widened by
    /// [`Diagnosis::widening`].
    pub log_likelihood: Array2<f64>,
}

/// What lies behind a result of [`Whittle`](super::Whittle): the fit made anew from it, looked at from all sides.
///
/// Pure and separate: a measurement does not take longer because this exists. Scene, noise and incoherent share are
/// fitted again from the stated direction and length, in the same part of the picture, window and band.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// The part measured, in the picture given.
    pub part: Region,
    /// Window laid over the part measured; `None` where weights took its place.
    pub window: Option<Window>,
    /// Independent powers of the whole plane of frequencies, of which the half shown holds every other: a window makes
    /// neighbours alike.
    pub independent_powers: f64,
    /// Highest frequency that took part, in cycles per pixel.
    pub band_cycles_per_px: f64,
    /// Direction of the maximum of the fit made anew, which may differ from the stated one by a small part of its
    /// uncertainty.
    pub angle: AxialAngle,
    /// Length of that maximum in pixels.
    pub length_px: f64,
    /// Factor of the stated standard uncertainties over those of the likelihood alone, at least 1: the scene's spectrum is
    /// rough within the patches that describe it too.
    pub widening: f64,
    /// The powers of the part measured.
    pub spectrum: PowerSpectrum,
    /// Mean power that the model expects of each bin of the spectrum, in the same order: that of the blurred scene, and
    /// that of the noise.
    pub expected: Vec<(f64, f64)>,
    /// The likelihood around the result.
    pub surface: Surface,
}

impl Diagnosis {
    /// Looks at the result `blur` that a [`Whittle`](super::Whittle) of `settings` found in `image`; `None` when the result
    /// has no uncertainties, as that of a picture without any pattern.
    pub fn of(image: ArrayView2<'_, f32>, settings: &Settings, blur: &MotionBlur) -> Result<Option<Self>> {
        image::check(image)?;
        let Some(stated) = Stated::of(blur) else { return Ok(None) };
        let (rows, columns) = image.dim();
        let side = rows.min(columns);
        let measured = stated.evidence.rows;
        let (part, default) = if side <= WHOLE_PX {
            (image, WHOLE_WINDOW)
        } else {
            (centre_square(image, measured), if measured > MIDDLE_PX { WHOLE_WINDOW } else { Window::Hann })
        };
        let accelerates = stated.kernel == Kernel::AcceleratedLine;
        let window = settings.window.unwrap_or(if accelerates { ACCELERATION_WINDOW } else { default });
        let mut view = View::new(part.dim(), window, settings.lengths_in(side.min(MIDDLE_PX) as f64));
        view.set(part);
        let (height, width) = part.dim();
        let part = Region { x: (columns - width) / 2, y: (rows - height) / 2, width, height };
        Ok(Some(stated.look(&mut view, part, Some(window))))
    }

    /// As [`of`](Self::of) for a result of [`Whittle::estimate_weighted`](super::Whittle::estimate_weighted) under
    /// `weights`.
    pub fn of_weighted(
        image: ArrayView2<'_, f32>,
        weights: ArrayView2<'_, f32>,
        settings: &Settings,
        blur: &MotionBlur,
    ) -> Result<Option<Self>> {
        let Some(stated) = Stated::of(blur) else { return Ok(None) };
        let part = Part::of(image, weights)?;
        let mut view = part.view(settings.lengths_in(part.side_px()));
        view.set_weighted(part.image, part.weights.view());
        Ok(Some(stated.look(&mut view, part.region, None)))
    }
}

/// A result that says how certain it is.
struct Stated {
    evidence: Evidence,
    kernel: Kernel,
    length_px: f64,
    length_std_px: f64,
    angle: f64,
    angle_std: f64,
}

impl Stated {
    fn of(blur: &MotionBlur) -> Option<Self> {
        let accelerates = blur.acceleration.is_some_and(|acceleration| acceleration.is_detected());
        Some(Self {
            evidence: blur.evidence?,
            kernel: if accelerates { Kernel::AcceleratedLine } else { Kernel::Line },
            length_px: blur.length_px,
            length_std_px: blur.length_std_px?,
            angle: blur.angle.rad(),
            angle_std: blur.angle_std_deg?.to_radians(),
        })
    }

    /// Fits anew to the picture of `view` and looks around.
    fn look(&self, view: &mut View, part: Region, window: Option<Window>) -> Diagnosis {
        let (kernel, band) = (self.kernel, self.evidence.band_cycles_per_px);
        let maximum = view.refit(kernel, (self.length_px, self.angle), band);
        let lengths_px = around(self.length_px, self.length_std_px, MOST_OF_LENGTH * self.length_px);
        let angles = around(self.angle, self.angle_std, MOST_ANGLE);
        let losses = view.profile(kernel, &lengths_px, &angles);
        // A profile may find a little more than the fit, whose last steps gain next to nothing.
        let least = losses.iter().copied().fold(maximum.loss, f64::min);
        let log_likelihood = Array2::from_shape_fn((angles.len(), lengths_px.len()), |(row, column)| {
            least - losses[row * lengths_px.len() + column]
        });
        let (length_px, angle) = view.best();
        let widening = view.widening(band);
        let (spectrum, expected) = view.expectation(kernel, band);
        Diagnosis {
            part,
            window,
            independent_powers: view.independent_powers(),
            band_cycles_per_px: band,
            angle: AxialAngle::from_deg(angle.to_degrees()),
            length_px,
            widening,
            spectrum,
            expected,
            surface: Surface {
                angles_deg: angles.into_iter().map(f64::to_degrees).collect(),
                lengths_px,
                log_likelihood,
            },
        }
    }
}

/// Points around `middle`, which is one of them, [`REACH`] times `std` either way and no farther than `most`.
fn around(middle: f64, std: f64, most: f64) -> Vec<f64> {
    let reach = (REACH * std).min(most);
    let half = (REACH as usize * POINTS_PER_STD) as f64;
    (0..=2 * half as usize).map(|i| middle + reach * (i as f64 / half - 1.0)).collect()
}
