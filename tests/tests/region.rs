//! Maps of the blur: the same on any number of threads, and without allocation.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

use allocation_counter::measure;
use blur_cli::map::Map;
use blur_core::estimate::{Settings, Status};
use blur_core::region::{TileEstimator, TilePlan};
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use blur_sim::street::{expose_street, two_movers};
use ndarray::{Array2, ArrayView2};

fn leaves(seed: u64, rows: usize, cols: usize) -> Array2<f64> {
    dead_leaves(seed, rows, cols, &DeadLeaves::default()).unwrap()
}

fn recorded(light: ArrayView2<'_, f64>, seed: u64) -> Array2<f32> {
    let sensor = Sensor::ideal().with_psnr_db(40.0).unwrap();
    f32_from_u8(sensor.record(light, seed).unwrap().view())
}

#[test]
fn a_tile_allocates_nothing_after_the_first() {
    let picture = recorded(leaves(60, 256, 384).view(), 60);
    let plan = TilePlan::new(picture.dim(), 96).unwrap();
    let mut estimator = TileEstimator::new(plan, &Settings::default()).unwrap();
    let mut counts = Vec::new();
    for index in 0..plan.len() {
        counts.push(
            measure(|| {
                estimator.estimate(picture.view(), index).unwrap();
            })
            .count_total,
        );
    }
    assert!(counts[0] > 0 && counts[1..].iter().all(|&count| count == 0), "{counts:?}");
}

#[test]
fn a_map_does_not_depend_on_the_number_of_threads() {
    let [a, b] = two_movers(4, 400, 736).unwrap();
    let [still, first, second] = [70, 71, 72].map(|scene| leaves(scene, 400, 736));
    let street = expose_street(still.view(), &[(a, first.view()), (b, second.view())]).unwrap();
    let picture = recorded(street.light.view(), 4);
    let maps = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Map::measure(picture.view(), 128, &Settings::default()).unwrap())
    });
    assert_eq!(maps[0], maps[1]);
    assert_eq!(maps[0], maps[2]);
    assert!(maps[0].tiles.iter().any(|tile| tile.blur.is_some_and(|blur| blur.status == Status::Ok)));
}
