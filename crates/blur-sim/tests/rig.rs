//! Promises of the virtual rig.
#![allow(clippy::unwrap_used)]

use blur_core::estimate::AxialAngle;
use blur_sim::Error;
use blur_sim::motion::Motion;
use blur_sim::rig::belt::SPEEDS_M_S;
use blur_sim::rig::design::{FIXED_RELEASE_M, LENGTHS_PX};
use blur_sim::rig::{Design, POSTERS, Preset, Rig, SCALE_M_PER_PX, SHOTS, STILLS, Setting, Shot, Studio};
use ndarray::Array2;

/// Small pictures, taken fast.
fn small() -> Rig {
    Rig { side_px: 72, ..Rig::default() }
}

fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(x), mean(y));
    let sum = |f: &dyn Fn(f64, f64) -> f64| x.iter().zip(y).map(|(a, b)| f(a - mx, b - my)).sum::<f64>();
    sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
}

fn of(shots: &[Shot], value: impl Fn(&Shot) -> f64) -> Vec<f64> {
    shots.iter().map(value).collect()
}

#[test]
fn a_pixel_is_1_1008_mm_of_the_poster() {
    assert!((SCALE_M_PER_PX - 1.1008e-3).abs() < 5e-8, "{SCALE_M_PER_PX}");
    assert_eq!(Rig::default().scale_m_per_px, SCALE_M_PER_PX);
}

#[test]
fn an_experiment_has_every_preset_poster_and_shot_once() {
    for (_, design) in Design::NAMED {
        let shots = Rig::default().shots(design, 3).unwrap();
        let mut cells: Vec<_> = shots.iter().map(|shot| (shot.preset, shot.poster, shot.index)).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!((shots.len(), cells.len()), (125, 125));
        assert!(cells.iter().all(|&(a, b, c)| a < 5 && b < POSTERS.len() && c < SHOTS));
    }
}

#[test]
fn lengths_follow_from_falling_since_the_release() {
    let rig = Rig::default();
    for (_, design) in Design::NAMED {
        for shot in rig.shots(design, 1).unwrap() {
            // From rest x = a t^2 / 2: the shutter opens at t = sqrt(2 d / a) and closes T later.
            let (a, opens) = (shot.accel_m_s2, (2.0 * shot.release_m / shot.accel_m_s2).sqrt());
            let x = |t: f64| 0.5 * a * t * t;
            let (begin, end) = (x(opens), x(opens + 0.1));
            let length_px = (end - begin) / (0.7789e-3 * 171.0 / 121.0);
            assert!((shot.length_px - length_px).abs() < 1e-9, "{shot:?}");
            assert!((shot.v0_m_s - a * opens).abs() < 1e-12, "{shot:?}");
            assert!((shot.speed_m_s - (end - begin) / 0.1).abs() < 1e-12, "{shot:?}");
            // The speed grows from (1 - r) to (1 + r) of its mean.
            let r = a * 0.1 / (a * opens + a * (opens + 0.1));
            assert!((shot.accel_ratio - r).abs() < 1e-12, "{shot:?}");
            // The displacement in the middle of the exposure is that of the motion that the pictures are made with.
            let middle = (x(opens + 0.05) - begin) / rig.scale_m_per_px - 0.5 * length_px;
            assert!((shot.motion().unwrap().centred_displacement_px(0.5) - middle).abs() < 1e-9, "{shot:?}");
        }
    }
}

#[test]
fn accelerations_scatter_about_the_presets_by_half_of_their_expanded_uncertainty() {
    let shots: Vec<Shot> = (0..20).flat_map(|seed| Rig::default().shots(Design::FixedRelease, seed).unwrap()).collect();
    for (preset, truth) in Preset::THESIS.iter().enumerate() {
        let off = of(&shots, |shot| (shot.accel_m_s2 - truth.accel_m_s2) / (0.5 * truth.expanded_m_s2));
        let off: Vec<f64> = off.iter().zip(&shots).filter(|(_, s)| s.preset == preset).map(|(z, _)| *z).collect();
        assert!(shots.iter().all(|s| s.preset != preset || s.preset_accel_m_s2 == truth.accel_m_s2));
        let n = off.len() as f64;
        assert_eq!(n, 500.0);
        let mean = off.iter().sum::<f64>() / n;
        let variance = off.iter().map(|z| z * z).sum::<f64>() / n;
        // Five standard errors of each.
        assert!(mean.abs() < 5.0 / n.sqrt(), "{mean}");
        assert!((variance - 1.0).abs() < 5.0 * (2.0 / n).sqrt(), "{variance}");
    }
}

