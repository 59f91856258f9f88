//! From a sharp picture to what a camera stores of it: exposed exactly, cut to what the exposure covers, cropped about
//! the centre, with noise, rounded to 8 bit and clipped.

use blur_sim::expose::{Blur, Exposer};
use blur_sim::sensor::{Sensor, f32_from_u8};
use ndarray::{Array2, ArrayView2, Slice};

/// PSNR in dB (peak 255) of each level of noise; `None` is clean, rounded only.
pub const LEVELS: [Option<f64>; 4] = [None, Some(36.0), Some(28.0), Some(20.0)];

/// Longest side of the pictures measured.
pub const SIDE_PX: usize = 512;

/// The name of a level of noise: `clean`, or its PSNR.
pub fn level_name(psnr_db: Option<f64>) -> String {
    psnr_db.map_or_else(|| "clean".to_owned(), |db| format!("{db:.0} dB"))
}

/// The square of at most `side` pixels in the middle.
pub fn centre_square<T>(mut picture: ArrayView2<'_, T>, side: usize) -> ArrayView2<'_, T> {
    let (rows, cols) = picture.dim();
    let n = side.min(rows).min(cols);
    picture.slice_each_axis_inplace(|axis| {
        let first = (axis.len - n) / 2;
        Slice::from(first..first + n)
    });
    picture
}

/// Whether a scene of `rows` x `cols` pixels leaves at least `least` pixels each way of this blur.
pub fn leaves(least: usize, (rows, cols): (usize, usize), blur: &impl Blur) -> bool {
    let (lost_rows, lost_cols) = blur.extent_px();
    rows >= lost_rows + least && cols >= lost_cols + least
}

/// The blurred `scene`, its middle of at most [`SIDE_PX`], recorded at each level: 8-bit values as `f32`. Every level
/// has noise of its own, made from `seed`.
///
/// # Errors
/// Those of the exposure and the sensor.
pub fn shots(
    exposer: &mut Exposer,
    scene: ArrayView2<'_, f64>,
    blur: &impl Blur,
    levels: &[Option<f64>],
    seed: u64,
) -> blur_sim::Result<Vec<Array2<f32>>> {
    let blurred = exposer.expose(scene, blur)?;
    let square = centre_square(blurred.view(), SIDE_PX);
    let seeds = (0..).map(|level: u64| seed.wrapping_mul(4).wrapping_add(level));
    levels.iter().zip(seeds).map(|(&psnr_db, seed)| record(square, psnr_db, seed)).collect()
}

/// `picture` with noise of a level, rounded to 8 bit and clipped.
///
/// # Errors
/// Those of the sensor.
pub fn record(picture: ArrayView2<'_, f64>, psnr_db: Option<f64>, seed: u64) -> blur_sim::Result<Array2<f32>> {
    let sensor = psnr_db.map_or_else(|| Ok(Sensor::ideal()), |db| Sensor::ideal().with_psnr_db(db))?;
    Ok(f32_from_u8(sensor.record(picture, seed)?.view()))
}

#[cfg(test)]
mod tests {
    use blur_core::estimate::AxialAngle;
    use blur_sim::motion::Motion;

    use super::*;

    #[test]
    fn the_centre_is_what_is_left_when_both_sides_are_cut_alike() {
        let picture = Array2::from_shape_fn((5, 9), |(row, col)| 10 * row + col);
        assert_eq!(centre_square(picture.view(), 3), ndarray::array![[13, 14, 15], [23, 24, 25], [33, 34, 35]]);
        assert_eq!(centre_square(picture.view(), 100).dim(), (5, 5));
    }

    #[test]
    fn a_blur_leaves_the_scene_less_its_extent() {
        let motion = Motion::uniform(20.0, AxialAngle::from_deg(0.0)).unwrap();
        assert!(leaves(64, (64, 84), &motion));
        assert!(!leaves(64, (64, 83), &motion) && !leaves(64, (63, 84), &motion) && !leaves(64, (64, 10), &motion));
    }

    #[test]
    fn levels_differ_in_noise_only() {
        let scene = Array2::from_elem((40, 60), 100.0);
        let motion = Motion::uniform(10.0, AxialAngle::from_deg(0.0)).unwrap();
        let found = shots(&mut Exposer::new(), scene.view(), &motion, &LEVELS, 5).unwrap();
        assert!(found.iter().all(|shot| shot.dim() == (40, 40)));
        assert!(found[0].iter().all(|&value| value == 100.0));
        let sd = |shot: &Array2<f32>| shot.std(0.0);
        // 255 x 10^(-36/20) = 4.0, 10.2 and 25.5; 1600 pixels tell a deviation to 2 %.
        for (shot, expected) in found[1..].iter().zip([4.04, 10.15, 25.5]) {
            assert!((sd(shot) / expected - 1.0).abs() < 0.08, "{} for {expected}", sd(shot));
        }
    }
}
