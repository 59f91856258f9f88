//! What a border between two points of the grid costs: less where the picture has an edge.

use ndarray::{Array2, Zip};

use super::grid::Grid;
use super::texture::Texture;

/// Rows down and columns across to the neighbours of a point of which it is the first.
pub(super) const NEIGHBOURS: [(usize, isize); 4] = [(0, 1), (1, 0), (1, 1), (1, -1)];
/// Cost of a border between neighbours beside or above each other, and across the corner, where there is no edge: its length is
/// then much the same in all directions.
const COSTS: [f32; 4] = [4.0, 4.0, 2.8, 2.8];
/// An edge of as many times the mean gradient takes all but 1/e of what it can of the cost, and this share is left in any case.
const EDGE: f32 = 1.0;
const LEFT: f32 = 0.2;

/// Costs of the borders of a grid.
#[derive(Debug)]
pub(super) struct Borders {
    /// By direction, in the order of [`NEIGHBOURS`].
    costs: [Array2<f32>; 4],
}

impl Borders {
    /// Those of a picture with this texture.
    pub(super) fn new(texture: &Texture, grid: Grid) -> Self {
        let (x, y) = texture.gradient();
        let edges = Zip::from(x).and(y).map_collect(|x, y| x.hypot(*y));
        // Where there is nothing but noise, that is no edge either.
        let mean = edges.mean().unwrap_or_default().max(texture.gradient_noise());
        let costs = std::array::from_fn(|direction| {
            let (down, across) = NEIGHBOURS[direction];
            Array2::from_shape_fn(grid.dim(), |at| {
                let (row, column) = grid.pixel(at);
                let steepest = (0..=grid.step_px())
                    .filter_map(|step| {
                        edges.get((row + step * down, column.wrapping_add_signed(step as isize * across)))
                    })
                    .copied()
                    .fold(0.0, f32::max);
                let edge = (-steepest / (EDGE * mean)).exp();
                COSTS[direction] * (LEFT + (1.0 - LEFT) * edge)
            })
        });
        Self { costs }
    }

    /// The cost of the border between the point `at` and its neighbour in a direction of [`NEIGHBOURS`].
    pub(super) fn cost(&self, direction: usize, at: (usize, usize)) -> f32 {
        self.costs[direction][at]
    }

    /// Borders of given costs, by direction.
    #[cfg(test)]
    pub(super) fn of(costs: impl FnMut(usize) -> Array2<f32>) -> Self {
        Self { costs: [0, 1, 2, 3].map(costs) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_border_along_an_edge_is_cheap_and_one_elsewhere_is_not() {
        let picture = Array2::from_shape_fn((64, 64), |(_, column)| if column < 30 { 20.0 } else { 180.0 });
        let texture = Texture::new(picture.view());
        let grid = Grid::new(&texture, 64);
        let borders = Borders::new(&texture, grid);
        let (row, column) = grid.nearest((29.0, 32.0));
        let (along, across) = (borders.cost(0, (row, column)), borders.cost(0, (row, 3)));
        assert!(along < 1.01 * LEFT * COSTS[0], "{along}");
        assert!(across > 0.99 * COSTS[0], "{across}");
        // Between points above each other far from the edge as much as beside each other.
        assert!((borders.cost(1, (row, 3)) - across).abs() < 1e-3);
    }

    #[test]
    fn a_plain_picture_has_borders_of_full_cost() {
        let texture = Texture::new(Array2::from_elem((64, 64), 7.0).view());
        let borders = Borders::new(&texture, Grid::new(&texture, 64));
        for (direction, cost) in COSTS.into_iter().enumerate() {
            assert!((borders.cost(direction, (4, 4)) - cost).abs() < 1e-3);
        }
    }
}
