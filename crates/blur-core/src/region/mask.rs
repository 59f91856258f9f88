//! Regions of any shape with a soft edge.

use ndarray::{Array2, ArrayView2};

use crate::{Error, Result};

/// Neighbouring pixels of a mask that differ by more than this are a hard edge.
const HARD_STEP: f32 = 0.25;
/// Width of the taper as a share of the region's inner radius: that of a Tukey window of 0.25 over its breadth.
const TAPER: f32 = 0.25;

/// A region of a picture by the weight of each pixel, its edge soft enough for a spectrum.
///
/// A hard edge, as a segmentation draws it, leaks into the dark lines of a blur (thesis section 7.1.2). From such an edge
/// the weights rise by a raised cosine over a quarter of the region's inner radius, the largest distance of any of its
/// pixels to a hard edge. An edge over which neighbouring pixels differ by no more than a quarter is soft already and stays
/// as it is. The border of the picture is a hard edge where the mask reaches it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    weights: Array2<f32>,
    taper_px: f32,
}

impl Mask {
    /// The region that `grey` marks: rows x columns, 0 outside, 1 inside.
    ///
    /// # Errors
    /// [`Error::Weight`] for a value that is no number from 0 to 1, [`Error::NoWeight`] when none is above 0.
    pub fn new(grey: ArrayView2<'_, f32>) -> Result<Self> {
        if let Some(((row, column), &value)) = grey.indexed_iter().find(|(_, value)| !(0.0..=1.0).contains(*value)) {
            return Err(Error::Weight { row, column, value });
        }
        let (height, width) = grey.dim();
        if !grey.iter().any(|&value| value > 0.0) {
            return Err(Error::NoWeight { width, height });
        }
        let distance = distance_px(grey);
        let inside = distance.iter().zip(grey).filter(|(_, grey)| **grey > 0.0).map(|(distance, _)| *distance);
        let radius = inside.fold(0.0, f32::max);
        let taper_px = if radius.is_finite() { TAPER * radius } else { 0.0 };
        let mut weights = grey.to_owned();
        for (weight, &distance) in weights.iter_mut().zip(&distance) {
            if distance < taper_px {
                *weight *= 0.5 - 0.5 * (std::f32::consts::PI * distance / taper_px).cos();
            }
        }
        Ok(Self { weights, taper_px })
    }

    /// The weights, 0 to 1, of the mask's size.
    pub fn weights(&self) -> ArrayView2<'_, f32> {
        self.weights.view()
    }

    /// Column and row of the centre of the weights.
    pub fn centroid(&self) -> [f64; 2] {
        let (mut x, mut y, mut sum) = (0.0, 0.0, 0.0);
        for ((row, column), &weight) in self.weights.indexed_iter() {
            let weight = f64::from(weight);
            x += weight * column as f64;
            y += weight * row as f64;
            sum += weight;
        }
        [x / sum, y / sum]
    }

    /// Width in pixels of the taper along hard edges; 0 when there are none.
    pub fn taper_px(&self) -> f32 {
        self.taper_px
    }
}

/// Distance of each pixel to the nearest darker side of a hard edge, infinite where there is none.
///
/// # Reference
/// P. Felzenszwalb and D. Huttenlocher, *Distance transforms of sampled functions*, Theory of Computing 8 (2012) 415: exact,
/// one pass along the columns and one along the rows.
fn distance_px(grey: ArrayView2<'_, f32>) -> Array2<f32> {
    let (rows, columns) = grey.dim();
    // A frame of black pixels stands for all that is outside.
    let at = |row: usize, column: usize| match (row.checked_sub(1), column.checked_sub(1)) {
        (Some(row), Some(column)) => grey.get((row, column)).copied().unwrap_or(0.0),
        _ => 0.0,
    };
    let mut squares = Array2::from_elem((rows + 2, columns + 2), f64::INFINITY);
    for row in 0..rows + 2 {
        for column in 0..columns + 2 {
            let here = at(row, column);
            for (next_row, next_column) in [(row + 1, column), (row, column + 1)] {
                if next_row > rows + 1 || next_column > columns + 1 {
                    continue;
                }
                let next = at(next_row, next_column);
                if (next - here).abs() > HARD_STEP {
                    let darker = if next < here { (next_row, next_column) } else { (row, column) };
                    squares[darker] = 0.0;
                }
            }
        }
    }
    let longest = rows.max(columns) + 2;
    let mut envelope = Envelope { parabolas: Vec::with_capacity(longest), line: Vec::with_capacity(longest) };
    for mut line in squares.columns_mut() {
        envelope.replace(line.iter_mut());
    }
    for mut line in squares.rows_mut() {
        envelope.replace(line.iter_mut());
    }
    Array2::from_shape_fn((rows, columns), |(row, column)| squares[[row + 1, column + 1]].sqrt() as f32)
}

/// The lower envelope of the parabolas `(x - i)^2 + f(i)` over a line.
struct Envelope {
    /// Apex, height and the place from where each parabola is the lowest.
    parabolas: Vec<(f64, f64, f64)>,
    line: Vec<f64>,
}

