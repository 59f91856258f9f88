//! Once its plans are made, extracting a PSF allocates nothing.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be measured fails the test")]

use allocation_counter::measure;
use blur_accel::homomorphic::{HomomorphicPsf, Prototype, Variant};
use blur_sim::rng::Rng;
use ndarray::Array2;

#[test]
fn extracting_a_psf_allocates_nothing() {
    let counted = measure(|| drop(std::hint::black_box(vec![1_u8; 100])));
    assert_eq!(counted.count_total, 1);
    let mut rng = Rng::new(1, 0);
    for variant in [Variant::Dft, Variant::Dct] {
        for dim in [(96, 96), (64, 100), (75, 93), (101, 67)] {
            let mut picture = || Array2::from_shape_simple_fn(dim, || rng.gaussian() as f32);
            let scene = Prototype::new(variant, &[picture().view()]).unwrap();
            let mut extractor = HomomorphicPsf::new(variant, dim.0, dim.1);
            for picture in [picture(), picture()] {
                let counted = measure(|| assert!(extractor.extract(picture.view(), &scene).is_ok()));
                assert_eq!(counted.count_total, 0, "{variant:?} {dim:?}");
            }
        }
    }
}
