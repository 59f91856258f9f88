//! From a path to a result: direction, sign and trust.

use super::measure::Outcome;
use super::path::Path;
use super::residual::MOST_UNEXPLAINED;
use crate::estimate::{Acceleration, AxialAngle, Doubt, LengthRange, MotionBlur, SignedRatio, Status, length};

/// Shorter paths are no motion blur, in pixels.
const LEAST_PX: f64 = 2.0;
/// Standard uncertainties that a length must differ from 0 by, and a path's middle from the stills' position, to count.
const SIGNIFICANT: f64 = 3.0;
/// Share of the path's length within which the stills' position counts as its begin.
const NEAR: f64 = 0.25;
/// Most standard uncertainty of a length, relative, and of an angle in degrees.
const MOST_LENGTH_STD: f64 = 0.08;
const MOST_ANGLE_STD_DEG: f64 = 3.0;

/// Places in the covariance.
const LENGTH: usize = 2;
const ANGLE: usize = 3;
const RATIO: usize = 4;

/// The result of a fit of lengths in `range`.
pub(super) fn result(outcome: &Outcome, range: LengthRange, acceleration: bool) -> MotionBlur {
    let std = |i: usize| outcome.covariance[i][i].max(0.0).sqrt();
    let correlation = |i: usize, j: usize| {
        let scale = std(i) * std(j);
        if scale > 0.0 { (outcome.covariance[i][j] / scale).clamp(-1.0, 1.0) } else { 0.0 }
    };
    let status = status(outcome, range);
    let axis = AxialAngle::from_deg(outcome.path.angle.to_degrees());
    let is_motion = !matches!(status, Status::NoMotionBlur(_));
    let begin = if is_motion { begin(outcome) } else { None };
    let path_deg = turn_deg(outcome.path.angle.to_degrees());
    // The path may be read from either end; the ratio changes its sign with it.
    let direction_deg = begin.map(|begin| match begin {
        Begin::First => path_deg,
        Begin::Last => turn_deg(path_deg + 180.0),
    });
    let is_along = match begin {
        Some(begin) => begin == Begin::First,
        None => path_deg < 180.0,
    };
    let sign = if is_along { 1.0 } else { -1.0 };
    MotionBlur {
        angle: axis,
        angle_std_deg: Some(std(ANGLE).to_degrees()),
        length_px: outcome.path.length,
        length_std_px: Some(std(LENGTH)),
        correlation: Some(correlation(LENGTH, ANGLE)),
        direction_deg,
        status,
        evidence: None,
        acceleration: acceleration.then(|| {
            Acceleration::from_signed(SignedRatio {
                ratio: sign * outcome.path.ratio,
                std: std(RATIO),
                length_correlation: sign * correlation(LENGTH, RATIO),
                angle_correlation: sign * correlation(ANGLE, RATIO),
            })
        }),
    }
}

/// A direction folded into `[0, 360)`.
fn turn_deg(deg: f64) -> f64 {
    let folded = deg.rem_euclid(360.0);
    // rem_euclid rounds tiny negative numbers up to 360 itself.
    if folded >= 360.0 { 0.0 } else { folded }
}

/// Which end of a path came first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Begin {
    First,
    Last,
}

/// The end of the path at which the stills were taken, when it is clear which one that is.
fn begin(outcome: &Outcome) -> Option<Begin> {
    let Path { centre, length, .. } = outcome.path;
    let direction = outcome.path.direction();
    let along = centre[0] * direction[0] + centre[1] * direction[1];
    let variance: f64 = (0..2)
        .flat_map(|i| (0..2).map(move |j| (i, j)))
        .map(|(i, j)| direction[i] * direction[j] * outcome.covariance[i][j])
        .sum();
    let [first, last] = outcome.path.ends().map(|end| end[0].hypot(end[1]));
    let is_clear = first.min(last) <= NEAR * length && along.abs() > SIGNIFICANT * variance.max(0.0).sqrt();
    is_clear.then_some(if first < last { Begin::First } else { Begin::Last })
}