impl Envelope {
    /// Replaces the heights of a line by their envelope.
    fn replace<'a>(&mut self, line: impl Iterator<Item = &'a mut f64>) {
        let line: Vec<&mut f64> = line.collect();
        self.line.clear();
        self.line.extend(line.iter().map(|value| **value));
        self.parabolas.clear();
        for (apex, &height) in self.line.iter().enumerate().filter(|(_, height)| height.is_finite()) {
            let apex = apex as f64;
            let mut from = f64::NEG_INFINITY;
            while let Some(&(other, other_height, other_from)) = self.parabolas.last() {
                from = (height + apex * apex - other_height - other * other) / (2.0 * (apex - other));
                if from > other_from {
                    break;
                }
                self.parabolas.pop();
                from = f64::NEG_INFINITY;
            }
            self.parabolas.push((apex, height, from));
        }
        let mut lowest = 0;
        for (x, out) in line.into_iter().enumerate() {
            let x = x as f64;
            while self.parabolas.get(lowest + 1).is_some_and(|(_, _, from)| *from <= x) {
                lowest += 1;
            }
            if let Some((apex, height, _)) = self.parabolas.get(lowest) {
                *out = (x - apex).powi(2) + height;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disk with a notch, hard.
    fn shape() -> Array2<f32> {
        Array2::from_shape_fn((61, 80), |(r, c)| {
            let inside = (r as f32 - 30.0).hypot(c as f32 - 38.0) < 25.0 && !(r < 30 && c > 40);
            if inside { 1.0 } else { 0.0 }
        })
    }

    #[test]
    fn the_centre_is_that_of_the_weights() {
        let grey = Array2::from_shape_fn((60, 80), |(y, x)| f32::from((10..31).contains(&y) && (40..61).contains(&x)));
        let [x, y] = Mask::new(grey.view()).unwrap().centroid();
        assert!((x - 50.0).abs() < 1e-6 && (y - 20.0).abs() < 1e-6, "{x} {y}");
    }

    #[test]
    fn distances_are_those_to_the_nearest_pixel_outside() {
        let shape = shape();
        let distance = distance_px(shape.view());
        for ((r, c), &inside) in shape.indexed_iter() {
            if inside > 0.0 {
                let black = shape.indexed_iter().filter(|(_, value)| **value == 0.0);
                let near = |(y, x): (usize, usize)| (y as f32 - r as f32).hypot(x as f32 - c as f32);
                let expected = black.map(|(at, _)| near(at)).fold(f32::INFINITY, f32::min);
                assert!((distance[[r, c]] - expected).abs() < 1e-4, "({r}, {c}): {}", distance[[r, c]]);
            }
        }
    }

    #[test]
    fn a_hard_mask_gets_a_raised_cosine_and_stays_white_inside() {
        let shape = shape();
        let mask = Mask::new(shape.view()).unwrap();
        let distance = distance_px(shape.view());
        for ((at, &weight), &distance) in mask.weights().indexed_iter().zip(&distance) {
            let t = (distance / mask.taper_px()).min(1.0);
            let expected = shape[at] * (0.5 * std::f32::consts::PI * t).sin().powi(2);
            assert!((weight - expected).abs() < 1e-5, "{at:?}: {weight} not {expected}");
        }
        assert!(mask.taper_px() > 3.0 && mask.weights()[[38, 30]] == 1.0);
    }

    #[test]
    fn a_soft_mask_is_left_alone() {
        let soft = Array2::from_shape_fn((64, 64), |(r, c)| {
            let edge = 1.0 - (r as f32 - 31.5).hypot(c as f32 - 31.5) / 30.0;
            (4.0 * edge).clamp(0.0, 1.0)
        });
        let mask = Mask::new(soft.view()).unwrap();
        assert_eq!((mask.weights(), mask.taper_px()), (soft.view(), 0.0));
    }

    #[test]
    fn a_mask_that_fills_the_picture_is_tapered_at_the_border() {
        let mask = Mask::new(Array2::ones((40, 64)).view()).unwrap();
        let weights = mask.weights();
        // The middle rows are 20 pixels from the black ones outside.
        assert!((mask.taper_px() - 5.0).abs() < 1e-6);
        assert!(weights[[0, 30]] < 0.2 && weights[[39, 30]] < 0.2 && weights[[20, 0]] < 0.2);
        assert_eq!(weights[[20, 32]], 1.0);
    }

    #[test]
    fn masks_that_mark_nothing_or_are_no_weights_are_refused() {
        assert_eq!(Mask::new(Array2::zeros((4, 5)).view()), Err(Error::NoWeight { width: 5, height: 4 }));
        let mut grey = Array2::zeros((4, 5));
        grey[[2, 3]] = 255.0;
        assert_eq!(Mask::new(grey.view()), Err(Error::Weight { row: 2, column: 3, value: 255.0 }));
    }
}
