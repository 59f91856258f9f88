//! Where the points of the upright picture are among the stored pixels.

use image::metadata::Orientation;

/// The frames of a picture: upright as it is shown, and as it is stored, which is that of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoredFrame {
    orientation: Orientation,
    upright: (usize, usize),
}

/// A way through the upright picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowsRun {
    /// From top to bottom, as in every picture that is stored as it is shown.
    Down,
    /// From bottom to top.
    Up,
    /// From left to right.
    Right,
    /// From right to left.
    Left,
}

impl RowsRun {
    /// The name used in machine-readable output.
    pub fn name(self) -> &'static str {
        self.ways()[0]
    }

    /// Words for a motion along with the readout and one against it.
    pub fn ways(self) -> [&'static str; 2] {
        match self {
            Self::Down => ["down", "up"],
            Self::Up => ["up", "down"],
            Self::Right => ["right", "left"],
            Self::Left => ["left", "right"],
        }
    }
}

impl StoredFrame {
    /// For an upright picture of `height` rows and `width` columns.
    pub(super) fn new(orientation: Orientation, (height, width): (usize, usize)) -> Self {
        Self { orientation, upright: (height, width) }
    }

    /// Columns as stored.
    pub fn stored_width_px(&self) -> usize {
        if self.is_transposed() { self.upright.0 } else { self.upright.1 }
    }

    /// Rows as stored.
    pub fn stored_height_px(&self) -> usize {
        if self.is_transposed() { self.upright.1 } else { self.upright.0 }
    }

    /// The stored place of an upright point `(u, v)`.
    pub fn stored(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (height, width) = self.upright;
        let u = if self.mirrors_columns() { width as f64 - 1.0 - u } else { u };
        let v = if self.mirrors_rows() { height as f64 - 1.0 - v } else { v };
        if self.is_transposed() { [v, u] } else { [u, v] }
    }

    /// The stored axis, in degrees counter-clockwise from the right, of one in the upright picture.
    pub fn stored_deg(&self, upright_deg: f64) -> f64 {
        let mirrored = if self.mirrors_columns() == self.mirrors_rows() { upright_deg } else { -upright_deg };
        // Exchanging right with down mirrors at the axis of -45 degrees.
        if self.is_transposed() { -90.0 - mirrored } else { mirrored }
    }

    /// Whether one is the mirror image of the other, so that angles run the other way.
    pub fn is_mirrored(&self) -> bool {
        (self.mirrors_columns() == self.mirrors_rows()) == self.is_transposed()
    }

    /// Where the sensor's rows follow each other in the upright picture, from the first to the last.
    pub fn rows_run(&self) -> RowsRun {
        match (self.is_transposed(), self.mirrors_rows(), self.mirrors_columns()) {
            (false, false, _) => RowsRun::Down,
            (false, true, _) => RowsRun::Up,
            (true, _, false) => RowsRun::Right,
            (true, _, true) => RowsRun::Left,
        }
    }

    /// The upright axis of a stored one.
    pub fn upright_deg(&self, stored_deg: f64) -> f64 {
        let mirrored = if self.is_transposed() { -90.0 - stored_deg } else { stored_deg };
        if self.mirrors_columns() == self.mirrors_rows() { mirrored } else { -mirrored }
    }

    fn is_transposed(&self) -> bool {
        use Orientation as O;
        matches!(self.orientation, O::Rotate90 | O::Rotate270 | O::Rotate90FlipH | O::Rotate270FlipH)
    }

    fn mirrors_columns(&self) -> bool {
        use Orientation as O;
        matches!(self.orientation, O::FlipHorizontal | O::Rotate180 | O::Rotate90 | O::Rotate270FlipH)
    }

    fn mirrors_rows(&self) -> bool {
        use Orientation as O;
        matches!(self.orientation, O::FlipVertical | O::Rotate180 | O::Rotate270 | O::Rotate270FlipH)
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::super::orientation::upright;
    use super::*;

    #[test]
    fn points_and_axes_go_where_the_pixels_went() {
        let stored = Array2::from_shape_fn((3, 5), |(v, u)| (10 * v + u) as f32);
        for tag in 1..=8 {
            let orientation = Orientation::from_exif(tag).unwrap();
            let shown = upright(stored.clone(), orientation);
            let frame = StoredFrame::new(orientation, shown.dim());
            assert_eq!((frame.stored_height_px(), frame.stored_width_px()), (3, 5), "orientation {tag}");
            for ((v, u), &value) in shown.indexed_iter() {
                let [column, row] = frame.stored([u as f64, v as f64]);
                assert_eq!(stored[[row as usize, column as usize]], value, "orientation {tag}");
            }
            // The first row of the sensor is where the rows run away from.
            let top = frame.stored([0.0, 0.0])[1];
            let [below, beside] = [frame.stored([0.0, 1.0])[1] - top, frame.stored([1.0, 0.0])[1] - top];
            let expected = match (below, beside) {
                (1.0, 0.0) => RowsRun::Down,
                (-1.0, 0.0) => RowsRun::Up,
                (0.0, 1.0) => RowsRun::Right,
                _ => RowsRun::Left,
            };
            assert_eq!(frame.rows_run(), expected, "orientation {tag}");
            assert_eq!(frame.is_mirrored(), frame.stored_deg(1.0) < frame.stored_deg(0.0), "orientation {tag}");
            let deg = 30.0_f64;
            let (sin, cos) = deg.to_radians().sin_cos();
            let (from, to) = (frame.stored([0.0, 0.0]), frame.stored([cos, -sin]));
            let expected = (from[1] - to[1]).atan2(to[0] - from[0]).to_degrees();
            let miss = |a: f64, b: f64| ((a - b + 90.0).rem_euclid(180.0) - 90.0).abs();
            assert!(miss(frame.stored_deg(deg), expected) < 1e-9, "orientation {tag}");
            assert!(miss(frame.upright_deg(expected), deg) < 1e-9, "orientation {tag}");
        }
    }
}