#[test]
fn fixed_release_couples_length_and_acceleration() {
    let shots = Rig::default().shots(Design::FixedRelease, 1).unwrap();
    assert!(shots.iter().all(|shot| shot.release_m == FIXED_RELEASE_M));
    let lengths = of(&shots, |shot| shot.length_px);
    assert!(lengths.iter().all(|length| (25.0..60.0).contains(length)), "{lengths:?}");
    assert!(correlation(&lengths, &of(&shots, |shot| shot.accel_m_s2)) > 0.98);
}

#[test]
fn random_release_uncouples_length_and_acceleration() {
    for seed in 0..10 {
        let shots = Rig::default().shots(Design::RandomRelease, seed).unwrap();
        let lengths = of(&shots, |shot| shot.length_px);
        let with_preset = correlation(&lengths, &of(&shots, |shot| shot.preset_accel_m_s2));
        assert!(with_preset.abs() < 1e-12, "{with_preset}");
        // The drawn deviations are at most 0.014 m/s2 in 0.66: 125 of them cannot correlate the sum by more.
        let with_truth = correlation(&lengths, &of(&shots, |shot| shot.accel_m_s2));
        assert!(with_truth.abs() < 0.02, "{with_truth}");
        for preset in 0..5 {
            let mut own: Vec<f64> = shots.iter().filter(|s| s.preset == preset).map(|s| s.length_px).collect();
            own.sort_by(f64::total_cmp);
            let width = (LENGTHS_PX.1 - LENGTHS_PX.0) / 25.0;
            for (stratum, length) in own.iter().enumerate() {
                let low = LENGTHS_PX.0 + width * stratum as f64;
                assert!((low..low + width).contains(length), "{length} in stratum {stratum}");
            }
        }
        assert!(shots.iter().all(|shot| (0.008..0.43).contains(&shot.release_m)));
        assert_ne!(lengths[..25], lengths[25..50], "each preset has an order of its own");
    }
}

