//! The virtual carriage is where the formulas of its motion put it.

use proptest::prelude::*;
use slider_host::simulate::motion::{GRAVITY_M_S2, Motion, PRESETS_M_S, Ripple};

/// Length of the sheet, m.
const LENGTH_M: f64 = 0.0991;

/// Gravity along the incline less friction, from the triangle of height and base rather than from sines.
fn down_the_incline(angle_deg: f64, friction: f64) -> f64 {
    let slope = angle_deg.to_radians().tan();
    GRAVITY_M_S2 * (slope - friction) / (1.0 + slope * slope).sqrt()
}

#[test]
fn constant_speed_takes_way_over_speed() {
    for speed in PRESETS_M_S {
        let motion = Motion::constant(speed).unwrap();
        for step in 0..=100 {
            let position = LENGTH_M * f64::from(step) / 100.0;
            assert!((motion.time_s(position).unwrap() - position / speed).abs() < 1e-15);
        }
        assert_eq!((motion.v0_m_s(), motion.accel_m_s2()), (speed, 0.0));
    }
}

#[test]
fn a_soft_start_is_over_before_the_first_tooth() {
    let (speed, ramp, lead) = (0.5, 0.171, 0.02);
    let motion = Motion::motor(speed, ramp, lead, Ripple::default()).unwrap();
    // Half of the speed on average, and the rest at all of it.
    assert!((motion.position_m(0.0) + speed * ramp / 2.0 + lead).abs() < 1e-15);
    assert!((motion.position_m(ramp) + lead).abs() < 1e-15);
    assert!((motion.time_s(0.0).unwrap() - (ramp + lead / speed)).abs() < 1e-14);
    let passage = motion.time_s(LENGTH_M).unwrap() - motion.time_s(0.0).unwrap();
    assert!((passage - LENGTH_M / speed).abs() < 1e-14);
    // In the middle of the start a quarter of its way is done.
    assert!((motion.position_m(ramp / 2.0) - motion.position_m(0.0) - speed * ramp / 8.0).abs() < 1e-15);
}

#[test]
fn an_incline_accelerates_by_gravity_less_friction_from_rest() {
    let (angle, friction, run_up) = (12.0, 0.01, 0.03);
    let motion = Motion::incline(angle, friction, run_up).unwrap();
    let accel = down_the_incline(angle, friction);
    assert!((motion.accel_m_s2() - accel).abs() < 1e-12);
    assert!((motion.v0_m_s() - (2.0 * accel * run_up).sqrt()).abs() < 1e-12);
    for step in 0..=100 {
        let position = LENGTH_M * f64::from(step) / 100.0;
        let expected = (2.0 * (position + run_up) / accel).sqrt();
        assert!((motion.time_s(position).unwrap() - expected).abs() < 1e-14);
    }
    assert!(Motion::incline(2.0, 0.04, 0.0).is_err(), "the tangent of 2 degrees is 0.035: friction holds it");
}

/// The thesis measures 2.463 m/s^2 at 15 degrees and 2.178 at 13.3.
#[test]
fn the_default_friction_gives_the_steep_accelerations_of_the_thesis() {
    for (angle, accel) in [(15.0, 2.463), (13.3, 2.178)] {
        let motion = Motion::incline(angle, 0.008, 0.01).unwrap();
        assert!((motion.accel_m_s2() - accel).abs() < 0.003, "{angle}: {}", motion.accel_m_s2());
    }
}

#[test]
fn a_carriage_that_comes_to_rest_stays_there() {
    // It rests after 0.1^2 / 2 = 5 mm, at 0.1 s.
    let motion = Motion::accelerated(0.1, -1.0).unwrap();
    assert!(motion.time_s(0.005_000_1).is_none());
    assert!((motion.time_s(0.004_999_999).unwrap() - 0.1).abs() < 1e-4);
    assert!((motion.position_m(7.0) - 0.005).abs() < 1e-15);
    assert!(Motion::accelerated(0.0, 0.0).is_err());
}

#[test]
fn the_end_of_travel_stops_it_dead() {
    let motion = Motion::constant(0.5).unwrap().ending_at(0.2);
    assert_eq!(motion.time_s(0.2), Some(0.4));
    assert_eq!(motion.time_s(0.200_001), None);
    assert_eq!((motion.position_m(0.3), motion.position_m(0.5)), (0.15, 0.2));
}

/// The integral of the speed by the midpoint rule, which knows nothing of the closed form.
#[test]
fn a_ripple_modulates_the_speed() {
    let (speed, ripple) = (0.4, Ripple { relative: 0.05, hz: 9.0, phase_rad: 0.7 });
    let motion = Motion::motor(speed, 0.0, 0.0, ripple).unwrap();
    let steps = 200_000;
    let step = 0.25 / f64::from(steps);
    let mut position = 0.0;
    for n in 0..steps {
        let time = (f64::from(n) + 0.5) * step;
        position += step * speed * (1.0 + 0.05 * (std::f64::consts::TAU * 9.0 * time + 0.7).sin());
    }
    // The rule's error is (length / 24) step^2 times the second derivative, 0.4 * 0.05 * 56.5^2 = 64: 1e-12 m.
    assert!((motion.position_m(0.25) - position).abs() < 3e-12);
}

#[test]
fn what_cannot_be_is_refused() {
    let ripple = |relative| Ripple { relative, hz: 5.0, phase_rad: 0.0 };
    for speed in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Motion::constant(speed).is_err());
    }
    assert!(Motion::motor(0.5, -1.0, 0.0, ripple(0.0)).is_err());
    assert!(Motion::motor(0.5, 0.1, f64::NAN, ripple(0.0)).is_err());
    assert!(Motion::motor(0.5, 0.1, 0.0, ripple(1.0)).is_err());
    assert!(Motion::accelerated(-0.1, 1.0).is_err());
    assert!(Motion::incline(0.0, 0.0, 0.0).is_err() && Motion::incline(91.0, 0.0, 0.0).is_err());
}

proptest! {
    #[test]
    fn the_time_at_a_place_is_when_it_is_there(
        speed in 0.05..2.0f64, ramp in 0.0..0.3f64, relative in 0.0..0.95f64, hz in 0.0..200.0f64, phase in 0.0..6.3f64,
        share in 0.0..1.0f64,
    ) {
        let motion = Motion::motor(speed, ramp, 0.01, Ripple { relative, hz, phase_rad: phase }).unwrap();
        let position = motion.position_m(0.0) * (1.0 - share) + LENGTH_M * share;
        let time = motion.time_s(position).unwrap();
        // Within 1e-12 s, at up to twice the speed.
        prop_assert!((motion.position_m(time) - position).abs() < 2e-12 * speed);
        prop_assert!(time >= 0.0);
    }

    #[test]
    fn accelerated_times_solve_the_quadratic(v0 in 0.001..1.0f64, accel in -3.0..3.0f64, position in 1e-9..0.2f64) {
        let motion = Motion::accelerated(v0, accel).unwrap();
        let reached = v0 * v0 + 2.0 * accel * position;
        match motion.time_s(position) {
            Some(time) => {
                prop_assert!(reached >= 0.0);
                prop_assert!((v0 * time + accel / 2.0 * time * time - position).abs() < 1e-14);
            }
            None => prop_assert!(reached < 0.0),
        }
    }
}
