//! A calibrated camera: what its picture is of the rays that enter it.

use metrology::Measurement;
use nalgebra::{Matrix2, SMatrix, Vector2};

use super::distortion::Distortion;
use crate::{Error, Result};

/// Number of parameters of a camera.
pub const PARAMETERS: usize = 10;

/// Names of the parameters in the order of [`Intrinsics::parameters`]; those that end in `_px` are in pixels, the others
/// are pure numbers.
pub const PARAMETER_NAMES: [&str; PARAMETERS] =
    ["fx_px", "fy_px", "cx_px", "cy_px", "skew_px", "k1", "k2", "p1", "p2", "k3"];

/// Index of the skew among the parameters.
pub(super) const SKEW: usize = 4;
/// Index of the first coefficient of distortion.
pub(super) const DISTORTION: usize = 5;

/// Relative error of a covariance that rounding explains: of its symmetry and of eigenvalues that should not be negative.
const ROUNDING: f64 = 1e-6;

pub(super) type Covariance = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// A pinhole camera with lens distortion (Zhang 2000, eq. 1; Brown 1966), in pixels, and how well it is known.
///
/// A point at `(X, Y, Z)` in the frame of the camera (x to the right, y down, z along the optical axis) is seen at
/// `u = fx x' + skew y' + cx`, `v = fy y' + cy`, where `(x', y')` is the distorted image of `(X/Z, Y/Z)`: with `r^2 = x^2 + y^2`
///
/// `x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)`
///
/// `y' = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y`
///
/// Pixel `(0, 0)` is the centre of the top left pixel, `v` grows downwards; model and order are those of `OpenCV`.
#[derive(Debug, Clone, PartialEq)]
pub struct Intrinsics {
    parameters: [f64; PARAMETERS],
    covariance: Covariance,
    width_px: usize,
    height_px: usize,
}

/// An ideal point `(X/Z, Y/Z)` behind a pixel, and how it depends on the pixel and on the parameters of the camera.
pub(super) struct Ray {
    pub(super) point: Vector2<f64>,
    pub(super) by_pixel: Matrix2<f64>,
    pub(super) by_parameters: SMatrix<f64, 2, PARAMETERS>,
}

/// A pixel, and how it depends on the ideal point and on the parameters.
pub(super) struct Pixel {
    pub(super) point: Vector2<f64>,
    pub(super) by_ideal: Matrix2<f64>,
    pub(super) by_parameters: SMatrix<f64, 2, PARAMETERS>,
}

impl Intrinsics {
    /// A camera from its [parameters](PARAMETER_NAMES), their covariance, row by row, and the size of its pictures.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a focal length that is not positive, a number that is not finite, an empty picture, and
    /// [`Error::Covariance`] for a matrix that is no covariance.
    pub fn new(
        parameters: [f64; PARAMETERS],
        covariance: [[f64; PARAMETERS]; PARAMETERS],
        width_px: usize,
        height_px: usize,
    ) -> Result<Self> {
        let flat = covariance.as_flattened();
        Self::from_parts(parameters, &Covariance::from_row_slice(flat), width_px, height_px)
    }

    pub(super) fn from_parts(
        parameters: [f64; PARAMETERS],
        covariance: &Covariance,
        width_px: usize,
        height_px: usize,
    ) -> Result<Self> {
        for (index, (&value, &name)) in parameters.iter().zip(&PARAMETER_NAMES).enumerate() {
            if !value.is_finite() || (index < 2 && value <= 0.0) {
                let expected = if index < 2 { "finite and greater than 0" } else { "a finite number" };
                return Err(Error::Parameter { name, value, expected });
            }
        }
        for (name, pixels) in [("width (px)", width_px), ("height (px)", height_px)] {
            if pixels == 0 {
                return Err(Error::Parameter { name, value: 0.0, expected: "at least 1" });
            }
        }
        check_covariance(covariance)?;
        Ok(Self { parameters, covariance: *covariance, width_px, height_px })
    }

    /// Columns of the pictures.
    pub fn width_px(&self) -> usize {
        self.width_px
    }

    /// Rows of the pictures.
    pub fn height_px(&self) -> usize {
        self.height_px
    }

    /// The parameters, in the order of [`PARAMETER_NAMES`].
    pub fn parameters(&self) -> &[f64; PARAMETERS] {
        &self.parameters
    }

    /// Covariance of the parameters, row by row; 0 where a parameter was not fitted.
    pub fn covariance(&self) -> [[f64; PARAMETERS]; PARAMETERS] {
        std::array::from_fn(|row| std::array::from_fn(|column| self.covariance[(row, column)]))
    }

    /// Standard uncertainties of the parameters.
    pub fn stds(&self) -> [f64; PARAMETERS] {
        std::array::from_fn(|i| self.covariance[(i, i)].max(0.0).sqrt())
    }

    /// The horizontal focal length in pixels.
    pub fn fx_px(&self) -> Result<Measurement> {
        measurement("fx (px)", self.parameters[0], self.stds()[0])
    }

    pub(super) fn parameter_covariance(&self) -> &Covariance {
        &self.covariance
    }

    /// Where the camera sees the point `(X, Y, Z)` of its own frame, in any one unit, as `(u, v)` in pixels.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a point that is not in front of the camera.
    pub fn project(&self, [x, y, z]: [f64; 3]) -> Result<[f64; 2]> {
        if !(z > 0.0 && [x / z, y / z].iter().all(|ideal| ideal.is_finite())) {
            return Err(Error::Parameter { name: "z", value: z, expected: "greater than 0: in front of the camera" });
        }
        Ok(pixel(&self.parameters, Vector2::new(x / z, y / z)).point.into())
    }