#[test]
fn settings_stay_within_their_bounds_and_differ() {
    let rig = Rig::default();
    let shots = rig.shots(Design::FixedRelease, 1).unwrap();
    let stills = (0..POSTERS.len()).flat_map(|poster| (0..STILLS).map(move |k| (poster, k)));
    let stills = stills.map(|(poster, k)| rig.still(poster, k, 1).unwrap().setting);
    let settings: Vec<Setting> = shots.iter().map(|shot| shot.setting).chain(stills).collect();
    let mut seeds: Vec<u64> = settings.iter().map(|s| s.noise_seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    assert_eq!(seeds.len(), 150);
    for (value, low, high) in [
        (of_settings(&settings, |s| s.gain), 0.95, 1.05),
        (of_settings(&settings, |s| s.kappa), 0.08, 0.12),
        (of_settings(&settings, |s| s.right_px), -0.5, 0.5),
        (of_settings(&settings, |s| s.down_px), -0.5, 0.5),
    ] {
        let (least, greatest) = value.iter().fold((f64::MAX, f64::MIN), |(a, b), &x| (f64::min(a, x), f64::max(b, x)));
        // 150 uniform numbers leave a tenth at an end empty with a chance of 0.9^150 = 1e-7.
        assert!(least >= low && least < low + 0.1 * (high - low), "{least} of {low}..{high}");
        assert!(greatest <= high && greatest > high - 0.1 * (high - low), "{greatest} of {low}..{high}");
    }
}

fn of_settings(settings: &[Setting], value: impl Fn(&Setting) -> f64) -> Vec<f64> {
    settings.iter().map(value).collect()
}

#[test]
fn a_picture_is_the_same_in_any_order_and_any_studio() {
    let rig = small();
    let shots = rig.shots(Design::RandomRelease, 7).unwrap();
    let (one, other) = (shots[3], shots[88]);
    let mut studio = Studio::new(&rig).unwrap();
    let first = (studio.picture(&one).unwrap(), studio.picture(&other).unwrap());
    let mut clone = studio.clone();
    let second = (clone.picture(&other).unwrap(), clone.picture(&one).unwrap());
    assert_eq!((&first.0, &first.1), (&second.1, &second.0));
    assert_eq!(rig.shots(Design::RandomRelease, 7).unwrap(), shots);
    assert_ne!(rig.shots(Design::RandomRelease, 8).unwrap()[3], one);
    let background = |k| Studio::new(&rig).unwrap().background(&rig.still(2, k, 7).unwrap()).unwrap();
    assert_eq!(background(0), background(0));
    assert_ne!(background(0), background(1));
}

/// A scene of bells, known between its pixels too: light in grey levels at the distances `x` to the right of and `y` below
/// the middle of the scene. Each bell is wide enough that its samples say all about it.
fn bells(x: f64, y: f64) -> f64 {
    let bell = |height: f64, x0: f64, y0: f64, sigma: f64| {
        let (dx, dy) = ((x - x0) / sigma, (y - y0) / sigma);
        height * (-0.5 * (dx * dx + dy * dy)).exp()
    };
    30.0 + bell(180.0, 0.3, -0.8, 5.0)
        + bell(150.0, -31.0, 12.4, 4.0)
        + bell(120.0, 14.6, 25.1, 3.0)
        + bell(-25.0, -12.0, -20.5, 6.0)
}

/// What pixel (`row`, `col`) should hold before rounding, from the kinematics in metres and seconds: the time average of
/// the bells as they move to the right, times vignetting and gain.
fn expected(rig: &Rig, shot: &Shot, (row, col): (usize, usize)) -> f64 {
    let setting = &shot.setting;
    let centre = 0.5 * (rig.side_px as f64 - 1.0);
    let (x, y) = (col as f64 - centre, row as f64 - centre);
    let steps = 2000;
    let light = (0..steps).map(|step| {
        let t = rig.exposure_s * (f64::from(step) + 0.5) / f64::from(steps);
        let moved_px = (shot.v0_m_s * t + 0.5 * shot.accel_m_s2 * t * t) / rig.scale_m_per_px;
        bells(x - setting.right_px - moved_px, y - setting.down_px)
    });
    let light = light.sum::<f64>() / f64::from(steps);
    let rho = x.hypot(y) / (0.5 * rig.side_px as f64 * 2_f64.sqrt());
    setting.gain * (1.0 - setting.kappa * rho * rho) * light
}

#[test]
fn pictures_are_the_time_average_of_a_scene_that_moves_from_the_reference_position() {
    let rig = Rig { psnr_db: None, ..small() };
    let mut studio = Studio::new(&rig).unwrap();
    for side in [312, 313] {
        let scene = Array2::from_shape_fn((side, 312), |(row, col)| {
            // An odd row more is one below the middle.
            bells(col as f64 - 155.5, row as f64 - 155.5)
        });
        let shots = rig.shots(Design::RandomRelease, 5).unwrap();
        let still = rig.still(0, 1, 5).unwrap();
        let stopped = Shot { v0_m_s: 0.0, accel_m_s2: 0.0, length_px: 0.0, setting: still.setting, ..shots[0] };
        for shot in shots.iter().step_by(31).chain([&stopped]) {
            let picture = studio.photograph(scene.view(), &shot.motion().unwrap(), &shot.setting).unwrap();
            for (at, &value) in picture.indexed_iter() {
                let truth = expected(&rig, shot, at);
                // Half a level of rounding; the midpoint rule errs by less than a thousandth.
                assert!((f64::from(value) - truth).abs() < 0.502, "{shot:?} {at:?}: {value} for {truth}");
            }
        }
    }
}

#[test]
fn shots_and_stills_are_photographs_of_the_posters() {
    let rig = small();
    let mut studio = Studio::new(&rig).unwrap();
    let shots = rig.shots(Design::FixedRelease, 5).unwrap();
    for (number, poster) in POSTERS.iter().enumerate() {
        let scene = poster.scene(rig.side_px + 224).unwrap();
        let shot = shots.iter().find(|shot| shot.poster == number && shot.preset == number).unwrap();
        let along_x = Motion::new(shot.length_px, AxialAngle::from_deg(0.0), shot.accel_ratio).unwrap();
        let picture = studio.photograph(scene.view(), &along_x, &shot.setting).unwrap();
        assert_eq!(studio.picture(shot).unwrap(), picture);
        let still = rig.still(number, 2, 5).unwrap();
        let at_rest = Motion::uniform(0.0, AxialAngle::from_deg(0.0)).unwrap();
        let picture = studio.photograph(scene.view(), &at_rest, &still.setting).unwrap();
        assert_eq!(studio.background(&still).unwrap(), picture);
    }
}

#[test]
fn noise_has_the_psnr_asked_for_and_is_new_in_every_picture() {
    let clean = Rig { psnr_db: None, ..small() };
    let noisy = Rig { psnr_db: Some(30.0), ..small() };
    let shots = noisy.shots(Design::FixedRelease, 2).unwrap();
    assert_eq!(shots, clean.shots(Design::FixedRelease, 2).unwrap());
    let noise = |shot: &Shot| -> Array2<f64> {
        let picture = |rig: &Rig| Studio::new(rig).unwrap().picture(shot).unwrap().mapv(f64::from);
        picture(&noisy) - picture(&clean)
    };
    let (a, b) = (noise(&shots[0]), noise(&shots[1]));
    let mean_square = |x: &Array2<f64>| x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64;
    // 255 x 10^(-30/20) = 8.06, rounded twice; 5 standard errors from 5184 pixels are a tenth.
    let truth = 8.0638_f64.powi(2) + 2.0 / 12.0;
    assert!((mean_square(&a) / truth - 1.0).abs() < 0.1, "{}", mean_square(&a));
    let product = (&a * &b).sum() / a.len() as f64;
    assert!(product.abs() < 5.0 * truth / (a.len() as f64).sqrt(), "{product}");
}

#[test]
fn posters_are_textured_along_the_motion_and_hardly_clipped() {
    let rig = Rig { side_px: 256, ..Rig::default() };
    let mut studio = Studio::new(&rig).unwrap();
    for (number, poster) in POSTERS.iter().enumerate() {
        let picture = studio.background(&rig.still(number, 0, 1).unwrap()).unwrap();
        let clipped = picture.iter().filter(|&&value| value == 0 || value == 255).count();
        assert!(clipped < picture.len() / 1000, "{}: {clipped} clipped", poster.name);
        // A sharp edge or two in every 30 pixels: the mean step from pixel to pixel is well above the noise's, 2.9.
        let steps = picture.rows().into_iter().flat_map(|row| {
            row.to_vec().windows(2).map(|pair| (f64::from(pair[0]) - f64::from(pair[1])).abs()).collect::<Vec<_>>()
        });
        let mean_step = steps.sum::<f64>() / (256.0 * 255.0);
        assert!(mean_step > 4.0, "{}: {mean_step}", poster.name);
    }
    let mut names: Vec<_> = POSTERS.iter().map(|poster| poster.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), POSTERS.len());
}

