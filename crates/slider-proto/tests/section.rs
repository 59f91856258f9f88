//! Edges become teeth and slits with their times.

use proptest::prelude::*;
use slider_proto::section::{Interval, LevelRepeated, Section, Sections};
use slider_proto::{Edge, Level};

/// The edges of an encoder whose sections, a tooth first, take these ticks; an edge with `late` set is late.
fn encoder(start: u32, passages: &[(u32, bool)]) -> Vec<Edge> {
    let mut tick = start;
    let mut edges = vec![Edge { tick, level: Level::Low, late: false }];
    for (i, &(ticks, late)) in passages.iter().enumerate() {
        tick = tick.wrapping_add(ticks);
        // After a tooth comes a slit, which is high.
        let level = if i % 2 == 0 { Level::High } else { Level::Low };
        edges.push(Edge { tick, level, late });
    }
    edges
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn sections_are_those_of_the_encoder(
        start: u32,
        passages in prop::collection::vec((any::<u32>(), prop::bool::weighted(0.1)), 0..60),
    ) {
        let mut sections = Sections::default();
        let edges = encoder(start, &passages);
        let found: Vec<_> = edges.iter().map(|&edge| sections.push(edge)).collect();
        prop_assert_eq!(found[0], Ok(None));
        for (i, &(ticks, late)) in passages.iter().enumerate() {
            let section = if i % 2 == 0 { Section::Tooth } else { Section::Slit };
            let late = late || i > 0 && passages[i - 1].1;
            prop_assert_eq!(found[i + 1], Ok(Some(Interval { section, start_tick: edges[i].tick, ticks, late })));
        }
    }

    #[test]
    fn missing_edge_is_told_and_the_section_after_it_is_right(
        start: u32,
        passages in prop::collection::vec((any::<u32>(), Just(false)), 3..60),
        missing in 1..59_usize,
    ) {
        let mut edges = encoder(start, &passages);
        let missing = missing.min(edges.len() - 2);
        edges.remove(missing);
        let mut sections = Sections::NEW;
        for (i, &edge) in edges.iter().enumerate() {
            let found = sections.push(edge);
            if i == missing {
                prop_assert_eq!(found, Err(LevelRepeated { tick: edge.tick, level: edge.level }));
            } else if i > 0 {
                // The passages lie between the original edges, which are shifted by one after the gap.
                let passage = if i < missing { i - 1 } else { i };
                prop_assert_eq!(found.map(|interval| interval.map(|interval| interval.ticks)), Ok(Some(passages[passage].0)));
            }
        }
    }
}

#[test]
fn low_is_a_tooth_and_high_a_slit() {
    assert_eq!(Section::at(Level::Low), Section::Tooth);
    assert_eq!(Section::at(Level::High), Section::Slit);
    assert_eq!((Level::Low.inverse(), Level::High.inverse()), (Level::High, Level::Low));
}
