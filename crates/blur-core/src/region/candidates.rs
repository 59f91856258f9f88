//! The motions that several tiles agree upon.

use super::tiles::TileBlur;
use crate::estimate::{AxialAngle, Doubt, MotionBlur, Status};

/// Motions at most.
const MOST: usize = 6;
/// Votes of a tile whose blur is certain; one in doubt has one.
const CERTAIN: usize = 3;
/// Votes that make a motion.
const LEAST_VOTES: usize = 3;
/// Tiles belong together within this many standard deviations ...
const DEVIATIONS: f64 = 3.0;
/// ... of their own and of this share of the length: a blur may differ somewhat over an object.
const TOLERANCE: f64 = 0.08;
/// A tile that knows its blur no better than to this share of the length agrees with anything, and has no vote.
const MOST_STD: f64 = 0.15;

/// A motion as a point of the plane: `(L cos angle, L sin angle)`, of which the opposite point is the same motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AxialVector {
    x: f64,
    y: f64,
}

/// The motion of several tiles.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub(super) length_px: f64,
    pub(super) angle: AxialAngle,
    /// Centres of the tiles, column and row.
    pub(super) seeds: Vec<(f64, f64)>,
    /// Side of a tile in pixels: nothing further from all seeds belongs to the motion.
    pub(super) reach_px: f64,
}

impl Candidate {
    /// Whether the motion may reach the point at column `x`, row `y`.
    pub(super) fn reaches(&self, x: f64, y: f64) -> bool {
        self.seeds.iter().any(|seed| (seed.0 - x).abs().max((seed.1 - y).abs()) <= self.reach_px)
    }

    /// Whether a measurement of the whole region differs from its tiles by less than a share of the length.
    pub(super) fn is_near(&self, blur: &MotionBlur, share: f64) -> bool {
        let tiles = AxialVector::of(self.length_px, self.angle);
        let whole = AxialVector::of(blur.length_px, blur.angle).towards(tiles);
        (tiles.x - whole.x).hypot(tiles.y - whole.y) < share * self.length_px
    }
}

impl AxialVector {
    fn of(length_px: f64, angle: AxialAngle) -> Self {
        let (sin, cos) = angle.rad().sin_cos();
        Self { x: length_px * cos, y: length_px * sin }
    }

    /// The same motion, on the side of `other`.
    fn towards(self, other: Self) -> Self {
        if self.x * other.x + self.y * other.y < 0.0 { Self { x: -self.x, y: -self.y } } else { self }
    }
}

/// Square of the distance of two blurs in their combined standard deviations.
fn distance2(a: &MotionBlur, b: &MotionBlur) -> f64 {
    let (av, bv) = (AxialVector::of(a.length_px, a.angle), AxialVector::of(b.length_px, b.angle));
    let bv = bv.towards(av);
    let (dx, dy) = (av.x - bv.x, av.y - bv.y);
    let (ca, cb) = (covariance(a), covariance(b));
    let [xx, xy, yy] = [ca[0] + cb[0], ca[1] + cb[1], ca[2] + cb[2]];
    (dx * dx * yy - 2.0 * dx * dy * xy + dy * dy * xx) / (xx * yy - xy * xy)
}

/// Covariance `xx, xy, yy` of the vector, the tolerance counted in.
fn covariance(blur: &MotionBlur) -> [f64; 3] {
    let (sin, cos) = blur.angle.rad().sin_cos();
    let length = blur.length_px;
    let (along, across) = stds_px(blur);
    let mixed = blur.correlation.unwrap_or(0.0) * along * across;
    let own = 0.5 * (TOLERANCE * length).powi(2);
    let (ll, lt, tt) = (along * along + own, mixed, across * across + own);
    [
        cos * cos * ll - 2.0 * sin * cos * lt + sin * sin * tt,
        sin * cos * (ll - tt) + (cos * cos - sin * sin) * lt,
        sin * sin * ll + 2.0 * sin * cos * lt + cos * cos * tt,
    ]
}

/// Standard uncertainties of a blur along it and across it, in pixels.
fn stds_px(blur: &MotionBlur) -> (f64, f64) {
    let across = blur.length_px * blur.angle_std_deg.unwrap_or(0.0).to_radians();
    (blur.length_std_px.unwrap_or(0.0), across)
}

/// Whether a blur is known well enough to agree with one and not with another.
fn is_known(blur: &MotionBlur) -> bool {
    let (along, across) = stds_px(blur);
    along.hypot(across) <= MOST_STD * blur.length_px
}