#[test]
fn any_scene_and_any_direction_can_be_photographed() {
    let rig = Rig { psnr_db: None, gain_half_width: 0.0, kappa: 0.0, kappa_half_width: 0.0, side_px: 40, ..small() };
    let mut studio = Studio::new(&rig).unwrap();
    let setting = Setting { right_px: 0.0, down_px: 0.0, gain: 1.0, kappa: 0.0, noise_seed: 0 };
    // A bright vertical line; a motion of ten pixels along a slope of 60 degrees takes it five to the right.
    let line = Array2::from_shape_fn((100, 91), |(_, col)| {
        let x = col as f64 - 45.0;
        200.0 * (-0.5 * x * x / 9.0).exp()
    });
    let motion = Motion::uniform(10.0, AxialAngle::from_deg(60.0)).unwrap();
    let picture = studio.photograph(line.view(), &motion, &setting).unwrap().mapv(f64::from);
    let centroid = picture.indexed_iter().map(|((_, col), value)| col as f64 * value).sum::<f64>() / picture.sum();
    // The middle 40 of 91 columns begin at column 25; the mean displacement is half of 10 cos 60.
    assert!((centroid - (45.0 - 25.0 + 2.5)).abs() < 0.05, "{centroid}");
    let long = Motion::uniform(70.0, AxialAngle::from_deg(0.0)).unwrap();
    let refused = studio.photograph(line.view(), &long, &setting);
    assert_eq!(refused, Err(Error::SceneTooSmall { rows: 100, cols: 91, need_rows: 40, need_cols: 180 }));
}

