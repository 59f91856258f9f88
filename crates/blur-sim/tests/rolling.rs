//! A rolling shutter makes the blur that `RollingShutter` says, and its speed can be got back.
#![allow(clippy::unwrap_used)]

use blur_core::camera::Scale;
use blur_core::estimate::{AxialAngle, JointEstimator, Settings, joint::Whittle};
use blur_core::motion::{Exposure, RolledBlur, RollingShutter};
use blur_sim::rng::Rng;
use blur_sim::rolling::{RollingMotion, expose_rows};
use blur_sim::scene::PlaneWave;
use metrology::Measurement;

/// Waves of all directions whose power falls with the square of the frequency.
fn waves(seed: u64, count: usize) -> Vec<PlaneWave> {
    let mut rng = Rng::new(seed, 77);
    (0..count)
        .map(|_| {
            // Uniform over the plane of frequencies.
            let (u, v) = (rng.uniform_in(-0.5, 0.5), rng.uniform_in(0.0, 0.5));
            let amplitude = 0.12 / u.hypot(v).max(0.01);
            PlaneWave { amplitude, u, v, phase_rad: rng.uniform_in(0.0, std::f64::consts::TAU) }
        })
        .collect()
}

#[test]
fn without_time_between_rows_it_is_an_ordinary_exposure() {
    let waves = waves(1, 20);
    let motion = RollingMotion { right_px: 9.0, down_px: -5.0, row_time: 0.0, speed_gain: 0.0 };
    let picture = expose_rows((16, 20), 100.0, &waves, &motion).unwrap();
    // The mean of many instants, by the midpoint rule.
    for ((row, col), &value) in picture.indexed_iter() {
        let instants = 2000;
        let mean: f64 = (0..instants)
            .map(|i| {
                let t = (f64::from(i) + 0.5) / f64::from(instants);
                waves.iter().map(|wave| wave.at(col as f64 - 9.0 * t, row as f64 + 5.0 * t)).sum::<f64>()
            })
            .sum::<f64>()
            / f64::from(instants);
        assert!((value - 100.0 - mean).abs() < 1e-3, "{row} {col}: {value} {mean}");
    }
}

