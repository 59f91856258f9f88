//! The pinhole camera and the scale of its picture.

use metrology::{Measurement, combined_std};

use crate::{Error, Result};

/// Size in the scene of one pixel of the picture, in metres per pixel: the factor `k` of thesis eq. 5.7.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale(Measurement);

impl Scale {
    /// A scale in metres per pixel with its standard uncertainty; it must be positive.
    pub fn new(m_per_px: Measurement) -> Result<Self> {
        positive("scale (m/px)", m_per_px).map(Self)
    }

    /// Metres per pixel.
    pub fn m_per_px(self) -> Measurement {
        self.0
    }
}

/// A pinhole camera in front of a moving object (thesis eq. 5.1-5.7; Lin and Li 2004).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    focal_length_m: Measurement,
    pixel_pitch_m: Measurement,
    distance_m: Measurement,
}

impl Pinhole {
    /// A camera of focal length `f`, pixel pitch `Sx` and distance `n` from the pinhole to the object, all in metres.
    pub fn new(focal_length_m: Measurement, pixel_pitch_m: Measurement, distance_m: Measurement) -> Result<Self> {
        Ok(Self {
            focal_length_m: positive("focal length (m)", focal_length_m)?,
            pixel_pitch_m: positive("pixel pitch (m)", pixel_pitch_m)?,
            distance_m: positive("distance (m)", distance_m)?,
        })
    }

    /// The scale `k = n Sx / f` of a motion parallel to the sensor, with first-order uncertainty (thesis eq. 5.7).
    pub fn scale(&self) -> Result<Scale> {
        let (f, pitch, n) = (self.focal_length_m, self.pixel_pitch_m, self.distance_m);
        let k = n.value() * pitch.value() / f.value();
        let std = combined_std([(k / n.value(), n.std()), (k / pitch.value(), pitch.std()), (-k / f.value(), f.std())]);
        Scale::new(Measurement::new(k, std).map_err(|_| Error::Parameter {
            name: "scale (m/px)",
            value: k,
            expected: "finite: check focal length, pixel pitch and distance",
        })?)
    }

    /// Distance in metres that an object travelled along a path tilted by `tilt_rad` against the sensor plane, from
    /// its blur of `length_px` pixels that starts `start_px` pixels from the optical axis (thesis eq. 5.3 and 5.6):
    ///
    /// `d = n L Sx / (f cos(tilt) - Sx (P + L) sin(tilt))`
    ///
    /// `start_px` is signed along the motion; a positive tilt recedes from the camera. An error when the blur would
    /// reach beyond the vanishing point of the path, where the denominator is not positive.
    pub fn path_length_m(&self, length_px: f64, start_px: f64, tilt_rad: f64) -> Result<f64> {
        let (f, pitch, n) = (self.focal_length_m.value(), self.pixel_pitch_m.value(), self.distance_m.value());
        let denominator = f * tilt_rad.cos() - pitch * (start_px + length_px) * tilt_rad.sin();
        if denominator.is_finite() && denominator > 0.0 {
            Ok(n * length_px * pitch / denominator)
        } else {
            Err(Error::Parameter {
                name: "tilt (rad)",
                value: tilt_rad,
                expected: "so small that the blur ends before the vanishing point",
            })
        }
    }
}

fn positive(name: &'static str, measured: Measurement) -> Result<Measurement> {
    if measured.value() > 0.0 {
        Ok(measured)
    } else {
        Err(Error::Parameter { name, value: measured.value(), expected: "greater than 0" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Pinhole {
        let exact = |x| Measurement::exact(x).unwrap();
        Pinhole::new(exact(0.008), exact(5.2e-6), Measurement::new(1.21, 0.005).unwrap()).unwrap()
    }

    #[test]
    fn scale_is_distance_times_pitch_over_focal_length() {
        let k = camera().scale().unwrap().m_per_px();
        assert!((k.value() - 1.21 * 5.2e-6 / 0.008).abs() < 1e-18);
        assert!((k.std() / k.value() - 0.005 / 1.21).abs() < 1e-12);
    }

    #[test]
    fn a_tilted_path_agrees_with_projecting_its_ends() {
        // Start on the sensor at p, travel d along a path that recedes by sin(tilt): project both ends by x f / z.
        let (f, pitch, n, tilt, d) = (0.008_f64, 5.2e-6, 1.21, 0.3_f64, 0.05);
        for start_px in [-200.0, 0.0, 350.0] {
            let x0 = start_px * pitch * n / f;
            // A positive tilt takes the object d sin(tilt) further away.
            let (x1, z1) = (x0 + d * tilt.cos(), n + d * tilt.sin());
            let length_px = (x1 * f / z1 - x0 * f / n) / pitch;
            let found = camera().path_length_m(length_px, start_px, tilt).unwrap();
            assert!((found - d).abs() < 1e-12, "{start_px}: {found}");
        }
    }

    #[test]
    fn without_tilt_the_path_is_scale_times_length() {
        let k = camera().scale().unwrap().m_per_px().value();
        let d = camera().path_length_m(37.5, 100.0, 0.0).unwrap();
        assert!((d - 37.5 * k).abs() < 1e-15);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let exact = |x| Measurement::exact(x).unwrap();
        let error = Pinhole::new(exact(0.0), exact(5e-6), exact(1.0)).unwrap_err();
        assert!(error.to_string().contains("focal length"), "{error}");
        assert!(camera().path_length_m(50.0, 0.0, 1.6).is_err());
    }
}
