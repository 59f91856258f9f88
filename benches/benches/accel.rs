//! Times the way from a picture in memory to its acceleration, in multiples of one 2-D FFT of the same picture.
//!
//! ```sh
//! cargo bench -p blur-benches --bench accel
//! ```
//!
//! `psf` is the homomorphic PSF by either transform, `predict` what a Gaussian process (Matern 5/2, 125 pictures, 76
//! components) makes of it with its standard deviation and the distance from the training, and `picture` both together.

use std::error::Error;
use std::path::Path;
use std::time::{Duration, SystemTime};

use blur_accel::homomorphic::Variant;
use blur_accel::model::{Features, Model, Source, Training};
use blur_accel::reduce::Components;
use blur_accel::regression::Preset;
use blur_accel::validate::Recipe;
use blur_benches::{FFT, Id, Timing, median_ns, table};
use blur_core::estimate::AxialAngle;
use blur_core::spectrum::Dft2;
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::rng::Rng;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use criterion::{BenchmarkId, Criterion};
use ndarray::{Array1, Array2, ArrayView1};

const SIDE: usize = 512;
const LENGTH_PX: f64 = 40.0;
const PICTURES: usize = 125;

fn main() -> Result<(), Box<dyn Error>> {
    let started = SystemTime::now();
    let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let folder = tmp.parent().unwrap_or(tmp).join("criterion");
    let mut criterion = Criterion::default()
        .output_directory(&folder)
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_millis(1500))
        .configure_from_args();
    let (still, picture) = pictures()?;
    let mut ids = Vec::new();
    let mut time = |kind: &'static str, method: &str, work: &mut dyn FnMut()| {
        let mut group = criterion.benchmark_group(kind);
        group.bench_function(BenchmarkId::new(method, SIDE), |bencher| bencher.iter(&mut *work));
        group.finish();
        ids.push(Id { kind, method: method.to_owned(), side: SIDE });
    };
    let mut dft = Dft2::new(SIDE, SIDE);
    time(FFT, "real-2d", &mut || {
        dft.input().assign(&picture);
        dft.transform();
    });
    for (variant, name) in [(Variant::Dft, "dft"), (Variant::Dct, "dct")] {
        let features = Features { variant, height_px: SIDE, width_px: SIDE };
        let scene = features.prototype(&[still.view()])?;
        let mut extractor = features.extractor();
        let psf = Array1::from_iter(extractor.extract(picture.view(), &scene)?.iter().copied());
        let model = model(features, &psf)?;
        model.predict(psf.view())?;
        let mut run = || -> blur_accel::Result<f64> {
            let psf = extractor.extract(picture.view(), &scene)?;
            Ok(model.predict(ArrayView1::from(psf))?.accel_m_s2)
        };
        time("picture", name, &mut || {
            std::hint::black_box(run().ok());
        });
        time("psf", name, &mut || {
            std::hint::black_box(extractor.extract(picture.view(), &scene).ok());
        });
        time("predict", name, &mut || {
            std::hint::black_box(model.predict(psf.view()).ok());
        });
    }
    criterion.final_summary();
    let timings: Vec<Timing> =
        ids.into_iter().filter_map(|id| median_ns(&folder, &id, started).map(|ns| Timing { id, ns })).collect();
    if !timings.is_empty() {
        println!("Median time of one picture, and how many 2-D FFTs of it fit into that\n\n{}", table(&timings));
    }
    Ok(())
}

/// A still and a blurred picture of one scene, 40 dB.
fn pictures() -> blur_sim::Result<(Array2<f32>, Array2<f32>)> {
    let motion = Motion::new(LENGTH_PX, AxialAngle::from_deg(0.0), 0.2)?;
    let sensor = Sensor::ideal().with_psnr_db(40.0)?;
    let scene = dead_leaves(1, SIDE, SIDE + motion.extent_px().1, &DeadLeaves::default())?;
    let blurred = sensor.record(expose(scene.view(), &motion)?.view(), 1)?;
    let still = sensor.record(scene.view(), 2)?;
    let still = Array2::from_shape_fn((SIDE, SIDE), |(row, column)| f32::from(still[[row, column]]));
    Ok((still, f32_from_u8(blurred.view())))
}

/// A model of pictures like the one with this PSF.
fn model(features: Features, psf: &Array1<f64>) -> blur_accel::Result<Model> {
    let mut rng = Rng::new(1, 0);
    let inputs = Array2::from_shape_fn((PICTURES, psf.len()), |(_, lag)| psf[lag] + 0.01 * rng.gaussian());
    let targets = inputs.column(0).mapv(|value| 20.0 * value);
    Model::train(&Training {
        features,
        inputs: inputs.view(),
        targets: targets.view(),
        recipe: Recipe { components: Components::Count(76), preset: Preset::named("gpr-matern52")? },
        seed: 1,
        source: Source { folder: "bench", sha256: "" },
        exposure_s: None,
        scale_m_per_px: None,
    })
}
