//! The ring of edges gives back what was put in, in order, and an unbroken beginning if that was too much.

use std::collections::VecDeque;

use proptest::prelude::*;
use slider_proto::ring::{CAPACITY, EdgeRing};
use slider_proto::{Edge, Level};

/// The ring by its documentation.
#[derive(Default)]
struct Model {
    edges: VecDeque<Edge>,
    lost: u64,
}

impl Model {
    fn push(&mut self, edge: Edge) {
        if self.lost > 0 || self.edges.len() == 64 {
            self.lost += 1;
        } else {
            self.edges.push_back(edge);
        }
    }
}

#[derive(Debug, Clone, Copy)]
enum Deed {
    Push(Edge),
    Pop(u8),
    Lose(u16),
    Clear,
}

fn edges() -> impl Strategy<Value = Edge> {
    any::<(u32, bool, bool)>().prop_map(|(tick, high, late)| {
        let level = if high { Level::High } else { Level::Low };
        Edge { tick, level, late }
    })
}

/// So many pushes that the ring is full now and then, and turns round often.
fn deeds() -> impl Strategy<Value = Deed> {
    prop_oneof![
        300 => edges().prop_map(Deed::Push),
        40 => (1..12_u8).prop_map(Deed::Pop),
        1 => (1..=u16::MAX).prop_map(Deed::Lose),
        3 => Just(Deed::Clear),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn ring_is_a_queue_that_shuts_when_it_overflows(deeds in prop::collection::vec(deeds(), 0..2000)) {
        let (mut ring, mut model) = (EdgeRing::new(), Model::default());
        for deed in deeds {
            match deed {
                Deed::Push(edge) => {
                    ring.push(edge);
                    model.push(edge);
                }
                Deed::Pop(times) => {
                    for _ in 0..times {
                        prop_assert_eq!(ring.pop(), model.edges.pop_front());
                    }
                }
                Deed::Lose(edges) => {
                    ring.lose(edges);
                    model.lost += u64::from(edges);
                }
                Deed::Clear => {
                    ring.clear();
                    model = Model::default();
                }
            }
            prop_assert_eq!(usize::from(ring.len()), model.edges.len());
            prop_assert_eq!(ring.is_empty(), model.edges.is_empty());
            prop_assert_eq!(u64::from(ring.lost()), model.lost.min(65_535));
        }
    }
}

fn numbered(tick: u32) -> Edge {
    Edge { tick, level: Level::Low, late: false }
}

#[test]
fn ring_holds_two_passes_of_thirteen_teeth() {
    let mut ring = EdgeRing::default();
    assert_eq!(CAPACITY, 64);
    for tick in 0..64 {
        ring.push(numbered(tick));
    }
    assert_eq!((ring.len(), ring.lost()), (64, 0));
    assert!((0..64).all(|tick| ring.pop() == Some(numbered(tick))));
    assert_eq!(ring.pop(), None);
}

#[test]
fn nothing_is_taken_after_a_loss_even_if_there_is_room_again() {
    let mut ring = EdgeRing::new();
    for tick in 0..65 {
        ring.push(numbered(tick));
    }
    for tick in 0..64 {
        assert_eq!(ring.pop(), Some(numbered(tick)));
    }
    ring.push(numbered(65));
    assert_eq!((ring.pop(), ring.lost()), (None, 2));
    ring.clear();
    ring.push(numbered(66));
    assert_eq!((ring.pop(), ring.lost()), (Some(numbered(66)), 0));
}