/// The first reason for doubt that applies.
fn status(outcome: &Outcome, range: LengthRange) -> Status {
    let length_px = outcome.path.length;
    let length_std = outcome.covariance[LENGTH][LENGTH].sqrt();
    let angle_std_deg = outcome.covariance[ANGLE][ANGLE].sqrt().to_degrees();
    let needed_px = LEAST_PX.max(SIGNIFICANT * length_std);
    // Without a number nothing is known: NaN must not pass.
    let relative = length_std / length_px;
    if outcome.unexplained.is_nan() || outcome.unexplained > MOST_UNEXPLAINED {
        Status::LowConfidence(Doubt::Unexplained { share: outcome.unexplained, most: MOST_UNEXPLAINED })
    } else if length_px < needed_px {
        Status::NoMotionBlur(Doubt::ShortLength { length_px, needed_px })
    } else if relative.is_nan() || relative > MOST_LENGTH_STD {
        Status::LowConfidence(Doubt::Uncertain { std: 100.0 * relative, most: 100.0 * MOST_LENGTH_STD, unit: "%" })
    } else if angle_std_deg.is_nan() || angle_std_deg > MOST_ANGLE_STD_DEG {
        Status::LowConfidence(Doubt::Uncertain { std: angle_std_deg, most: MOST_ANGLE_STD_DEG, unit: "deg" })
    } else {
        length::status_in(range, length_px, Status::Ok)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(centre: [f64; 2], length: f64, deg: f64, ratio: f64) -> Outcome {
        let mut covariance = [[0.0; 13]; 13];
        for (i, row) in covariance.iter_mut().enumerate().take(5) {
            row[i] = 1e-4;
        }
        (covariance[2][4], covariance[4][2]) = (5e-5, 5e-5);
        Outcome { path: Path { centre, length, angle: deg.to_radians(), ratio }, covariance, unexplained: 0.0 }
    }

    fn judged(outcome: &Outcome) -> MotionBlur {
        result(outcome, LengthRange::new(4.0, 100.0).unwrap(), true)
    }

    #[test]
    fn a_direction_is_never_a_whole_turn() {
        for deg in [-1e-17, 0.0, 360.0, -360.0] {
            assert_eq!(turn_deg(deg), 0.0, "{deg}");
        }
        assert_eq!(turn_deg(-90.0), 270.0);
    }

    #[test]
    fn the_end_at_the_stills_is_the_begin_and_the_sign_belongs_to_the_direction() {
        // To the upper right by 20 px, from the stills; the same exposure read backwards; both turned by a whole turn.
        let (cos, sin) = (30.0_f64.to_radians().cos(), 30.0_f64.to_radians().sin());
        let centre = [10.0 * cos, -10.0 * sin];
        for (deg, ratio) in [(30.0, 0.25), (210.0, -0.25), (390.0, 0.25), (-150.0, -0.25)] {
            let found = judged(&outcome(centre, 20.0, deg, ratio));
            assert!((found.direction_deg.unwrap() - 30.0).abs() < 1e-9, "{deg}: {found:?}");
            assert!((found.angle.deg() - 30.0).abs() < 1e-9);
            let signed = found.acceleration.unwrap().signed.unwrap();
            assert!((signed.ratio - 0.25).abs() < 1e-12, "{deg}: {signed:?}");
            let turned = if ratio > 0.0 { 0.5 } else { -0.5 };
            assert!((signed.length_correlation - turned).abs() < 1e-12);
        }
        let away = judged(&outcome([-centre[0], -centre[1]], 20.0, 30.0, 0.25));
        assert!((away.direction_deg.unwrap() - 210.0).abs() < 1e-9);
        assert!((away.acceleration.unwrap().signed.unwrap().ratio + 0.25).abs() < 1e-12);
    }

    #[test]
    fn stills_away_from_both_ends_tell_no_direction() {
        for centre in [[0.0, 0.0], [0.01, 0.0], [30.0, 0.0], [10.0, 6.0]] {
            // Along the axis the sign is known all the same: 200 degrees are the axis 20.
            let found = judged(&outcome(centre, 20.0, 200.0, 0.25));
            assert_eq!(found.direction_deg, None, "{centre:?}");
            assert!((found.acceleration.unwrap().signed.unwrap().ratio + 0.25).abs() < 1e-12);
        }
    }

    #[test]
    fn every_rule_raises_its_own_doubt() {
        let perfect = outcome([10.0, 0.0], 20.0, 0.0, 0.2);
        assert_eq!(judged(&perfect).status, Status::Ok);
        let mut short = perfect;
        short.path.length = 1.9;
        assert!(matches!(judged(&short).status, Status::NoMotionBlur(Doubt::ShortLength { needed_px: 2.0, .. })));
        let mut lost = perfect;
        lost.covariance[2][2] = 49.0;
        assert!(matches!(judged(&lost).status, Status::NoMotionBlur(Doubt::ShortLength { needed_px: 21.0, .. })));
        let mut vague = perfect;
        vague.covariance[2][2] = 4.0;
        assert!(matches!(judged(&vague).status, Status::LowConfidence(Doubt::Uncertain { unit: "%", .. })));
        let mut turning = perfect;
        turning.covariance[3][3] = 3.1_f64.to_radians().powi(2);
        assert!(matches!(judged(&turning).status, Status::LowConfidence(Doubt::Uncertain { unit: "deg", .. })));
        for share in [0.06, f64::NAN] {
            let mut strange = perfect;
            strange.unexplained = share;
            assert!(matches!(judged(&strange).status, Status::LowConfidence(Doubt::Unexplained { .. })));
        }
        let mut long = perfect;
        long.path.length = 99.95;
        assert!(matches!(judged(&long).status, Status::LowConfidence(Doubt::LengthAtRangeEnd { .. })));
    }
}
