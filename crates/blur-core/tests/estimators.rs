//! What every registered method promises for every picture, whatever it shows.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a picture that cannot be measured fails the test")]

use blur_core::Error;
use blur_core::estimate::registry::{ANGLE, JOINT, LENGTH};
use blur_core::estimate::{
    AngleEstimate, AngleEstimator, AxialAngle, JointEstimator, LengthEstimate, LengthEstimator, LengthRange,
    MotionBlur, Settings, Status,
};
use blur_core::image::Window;
use ndarray::{Array2, ArrayView2, Axis, Slice};
use proptest::prelude::*;

/// `SplitMix64` (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    fn uniform(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1_u32 << 24) as f32
    }
}

fn noise(seed: u64, dim: (usize, usize)) -> Array2<f32> {
    let mut random = Random(seed);
    Array2::from_shape_simple_fn(dim, || random.uniform())
}

/// Noise, 0..255, moved over `steps` pixels by `down` rows and `right` columns a step.
fn moved(seed: u64, (rows, columns): (usize, usize), steps: usize, (down, right): (usize, usize)) -> Array2<f32> {
    let scene = noise(seed, (rows + steps * down, columns + steps * right));
    Array2::from_shape_fn((rows, columns), |(r, c)| {
        let sum: f32 = (0..steps).map(|i| scene[[r + i * down, c + i * right]]).sum();
        (255.0 * sum / steps as f32).round()
    })
}

/// Blurred pictures of several sizes and directions, for promises about pictures that can be measured.
/// The second has the rows of the first, the third its columns.
fn blurred() -> [Array2<f32>; 4] {
    [
        moved(1, (64, 64), 9, (0, 1)),
        moved(2, (64, 96), 11, (1, 0)),
        moved(3, (81, 64), 7, (1, 1)),
        moved(4, (72, 101), 8, (1, 2)),
    ]
}

fn angles_deg() -> impl Iterator<Item = f64> {
    [0.0, 30.0, 45.0, 90.0, 133.7, 179.9].into_iter()
}

/// A fresh estimator of every angle method, by name.
fn angle_methods() -> impl Iterator<Item = (&'static str, Box<dyn AngleEstimator>)> {
    ANGLE.iter().map(|method| (method.name, method.build(&Settings::default())))
}

fn length_methods() -> impl Iterator<Item = (&'static str, Box<dyn LengthEstimator>)> {
    LENGTH.iter().map(|method| (method.name, method.build(&Settings::default())))
}

fn joint_methods() -> impl Iterator<Item = (&'static str, Box<dyn JointEstimator>)> {
    JOINT.iter().map(|method| (method.name, method.build(&Settings::default())))
}

/// All methods on one picture.
fn measured(
    image: ArrayView2<'_, f32>,
    settings: &Settings,
) -> (Vec<AngleEstimate>, Vec<LengthEstimate>, Vec<MotionBlur>) {
    let angles = ANGLE.iter().map(|method| method.build(settings).estimate(image).unwrap()).collect();
    let lengths = LENGTH
        .iter()
        .flat_map(|method| {
            let mut estimator = method.build(settings);
            angles_deg().map(move |deg| estimator.estimate(image, AxialAngle::from_deg(deg)).unwrap())
        })
        .collect();
    let joint = JOINT.iter().map(|method| method.build(settings).estimate(image).unwrap()).collect();
    (angles, lengths, joint)
}

