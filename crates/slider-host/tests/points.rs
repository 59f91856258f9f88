//! What points of a run promise.
#![allow(clippy::unwrap_used, clippy::panic)]

mod simulated;

use proptest::prelude::*;
use simulated::{Random, cut_sheet, drawn, edges, run, run_of, time_of};
use slider_host::Error;
use slider_host::points::{Points, Positions};
use slider_host::run::End;
use slider_host::sheet::Sheet;
use slider_proto::{Edge, Level};

fn indices(points: &Points) -> &[usize] {
    match &points.positions {
        Positions::Edges { indices, .. } => indices,
        other => panic!("{other:?}"),
    }
}

fn warned(points: &Points, text: &str) -> bool {
    points.warnings.iter().any(|warning| warning.contains(text))
}

/// Motions from slow and steady to a start from rest and a hard stop.
const MOTIONS: [(f64, f64); 6] = [(0.17, 0.0), (2.0, 0.0), (0.0, 0.351), (0.0, 2.463), (0.5, -0.8), (0.05, 1.0)];

#[test]
fn a_missing_tooth_is_found_wherever_it_is() {
    let sheet = cut_sheet(10e-6);
    for (v0, a) in MOTIONS {
        for tooth in 1..12 {
            let mut run = run(&drawn(&sheet, &mut Random(tooth as u64)), time_of(v0, a));
            run.edges.drain(2 * tooth..2 * tooth + 2);
            let points = Points::from_run(&run, &sheet).unwrap();
            let wanted: Vec<usize> = (0..26).filter(|edge| edge / 2 != tooth).collect();
            assert_eq!(indices(&points), wanted, "tooth {} at {v0} m/s, {a} m/s^2", tooth + 1);
            assert!(warned(&points, &format!("tooth {} was not seen", tooth + 1)), "{:?}", points.warnings);
        }
    }
}

#[test]
fn two_missing_teeth_are_found() {
    let sheet = Sheet::nominal();
    for (v0, a) in MOTIONS {
        let mut run = run(&sheet, time_of(v0, a));
        run.edges.drain(14..16);
        run.edges.drain(6..8);
        let points = Points::from_run(&run, &sheet).unwrap();
        assert!(warned(&points, "tooth 4 was") && warned(&points, "tooth 8 was"), "{v0} {a}: {:?}", points.warnings);
    }
}

#[test]
fn one_lost_edge_is_told_by_the_level() {
    let sheet = Sheet::nominal();
    let mut run = run(&sheet, time_of(0.5, 0.0));
    run.edges.remove(7);
    let points = Points::from_run(&run, &sheet).unwrap();
    assert_eq!(indices(&points), (0..26).filter(|&edge| edge != 7).collect::<Vec<_>>());
    assert!(warned(&points, "edge 8 is missing"));
}

#[test]
fn pulses_and_bounces_are_left_out() {
    let sheet = Sheet::nominal();
    for (v0, a) in MOTIONS {
        let clean = run(&sheet, time_of(v0, a));
        for edge in 0..25 {
            let mut run = clean.clone();
            let Edge { tick, level, .. } = run.edges[edge];
            let other = if level == Level::Low { Level::High } else { Level::Low };
            // A bounce of 10 and 8 us after the edge, and a flicker of 30 us amid the next section.
            let bounce =
                [Edge { tick: tick + 20, level: other, late: false }, Edge { tick: tick + 36, level, late: false }];
            let middle = tick + (run.edges[edge + 1].tick - tick) / 2;
            let flicker =
                [Edge { tick: middle, level: other, late: false }, Edge { tick: middle + 60, level, late: false }];
            let next = edge + 1;
            run.edges.splice(next..next, bounce.into_iter().chain(flicker));
            let points = Points::from_run(&run_of(run.edges), &sheet).unwrap();
            let wanted = Points::from_run(&clean, &sheet).unwrap();
            assert_eq!(points.t_s, wanted.t_s, "edge {edge} at {v0} m/s, {a} m/s^2: {:?}", points.warnings);
            assert!(warned(&points, "4 edges of pulses"));
        }
    }
}

