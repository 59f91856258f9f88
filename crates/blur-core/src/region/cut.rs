//! Minimum cuts of the grid of points.

use std::collections::VecDeque;

/// Arcs, both ways, between a point of the grid and half of its neighbours.
const ARCS_PER_NODE: usize = 8;
/// Capacity that counts as none.
const NOTHING: f32 = 1e-4;

/// An arc and what may still flow along it; arc `i ^ 1` is its reverse. Numbers of arcs and nodes are kept in half the bytes of
/// a `usize`: what waits here is the memory.
#[derive(Debug, Clone, Copy)]
struct Arc {
    to: u32,
    capacity: f32,
    /// The next arc that leaves the same node.
    next: Option<u32>,
}

/// A network between a source and a sink.
///
/// Two trees of arcs that are not used up grow from source and sink until they meet; the path is filled, and what it cuts off
/// looks for another parent in its tree before the trees grow on. On grids such as those of pictures nearly everything of
/// the trees stays from path to path.
///
/// *Reference*: Y. Boykov and V. Kolmogorov, *An experimental comparison of min-cut/max-flow algorithms for energy
/// minimization in vision*, IEEE Transactions on Pattern Analysis and Machine Intelligence 26 (2004) 1124, section 3, with
/// the marks and distances of Kolmogorov's program.
#[derive(Debug)]
pub(super) struct Network {
    arcs: Vec<Arc>,
    nodes: Vec<Node>,
    /// Nodes at the front of their tree.
    active: VecDeque<u32>,
    orphans: VecDeque<u32>,
    /// Number of the present path; marks from earlier ones are out of date.
    time: u32,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// What it may still draw from the source, or give to the sink when negative.
    supply: f32,
    first: Option<u32>,
    tree: Tree,
    parent: Parent,
    is_active: bool,
    /// When the distance to the root was found, and that distance.
    time: u32,
    distance: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tree {
    Source,
    Sink,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Parent {
    /// The node is in no tree.
    None,
    /// Source or sink itself.
    Root,
    /// It was cut off.
    Orphan,
    /// The node that this arc leads to.
    Arc(u32),
}

impl Network {
    /// Without arcs, with room for those of a grid.
    pub(super) fn new(nodes: usize) -> Self {
        let node = Node {
            supply: 0.0,
            first: None,
            tree: Tree::Source,
            parent: Parent::None,
            is_active: false,
            time: 0,
            distance: 0,
        };
        Self {
            arcs: Vec::with_capacity(ARCS_PER_NODE * nodes),
            nodes: vec![node; nodes],
            active: VecDeque::with_capacity(nodes),
            orphans: VecDeque::new(),
            time: 0,
        }
    }

    /// What it costs more to have `node` on the side of the sink than on that of the source.
    pub(super) fn prefer_source(&mut self, node: usize, cost: f32) {
        self.nodes[node].supply += cost;
    }

    /// What it costs to have `a` on the side of the source and `b` on that of the sink, and the other way round.
    pub(super) fn join(&mut self, a: usize, b: usize, forward: f32, backward: f32) {
        let number = self.arcs.len() as u32;
        self.arcs.push(Arc { to: b as u32, capacity: forward, next: self.nodes[a].first.replace(number) });
        self.arcs.push(Arc { to: a as u32, capacity: backward, next: self.nodes[b].first.replace(number + 1) });
    }

    /// Whether each node is on the side of the source in the cheapest cut: the least such side of all.
    pub(super) fn source_side(mut self) -> Vec<bool> {
        for number in 0..self.nodes.len() {
            let node = &mut self.nodes[number];
            if node.supply.abs() > NOTHING {
                node.tree = if node.supply > 0.0 { Tree::Source } else { Tree::Sink };
                (node.parent, node.distance) = (Parent::Root, 1);
                self.activate(number);
            }
        }
        while let Some(&number) = self.active.front() {
            let number = number as usize;
            if self.nodes[number].parent == Parent::None {
                self.retire();
                continue;
            }
            self.time += 1;
            match self.grow(number) {
                Some(bridge) => {
                    self.fill_path(bridge);
                    self.time += 1;
                    while let Some(orphan) = self.orphans.pop_front() {
                        self.adopt(orphan as usize);
                    }
                }
                None => self.retire(),
            }
        }
        self.nodes.iter().map(|node| node.parent != Parent::None && node.tree == Tree::Source).collect()
    }

    fn activate(&mut self, number: usize) {
        let node = &mut self.nodes[number];
        if !node.is_active {
            node.is_active = true;
            self.active.push_back(number as u32);
        }
    }

    /// The first of the active nodes is no longer one.
    fn retire(&mut self) {
        if let Some(number) = self.active.pop_front() {
            self.nodes[number as usize].is_active = false;
        }
    }

    /// Whether something can flow from the root towards `arc.to` through the node that `arc` leaves, or back in the tree of
    /// the sink.
    fn is_open(&self, arc: usize, tree: Tree) -> bool {
        let arc = if tree == Tree::Source { arc } else { arc ^ 1 };
        self.arcs[arc].capacity > NOTHING
    }

    /// Takes free neighbours into the tree; the arc from the tree of the source to that of the sink if they meet here.
    fn grow(&mut self, number: usize) -> Option<usize> {
        let Node { tree, time, distance, .. } = self.nodes[number];
        let mut next = self.nodes[number].first;
        while let Some(arc) = next.map(|arc| arc as usize) {
            next = self.arcs[arc].next;
            if !self.is_open(arc, tree) {
                continue;
            }
            let to = self.arcs[arc].to as usize;
            let other = &mut self.nodes[to];
            if other.parent == Parent::None {
                (other.tree, other.parent) = (tree, Parent::Arc((arc ^ 1) as u32));
                (other.time, other.distance) = (time, distance + 1);
                self.activate(to);
            } else if other.tree != tree {
                return Some(if tree == Tree::Source { arc } else { arc ^ 1 });
            } else if other.time <= time && other.distance > distance {
                // A shorter way to the root.
                (other.parent, other.time, other.distance) = (Parent::Arc((arc ^ 1) as u32), time, distance + 1);
            }
        }
        None
    }

    /// The arc along which something flows between a node and its parent; `None` at a root.
    fn flow_arc(&self, number: usize) -> Option<usize> {
        match (self.nodes[number].parent, self.nodes[number].tree) {
            (Parent::Arc(arc), Tree::Source) => Some(arc as usize ^ 1),
            (Parent::Arc(arc), Tree::Sink) => Some(arc as usize),
            _ => None,
        }
    }

    /// The parent of a node that has one.
    fn above(&self, number: usize) -> usize {
        match self.nodes[number].parent {
            Parent::Arc(arc) => self.arcs[arc as usize].to as usize,
            _ => number,
        }
    }

    /// Sends what the path from the source over `bridge` to the sink can carry.
    fn fill_path(&mut self, bridge: usize) {
        let ends = [self.arcs[bridge ^ 1].to, self.arcs[bridge].to].map(|end| end as usize);
        let mut flow = self.arcs[bridge].capacity;
        for end in ends {
            let mut number = end;
            while let Some(arc) = self.flow_arc(number) {
                flow = flow.min(self.arcs[arc].capacity);
                number = self.above(number);
            }
            flow = flow.min(self.nodes[number].supply.abs());
        }
        self.arcs[bridge].capacity -= flow;
        self.arcs[bridge ^ 1].capacity += flow;
        for end in ends {
            let mut number = end;
            while let Some(arc) = self.flow_arc(number) {
                let above = self.above(number);
                self.arcs[arc].capacity -= flow;
                self.arcs[arc ^ 1].capacity += flow;
                if self.arcs[arc].capacity <= NOTHING {
                    self.cut_off(number);
                }
                number = above;
            }
            let root = &mut self.nodes[number];
            root.supply -= flow.copysign(root.supply);
            if root.supply.abs() <= NOTHING {
                self.cut_off(number);
            }
        }
    }

    fn cut_off(&mut self, number: usize) {
        self.nodes[number].parent = Parent::Orphan;
        self.orphans.push_back(number as u32);
    }

    /// Gives an orphan the parent nearest to the root of its tree, or frees it and makes its children orphans.
    fn adopt(&mut self, orphan: usize) {
        let tree = self.nodes[orphan].tree;
        let mut best: Option<(u32, usize)> = None;
        let mut next = self.nodes[orphan].first;
        while let Some(arc) = next.map(|arc| arc as usize) {
            next = self.arcs[arc].next;
            let to = self.arcs[arc].to as usize;
            if self.is_open(arc ^ 1, tree)
                && self.nodes[to].tree == tree
                && let Some(distance) = self.distance(to)
                && best.is_none_or(|(least, _)| distance < least)
            {
                best = Some((distance, arc));
            }
        }
        if let Some((distance, arc)) = best {
            let node = &mut self.nodes[orphan];
            (node.parent, node.time, node.distance) = (Parent::Arc(arc as u32), self.time, distance + 1);
            return;
        }
        self.nodes[orphan].parent = Parent::None;
        let mut next = self.nodes[orphan].first;
        while let Some(arc) = next.map(|arc| arc as usize) {
            next = self.arcs[arc].next;
            let to = self.arcs[arc].to as usize;
            let Node { tree: of, parent, .. } = self.nodes[to];
            if of != tree || parent == Parent::None {
                continue;
            }
            if self.is_open(arc ^ 1, tree) {
                self.activate(to);
            }
            if parent == Parent::Arc((arc ^ 1) as u32) {
                self.cut_off(to);
            }
        }
    }

    /// Arcs from a node to the root of its tree; `None` when the way there is cut off. What is found is noted on the way.
    fn distance(&mut self, from: usize) -> Option<u32> {
        let (mut number, mut steps) = (from, 0);
        let total = loop {
            let node = self.nodes[number];
            match node.parent {
                Parent::None | Parent::Orphan => return None,
                Parent::Root => break steps + 1,
                Parent::Arc(_) if node.time == self.time => break steps + node.distance,
                Parent::Arc(arc) => number = self.arcs[arc as usize].to as usize,
            }
            steps += 1;
        };
        let (mut number, mut left) = (from, total);
        while self.nodes[number].time != self.time {
            (self.nodes[number].time, self.nodes[number].distance) = (self.time, left);
            match self.nodes[number].parent {
                Parent::Arc(arc) => number = self.arcs[arc as usize].to as usize,
                _ => break,
            }
            left -= 1;
        }
        Some(total)
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