/// Numbers only, in every field, those of a doubt included.
fn assert_answers(image: ArrayView2<'_, f32>, settings: &Settings) {
    let is_number = |shown: String| !shown.contains("NaN") && !shown.contains("inf");
    for method in ANGLE {
        let found = method.build(settings).estimate(image);
        let found = found.unwrap_or_else(|error| panic!("{}: {error}", method.name));
        assert!((0.0..180.0).contains(&found.angle.deg()), "{}: {found:?}", method.name);
        assert!(found.std_deg.is_none_or(|std| std >= 0.0), "{}: {found:?}", method.name);
        assert!(is_number(format!("{found:?}")), "{}: {found:?}", method.name);
    }
    for method in LENGTH {
        let mut estimator = method.build(settings);
        for deg in angles_deg() {
            let found = estimator.estimate(image, AxialAngle::from_deg(deg));
            let found = found.unwrap_or_else(|error| panic!("{} at {deg}: {error}", method.name));
            assert!(found.length_px > 0.0, "{} at {deg}: {found:?}", method.name);
            assert!(found.std_px.is_none_or(|std| std >= 0.0), "{} at {deg}: {found:?}", method.name);
            assert!(is_number(format!("{found:?}")), "{} at {deg}: {found:?}", method.name);
        }
    }
    for method in JOINT {
        let found = method.build(settings).estimate(image);
        let found = found.unwrap_or_else(|error| panic!("{}: {error}", method.name));
        assert!((0.0..180.0).contains(&found.angle.deg()), "{}: {found:?}", method.name);
        assert!(found.length_px > 0.0, "{}: {found:?}", method.name);
        assert!(found.angle_std_deg.is_none_or(|std| std >= 0.0), "{}: {found:?}", method.name);
        assert!(found.length_std_px.is_none_or(|std| std >= 0.0), "{}: {found:?}", method.name);
        assert!(found.correlation.is_none_or(|r| (-1.0..=1.0).contains(&r)), "{}: {found:?}", method.name);
        assert!(is_number(format!("{found:?}")), "{}: {found:?}", method.name);
    }
}

/// Every method refuses `image`, with the same error.
fn refusals(image: ArrayView2<'_, f32>) -> Vec<Error> {
    let axis = AxialAngle::from_deg(20.0);
    let angles = angle_methods().map(|(_, mut estimator)| estimator.estimate(image).unwrap_err());
    let lengths = length_methods().map(|(_, mut estimator)| estimator.estimate(image, axis).unwrap_err());
    let joint = joint_methods().map(|(_, mut estimator)| estimator.estimate(image).unwrap_err());
    angles.chain(lengths).chain(joint).collect()
}

#[test]
fn pictures_below_32_pixels_are_refused_with_their_size() {
    for (rows, columns) in [(1, 1), (0, 0), (0, 50), (5, 10_000)] {
        for error in refusals(noise(1, (rows, columns)).view()) {
            // The likelihood along a known angle takes strips, and asks for pixels along the motion only.
            if matches!(error, Error::TooShort { along_px, .. } if along_px < 16.0) {
                continue;
            }
            assert_eq!(error, Error::TooSmall { width: columns, height: rows, min: 32 });
        }
    }
}

#[test]
fn strips_are_refused_by_all_methods_but_the_likelihood_along_a_known_angle() {
    let axis = AxialAngle::from_deg(20.0);
    for (rows, columns) in [(31, 64), (64, 31), (16, 10_000)] {
        let image = noise(1, (rows, columns));
        let angles = angle_methods().map(|(_, mut method)| method.estimate(image.view()).unwrap_err());
        let lengths = length_methods().filter(|(name, _)| *name != "whittle");
        let lengths = lengths.map(|(_, mut method)| method.estimate(image.view(), axis).unwrap_err());
        let joint = joint_methods().map(|(_, mut method)| method.estimate(image.view()).unwrap_err());
        for error in angles.chain(lengths).chain(joint) {
            assert_eq!(error, Error::TooSmall { width: columns, height: rows, min: 32 });
        }
    }
}

#[test]
fn a_pixel_that_is_no_number_is_refused_with_its_place() {
    for value in [f32::INFINITY, f32::NEG_INFINITY] {
        let mut image = noise(1, (40, 50));
        image[[39, 49]] = value;
        for error in refusals(image.view()) {
            assert_eq!(error, Error::NotFinite { row: 39, column: 49, value });
        }
    }
    let mut image = noise(1, (40, 50));
    image[[0, 3]] = f32::NAN;
    for error in refusals(image.view()) {
        assert!(matches!(error, Error::NotFinite { row: 0, column: 3, value } if value.is_nan()), "{error}");
    }
    // Infinities of both signs, whose sum is not infinite.
    image[[0, 3]] = f32::INFINITY;
    image[[7, 7]] = f32::NEG_INFINITY;
    for error in refusals(image.view()) {
        assert_eq!(error, Error::NotFinite { row: 0, column: 3, value: f32::INFINITY });
    }
}