#[test]
fn a_sheet_that_passes_the_other_way_is_recognised() {
    let sheet = cut_sheet(10e-6);
    for seed in 0..50 {
        let truth = drawn(&sheet, &mut Random(seed));
        let mut reversed = truth.clone();
        reversed.sections.reverse();
        let forward = Points::from_run(&run(&truth, time_of(0.3, 0.2)), &sheet).unwrap();
        let backward = Points::from_run(&run(&reversed, time_of(0.3, 0.2)), &sheet).unwrap();
        assert!(!warned(&forward, "last tooth first"));
        assert!(warned(&backward, "last tooth first"));
        let wanted = Sheet { sections: sheet.sections.iter().copied().rev().collect(), ..sheet.clone() }.positions_m();
        assert_eq!(backward.x_m, wanted);
    }
}

#[test]
fn what_comes_after_a_turn_is_left_out() {
    let sheet = Sheet::nominal();
    let positions = sheet.positions_m();
    for (v0, a) in [(0.5, 2.0), (0.3, 0.9)] {
        // x = v0 t - a t^2 / 2 turns at v0^2 / 2a: 62.5 and 50 mm.
        let turn = v0 * v0 / (2.0 * a);
        let forth: Vec<f64> = positions.iter().copied().filter(|&x| x < turn).collect();
        let time = |x: f64, sign: f64| (v0 + sign * (v0 * v0 - 2.0 * a * x).sqrt()) / a;
        let times: Vec<f64> =
            forth.iter().map(|&x| time(x, -1.0)).chain(forth.iter().rev().map(|&x| time(x, 1.0))).collect();
        let points = Points::from_run(&run_of(edges(&times, |t| t, 0.0, &mut Random(4))), &sheet).unwrap();
        assert!(warned(&points, "turned back"), "{v0} {a}: {:?}", points.warnings);
        assert_eq!(points.x_m, forth);
    }
    // Back again after the whole sheet.
    let times: Vec<f64> = positions.iter().map(|x| x / 0.4).chain(positions.iter().map(|x| 2.0 + x / 0.4)).collect();
    let points = Points::from_run(&run_of(edges(&times, |t| t, 0.0, &mut Random(4))), &sheet).unwrap();
    assert_eq!(points.x_m, positions);
    assert!(warned(&points, "26 edges came after"));
}

#[test]
fn a_run_that_stops_halfway_is_used_and_said_to_be_incomplete() {
    let sheet = cut_sheet(10e-6);
    for (v0, a) in MOTIONS {
        for kept in [9, 15, 20, 25] {
            let mut run = run(&drawn(&sheet, &mut Random(7)), time_of(v0, a));
            run.edges.truncate(kept);
            run.end = End::Missing;
            let points = Points::from_run(&run, &sheet).unwrap();
            assert_eq!(indices(&points), (0..kept).collect::<Vec<_>>(), "{v0} {a} {kept}: {:?}", points.warnings);
            assert!(warned(&points, &format!("it ends with edge {kept} of 26")) && warned(&points, "was not received"));
        }
    }
}

#[test]
fn late_edges_count_less_and_half_their_lateness_is_taken_off() {
    let sheet = Sheet::nominal();
    let mut run = run(&sheet, time_of(0.5, 0.0));
    let exact = Points::from_run(&run, &sheet).unwrap();
    run.edges[5].tick += 15;
    run.edges[5].late = true;
    let points = Points::from_run(&run, &sheet).unwrap();
    // 15 ticks are 7.5 us, the mean of 0 and 15 us.
    assert!((points.t_s[5] - exact.t_s[5]).abs() < 1e-12);
    assert!((points.time_std_s[5] / (15e-6 / 12f64.sqrt()) - 1.0).abs() < 1e-3);
    assert!(warned(&points, "1 edges were stamped late"));
}

#[test]
fn a_run_across_the_wrap_of_the_counter_is_as_any_other() {
    let sheet = Sheet::nominal();
    let mut run = run(&sheet, time_of(0.2, 0.0));
    let wanted = Points::from_run(&run, &sheet).unwrap();
    let shift = u32::MAX - run.edges[12].tick;
    for edge in &mut run.edges {
        edge.tick = edge.tick.wrapping_add(shift);
    }
    assert_eq!(Points::from_run(&run, &sheet).unwrap(), wanted);
}

