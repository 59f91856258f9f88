//! The slider's reader accepts no edge that was not sent, whatever happens to the line.
#![allow(clippy::unwrap_used, missing_docs, unreachable_pub, reason = "tests")]

#[path = "../../crates/slider-host/tests/damage/mod.rs"]
mod damage;

use std::thread;

use damage::{Corpus, Random};

const STREAMS: u64 = 10_000_000;
const CORPORA: u64 = 50;

#[test]
#[ignore = "long: ten million streams of damaged frames, one to two minutes"]
fn no_damage_makes_an_edge_that_was_not_sent() {
    let part = |corpora: std::ops::Range<u64>| {
        let mut sums = [0; 4];
        for seed in corpora {
            let mut random = Random(1000 + seed);
            let corpus = Corpus::new(&mut random);
            let tally = corpus.damage(STREAMS / CORPORA, 6, &mut random);
            for (sum, count) in
                sums.iter_mut().zip([tally.runs_sent, tally.runs_complete, tally.runs_incomplete, tally.edges_accepted])
            {
                *sum += count;
            }
        }
        sums
    };
    let halves = thread::scope(|scope| {
        let one = scope.spawn(|| part(0..CORPORA / 2));
        let two = part(CORPORA / 2..CORPORA);
        [one.join().unwrap(), two]
    });
    let [sent, complete, incomplete, edges] = [0, 1, 2, 3].map(|at| halves[0][at] + halves[1][at]);
    println!("{STREAMS} streams, {sent} runs: {complete} complete, {incomplete} cut, {edges} edges accepted");
    assert!(complete * 5 > sent && incomplete > 0, "{complete} of {sent} runs complete");
}