#[test]
fn a_row_is_exposed_at_its_own_time() {
    let waves = waves(2, 10);
    let rolling = RollingMotion { right_px: 6.0, down_px: 2.0, row_time: 0.25, speed_gain: 0.0 };
    let still = RollingMotion { row_time: 0.0, ..rolling };
    let rolled = expose_rows((9, 12), 0.0, &waves, &rolling).unwrap();
    // Row 8 opens two exposures late: the content has moved on by 12 and 4 pixels.
    let moved: Vec<PlaneWave> = waves
        .iter()
        .map(|wave| {
            let turn = std::f64::consts::TAU * (12.0 * wave.u + 4.0 * wave.v);
            PlaneWave { phase_rad: wave.phase_rad - turn, ..*wave }
        })
        .collect();
    let later = expose_rows((9, 12), 0.0, &moved, &still).unwrap();
    for (a, b) in rolled.row(8).iter().zip(later.row(8)) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn a_speed_that_rises_is_that_of_the_middle_of_each_exposure() {
    let waves = waves(4, 10);
    let rising = RollingMotion { right_px: 6.0, down_px: 2.0, row_time: 0.25, speed_gain: 0.04 };
    let picture = expose_rows((33, 12), 0.0, &waves, &rising).unwrap();
    let steady = expose_rows((33, 12), 0.0, &waves, &RollingMotion { speed_gain: 0.0, ..rising }).unwrap();
    // What an eighth of the gain in length, at both ends of a row's exposure, can change.
    let turns = |wave: &PlaneWave| (6.0 * wave.u + 2.0 * wave.v).abs();
    let most: f64 = waves.iter().map(|wave| wave.amplitude * std::f64::consts::TAU * turns(wave) * 0.04 / 8.0).sum();
    let mut farthest = 0.0_f64;
    // Row 32 is exposed eight exposures late, when the speed is higher by a third.
    for (column, (&value, &other)) in picture.row(32).iter().zip(steady.row(32)).enumerate() {
        let instants = 2000;
        let mean: f64 = (0..instants)
            .map(|i| {
                // Time since the middle of the first row's exposure, and how far the content has come.
                let t = 8.0 - 0.5 + (f64::from(i) + 0.5) / f64::from(instants);
                let moved = 0.5 + t + 0.02 * t * t;
                waves.iter().map(|wave| wave.at(column as f64 - 6.0 * moved, 32.0 - 2.0 * moved)).sum::<f64>()
            })
            .sum::<f64>()
            / f64::from(instants);
        assert!((value - mean).abs() < most, "{column}: {value} {mean} {most}");
        farthest = farthest.max((other - mean).abs());
    }
    assert!(farthest > 3.0 * most, "{farthest} {most}");
}

#[test]
fn the_speed_is_one_of_the_two_that_the_shutter_allows() {
    let scene = waves(3, 1500);
    // (right, down) in pixels an exposure; 1/160 of an exposure from row to row makes 8 to 11 % of the length.
    for (right_px, down_px) in [(4.0_f64, 14.0_f64), (4.0, -14.0), (9.0, 13.0)] {
        let motion = RollingMotion { right_px, down_px, row_time: 1.0 / 160.0, speed_gain: 0.0 };
        let picture = expose_rows((224, 224), 128.0, &scene, &motion).unwrap().mapv(|value| value as f32);
        let blur = Whittle::new(&Settings::default()).estimate(picture.view()).unwrap();
        let true_px = right_px.hypot(down_px);
        let trace_px = true_px / (1.0 - down_px * motion.row_time);
        let miss = format!("{right_px} {down_px}: {blur:?}");
        assert!((blur.length_px / trace_px - 1.0).abs() < 0.02, "{trace_px} {miss}");
        // The direction is that of the motion.
        let angle = AxialAngle::from_deg((-down_px).atan2(right_px).to_degrees());
        assert!(blur.angle.distance_deg(angle) < 1.0, "{miss}");

        // One exposure lasts a second and a pixel is a metre.
        let one = Measurement::exact(1.0).unwrap();
        let (scale, exposure) = (Scale::new(one).unwrap(), Exposure::new(one).unwrap());
        let shutter = RollingShutter::new(224.0 / 160.0, 224).unwrap();
        let rolled = RolledBlur {
            length_px: blur.length_px,
            length_std_px: blur.length_std_px,
            angle: blur.angle,
            angle_std_deg: blur.angle_std_deg,
            correlation: blur.correlation.unwrap(),
        };
        let speeds =
            [shutter.speed_downwards(&rolled, scale, exposure), shutter.speed_upwards(&rolled, scale, exposure)];
        let (right, wrong) = if down_px > 0.0 { (speeds[0], speeds[1]) } else { (speeds[1], speeds[0]) };
        assert!((right.value_m_s / true_px - 1.0).abs() < 0.02, "{speeds:?} {miss}");
        assert!((wrong.value_m_s / true_px - 1.0).abs() > 0.1, "{speeds:?} {miss}");
    }
}

#[test]
fn the_uncertainty_of_the_speed_is_that_of_finite_differences() {
    let shutter = RollingShutter::new(0.02, 1440).unwrap();
    let measured = |value: f64, std: f64| Measurement::new(value, std).unwrap();
    let speed = |length: f64, deg: f64, k: f64, t: f64| {
        let blur = RolledBlur {
            length_px: length,
            length_std_px: Some(0.8),
            angle: AxialAngle::from_deg(deg),
            angle_std_deg: Some(1.5),
            correlation: 0.4,
        };
        let (scale, exposure) = (Scale::new(measured(k, 2e-5)).unwrap(), Exposure::new(measured(t, 2e-4)).unwrap());
        [shutter.speed_downwards(&blur, scale, exposure), shutter.speed_upwards(&blur, scale, exposure)]
    };
    for way in 0..2 {
        let at = |length: f64, deg: f64, k: f64, t: f64| speed(length, deg, k, t)[way].value_m_s;
        let (length, deg, k, t) = (90.0, 130.0, 1e-3, 4e-3);
        let difference = |high: f64, low: f64, step: f64| (high - low) / (2.0 * step);
        let by_length = 0.8 * difference(at(length + 1e-3, deg, k, t), at(length - 1e-3, deg, k, t), 1e-3);
        let by_angle = 1.5 * difference(at(length, deg + 1e-3, k, t), at(length, deg - 1e-3, k, t), 1e-3);
        let by_scale = 2e-5 * difference(at(length, deg, k + 1e-8, t), at(length, deg, k - 1e-8, t), 1e-8);
        let by_exposure = 2e-4 * difference(at(length, deg, k, t + 1e-8), at(length, deg, k, t - 1e-8), 1e-8);
        let squares = by_length.powi(2) + by_angle.powi(2) + by_scale.powi(2) + by_exposure.powi(2);
        let expected = (squares + 2.0 * 0.4 * by_length * by_angle).sqrt();
        let found = speed(length, deg, k, t)[way].std_m_s.unwrap();
        assert!((found / expected - 1.0).abs() < 1e-5, "{way}: {found} {expected}");
    }
}

#[test]
fn no_speed_upwards_outruns_the_readout() {
    let one = Measurement::exact(1.0).unwrap();
    let (scale, exposure) = (Scale::new(one).unwrap(), Exposure::new(one).unwrap());
    // The 50 rows of the blur are read in 1.25 exposures.
    let shutter = RollingShutter::new(2.5, 100).unwrap();
    let angle = AxialAngle::from_deg(90.0);
    let blur = RolledBlur { length_px: 50.0, length_std_px: None, angle, angle_std_deg: None, correlation: 0.0 };
    assert!(shutter.speed_upwards(&blur, scale, exposure).value_m_s.is_infinite());
    assert!((shutter.speed_downwards(&blur, scale, exposure).value_m_s - 50.0 / 2.25).abs() < 1e-12);
    assert!(RollingShutter::new(-1.0, 100).is_err() && RollingShutter::new(0.02, 0).is_err());
}