#[test]
fn errors_of_points_name_the_line() {
    for (text, line, reason) in [
        ("", 1, "there is no header"),
        ("t,x\n0,0\n", 1, "the header is 't,x', expected t_s,x_m or t_s,x_m,u_x_m"),
        ("t_s,x_m\n0,0\n\n1,abc\n", 4, "x_m is 'abc', expected a finite number"),
        ("t_s,x_m\n0,0\n1,inf\n", 3, "x_m is 'inf', expected a finite number"),
        ("# photogate\nt_s,x_m,u_x_m\n0,0,1e-3\n1,1\n", 4, "2 values, expected 3"),
        ("t_s,x_m\n1,0\n1,1\n", 3, "t_s is 1, which is not after 1"),
        ("t_s,x_m,u_x_m\n0,0,-1\n", 2, "u_x_m is -1, expected 0 or more"),
    ] {
        match Points::from_csv(text) {
            Err(Error::Points { line: found, reason: why }) => assert_eq!((found, why.as_str()), (line, reason)),
            other => panic!("{text:?}: {other:?}"),
        }
    }
    assert_eq!(Points::from_csv("\u{feff}t_s , x_m\r\n0, 0\r\n1, 2\r\n").unwrap().x_m, [0.0, 2.0]);
}

const VALID: &str =
    "# gate\nt_s,x_m,u_x_m\n0.0,0.0,1e-5\n0.0193,0.0093,1e-5\n0.0387,0.0186,1.5e-5\n0.0580,0.0279,1e-5\n";

proptest! {
    /// Bytes changed, put in and taken out at random: points that make sense, or an error with a line that exists.
    #[test]
    fn any_mutation_of_a_file_is_read_or_refused_with_its_line(
        changes in prop::collection::vec((0usize..200, 0u8..3, any::<u8>()), 1..12),
    ) {
        let mut bytes = VALID.as_bytes().to_vec();
        let typical = b"0123456789.,-+eE\n\r #\"naif;\t";
        for (at, what, byte) in changes {
            let at = at % bytes.len();
            // Mostly characters that a number is made of.
            let byte = if byte < 200 { typical[usize::from(byte) % typical.len()] } else { byte };
            match what {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => { bytes.remove(at); }
            }
        }
        let text = String::from_utf8_lossy(&bytes);
        match Points::from_csv(&text) {
            Ok(points) => {
                prop_assert_eq!(points.t_s.len(), points.x_m.len());
                prop_assert!(points.t_s.windows(2).all(|pair| pair[0] < pair[1]));
                prop_assert!(points.t_s.iter().chain(&points.x_m).all(|number| number.is_finite()));
                if let Positions::Independent(std) = &points.positions {
                    prop_assert!(std.iter().all(|std| std.is_finite() && *std >= 0.0));
                }
            }
            Err(Error::Points { line, reason }) => {
                prop_assert!((1..=text.lines().count().max(1)).contains(&line), "line {} of {:?}", line, text);
                prop_assert!(!reason.is_empty());
            }
            Err(other) => prop_assert!(false, "{other:?}"),
        }
    }

    /// Whatever the edges are, there is an answer without a panic.
    #[test]
    fn any_edges_are_points_or_an_error(ticks in prop::collection::vec((any::<u32>(), any::<bool>()), 0..60)) {
        let edges = ticks.into_iter().map(|(step, low)| Edge {
            tick: step >> 8,
            level: if low { Level::Low } else { Level::High },
            late: step.is_multiple_of(7),
        });
        let mut tick = 0u32;
        let edges = edges.map(|edge| { tick = tick.wrapping_add(edge.tick); Edge { tick, ..edge } }).collect();
        if let Ok(points) = Points::from_run(&run_of(edges), &Sheet::nominal()) {
            prop_assert!(points.t_s.len() == points.x_m.len() && points.t_s.len() >= 3);
            let _ = slider_host::fit::fit(1, &points, &slider_host::fit::Options::of_degree(2));
        }
    }
}