/// The motions of the tiles that have one, the one with most votes first: a tile in doubt may be right all the same when
/// others agree with it.
pub(super) fn candidates(tiles: &[TileBlur]) -> Vec<Candidate> {
    let vote = |status: Status| match status {
        Status::Ok => CERTAIN,
        Status::LowConfidence(_) => 1,
        Status::NoMotionBlur(_) => 0,
    };
    let mut blurs: Vec<(MotionBlur, (f64, f64))> = tiles
        .iter()
        .filter_map(|tile| tile.blur.map(|blur| (blur, tile.centre())))
        .filter(|(blur, _)| vote(blur.status) > 0 && is_known(blur))
        .collect();
    let reach_px = tiles.iter().map(|tile| tile.tile.width).max().unwrap_or(0) as f64;
    let near = |a: &MotionBlur, b: &MotionBlur| distance2(a, b) < DEVIATIONS * DEVIATIONS;
    let mut found = Vec::new();
    while found.len() < MOST {
        // The tile that most others agree with.
        let votes = |a| blurs.iter().filter(|(b, _)| near(a, b)).map(|(b, _)| vote(b.status)).sum::<usize>();
        let Some((most, leader)) = blurs.iter().map(|(a, _)| (votes(a), *a)).max_by_key(|(votes, _)| *votes) else {
            break;
        };
        if most < LEAST_VOTES {
            break;
        }
        let shows = |status: Status| !matches!(status, Status::LowConfidence(Doubt::WeakEvidence { .. }));
        if !blurs.iter().any(|(b, _)| near(&leader, b) && shows(b.status)) {
            // Hardly more likely than no blur in any tile.
            blurs.retain(|(blur, _)| !near(&leader, blur));
            continue;
        }
        let origin = AxialVector::of(leader.length_px, leader.angle);
        let (mut x, mut y, mut total) = (0.0, 0.0, 0.0);
        let mut seeds = Vec::new();
        for (blur, centre) in blurs.iter().filter(|(blur, _)| near(&leader, blur)) {
            let vector = AxialVector::of(blur.length_px, blur.angle).towards(origin);
            let [xx, _, yy] = covariance(blur);
            let weight = vote(blur.status) as f64 / (xx + yy);
            seeds.push(*centre);
            (x, y, total) = (x + weight * vector.x, y + weight * vector.y, total + weight);
        }
        found.push(Candidate {
            length_px: x.hypot(y) / total,
            angle: AxialAngle::from_deg(y.atan2(x).to_degrees()),
            seeds,
            reach_px,
        });
        blurs.retain(|(blur, _)| !near(&leader, blur));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Region;

    const WEAK: Status = Status::LowConfidence(Doubt::WeakEvidence { per_bin: 0.01, needed: 0.02 });

    /// A tile blurred by `length_px` along `deg`.
    fn tile(x: usize, (length_px, length_std_px): (f64, f64), deg: f64, status: Status) -> TileBlur {
        let blur = MotionBlur {
            angle: AxialAngle::from_deg(deg),
            angle_std_deg: Some(0.5),
            length_px,
            length_std_px: Some(length_std_px),
            correlation: Some(0.0),
            direction_deg: None,
            status,
            evidence: None,
            acceleration: None,
        };
        TileBlur { tile: Region { x, y: 0, width: 128, height: 128 }, blur: Some(blur) }
    }

    #[test]
    fn a_tile_that_knows_nothing_of_its_length_does_not_join_others() {
        let mut tiles: Vec<TileBlur> = (0..5).map(|i| tile(64 * i, (70.0, 1.0), 13.0, Status::Ok)).collect();
        tiles.extend((5..9).map(|i| tile(64 * i, (20.0, 0.5), 100.0, Status::Ok)));
        tiles.push(tile(640, (300.0, 240.0), 13.0, WEAK));
        let found = candidates(&tiles);
        let expected = [(70.0, 13.0, 5), (20.0, 100.0, 4)];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, (length_px, deg, seeds)) in found.iter().zip(expected) {
            assert!((found.length_px - length_px).abs() < 1e-6 && found.seeds.len() == seeds, "{found:?}");
            assert!(found.angle.distance_deg(AxialAngle::from_deg(deg)) < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn the_two_ends_of_the_scale_of_angles_are_one_direction() {
        let angles = [179.5, 0.5, 179.5, 0.5];
        let tiles: Vec<TileBlur> =
            angles.iter().enumerate().map(|(i, &deg)| tile(64 * i, (30.0, 0.5), deg, Status::Ok)).collect();
        let found = candidates(&tiles);
        assert_eq!((found.len(), found[0].seeds.len()), (1, 4), "{found:?}");
        assert!(found[0].angle.distance_deg(AxialAngle::from_deg(0.0)) < 1e-6, "{found:?}");
    }

    #[test]
    fn what_is_hardly_likelier_than_no_blur_needs_a_better_tile() {
        let mut tiles: Vec<TileBlur> = (0..5).map(|i| tile(64 * i, (8.0, 0.2), 90.0, WEAK)).collect();
        assert!(candidates(&tiles).is_empty());
        tiles.push(tile(320, (8.0, 0.2), 90.0, Status::Ok));
        assert_eq!(candidates(&tiles)[0].seeds.len(), 6);
    }
}
