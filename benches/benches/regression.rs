//! Times the regressions of the acceleration at the size of the thesis: 125 pictures of 76 components. Predictions are
//! in observations (elements) per second, of one thread; the thesis states 530 per second for its best model.

use std::error::Error;
use std::hint::black_box;

use blur_accel::regression::Preset;
use blur_sim::rng::Rng;
use criterion::{Criterion, Throughput};
use ndarray::{Array1, Array2};

const PICTURES: usize = 125;
const COMPONENTS: usize = 76;
/// Observations predicted in one call.
const BATCH: usize = 4096;

fn main() -> Result<(), Box<dyn Error>> {
    let mut criterion = Criterion::default().sample_size(10).configure_from_args();
    let (inputs, targets) = (gaussian(PICTURES, 0), targets());
    let unseen = gaussian(BATCH, 1);

    let mut group = criterion.benchmark_group("predict");
    group.throughput(Throughput::Elements(BATCH as u64));
    for name in ["gpr-matern52", "svm-quadratic", "trees-boosted", "linear"] {
        let model = Preset::named(name)?.fit(inputs.view(), targets.view(), 1)?;
        group.bench_function(name, |bencher| bencher.iter(|| model.predict(black_box(unseen.view()))));
        if model.predict_std(unseen.view()).is_some() {
            group.bench_function(format!("{name}-with-std"), |bencher| {
                bencher.iter(|| (model.predict(black_box(unseen.view())), model.predict_std(unseen.view())));
            });
        }
    }
    group.finish();

    let mut group = criterion.benchmark_group("train");
    for name in ["gpr-matern52", "svm-quadratic", "trees-boosted"] {
        let preset = Preset::named(name)?;
        group.bench_function(name, |bencher| {
            bencher.iter(|| preset.fit(black_box(inputs.view()), targets.view(), 1));
        });
    }
    group.finish();
    criterion.final_summary();
    Ok(())
}

/// Standardised components.
fn gaussian(rows: usize, stream: u64) -> Array2<f64> {
    let mut rng = Rng::new(7, stream);
    Array2::from_shape_simple_fn((rows, COMPONENTS), || rng.gaussian())
}

/// Accelerations in m/s², which a few of the components tell with some noise.
fn targets() -> Array1<f64> {
    let inputs = gaussian(PICTURES, 0);
    let mut rng = Rng::new(7, 2);
    let of = |row: ndarray::ArrayView1<'_, f64>| 1.5 + 0.5 * row[0].tanh() + 0.3 * row[1] - 0.2 * row[0] * row[2];
    inputs.rows().into_iter().map(|row| of(row) + 0.1 * rng.gaussian()).collect()
}
