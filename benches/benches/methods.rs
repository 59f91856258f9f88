//! Times the methods of the registry; see the documentation of the crate for how to read the result.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use blur_benches::{
    ANGLE_DEG, FFT, Id, LENGTH_PX, Timing, blurred_frame, blurred_picture, median_ns, sharp_picture, table,
};
use blur_core::Result;
use blur_core::estimate::joint::{Stage, Tracker, Whittle};
use blur_core::estimate::{AxialAngle, Heading, JointEstimator, Pair, Settings, registry};
use blur_core::region::{TileEstimator, TilePlan, measure_tiles, segment};
use blur_core::restore::{LineBlur, Method, Restorer};
use blur_core::spectrum::Dft2;
use criterion::{BenchmarkId, Criterion};
use ndarray::{Array2, ArrayView2};

const SIDES: [usize; 3] = [256, 512, 1024];

fn main() -> std::result::Result<(), Box<dyn Error>> {
    let started = SystemTime::now();
    let folder = output_folder();
    let mut criterion = Criterion::default()
        .output_directory(&folder)
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_millis(1500))
        .configure_from_args();
    let mut ids = Vec::new();
    for side in SIDES {
        let (picture, still) = (blurred_picture(side)?, sharp_picture(side)?);
        ids.extend(time_all(&mut criterion, picture.view(), still.view())?);
    }
    let frame = blurred_frame(FRAME)?;
    let mut whittle = Whittle::new(&Settings::default());
    let mut group = criterion.benchmark_group("joint");
    group.bench_function(BenchmarkId::new("whittle-frame", format!("{}x{}", FRAME.1, FRAME.0)), |bencher| {
        bencher.iter(|| whittle.estimate(frame.view()));
    });
    group.finish();
    criterion.final_summary();
    print_stages()?;

    let timings: Vec<Timing> =
        ids.into_iter().filter_map(|id| median_ns(&folder, &id, started).map(|ns| Timing { id, ns })).collect();
    if !timings.is_empty() {
        println!("Median time of one picture, and how many 2-D FFTs of it fit into that\n\n{}", table(&timings));
    }
    Ok(())
}

/// Rows and columns of a camera's frame.
const FRAME: (usize, usize) = (1440, 1920);
/// Side of the tiles of a map.
const TILE_PX: usize = 128;
/// Pictures that the stages are timed on.
const STAGE_RUNS: u32 = 30;

/// Prints how the time of `whittle` at 512 pixels is spent, stage by stage, beside the transform of the picture.
fn print_stages() -> std::result::Result<(), Box<dyn Error>> {
    let picture = blurred_picture(512)?;
    let mut dft = Dft2::new(512, 512);
    let mut fft = Duration::MAX;
    for _ in 0..STAGE_RUNS {
        dft.input().assign(&picture);
        let start = Instant::now();
        dft.transform();
        fft = fft.min(start.elapsed());
    }
    let mut whittle = Whittle::new(&Settings::default());
    whittle.estimate(picture.view())?;
    let mut stages: Vec<(Stage, Duration)> = Vec::new();
    for _ in 0..STAGE_RUNS {
        let mut start = Instant::now();
        whittle.estimate_in_stages(picture.view(), &mut |stage| {
            let taken = start.elapsed();
            match stages.iter_mut().find(|(known, _)| *known == stage) {
                Some((_, total)) => *total += taken,
                None => stages.push((stage, taken)),
            }
            start = Instant::now();
        })?;
    }
    println!(
        "whittle at 512 pixels, stage by stage (mean of {STAGE_RUNS}; one transform {:.2} ms)",
        1e3 * fft.as_secs_f64()
    );
    for (stage, total) in stages {
        let mean = (total / STAGE_RUNS).as_secs_f64();
        println!(
            "  {:10} {:7.2} ms  x {:5.1}",
            format!("{stage:?}").to_lowercase(),
            1e3 * mean,
            mean / fft.as_secs_f64()
        );
    }
    println!();
    Ok(())
}

/// `criterion` in the folder where cargo builds.
fn output_folder() -> PathBuf {
    let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
    tmp.parent().unwrap_or(tmp).join("criterion")
}

fn time_all(criterion: &mut Criterion, picture: ArrayView2<'_, f32>, still: ArrayView2<'_, f32>) -> Result<Vec<Id>> {
    let settings = Settings::default();
    let mut bench = Bench { criterion, side: picture.ncols(), ids: Vec::new() };
    let (rows, columns) = picture.dim();
    let mut dft = Dft2::new(rows, columns);
    bench.time(FFT, "real-2d", || {
        dft.input().assign(&picture);
        Ok(dft.transform()[[0, 0]].re)
    })?;
    for method in registry::ANGLE {
        let mut estimator = method.build(&settings);
        bench.time("angle", method.name, || estimator.estimate(picture))?;
    }
    let angle = AxialAngle::from_deg(ANGLE_DEG);
    for method in registry::LENGTH {
        let mut estimator = method.build(&settings);
        bench.time("length", method.name, || estimator.estimate(picture, angle))?;
    }
    if let (Some(angle), Some(length)) = (registry::ANGLE.first(), registry::LENGTH.first()) {
        let mut pair = Pair::new(angle.build(&settings), length.build(&settings));
        bench.time("pair", &format!("{}+{}", angle.name, length.name), || pair.estimate(picture))?;
    }
    for method in registry::JOINT {
        let mut estimator = method.build(&settings);
        bench.time("joint", method.name, || estimator.estimate(picture))?;
    }
    // Frames that follow each other: the fit from the one before, and the displacement since.
    let mut tracker = Tracker::new(&settings);
    bench.time("sequence", "whittle-tracked", || tracker.estimate(picture))?;
    let mut heading = Heading::new();
    bench.time("sequence", "heading", || Ok(heading.next(picture, Some((angle, LENGTH_PX)))))?;
    for method in registry::REFERENCE {
        let mut estimator = method.build(&[still], &settings)?;
        bench.time("joint", method.name, || estimator.estimate(picture))?;
    }
    let blur = LineBlur::uniform(LENGTH_PX, ANGLE_DEG)?;
    let mut scene = Array2::zeros(picture.dim());
    for (name, method) in
        [("wiener", Method::Wiener), ("richardson-lucy", Method::RichardsonLucy), ("sliding-dct", Method::SlidingDct)]
    {
        let mut restorer = Restorer::new(picture.dim(), &blur, method)?;
        bench.time("restore", name, || restorer.restore(picture, scene.view_mut()))?;
    }
    let plan = TilePlan::new(picture.dim(), TILE_PX)?;
    let mut estimator = TileEstimator::new(plan, &settings)?;
    bench.time("map", "tiles", || (0..plan.len()).try_for_each(|tile| estimator.estimate(picture, tile).map(drop)))?;
    let tiles = measure_tiles(picture, plan, &settings)?;
    bench.time("map", "segments", || segment(picture, &tiles, &settings))?;
    Ok(bench.ids)
}

struct Bench<'a> {
    criterion: &'a mut Criterion,
    side: usize,
    ids: Vec<Id>,
}

impl Bench<'_> {
    /// Times `work` on one picture after running it once, so that a method that fails ends the run.
    fn time<O>(&mut self, kind: &'static str, method: &str, mut work: impl FnMut() -> Result<O>) -> Result<()> {
        work()?;
        let mut group = self.criterion.benchmark_group(kind);
        group.bench_function(BenchmarkId::new(method, self.side), |bencher| bencher.iter(&mut work));
        group.finish();
        self.ids.push(Id { kind, method: method.to_owned(), side: self.side });
        Ok(())
    }
}
