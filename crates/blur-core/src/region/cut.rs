//! Minimum cuts of the grid of points.

use std::collections::VecDeque;

/// Capacity that counts as none.
const NOTHING: f32 = 1e-4;

/// An arc and what may still flow along it; arc `i ^ 1` is its reverse.
#[derive(Debug, Clone, Copy)]
struct Arc {
    to: usize,
    capacity: f32,
}

/// A network between a source and a sink.
///
/// *Reference*: E. A. Dinic, *Algorithm for solution of a problem of maximum flow in a network with power estimation*,
/// Soviet Math. Doklady 11 (1970) 1277.
#[derive(Debug)]
pub(super) struct Network {
    arcs: Vec<Arc>,
    /// Arcs that leave each node.
    leaving: Vec<Vec<u32>>,
    /// What each node may still draw from the source, or give to the sink when negative.
    supply: Vec<f32>,
    level: Vec<u32>,
    /// How far the arcs of each node are used up in this phase.
    next: Vec<usize>,
}

const UNSEEN: u32 = u32::MAX;

impl Network {
    /// Without arcs.
    pub(super) fn new(nodes: usize) -> Self {
        Self {
            arcs: Vec::new(),
            leaving: vec![Vec::new(); nodes],
            supply: vec![0.0; nodes],
            level: vec![UNSEEN; nodes],
            next: vec![0; nodes],
        }
    }

    /// What it costs more to have `node` on the side of the sink than on that of the source.
    pub(super) fn prefer_source(&mut self, node: usize, cost: f32) {
        self.supply[node] += cost;
    }

    /// What it costs to have `a` on the side of the source and `b` on that of the sink, and the other way round.
    pub(super) fn join(&mut self, a: usize, b: usize, forward: f32, backward: f32) {
        let number = self.arcs.len() as u32;
        self.leaving[a].push(number);
        self.leaving[b].push(number + 1);
        self.arcs.push(Arc { to: b, capacity: forward });
        self.arcs.push(Arc { to: a, capacity: backward });
    }

    /// Whether each node is on the side of the source in the cheapest cut: the least such side of all.
    pub(super) fn source_side(mut self) -> Vec<bool> {
        while self.rank() {
            self.next.fill(0);
            for node in 0..self.supply.len() {
                while self.supply[node] > NOTHING && self.push_from(node) {}
            }
        }
        self.level.iter().map(|&level| level != UNSEEN).collect()
    }

    /// Distances from the source; whether the sink can be reached.
    fn rank(&mut self) -> bool {
        self.level.fill(UNSEEN);
        let mut open: VecDeque<usize> = (0..self.supply.len()).filter(|&node| self.supply[node] > NOTHING).collect();
        for &node in &open {
            self.level[node] = 0;
        }
        let mut reached = false;
        while let Some(node) = open.pop_front() {
            reached |= self.supply[node] < -NOTHING;
            for &arc in &self.leaving[node] {
                let Arc { to, capacity } = self.arcs[arc as usize];
                if capacity > NOTHING && self.level[to] == UNSEEN {
                    self.level[to] = self.level[node] + 1;
                    open.push_back(to);
                }
            }
        }
        reached
    }

    /// Sends what one path from `start` to the sink can carry; false when there is none left in this phase.
    fn push_from(&mut self, start: usize) -> bool {
        let mut path: Vec<usize> = Vec::new();
        let mut node = start;
        loop {
            if self.supply[node] < -NOTHING {
                let widest = path.iter().map(|&arc| self.arcs[arc].capacity).fold(f32::INFINITY, f32::min);
                let flow = widest.min(self.supply[start]).min(-self.supply[node]);
                for arc in path {
                    self.arcs[arc].capacity -= flow;
                    self.arcs[arc ^ 1].capacity += flow;
                }
                self.supply[start] -= flow;
                self.supply[node] += flow;
                return true;
            }
            if let Some(&arc) = self.leaving[node].get(self.next[node]) {
                let arc = arc as usize;
                let Arc { to, capacity } = self.arcs[arc];
                if capacity > NOTHING && self.level[to] == self.level[node] + 1 {
                    path.push(arc);
                    node = to;
                } else {
                    self.next[node] += 1;
                }
            } else if let Some(arc) = path.pop() {
                // A dead end: the arc that led here is of no use in this phase.
                node = self.arcs[arc ^ 1].to;
                self.next[node] += 1;
            } else {
                return false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cost of a cut by the definition.
    fn cost(preferences: &[f32], arcs: &[(usize, usize, f32, f32)], side: u32) -> f32 {
        let source = |node: usize| (side >> node) & 1 == 1;
        let own = preferences
            .iter()
            .enumerate()
            .map(|(node, &cost)| if source(node) { (-cost).max(0.0) } else { cost.max(0.0) });
        let cut = arcs.iter().map(|&(a, b, forward, backward)| match (source(a), source(b)) {
            (true, false) => forward,
            (false, true) => backward,
            _ => 0.0,
        });
        own.sum::<f32>() + cut.sum::<f32>()
    }

    #[test]
    fn no_side_is_cheaper() {
        // A linear congruence makes numbers enough: whole ones, so that sums are exact.
        let mut state = 7_u64;
        let mut draw = |most: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) % most
        };
        for _ in 0..200 {
            let preferences: Vec<f32> = (0..9).map(|_| draw(21) as f32 - 10.0).collect();
            let arcs: Vec<_> = (0..16)
                .map(|_| (draw(9) as usize, draw(9) as usize, draw(8) as f32, draw(8) as f32))
                .filter(|(a, b, _, _)| a != b)
                .collect();
            let mut network = Network::new(9);
            for (node, &cost) in preferences.iter().enumerate() {
                network.prefer_source(node, cost);
            }
            for &(a, b, forward, backward) in &arcs {
                network.join(a, b, forward, backward);
            }
            let found = network
                .source_side()
                .iter()
                .enumerate()
                .fold(0, |side, (node, &source)| side | (u32::from(source) << node));
            let least = (0..1 << 9).map(|side| cost(&preferences, &arcs, side)).fold(f32::INFINITY, f32::min);
            assert_eq!(cost(&preferences, &arcs, found), least, "{preferences:?} {arcs:?}");
        }
    }
}
