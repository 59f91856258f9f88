//! Points that form a grid, whatever the perspective and the lens make of it.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::Vector2;

/// A point may be so far from where its neighbours expect it, in steps of the grid.
const TOLERANCE: f64 = 0.3;

/// Place on a grid: column and row.
pub(super) type Place = (i32, i32);

/// The four neighbours of a place.
const SIDES: [Place; 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// A grown grid.
pub(super) struct Grid {
    nodes: BTreeMap<Place, Node>,
}

#[derive(Clone, Copy)]
struct Node {
    index: usize,
    /// Steps to the next column and the next row hereabouts.
    steps: [Vector2<f64>; 2],
}

/// What keeps a grid from being the board.
pub(super) enum Misfit {
    /// There is no such part, and this many points fit.
    Incomplete(usize),
    /// There is more than one.
    Larger,
}

impl Grid {
    /// Grows a grid of at most `longest` places a side from point `seed` with its `steps` to the next column and the next
    /// row. `may_adjoin` tells whether two points may be neighbours.
    pub(super) fn grow(
        points: &[Vector2<f64>],
        seed: usize,
        steps: [Vector2<f64>; 2],
        longest: usize,
        may_adjoin: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let mut grid = Self { nodes: BTreeMap::from([((0, 0), Node { index: seed, steps })]) };
        let mut used = vec![false; points.len()];
        used[seed] = true;
        let mut open = VecDeque::from([(0, 0)]);
        let limit = longest as i32;
        while let Some(place) = open.pop_front() {
            for side in SIDES {
                let next = (place.0 + side.0, place.1 + side.1);
                let Some(&node) = grid.nodes.get(&place) else { continue };
                if grid.nodes.contains_key(&next) || next.0.abs() > limit || next.1.abs() > limit {
                    continue;
                }
                let step = grid.step(points, place, side);
                let expected = points[node.index] + step;
                let nearest = (0..points.len())
                    .filter(|&i| !used[i] && may_adjoin(node.index, i))
                    .map(|i| (i, (points[i] - expected).norm()))
                    .min_by(|a, b| a.1.total_cmp(&b.1));
                if let Some((index, distance)) = nearest
                    && distance <= TOLERANCE * step.norm()
                {
                    used[index] = true;
                    let mut steps = node.steps;
                    let found = points[index] - points[node.index];
                    steps[usize::from(side.0 == 0)] = found * f64::from(side.0 + side.1);
                    grid.nodes.insert(next, Node { index, steps });
                    open.push_back(next);
                }
            }
        }
        grid
    }

    /// The step from `place` to its side: that of the parallel neighbours, or the last one straight on.
    fn step(&self, points: &[Vector2<f64>], place: Place, side: Place) -> Vector2<f64> {
        let point = |p: Place| self.nodes.get(&p).map(|node| points[node.index]);
        let add = |p: Place, q: Place| (p.0 + q.0, p.1 + q.1);
        let across = [(side.1, side.0), (-side.1, -side.0)];
        let parallel: Vec<Vector2<f64>> = across
            .iter()
            .filter_map(|&way| Some(point(add(add(place, way), side))? - point(add(place, way))?))
            .collect();
        if !parallel.is_empty() {
            return parallel.iter().sum::<Vector2<f64>>() / parallel.len() as f64;
        }
        if let (Some(here), Some(before)) = (point(place), point((place.0 - side.0, place.1 - side.1))) {
            return here - before;
        }
        let steps = self.nodes.get(&place).map_or([Vector2::zeros(); 2], |node| node.steps);
        steps[0] * f64::from(side.0) + steps[1] * f64::from(side.1)
    }

    /// The step to the next column and the next row at a place.
    pub(super) fn steps(&self, points: &[Vector2<f64>], place: Place) -> [Vector2<f64>; 2] {
        [self.step(points, place, SIDES[0]), self.step(points, place, SIDES[1])]
    }

    /// The places of the only part with `columns` by `rows` points, row by row, first row and column as near to the top left
    /// as the board's shape and not being mirrored allow.
    pub(super) fn part(&self, points: &[Vector2<f64>], columns: usize, rows: usize) -> Result<Vec<Place>, Misfit> {
        let lying = self.places_of(columns, rows);
        let standing = if columns == rows { Vec::new() } else { self.places_of(rows, columns) };
        let (corner, is_turned) = match (lying.as_slice(), standing.as_slice()) {
            ([corner], []) => (*corner, false),
            ([], [corner]) => (*corner, true),
            ([], []) => return Err(Misfit::Incomplete(self.nodes.len())),
            _ => return Err(Misfit::Larger),
        };
        let (columns, rows) = (columns as i32, rows as i32);
        let place = |column: i32, row: i32| {
            let (right, down) = if is_turned { (row, column) } else { (column, row) };
            (corner.0 + right, corner.1 + down)
        };
        let point = |column: i32, row: i32| self.index(place(column, row)).map(|index| points[index]);
        // The four ways to read a grid: each axis forwards or backwards.
        let best = [(false, false), (true, false), (false, true), (true, true)]
            .into_iter()
            .filter_map(|(flip_x, flip_y)| {
                let x = |i: i32| if flip_x { columns - 1 - i } else { i };
                let y = |j: i32| if flip_y { rows - 1 - j } else { j };
                let origin = point(x(0), y(0))?;
                let (along, down) = (point(x(columns - 1), y(0))? - origin, point(x(0), y(rows - 1))? - origin);
                // Down is to the right of along where v grows downwards, unless the board is mirrored.
                (along.perp(&down) > 0.0).then_some((flip_x, flip_y, origin.x + origin.y))
            })
            .min_by(|a, b| a.2.total_cmp(&b.2));
        let Some((flip_x, flip_y, _)) = best else { return Err(Misfit::Incomplete(self.nodes.len())) };
        let read = |i: i32, last: i32, flip: bool| if flip { last - i } else { i };
        Ok((0..rows)
            .flat_map(|j| (0..columns).map(move |i| (i, j)))
            .map(|(i, j)| place(read(i, columns - 1, flip_x), read(j, rows - 1, flip_y)))
            .collect())
    }

    /// The point at a place.
    pub(super) fn index(&self, place: Place) -> Option<usize> {
        self.nodes.get(&place).map(|node| node.index)
    }

    /// All points of the grid.
    pub(super) fn indices(&self) -> impl Iterator<Item = usize> {
        self.nodes.values().map(|node| node.index)
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Top left places of all full parts of a shape.
    fn places_of(&self, columns: usize, rows: usize) -> Vec<Place> {
        self.nodes
            .keys()
            .filter(|corner| {
                (0..columns as i32)
                    .all(|i| (0..rows as i32).all(|j| self.nodes.contains_key(&(corner.0 + i, corner.1 + j))))
            })
            .copied()
            .collect()
    }
}