#[test]
fn a_picture_without_contrast_is_refused_with_its_value() {
    for value in [0.0, 128.0, -7.5, f32::MAX, 1e-45] {
        for error in refusals(Array2::from_elem((48, 33), value).view()) {
            assert_eq!(error, Error::Constant { value });
        }
    }
}

#[test]
fn an_estimator_that_refused_a_picture_measures_the_next() {
    let image = moved(1, (64, 64), 9, (0, 1));
    let axis = AxialAngle::from_deg(0.0);
    for (name, mut estimator) in angle_methods() {
        let before = estimator.estimate(image.view()).unwrap();
        estimator.estimate(Array2::from_elem((64, 64), 1.0).view()).unwrap_err();
        assert_eq!(estimator.estimate(image.view()).unwrap(), before, "{name}");
    }
    for (name, mut estimator) in length_methods() {
        let before = estimator.estimate(image.view(), axis).unwrap();
        estimator.estimate(Array2::from_elem((64, 64), 1.0).view(), axis).unwrap_err();
        assert_eq!(estimator.estimate(image.view(), axis).unwrap(), before, "{name}");
    }
    for (name, mut estimator) in joint_methods() {
        let before = estimator.estimate(image.view()).unwrap();
        estimator.estimate(Array2::from_elem((64, 64), 1.0).view()).unwrap_err();
        assert_eq!(estimator.estimate(image.view()).unwrap(), before, "{name}");
    }
}

/// What a generated picture shows.
#[derive(Debug, Clone, Copy)]
enum Content {
    Noise,
    Ramp,
    Stripes,
    BrightPixel,
    Checkerboard,
    SaturatedHalves,
    /// Constant rows: no power off one axis of the spectrum.
    Rows,
    /// Constant but for one pixel by the least step a float can make.
    LeastStep,
}

const CONTENTS: [Content; 8] = [
    Content::Noise,
    Content::Ramp,
    Content::Stripes,
    Content::BrightPixel,
    Content::Checkerboard,
    Content::SaturatedHalves,
    Content::Rows,
    Content::LeastStep,
];

fn picture_of(content: Content, seed: u64, (rows, columns): (usize, usize)) -> Array2<f32> {
    let mut random = Random(seed);
    let (a, b) = (random.uniform(), random.uniform());
    let at = ((a * rows as f32) as usize, (b * columns as f32) as usize);
    let period = 2 + (random.next() % 9) as usize;
    let bit = |on: bool| f32::from(u8::from(on));
    Array2::from_shape_fn((rows, columns), |(r, c)| match content {
        Content::Noise => random.uniform(),
        Content::Ramp => a * (r as f32 / rows as f32) + (0.1 + b) * (c as f32 / columns as f32),
        Content::Stripes => bit((r * at.0 + c).is_multiple_of(period)),
        Content::BrightPixel => bit((r, c) == at),
        Content::Checkerboard => bit((r + c).is_multiple_of(2)),
        Content::SaturatedHalves => bit(c as f32 * (1.0 - a) + r as f32 * a > 0.4 * columns.min(rows) as f32),
        Content::Rows => bit(r.is_multiple_of(period)),
        Content::LeastStep => 1.0 + f32::EPSILON * bit((r, c) == at),
    })
}

