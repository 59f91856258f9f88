//! `reference`: least squares against sharp pictures of the same scene.

mod fit;
mod grid;
mod kernel;
mod measure;
mod model;
mod normal;
mod path;
mod power;
mod residual;
mod scene;
mod verdict;

use std::sync::Arc;

use ndarray::ArrayView2;

use self::measure::Measurement;
use self::scene::Scene;
use super::no_pattern;
use crate::estimate::{JointEstimator, LengthRange, MotionBlur, Settings};
use crate::{Error, Result, image};

/// `reference`: the path of a blurred picture from sharp pictures of the same scene, by least squares.
///
/// Unlike a blurred picture alone, a picture and its scene give the complex transfer function: with it the direction as an
/// arrow and the acceleration with its sign.
///
/// # Model
///
/// `g = gain (h * I) + offset + noise`, with
///
/// - `I` the mean of the stills, registered to each other to a fraction of a pixel, under its Wiener filter;
/// - `h` a straight path of the length `L` from its begin along the direction, covered as `L [(1 - r) t + r t^2]` in the
///   share `t` of the exposure, by its [exact transfer function](crate::psf::AcceleratedBlur::transfer);
/// - `gain` a quadratic polynomial over the picture: a change of the light, of the exposure or of the vignetting;
/// - one more term for a vignetting `1 - k rho^2` that the stills have too, since that does not commute with the blur.
///
/// Only pixels whose whole path lies inside the stills count. Residual and derivatives are weighted by the power of the
/// noise, frequency by frequency: that of the picture, and that of the stills as it shows through the blur. Noise in a
/// regressor attenuates and biases; the Wiener filter turns it into an error that does not correlate with the regressor
/// (Berkson), which only adds to the residual.
///
/// # Search
///
/// The picture deconvolved by the still shows the kernel in space: the brightest straight segment of it is the start. Fits
/// of ever wider bands of frequencies lead from there to the whole spectrum.
///
/// # Direction
///
/// A path from its begin with the ratio `r` and the same path from its end with `-r` are one exposure. The stills are
/// taken to show the scene where the shutter opens: the end of the path nearer to their position is its begin. When none is
/// within a quarter of the length, or both are equally near, no direction is stated. The acceleration as a vector is
/// the same either way.
///
/// # Uncertainty
///
/// The inverse of the weighted normal equations, illumination included, corrected for the window (sandwich), in units of
/// the residual.
///
/// # When it fails
///
/// A scene that changed between the stills and the picture is called doubtful by what stays unexplained. A light that falls
/// off linearly along the path, in stills and picture alike, looks like an acceleration: the vignetting must be symmetric
/// about a [known centre](Reference::with_optical_centre). Parts of a picture in which not all moves alike
/// must be cut out first.
///
/// # Reference
///
/// Levenberg (1944) and Marquardt, *An algorithm for least-squares estimation of nonlinear parameters*, SIAM J. Appl.
/// Math. 11 (1963) 431; Berkson, *Are there two regressions?*, JASA 45 (1950) 164; the transfer function from thesis
/// eq. 3.15-3.24.
///
/// ```
/// use blur_core::estimate::joint::Reference;
/// use blur_core::estimate::{JointEstimator, Settings};
/// use ndarray::Array2;
///
/// # fn main() -> blur_core::Result<()> {
/// // A sum of waves of many directions, and its mean over 8 px to the right.
/// let scene = |y: usize, x: f64| -> f64 {
///     let wave = |k: f64| (0.06 * k * (x * (2.4 * k).cos() + y as f64 * (2.4 * k).sin()) + k * k).sin();
///     (1..40).map(|k| wave(f64::from(k))).sum()
/// };
/// let still = Array2::from_shape_fn((96, 96), |(y, x)| scene(y, x as f64) as f32);
/// let picture = Array2::from_shape_fn((96, 96), |(y, x)| {
///     (0..40).map(|i| scene(y, x as f64 - 0.2 * (f64::from(i) + 0.5))).sum::<f64>() as f32 / 40.0
/// });
/// let found = Reference::new(&[still.view()], &Settings::default())?.estimate(picture.view())?;
/// assert!((found.length_px - 8.0).abs() < 0.1);
/// // To the right: 0 degrees, or a hair below 360.
/// assert!(found.direction_deg.is_some_and(|deg| deg < 1.0 || deg > 359.0));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Reference {
    settings: Settings,
    range: LengthRange,
    optical_centre: [f64; 2],
    scene: Arc<Scene>,
    measurement: Measurement,
}

impl Reference {
    /// An estimator for pictures of the scene that `stills` show, all of one size and at rest; they may be displaced by up
    /// to 24 pixels from each other. Plans and buffers are made here.
    ///
    /// # Errors
    /// [`Error::NoStill`] without any, [`Error::StillSize`] when they differ in size, [`Error::StillsDiffer`] when one does
    /// not show the scene of the first, and what [`estimate`](JointEstimator::estimate) refuses.
    pub fn new(stills: &[ArrayView2<'_, f32>], settings: &Settings) -> Result<Self> {
        let scene = Scene::new(stills)?;
        let (rows, columns) = scene.grid.picture;
        let centre = [0.5 * (columns as f64 - 1.0), 0.5 * (rows as f64 - 1.0)];
        Ok(Self::of_scene(Arc::new(scene), *settings, centre))
    }

    /// The same with the centre of the vignetting at `right_px`, `down_px` from the centre of the upper left pixel. It is
    /// the middle of the picture unless that is a part cut from a larger one.
    #[must_use]
    pub fn with_optical_centre(self, right_px: f64, down_px: f64) -> Self {
        Self::of_scene(self.scene, self.settings, [right_px, down_px])
    }

    fn of_scene(scene: Arc<Scene>, settings: Settings, optical_centre: [f64; 2]) -> Self {
        let (rows, columns) = scene.grid.picture;
        let range = settings.lengths_in(rows.min(columns) as f64).within((rows as f64).hypot(columns as f64));
        let measurement = Measurement::new(&scene, range, optical_centre);
        Self { settings, range, optical_centre, scene, measurement }
    }
}

/// The stills are shared; plans and buffers are new.
impl Clone for Reference {
    fn clone(&self) -> Self {
        Self::of_scene(Arc::clone(&self.scene), self.settings, self.optical_centre)
    }
}

impl JointEstimator for Reference {
    fn estimate(&mut self, image: ArrayView2<'_, f32>) -> Result<MotionBlur> {
        image::check(image)?;
        if image.dim() != self.scene.grid.picture {
            let ((height, width), (other_height, other_width)) = (self.scene.grid.picture, image.dim());
            return Err(Error::StillSize { width, height, other_width, other_height });
        }
        Ok(match self.measurement.measure(&self.scene, image) {
            Some(outcome) => verdict::result(&outcome, self.range, self.settings.acceleration),
            None => no_pattern(self.range),
        })
    }
}
