//! The virtual rig's edges are those of its sheet, its motion and its sensor, and its ticks are those of its clock.
#![allow(clippy::unwrap_used, reason = "a helper that fails, fails the test")]

use slider_host::sheet::{Sheet, Width};
use slider_host::simulate::motion::Motion;
use slider_host::simulate::rig::{Clock, Pass, Rig, Sensor};
use slider_proto::{Level, TICK_HZ};

fn exact(sensor: Sensor) -> Rig {
    Rig::exact(&Sheet::nominal(), sensor, Clock::default(), 1).unwrap()
}

fn times(pass: &Pass) -> Vec<f64> {
    pass.crossings.iter().map(|crossing| crossing.time_s).collect()
}

fn alternates(pass: &Pass) -> bool {
    pass.crossings.first().is_some_and(|first| first.level == Level::Low)
        && pass.crossings.windows(2).all(|pair| pair[0].time_s < pair[1].time_s && pair[0].level != pair[1].level)
}

/// Position of edge `index` of the nominal sheet: 3.1 mm of tooth and 4.9 mm of slit in turn.
fn nominal_m(index: usize) -> f64 {
    (index / 2) as f64 * 8.0e-3 + (index % 2) as f64 * 3.1e-3
}

#[test]
fn thirteen_teeth_make_twenty_six_edges_at_their_times() {
    let pass = exact(Sensor::default()).pass(&Motion::constant(0.5).unwrap(), 0);
    assert_eq!(pass.crossings.len(), 26);
    assert!(alternates(&pass));
    for (index, time) in times(&pass).into_iter().enumerate() {
        assert!((time - nominal_m(index) / 0.5).abs() < 1e-14);
        assert!((pass.truth.edges_s[index] - time).abs() < 1e-14);
    }
    assert_eq!((pass.truth.v0_m_s, pass.truth.accel_m_s2, pass.truth.pass), (0.5, 0.0, 1));
    assert_eq!(pass.truth.widths_m, [3.1e-3, 4.9e-3].repeat(13)[..25]);
}

#[test]
fn truth_counts_from_the_first_edge_of_the_sheet() {
    let (angle, run_up) = (10.0, 0.02);
    let motion = Motion::incline(angle, 0.01, run_up).unwrap();
    let truth = exact(Sensor::default()).pass(&motion, 4).truth;
    assert_eq!((truth.pass, truth.edges_s[0]), (5, 0.0));
    for (index, time) in truth.edges_s.iter().enumerate() {
        let there = truth.v0_m_s * time + truth.accel_m_s2 / 2.0 * time * time;
        assert!((there - nominal_m(index)).abs() < 1e-14);
    }
}

#[test]
fn a_shift_of_the_sensor_moves_rising_edges_only() {
    let sensor = Sensor { rising_shift_m: 0.2e-3, falling_delay_s: 1e-6, rising_delay_s: 3e-6, ..Sensor::default() };
    let pass = exact(sensor).pass(&Motion::constant(0.4).unwrap(), 0);
    for (index, time) in times(&pass).into_iter().enumerate() {
        let (shift, delay) = if index % 2 == 1 { (0.2e-3, 3e-6) } else { (0.0, 1e-6) };
        assert!((time - (nominal_m(index) + shift) / 0.4 - delay).abs() < 1e-14);
    }
    // What passes the sensor is the same.
    assert!((pass.truth.edges_s[25] - nominal_m(25) / 0.4).abs() < 1e-14);
}

/// 500 passes of 26 edges: the standard deviation of 13000 draws is within 3 % of its value (4.8 standard deviations of
/// 1 / sqrt(2 n) = 0.62 %), and their mean within 5 / sqrt(n) = 4.4 % of it.
#[test]
fn jitter_has_its_standard_deviation_and_no_mean() {
    let std = 2e-6;
    let rig = exact(Sensor { jitter_std_s: std, ..Sensor::default() });
    let motion = Motion::constant(0.5).unwrap().ending_at(1.0);
    let mut errors = Vec::new();
    for index in 0..500 {
        let pass = rig.pass(&motion, index);
        assert!(alternates(&pass));
        // The first edge, at time 0, cannot be early.
        errors.extend(times(&pass).into_iter().enumerate().skip(1).map(|(edge, time)| time - nominal_m(edge) / 0.5));
    }
    let n = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let variance = errors.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / (n - 1.0);
    assert!((variance.sqrt() / std - 1.0).abs() < 0.03, "{}", variance.sqrt());
    assert!(mean.abs() < 0.044 * std, "{mean}");
}

#[test]
fn a_seed_means_one_sheet_and_one_series_of_passes() {
    let mut sheet = Sheet::nominal();
    for width in &mut sheet.sections {
        width.std_m = 20e-6;
    }
    let sensor = Sensor { jitter_std_s: 1e-6, ..Sensor::default() };
    let rig = |seed| Rig::drawn(&sheet, sensor, Clock::default(), seed).unwrap();
    let motion = Motion::constant(0.3).unwrap();
    assert_eq!(rig(7).pass(&motion, 3), rig(7).pass(&motion, 3));
    assert_eq!(rig(7).widths_m(), rig(7).widths_m());
    assert_ne!(rig(7).pass(&motion, 3).crossings, rig(7).pass(&motion, 4).crossings);
    assert_ne!(rig(7).widths_m(), rig(8).widths_m());
}

