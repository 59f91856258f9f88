//! A blur at one place of a calibrated picture: how far the object moved, or how far the camera turned.

use metrology::Measurement;
use nalgebra::{Matrix2, SMatrix, Vector2, Vector3};

use super::intrinsics::{Covariance, Intrinsics, PARAMETERS, Ray, measurement};
use super::pinhole::Scale;
use crate::estimate::AxialAngle;
use crate::{Error, Result};

/// A blur at one place of a picture, in the pixels of the picture as it was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalBlur {
    /// Centre `(u, v)` of the region in which the blur was measured, in pixels of the whole picture.
    pub centre_px: [f64; 2],
    /// Axis of the motion as seen.
    pub angle: AxialAngle,
    /// Standard uncertainty of the axis in degrees, 0 if none is known.
    pub angle_std_deg: f64,
    /// Blur length in pixels.
    pub length_px: f64,
    /// Standard uncertainty of the length in pixels, 0 if none is known.
    pub length_std_px: f64,
    /// Correlation coefficient of angle and length.
    pub correlation: f64,
}

/// A blur seen through a calibrated camera: its two ends as rays, without distortion.
///
/// Uncertainties are of first order; those of the blur and of the camera count as independent of each other.
#[derive(Debug, Clone, PartialEq)]
pub struct IdealBlur {
    ends: [Vector2<f64>; 2],
    /// How the ends depend on the blur vector and on the camera.
    by_blur: [Matrix2<f64>; 2],
    by_camera: [SMatrix<f64, 2, PARAMETERS>; 2],
    blur: LocalBlur,
    fx_px: f64,
    camera: Covariance,
}

impl Intrinsics {
    /// The rays through both ends of a blur.
    ///
    /// # Errors
    /// [`Error::BeyondLens`] when an end lies farther out than the distortion can be undone, [`Error::Parameter`] for a
    /// length that is not positive or numbers that are not finite.
    pub fn ideal_blur(&self, blur: LocalBlur) -> Result<IdealBlur> {
        if !(blur.length_px > 0.0 && blur.length_px.is_finite()) {
            return Err(Error::Parameter {
                name: "blur length (px)",
                value: blur.length_px,
                expected: "finite and greater than 0",
            });
        }
        let half = 0.5 * blur.length_px * direction(blur.angle.deg());
        let centre = Vector2::from(blur.centre_px);
        let start = self.ray(centre - half)?;
        let end = self.ray(centre + half)?;
        let part = |ray: &Ray, share: f64| share * ray.by_pixel;
        Ok(IdealBlur {
            ends: [start.point, end.point],
            by_blur: [part(&start, -0.5), part(&end, 0.5)],
            by_camera: [start.by_parameters, end.by_parameters],
            blur,
            fx_px: self.parameters()[0],
            camera: *self.parameter_covariance(),
        })
    }
}

impl IdealBlur {
    /// The axis of the motion in a picture without distortion and with square pixels: that of a motion parallel to the
    /// sensor in space.
    pub fn angle(&self) -> AxialAngle {
        let moved = self.ends[1] - self.ends[0];
        AxialAngle::from_deg((-moved.y).atan2(moved.x).to_degrees())
    }

    /// The blur length in such a picture, whose focal length is `fx`.
    pub fn length_px(&self) -> f64 {
        self.fx_px * (self.ends[1] - self.ends[0]).norm()
    }

    /// Metres in the scene for each pixel of the blur *as it was measured*, for an object that moves parallel to the
    /// sensor at `distance_m` along the optical axis: `k = n |m1 - m0| / L`, with `m` the ideal points of both ends.
    ///
    /// Without distortion and with square pixels that is `k = n / f` everywhere (thesis eq. 5.7, with `f` in pixels). Its
    /// uncertainty holds those of distance, camera and direction; that of the length is not in it.
    pub fn scale(&self, distance_m: Measurement) -> Result<Scale> {
        let distance = distance_m.value();
        if distance <= 0.0 {
            return Err(Error::Parameter { name: "distance (m)", value: distance, expected: "greater than 0" });
        }
        let moved = self.ends[1] - self.ends[0];
        let value = moved.norm() / self.blur.length_px;
        let towards = moved.normalize() / self.blur.length_px;
        let std = self.std([-towards, towards], 0.0);
        let k = distance * value;
        Scale::new(measurement("scale (m/px)", k, (distance * std).hypot(value * distance_m.std()))?)
    }

    /// The angle in radians between the rays through both ends: how far a camera turned before a scene that stands still,
    /// about an axis perpendicular to the ray through the centre of the blur. A part of the turn about that very ray is
    /// not seen there.
    pub fn turn_rad(&self) -> Result<Measurement> {
        let rays = self.ends.map(|end| Vector3::new(end.x, end.y, 1.0));
        let (cross, dot) = (rays[0].cross(&rays[1]), rays[0].dot(&rays[1]));
        let turn = cross.norm().atan2(dot);
        // Away from each other, both ends widen the angle: along the tangent, by one over the length of the ray.
        let axis = cross.normalize();
        let widening = |ray: Vector3<f64>, sign: f64| {
            let along = axis.cross(&ray.normalize()) * (sign / ray.norm());
            Vector2::new(along.x, along.y)
        };
        let std = self.std([widening(rays[0], -1.0), widening(rays[1], 1.0)], self.blur.length_std_px);
        measurement("turn (rad)", turn, std)
    }

    /// Standard uncertainty of a quantity from its derivatives by both ends, for a blur length known to `length_std_px`.
    fn std(&self, by_ends: [Vector2<f64>; 2], length_std_px: f64) -> f64 {
        let blur = &self.blur;
        let mut by_blur = Vector2::zeros();
        let mut by_camera = SMatrix::<f64, PARAMETERS, 1>::zeros();
        for (end, by_end) in by_ends.iter().enumerate() {
            by_blur += self.by_blur[end].transpose() * by_end;
            by_camera += self.by_camera[end].transpose() * by_end;
        }
        let along = direction(blur.angle.deg());
        // A turn counter-clockwise as seen goes from right to up, which is -v.
        let across = Vector2::new(along.y, -along.x);
        let by_length = by_blur.dot(&along) * length_std_px;
        let by_angle = by_blur.dot(&across) * blur.length_px * blur.angle_std_deg.to_radians();
        let from_blur = by_length * by_length + by_angle * by_angle + 2.0 * blur.correlation * by_length * by_angle;
        (from_blur + by_camera.dot(&(self.camera * by_camera))).max(0.0).sqrt()
    }
}

/// Unit vector of an axis in pixels: `v` grows downwards.
fn direction(deg: f64) -> Vector2<f64> {
    let (sin, cos) = deg.to_radians().sin_cos();
    Vector2::new(cos, -sin)
}