    /// The ideal point `(X/Z, Y/Z)` of the ray that the camera sees at `(u, v)` in pixels: the inverse of
    /// [`project`](Self::project).
    ///
    /// # Errors
    /// [`Error::BeyondLens`] for a pixel farther out than the distortion can be undone, [`Error::Parameter`] for one that is
    /// not finite.
    pub fn unproject(&self, pixel: [f64; 2]) -> Result<[f64; 2]> {
        Ok(self.ray(pixel.into())?.point.into())
    }

    pub(super) fn ray(&self, seen: Vector2<f64>) -> Result<Ray> {
        if let Some(&value) = seen.iter().find(|value| !value.is_finite()) {
            return Err(Error::Parameter { name: "pixel", value, expected: "a finite number" });
        }
        let [fx, fy, cx, cy, skew, ..] = self.parameters;
        let y = (seen.y - cy) / fy;
        let x = (seen.x - cx - skew * y) / fx;
        let point = distortion(&self.parameters).undistort(Vector2::new(x, y))?;
        let Pixel { by_ideal, by_parameters, .. } = pixel(&self.parameters, point);
        // The undistorted point exists only where this determinant is positive.
        let by_pixel = by_ideal.try_inverse().unwrap_or_default();
        Ok(Ray { point, by_pixel, by_parameters: -by_pixel * by_parameters })
    }

    /// The same camera for pictures of `width_px` columns and `height_px` rows that show the same scene, resampled.
    ///
    /// # Errors
    /// [`Error::OtherShape`] when the sides are in another proportion: then the picture was cut.
    pub fn resized(&self, width_px: usize, height_px: usize) -> Result<Self> {
        let (x, y) = (width_px as f64 / self.width_px as f64, height_px as f64 / self.height_px as f64);
        // Resampling rounds to whole pixels on each side.
        let rounding = 1.0 / self.width_px.min(self.height_px) as f64 + 1.0 / width_px.min(height_px).max(1) as f64;
        let is_same_shape = (x / y - 1.0).abs() <= rounding;
        if !is_same_shape {
            return Err(Error::OtherShape {
                width: width_px,
                height: height_px,
                camera_width: self.width_px,
                camera_height: self.height_px,
            });
        }
        let mut parameters = self.parameters;
        let factors = [x, y, x, y, x, 1.0, 1.0, 1.0, 1.0, 1.0];
        for (parameter, factor) in parameters.iter_mut().zip(factors) {
            *parameter *= factor;
        }
        // The edge of the picture lies half a pixel before the centre of the first.
        parameters[2] += 0.5 * (x - 1.0);
        parameters[3] += 0.5 * (y - 1.0);
        let by_old = Covariance::from_diagonal(&SMatrix::from(factors));
        Self::from_parts(parameters, &(by_old * self.covariance * by_old), width_px, height_px)
    }
}

/// The distortion among parameters.
fn distortion(parameters: &[f64; PARAMETERS]) -> Distortion {
    let [.., k1, k2, p1, p2, k3] = *parameters;
    Distortion { k1, k2, p1, p2, k3 }
}

/// The image of an ideal point.
pub(super) fn pixel(parameters: &[f64; PARAMETERS], ideal: Vector2<f64>) -> Pixel {
    let [fx, fy, cx, cy, skew, ..] = *parameters;
    let distorted = distortion(parameters).distort(ideal);
    let (x, y) = (distorted.point.x, distorted.point.y);
    let scale = Matrix2::new(fx, skew, 0.0, fy);
    let mut by_parameters = SMatrix::<f64, 2, PARAMETERS>::zeros();
    by_parameters[(0, 0)] = x;
    by_parameters[(1, 1)] = y;
    by_parameters[(0, 2)] = 1.0;
    by_parameters[(1, 3)] = 1.0;
    by_parameters[(0, SKEW)] = y;
    by_parameters.fixed_view_mut::<2, 5>(0, DISTORTION).copy_from(&(scale * distorted.by_coefficients));
    Pixel { point: scale * distorted.point + Vector2::new(cx, cy), by_ideal: scale * distorted.by_point, by_parameters }
}

pub(super) fn measurement(name: &'static str, value: f64, std: f64) -> Result<Measurement> {
    Measurement::new(value, std).map_err(|_| Error::Parameter { name, value, expected: "finite, as its uncertainty" })
}

fn check_covariance(covariance: &Covariance) -> Result<()> {
    for row in 0..PARAMETERS {
        let variance = covariance[(row, row)];
        if !(variance.is_finite() && variance >= 0.0) {
            return Err(Error::Covariance { row: PARAMETER_NAMES[row], column: PARAMETER_NAMES[row], value: variance });
        }
        for column in 0..row {
            let (value, mirrored) = (covariance[(row, column)], covariance[(column, row)]);
            let bound = (variance * covariance[(column, column)]).sqrt();
            let correlates = value.abs() <= bound * (1.0 + ROUNDING) && (value - mirrored).abs() <= bound * ROUNDING;
            if !correlates {
                return Err(Error::Covariance { row: PARAMETER_NAMES[row], column: PARAMETER_NAMES[column], value });
            }
        }
    }
    Ok(())
}