fn arbitrary_picture() -> impl Strategy<Value = Array2<f32>> {
    let scales = prop::sample::select(vec![1.0, 255.0, -1.0, 65_535.0, 1e38, 1e-38, 1e-44]);
    let content = prop::sample::select(CONTENTS.to_vec());
    (32_usize..=80, 32_usize..=80, content, any::<u64>(), scales)
        .prop_map(|(rows, columns, content, seed, scale)| {
            picture_of(content, seed, (rows, columns)).mapv(|pixel| pixel * scale)
        })
        .prop_filter("the scale left no contrast", |image| image.iter().any(|&pixel| pixel != image[[0, 0]]))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_finite_picture_with_contrast_gets_finite_answers(image in arbitrary_picture()) {
        assert_answers(image.view(), &Settings::default());
    }

    #[test]
    fn every_setting_gets_finite_answers(
        content in prop::sample::select(CONTENTS.to_vec()),
        seed in any::<u64>(),
        window in prop::sample::select(vec![
            None,
            Some(Window::None),
            Some(Window::Hann),
            Some(Window::Tukey { taper: 0.0 }),
            Some(Window::Tukey { taper: -3.0 }),
            Some(Window::Tukey { taper: 1e9 }),
        ]),
        range in prop::sample::select(vec![(2.0, 2.1), (2.0, 1e4), (10.0, 20.0), (31.9, 32.0), (200.0, 300.0)]),
    ) {
        let mut settings = Settings::default();
        settings.window = window;
        settings.length_range = Some(LengthRange::new(range.0, range.1).unwrap());
        assert_answers(picture_of(content, seed, (41, 54)).view(), &settings);
    }
}

#[test]
fn every_content_at_every_scale_gets_finite_answers() {
    for content in CONTENTS {
        for scale in [1.0, 1e38, 1e-38, 1e-44] {
            let image = picture_of(content, 5, (48, 37)).mapv(|pixel| pixel * scale);
            if image.iter().any(|&pixel| pixel != image[[0, 0]]) {
                assert_answers(image.view(), &Settings::default());
            }
        }
    }
    let full_range =
        Array2::from_shape_fn((40, 40), |(r, c)| if (r * c).is_multiple_of(3) { f32::MAX } else { f32::MIN });
    assert_answers(full_range.view(), &Settings::default());
}

#[test]
fn a_window_whose_share_is_no_number_gets_finite_answers() {
    let mut settings = Settings::default();
    settings.window = Some(Window::Tukey { taper: f64::NAN });
    assert_answers(moved(1, (64, 64), 9, (0, 1)).view(), &settings);
}

#[test]
fn long_strips_get_finite_answers() {
    for dim in [(32, 700), (700, 32), (33, 509)] {
        assert_answers(moved(6, dim, 6, (1, 1)).view(), &Settings::default());
    }
}

#[test]
fn the_layout_of_a_view_in_memory_does_not_matter() {
    let every_other = |image: &Array2<f32>| {
        // The picture at every other place of a larger one full of something else.
        let mut spread = noise(9, (2 * image.nrows(), 3 * image.ncols()));
        spread
            .slice_axis_mut(Axis(0), Slice::new(0, None, 2))
            .slice_axis_mut(Axis(1), Slice::new(1, None, 3))
            .assign(image);
        spread
    };
    for image in blurred() {
        let contiguous = measured(image.view(), &Settings::default());

        let spread = every_other(&image);
        let mut strided = spread.view();
        strided.slice_axis_inplace(Axis(0), Slice::new(0, None, 2));
        strided.slice_axis_inplace(Axis(1), Slice::new(1, None, 3));
        assert_eq!(measured(strided, &Settings::default()), contiguous);

        let transposed = image.t().as_standard_layout().into_owned();
        assert_eq!(measured(transposed.view().reversed_axes(), &Settings::default()), contiguous);

        let mut backwards = image.clone();
        backwards.invert_axis(Axis(0));
        backwards.invert_axis(Axis(1));
        let mut reversed = backwards.as_standard_layout().into_owned();
        reversed.invert_axis(Axis(0));
        reversed.invert_axis(Axis(1));
        assert_eq!(reversed, image);
        assert_eq!(measured(reversed.view(), &Settings::default()), contiguous);
    }
}

