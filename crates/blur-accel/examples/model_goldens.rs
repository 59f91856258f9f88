//! Writes a small model of every regression in the present version of the format, and what each predicts, into a folder.
//!
//! Remake: `cargo run -p blur-accel --example model_goldens -- fixtures/model/v1`
//!
//! When the version of the format is raised, the new files go to a folder of their own; the old ones must stay readable
//! (`tests/model_versions.rs`). `predictions.csv` has the columns: name of the regression; blur length in pixels of the
//! box whose zero-phase PSF was given to it; acceleration in m/s²; its standard deviation in m/s², if it has one.

use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use blur_accel::homomorphic::Variant;
use blur_accel::model::{Features, Model, Source, Training, sha256};
use blur_accel::reduce::Components;
use blur_accel::regression::PRESETS;
use blur_accel::validate::Recipe;
use blur_sim::rng::Rng;
use ndarray::{Array1, Array2};

const WIDTH: usize = 32;
const OBSERVATIONS: usize = 24;
/// Lengths in pixels of the boxes that are predicted.
const LENGTHS: [f64; 3] = [5.5, 6.75, 7.5];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("which folder?")?);
    fs::create_dir_all(&folder)?;
    let mut rng = Rng::new(1, 0);
    let lengths: Array1<f64> = (0..OBSERVATIONS).map(|_| rng.uniform_in(4.0, 9.0)).collect();
    let mut inputs = Array2::zeros((OBSERVATIONS, WIDTH / 2 + 1));
    for (mut row, &length) in inputs.rows_mut().into_iter().zip(&lengths) {
        row.assign(&psf(length).mapv(|value| value + 0.005 * rng.gaussian()));
    }
    let targets = lengths.mapv(|length| 0.25 * length);
    let mut predictions = "preset,length_px,accel_m_s2,accel_std_m_s2\n".to_owned();
    for preset in PRESETS {
        let model = Model::train(&Training {
            features: Features { variant: Variant::Dft, height_px: 32, width_px: WIDTH },
            inputs: inputs.view(),
            targets: targets.view(),
            recipe: Recipe { components: Components::Count(3), preset },
            seed: 1,
            source: Source { folder: "boxes", sha256: &sha256(b"boxes") },
            exposure_s: Some(0.1),
            scale_m_per_px: Some(0.001),
        })?;
        for length in LENGTHS {
            let found = model.predict(psf(length).view())?;
            let std = found.std_m_s2.map(|std| std.to_string()).unwrap_or_default();
            writeln!(predictions, "{},{length},{},{std}", preset.name, found.accel_m_s2)?;
        }
        fs::write(folder.join(format!("{}.json", preset.name)), model.to_json()?)?;
    }
    fs::write(folder.join("predictions.csv"), predictions)?;
    Ok(())
}

/// The inverse transform of `|sinc|`: the zero-phase PSF of a box.
fn psf(length: f64) -> Array1<f64> {
    let mtf = |k: usize| {
        let x = PI * length * k as f64 / WIDTH as f64;
        if k == 0 { 1.0 } else { (x.sin() / x).abs() }
    };
    let turn = |k: usize, lag: usize| (2.0 * PI * (k * lag) as f64 / WIDTH as f64).cos();
    let value = |lag: usize| (0..WIDTH).map(|k| mtf(k.min(WIDTH - k)) * turn(k, lag)).sum::<f64>() / WIDTH as f64;
    (0..=WIDTH / 2).map(value).collect()
}
