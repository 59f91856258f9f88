//! A camera as far as the EXIF data of a picture describe it.

use blur_core::camera::{Intrinsics, PARAMETERS};

use crate::Result;
use crate::picture::Focal;

/// Relative standard uncertainty of a focal length from that of the lens and the pitch of the sensor: makers round the
/// length, and focusing changes it.
pub const FROM_PITCH: f64 = 0.03;

/// Relative standard uncertainty of a focal length from its equivalent on 35 mm film, which is a whole number, for the
/// diagonal or the width, and often for another crop.
pub const FROM_FILM: f64 = 0.05;

/// Diagonal of a frame of 35 mm film, 36 mm by 24 mm.
const FILM_DIAGONAL_MM: f64 = 43.266_615_305_567_87;

/// A camera without distortion, its axis in the middle of the picture, with the focal length that EXIF data tell; `None`
/// when they tell none. `width_px` and `height_px` are those of the picture as stored.
///
/// The pitch of the sensor comes first; the equivalent on film counts along the diagonal (CIPA DCG-001).
pub fn camera(focal: &Focal, width_px: usize, height_px: usize) -> Option<Result<Intrinsics>> {
    let (width, height) = (width_px as f64, height_px as f64);
    let from_pitch = || {
        // A picture that was made smaller has larger pixels.
        let shrunk = focal.columns.map_or(1.0, |columns| width / columns);
        Some((focal.length_mm? * focal.pixels_per_mm? * shrunk, FROM_PITCH))
    };
    let from_film = || Some((focal.film_length_mm? / FILM_DIAGONAL_MM * width.hypot(height), FROM_FILM));
    let (focal_px, relative) = from_pitch().or_else(from_film)?;
    let mut parameters = [0.0; PARAMETERS];
    parameters[0] = focal_px;
    parameters[1] = focal_px;
    parameters[2] = 0.5 * (width - 1.0);
    parameters[3] = 0.5 * (height - 1.0);
    // Both focal lengths are one number, and the axis meets the sensor within a few hundredths of the middle.
    let mut covariance = [[0.0; PARAMETERS]; PARAMETERS];
    for row in &mut covariance[..2] {
        row[..2].fill((relative * focal_px).powi(2));
    }
    covariance[2][2] = (relative * width).powi(2);
    covariance[3][3] = (relative * height).powi(2);
    Some(Intrinsics::new(parameters, covariance, width_px, height_px).map_err(Into::into))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fx(focal: Focal) -> Option<(f64, f64)> {
        let camera = camera(&focal, 6000, 4000)?.unwrap();
        Some((camera.parameters()[0], camera.stds()[0]))
    }

    #[test]
    fn the_pitch_of_the_sensor_gives_the_focal_length() {
        // 50 mm on a sensor of 36 mm by 24 mm with 6000 columns: 50 / 36 * 6000.
        let focal = Focal { length_mm: Some(50.0), pixels_per_mm: Some(6000.0 / 36.0), ..Focal::default() };
        let (value, std) = fx(focal).unwrap();
        assert!((value - 8333.333).abs() < 1e-3 && (std / value - FROM_PITCH).abs() < 1e-12);
        // Written with 12000 columns and made smaller: half of it.
        let (value, _) = fx(Focal { columns: Some(12000.0), ..focal }).unwrap();
        assert!((value - 4166.667).abs() < 1e-3);
    }

    #[test]
    fn the_equivalent_on_film_is_the_next_best() {
        let focal = Focal { length_mm: Some(4.25), film_length_mm: Some(26.0), ..Focal::default() };
        let (value, std) = fx(focal).unwrap();
        // On 3:2 as on film diagonal and width agree: 26 / 36 * 6000.
        assert!((value - 4333.333).abs() < 1e-3 && (std / value - FROM_FILM).abs() < 1e-12);
        assert_eq!(fx(Focal { length_mm: Some(4.25), ..Focal::default() }), None);
    }
}