/// Of 400 sheets each section has 400 draws: their mean is within 5 / sqrt(400) standard deviations of the description,
/// and all 10000 have a standard deviation within 4 % of theirs (5.6 standard deviations of 1 / sqrt(2 n)).
#[test]
fn drawn_sheets_scatter_as_their_uncertainties_say() {
    let mut sheet = Sheet::nominal();
    for width in &mut sheet.sections {
        width.std_m = 20e-6;
    }
    let mut sum = [0.0; 25];
    let mut squares = 0.0;
    for seed in 0..400 {
        let rig = Rig::drawn(&sheet, Sensor::default(), Clock::default(), seed).unwrap();
        for ((sum, drawn), width) in sum.iter_mut().zip(rig.widths_m()).zip(&sheet.sections) {
            let deviation = (drawn - width.value_m) / width.std_m;
            *sum += deviation;
            squares += deviation * deviation;
        }
    }
    assert!(sum.iter().all(|sum| (sum / 400.0).abs() < 0.25));
    assert!(((squares / 10_000.0_f64).sqrt() - 1.0).abs() < 0.04);
}

#[test]
fn a_wrong_scale_is_shared_by_all_widths() {
    let sheet = Sheet { scale_std: 1e-3, ..Sheet::nominal() };
    let rig = Rig::drawn(&sheet, Sensor::default(), Clock::default(), 3).unwrap();
    let scale = rig.widths_m()[0] / 3.1e-3;
    assert!(scale != 1.0 && (scale - 1.0).abs() < 5e-3);
    assert!(
        rig.widths_m()
            .iter()
            .zip(&sheet.sections)
            .all(|(drawn, width)| { (drawn / width.value_m / scale - 1.0).abs() < 1e-14 })
    );
}

#[test]
fn a_missing_tooth_takes_its_two_edges_and_no_other() {
    let motion = Motion::constant(0.5).unwrap();
    let whole = times(&exact(Sensor::default()).pass(&motion, 0));
    for tooth in 1..=13 {
        let pass = exact(Sensor::default()).without_tooth(tooth).unwrap().pass(&motion, 0);
        let mut expected = whole.clone();
        expected.drain(2 * tooth - 2..2 * tooth);
        assert_eq!(times(&pass), expected);
        assert!(alternates(&pass));
        assert_eq!(pass.truth.edges_s.len(), 26);
    }
    for tooth in [0, 14] {
        assert!(exact(Sensor::default()).without_tooth(tooth).is_err());
    }
}

#[test]
fn glitches_come_in_pairs_of_their_width_and_leave_the_edges() {
    let motion = Motion::constant(0.5).unwrap();
    let clean = exact(Sensor::default()).pass(&motion, 2);
    let rig = exact(Sensor { glitches: 5, glitch_s: 20e-6, ..Sensor::default() });
    let dirty = rig.pass(&motion, 2);
    assert!(alternates(&dirty));
    assert_eq!(dirty.crossings.len(), 26 + 10);
    let extra: Vec<_> = dirty.crossings.iter().filter(|crossing| !clean.crossings.contains(crossing)).collect();
    assert_eq!(extra.len(), 10);
    assert!(extra.chunks(2).all(|pulse| (pulse[1].time_s - pulse[0].time_s - 20e-6).abs() < 1e-12));
}

#[test]
fn a_carriage_that_does_not_come_so_far_has_fewer_edges() {
    // It rests after 0.3^2 / 2 / 1 = 45 mm: 5 pitches of 8 mm, and tooth 6 from 40 to 43.1.
    let pass = exact(Sensor::default()).pass(&Motion::accelerated(0.3, -1.0).unwrap(), 0);
    assert_eq!((pass.crossings.len(), pass.limit_s), (12, None));
    // Tooth 7 begins at 48 mm and ends at 51.1.
    let stopped = exact(Sensor::default()).pass(&Motion::constant(0.5).unwrap().ending_at(0.05), 0);
    assert_eq!((stopped.crossings.len(), stopped.limit_s), (13, Some(0.1)));
}

#[test]
fn ticks_are_within_half_a_tick_of_the_truth() {
    for ppm in [-40.0, 0.0, 25.0] {
        let clock = Clock { ppm, start_tick: 0xffff_ff00 };
        for step in 0..1000 {
            let time = f64::from(step) * 1.234_567e-3;
            let exact = time * f64::from(TICK_HZ) * (1.0 + ppm / 1e6);
            let error = (clock.tick(time) - 0xffff_ff00) as f64 - exact;
            assert!(error.abs() <= 0.5, "{error}");
            assert!((clock.time_s(clock.tick(time)) - time).abs() <= 0.26e-6);
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let rig = |sensor, clock| Rig::exact(&Sheet::nominal(), sensor, clock, 1);
    let clock = Clock::default();
    assert!(rig(Sensor { jitter_std_s: -1.0, ..Sensor::default() }, clock).is_err());
    assert!(rig(Sensor { rising_shift_m: f64::NAN, ..Sensor::default() }, clock).is_err());
    assert!(rig(Sensor::default(), Clock { ppm: f64::INFINITY, ..clock }).is_err());
    let mut sheet = Sheet::nominal();
    sheet.sections[3] = Width { value_m: 0.0, std_m: 0.0 };
    assert!(Rig::exact(&sheet, Sensor::default(), clock, 1).is_err());
}