#[test]
fn a_power_of_two_as_scale_changes_nothing() {
    for image in blurred() {
        let expected = measured(image.view(), &Settings::default());
        for scale in [0.25, 65_536.0, 2.0_f32.powi(100), 2.0_f32.powi(-100)] {
            let scaled = image.mapv(|pixel| scale * pixel);
            assert_eq!(measured(scaled.view(), &Settings::default()), expected, "{scale}");
        }
    }
}

#[test]
fn scale_and_offset_of_the_grey_values_do_not_matter() {
    // The grey values are integers up to 255: rounding a x + b moves them by 2^-24 of their greatest value, b
    // included, which is some 1e-5 of their contrast here.
    for image in blurred() {
        let (angles, lengths, joint) = measured(image.view(), &Settings::default());
        for (scale, offset) in [(1.0 / 255.0, 0.0), (3.7, 100.0), (257.0, -3000.0), (1.0, 1000.0)] {
            let affine = image.mapv(|pixel| scale * pixel + offset);
            let (affine_angles, affine_lengths, affine_joint) = measured(affine.view(), &Settings::default());
            for ((method, a), b) in ANGLE.iter().zip(&angles).zip(&affine_angles) {
                let distance = a.angle.distance_deg(b.angle);
                assert!(distance < 0.02, "{} {scale} {offset}: {a:?} {b:?}", method.name);
            }
            for (a, b) in lengths.iter().zip(&affine_lengths) {
                // Where there is no motion blur both say so; what length it would have has no meaning.
                let are_denied = [a, b].map(|found| matches!(found.status, Status::NoMotionBlur(_)));
                let close = (a.length_px - b.length_px).abs() < 0.01;
                assert!(
                    are_denied == [true; 2] || (are_denied == [false; 2] && close),
                    "{scale} {offset}: {a:?} {b:?}"
                );
            }
            for ((method, a), b) in JOINT.iter().zip(&joint).zip(&affine_joint) {
                let close = a.angle.distance_deg(b.angle) < 0.02 && (a.length_px - b.length_px).abs() < 0.01;
                assert!(close, "{} {scale} {offset}: {a:?} {b:?}", method.name);
            }
        }
    }
}

#[test]
fn what_was_measured_before_does_not_matter() {
    let images = blurred();
    let order = [0, 1, 0, 2, 2, 1, 3, 0];
    for (i, (name, mut estimator)) in angle_methods().enumerate() {
        for at in order {
            let fresh = ANGLE[i].build(&Settings::default()).estimate(images[at].view());
            assert_eq!(estimator.estimate(images[at].view()), fresh, "{name}");
        }
    }
    for (i, (name, mut estimator)) in length_methods().enumerate() {
        for at in order {
            for deg in angles_deg() {
                let axis = AxialAngle::from_deg(deg);
                let fresh = LENGTH[i].build(&Settings::default()).estimate(images[at].view(), axis);
                assert_eq!(estimator.estimate(images[at].view(), axis), fresh, "{name} at {deg}");
            }
        }
    }
    for (i, (name, mut estimator)) in joint_methods().enumerate() {
        for at in order {
            let fresh = JOINT[i].build(&Settings::default()).estimate(images[at].view());
            assert_eq!(estimator.estimate(images[at].view()), fresh, "{name}");
        }
    }
}

#[test]
fn every_method_is_found_by_its_name_and_no_other() {
    use blur_core::estimate::registry;
    for method in ANGLE {
        assert_eq!(registry::angle(method.name).unwrap().name, method.name);
    }
    for method in LENGTH {
        assert_eq!(registry::length(method.name).unwrap().name, method.name);
    }
    for method in JOINT {
        assert_eq!(registry::joint(method.name).unwrap().name, method.name);
    }
    for name in ["", "DCT-RADON", "dct-radon ", "no-such-method"] {
        let error = registry::angle(name).unwrap_err();
        assert!(
            matches!(&error, Error::UnknownMethod { kind: "angle", name: n, known } if n == name && known.contains("dct-radon")),
            "{error}"
        );
        assert!(registry::length(name).is_err());
        assert!(registry::joint(name).is_err());
    }
}
