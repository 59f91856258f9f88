//! The points of a picture that are judged one by one.

use ndarray::Array2;

use super::texture::{STEP_PX, Texture};

/// Steps of the grid in the side of a tile: the finer the tiles, the finer the regions.
const STEPS_PER_TILE: usize = 16;

/// A point with a label other than 0 counts as much as so many without: borders come to lie a quarter of a step further out. A
/// window that reaches over the border of what moves sees the sharp texture outside rather than the blurred one inside.
const MOVING: f32 = 3.0;

/// Every so-many-th point of the texture, row by row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Grid {
    rows: usize,
    columns: usize,
    /// Points of the texture from one point to the next.
    stride: usize,
}

impl Grid {
    /// The grid for tiles of `tile_px` of a picture with this texture.
    pub(super) fn new(texture: &Texture, tile_px: usize) -> Self {
        let (rows, columns) = texture.dim();
        let stride = (tile_px / (STEPS_PER_TILE * STEP_PX)).clamp(1, rows.min(columns).max(1));
        Self { rows: rows / stride, columns: columns / stride, stride }
    }

    /// Rows and columns.
    pub(super) fn dim(self) -> (usize, usize) {
        (self.rows, self.columns)
    }

    /// Pixels from one point to the next.
    pub(super) fn step_px(self) -> usize {
        self.stride * STEP_PX
    }

    /// The pixel, by row and column, that a point stands for.
    pub(super) fn pixel(self, (row, column): (usize, usize)) -> (usize, usize) {
        let (row, column) = self.of_texture((row, column));
        (row * STEP_PX + STEP_PX / 2, column * STEP_PX + STEP_PX / 2)
    }

    /// The point of the texture, by row and column, that a point is.
    pub(super) fn of_texture(self, (row, column): (usize, usize)) -> (usize, usize) {
        (row * self.stride + (self.stride - 1) / 2, column * self.stride + (self.stride - 1) / 2)
    }

    /// The point nearest to the pixel at column `x`, row `y`.
    pub(super) fn nearest(self, (x, y): (f64, f64)) -> (usize, usize) {
        let step = self.step_px() as f64;
        let near = |pixel: f64, last: usize| ((pixel / step) as usize).min(last);
        (near(y, self.rows - 1), near(x, self.columns - 1))
    }

    /// Labels of the pixels of a picture of `dim` rows and columns, from those of the points: of the four around a pixel, that
    /// which weighs most by how near they are and how much they count.
    pub(super) fn to_pixels(self, labels: &Array2<u8>, dim: (usize, usize)) -> Array2<u8> {
        let (first_row, first_column) = self.pixel((0, 0));
        let columns: Vec<(usize, f32)> =
            (0..dim.1).map(|column| self.between(column, first_column, self.columns)).collect();
        let mut pixels = Array2::zeros(dim);
        for (row, mut pixels) in pixels.rows_mut().into_iter().enumerate() {
            let (top, down) = self.between(row, first_row, self.rows);
            let (above, below) = (labels.row(top), labels.row((top + 1).min(self.rows - 1)));
            for (pixel, &(left, right)) in pixels.iter_mut().zip(&columns) {
                let other = (left + 1).min(self.columns - 1);
                *pixel = heaviest([above[left], above[other], below[left], below[other]], (down, right));
            }
        }
        pixels
    }

    /// The last of `count` points, the first of which is at `first`, that is not beyond `pixel`, and what share of a step the pixel
    /// is beyond it; at the ends none.
    fn between(self, pixel: usize, first: usize, count: usize) -> (usize, f32) {
        let beyond = pixel.saturating_sub(first);
        let (point, rest) = (beyond / self.step_px(), beyond % self.step_px());
        if point + 1 < count { (point, rest as f32 / self.step_px() as f32) } else { (count - 1, 0.0) }
    }
}

/// Of the labels above and below, left and right, that which weighs most at a place that is `(down, right)` of a step away from
/// the first.
fn heaviest(labels: [u8; 4], (down, right): (f32, f32)) -> u8 {
    if labels.iter().all(|&label| label == labels[0]) {
        return labels[0];
    }
    let near = [(1.0 - down) * (1.0 - right), (1.0 - down) * right, down * (1.0 - right), down * right];
    let counts = |label: u8| if label == 0 { 1.0 } else { MOVING };
    let weight = |label: u8| {
        counts(label) * labels.iter().zip(near).filter(|(other, _)| **other == label).map(|(_, near)| near).sum::<f32>()
    };
    let heaviest = labels.iter().map(|&label| (label, weight(label))).max_by(|a, b| a.1.total_cmp(&b.1));
    heaviest.map_or(0, |(label, _)| label)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::new(&Texture::new(Array2::from_elem((96, 128), 1.0).view()), 128)
    }

    #[test]
    fn points_stand_for_pixels_near_them() {
        let grid = grid();
        assert_eq!((grid.dim(), grid.step_px()), ((12, 16), 8));
        for row in 0..12 {
            for column in 0..16 {
                let (y, x) = grid.pixel((row, column));
                assert!(y < 96 && x < 128);
                assert_eq!(grid.nearest((x as f64, y as f64)), (row, column));
            }
        }
        assert_eq!(grid.nearest((500.0, 500.0)), (11, 15));
    }

    #[test]
    fn a_border_lies_a_quarter_of_a_step_outside_the_points_that_move() {
        let grid = grid();
        let labels = Array2::from_shape_fn((12, 16), |(_, column)| u8::from(column < 5));
        let (_, last) = grid.pixel((0, 4));
        let pixels = grid.to_pixels(&labels, (96, 128));
        let moving = (0..128).filter(|&column| pixels[(50, column)] == 1).count();
        assert_eq!(moving, last + grid.step_px() * 3 / 4);
        assert_eq!((pixels[(95, 127)], pixels[(0, 0)]), (0, 1));
    }
}
