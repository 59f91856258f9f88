//! Models of every version of the format that was ever written are still read and predict what they did.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use blur_accel::model::{Model, VERSION};
use blur_accel::regression::PRESETS;
use ndarray::Array1;

/// The zero-phase PSF of a box in pictures of 32 columns, as `examples/model_goldens.rs` defines it.
fn psf(length: f64) -> Array1<f64> {
    let mtf = |k: usize| {
        let x = PI * length * k as f64 / 32.0;
        if k == 0 { 1.0 } else { (x.sin() / x).abs() }
    };
    let value = |lag: usize| (0..32).map(|k| mtf(k.min(32 - k)) * (PI * (k * lag) as f64 / 16.0).cos()).sum::<f64>();
    (0..=16).map(|lag| value(lag) / 32.0).collect()
}

#[test]
fn models_of_every_version_predict_what_they_did() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/model");
    for version in 1..=VERSION {
        let folder = models.join(format!("v{version}"));
        let table = fs::read_to_string(folder.join("predictions.csv")).unwrap();
        let mut seen = 0;
        for line in table.lines().skip(1) {
            let [preset, length, accel, std] = line.split(',').collect::<Vec<_>>()[..] else { panic!("{line}") };
            let model = Model::from_json(&fs::read(folder.join(format!("{preset}.json"))).unwrap()).unwrap();
            assert_eq!(model.provenance().preset, preset);
            let found = model.predict(psf(length.parse().unwrap()).view()).unwrap();
            // Other processors round the cosines of the input otherwise.
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9 * b.abs();
            assert!(close(found.accel_m_s2, accel.parse().unwrap()), "v{version} {line}: {found:?}");
            assert_eq!(found.std_m_s2.is_none(), std.is_empty(), "v{version} {line}");
            assert!(
                found.std_m_s2.is_none_or(|found| close(found, std.parse().unwrap())),
                "v{version} {line}: {found:?}"
            );
            seen += 1;
        }
        assert!(seen >= PRESETS.len().min(19), "v{version}: {seen}");
    }
}