#[test]
fn impossible_rigs_are_refused() {
    let rigs = [
        Rig { exposure_s: 0.0, ..small() },
        Rig { scale_m_per_px: f64::NAN, ..small() },
        Rig { gain_half_width: 1.0, ..small() },
        Rig { misalignment_px: -1.0, ..small() },
        Rig { kappa: 0.95, kappa_half_width: 0.1, ..small() },
        Rig { presets: vec![Preset { accel_m_s2: -1.0, expanded_m_s2: 0.0 }], ..small() },
    ];
    for rig in rigs {
        assert!(matches!(rig.shots(Design::FixedRelease, 1), Err(Error::Parameter { .. })), "{rig:?}");
        assert!(matches!(rig.still(0, 0, 1), Err(Error::Parameter { .. })), "{rig:?}");
        assert!(matches!(Studio::new(&rig), Err(Error::Parameter { .. })), "{rig:?}");
    }
    // Released at rest, 1 s at 2 m/s2 is a metre, 900 pixels: no start makes it 30.
    let slow = Rig { exposure_s: 1.0, ..small() };
    assert!(matches!(slow.shots(Design::RandomRelease, 1), Err(Error::Parameter { .. })));
    assert_eq!(small().still(5, 0, 1), Err(Error::NoPoster { poster: 5, last: 4 }));
    assert!(small().still(0, usize::MAX, u64::MAX).is_ok());
}

#[test]
fn a_pass_blurs_by_the_way_of_the_content_during_the_exposure() {
    let rig = Rig::belt_driven();
    for speed in SPEEDS_M_S {
        let pass = rig.pass(0, 0, speed, AxialAngle::from_deg(20.0), 1).unwrap();
        // v T = 0.1 s of it, in pixels of 0.7789 mm: 28.8 px at V0 to 77.3 px at V9.
        assert!((pass.motion.length_px() - 0.1 * speed / 0.7789e-3).abs() < 1e-9, "{pass:?}");
        assert_eq!(pass.motion.angle().deg(), 20.0);
    }
    assert!(matches!(rig.pass(5, 0, 0.5, AxialAngle::from_deg(0.0), 1), Err(Error::NoPoster { poster: 5, .. })));
    assert!(rig.pass(0, 0, -0.5, AxialAngle::from_deg(0.0), 1).is_err());
}

#[test]
fn passes_of_one_setting_differ_in_what_the_rig_cannot_hold() {
    let rig = Rig { side_px: 72, ..Rig::belt_driven() };
    let pass = |index, seed| rig.pass(1, index, 0.3, AxialAngle::from_deg(90.0), seed).unwrap();
    let (one, other) = (pass(0, 1), pass(1, 1));
    assert_eq!(one.motion, other.motion);
    assert!(one.setting.gain != other.setting.gain && one.setting.noise_seed != other.setting.noise_seed);
    assert_eq!(pass(0, 1), one);
    assert_ne!(pass(0, 2).setting, one.setting);
    let mut studio = Studio::new(&rig).unwrap();
    let first = studio.passing(&one).unwrap();
    assert_ne!(studio.passing(&other).unwrap(), first);
    assert_eq!(studio.passing(&one).unwrap(), first);
}
