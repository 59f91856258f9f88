//! Blur that differs over the picture: streets of known truth, and pictures in which nothing or everything moves.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

use blur_core::estimate::{AxialAngle, MotionBlur, Settings};
use blur_core::region::{MovingRegion, STILL, Segmentation, TilePlan, UNKNOWN, measure_tiles, segment};
use blur_sim::expose::expose;
use blur_sim::motion::Motion;
use blur_sim::scene::{DeadLeaves, dead_leaves};
use blur_sim::sensor::{Sensor, f32_from_u8};
use blur_sim::street::{Mover, expose_street, two_movers};
use ndarray::{Array2, ArrayView2};

/// Side of the tiles: more than twice the longest blur, less than the smallest object.
const TILE_PX: usize = 128;

fn leaves(seed: u64, rows: usize, cols: usize) -> Array2<f64> {
    dead_leaves(seed, rows, cols, &DeadLeaves::default()).unwrap()
}

/// Eight bits with a noise of 40 dB.
fn recorded(light: ArrayView2<'_, f64>, seed: u64) -> Array2<f32> {
    let sensor = Sensor::ideal().with_psnr_db(40.0).unwrap();
    f32_from_u8(sensor.record(light, seed).unwrap().view())
}

fn divided(picture: ArrayView2<'_, f32>) -> Segmentation {
    let settings = Settings::default();
    let plan = TilePlan::new(picture.dim(), TILE_PX).unwrap();
    let tiles = measure_tiles(picture, plan, &settings).unwrap();
    segment(picture, &tiles, &settings).unwrap()
}

/// Intersection over union of two labels.
fn overlap(found: &Array2<u8>, label: u8, truth: &Array2<u8>, object: u8) -> f64 {
    let (mut both, mut either) = (0, 0);
    for (found, truth) in found.iter().zip(truth) {
        both += usize::from(*found == label && *truth == object);
        either += usize::from(*found == label || *truth == object);
    }
    f64::from(u32::try_from(both).unwrap()) / f64::from(u32::try_from(either.max(1)).unwrap())
}

/// The speed goes with the length: both exact factors are 1 here.
fn speed_holds(blur: &MotionBlur, motion: &Motion) -> bool {
    let off = blur.length_px - motion.length_px();
    off.abs() <= 0.03 * motion.length_px() && off.abs() <= 2.0 * blur.length_std_px.unwrap()
}

/// A street of dead leaves, its parts and, for each object, the region that covers most of it with that share.
fn street(seed: u64) -> (Array2<u8>, Segmentation, Vec<(Mover, MovingRegion, f64)>) {
    let movers = two_movers(seed, 512, 768).unwrap();
    let [still, first, second] = [10, 20, 30].map(|scene| leaves(scene + seed, 512, 768));
    let layers = [(movers[0], first.view()), (movers[1], second.view())];
    let truth = expose_street(still.view(), &layers).unwrap();
    let found = divided(recorded(truth.light.view(), seed).view());
    let objects = movers.iter().zip(1..).map(|(&mover, object)| {
        let shares = found.moving.iter().map(|region| overlap(&found.labels, region.label, &truth.labels, object));
        let (region, share) = found.moving.iter().zip(shares).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        (mover, region.clone(), share)
    });
    let objects = objects.collect();
    (truth.labels, found, objects)
}

#[test]
fn a_street_is_divided_into_what_stands_still_and_two_motions() {
    for seed in 0..3 {
        let (truth, found, objects) = street(seed);
        assert_eq!(found.moving.len(), 2, "seed {seed}: {:?}", found.moving);
        for (mover, region, share) in objects {
            assert!(share >= 0.8, "seed {seed}, {mover:?}: {region:?} {share:.3}");
            assert!(speed_holds(&region.blur, &mover.motion), "seed {seed}, {mover:?}: {region:?}");
            let off_deg = region.blur.angle.distance_deg(mover.motion.angle());
            assert!(off_deg < 1.0, "seed {seed}, {mover:?}: {region:?}");
        }
        let right = found.labels.iter().zip(&truth).filter(|(f, t)| **f == STILL && **t == 0).count();
        let truly_still = truth.iter().filter(|label| **label == 0).count();
        assert!(right * 10 > truly_still * 8, "seed {seed}: {right} of {truly_still} still");
    }
}

#[test]
fn nothing_moves_in_a_sharp_picture() {
    for seed in 0..3 {
        let found = divided(recorded(leaves(40 + seed, 400, 520).view(), seed).view());
        assert!(found.moving.is_empty(), "seed {seed}: {:?}", found.moving);
        // Leaves are plain inside: what is far from their borders tells nothing.
        assert!(found.share(STILL) > 0.5, "seed {seed}: {}", found.share(STILL));
    }
}

#[test]
fn everything_moves_in_a_blurred_picture() {
    for (seed, length_px, deg) in [(50, 14.0, 20.0), (51, 27.0, 110.0), (52, 38.0, 64.0)] {
        let motion = Motion::uniform(length_px, AxialAngle::from_deg(deg)).unwrap();
        let (rows, cols) = motion.extent_px();
        let light = expose(leaves(seed, 400 + rows, 520 + cols).view(), &motion).unwrap();
        let found = divided(recorded(light.view(), seed).view());
        assert_eq!(found.moving.len(), 1, "{length_px} px: {:?}", found.moving);
        let region = &found.moving[0];
        assert!(found.share(region.label) > 0.95, "{length_px} px: {}", found.share(region.label));
        assert!(speed_holds(&region.blur, &motion), "{length_px} px: {region:?}");
        assert!((region.centroid.0 - 260.0).abs() < 15.0 && (region.centroid.1 - 200.0).abs() < 15.0);
    }
}

#[test]
fn a_picture_without_texture_tells_nothing() {
    let mut picture = Array2::from_elem((200, 260), 0.5_f32);
    picture[(3, 4)] = 0.6;
    let found = divided(picture.view());
    assert!(found.moving.is_empty() && found.share(UNKNOWN) > 0.95, "{}", found.share(UNKNOWN));
}

#[test]
fn tiles_overlap_by_half_at_least_and_reach_every_border() {
    for (dim, tile_px) in [((64, 64), 64), ((65, 300), 64), ((512, 768), 128), ((1440, 1920), 256), ((401, 333), 101)] {
        let plan = TilePlan::new(dim, tile_px).unwrap();
        let tiles: Vec<_> = (0..plan.len()).map(|index| plan.tile(index)).collect();
        for (starts, side) in
            [(tiles.iter().map(|t| t.x).collect::<Vec<_>>(), dim.1), (tiles.iter().map(|t| t.y).collect(), dim.0)]
        {
            let mut starts = starts;
            starts.sort_unstable();
            starts.dedup();
            assert_eq!((starts[0], starts[starts.len() - 1] + tile_px), (0, side), "{dim:?} {tile_px}");
            assert!(starts.windows(2).all(|pair| pair[1] - pair[0] <= tile_px / 2), "{dim:?} {tile_px}: {starts:?}");
        }
        assert!(tiles.iter().all(|tile| tile.width == tile_px && tile.height == tile_px));
    }
    assert!(TilePlan::new((512, 512), 63).unwrap_err().to_string().contains("= 63"));
    assert!(TilePlan::new((100, 512), 128).unwrap_err().to_string().contains("512x100"));
}
