//! Turning stored pixels upright.

use image::metadata::Orientation;
use ndarray::{Array2, Axis};

/// The upright picture of `stored` pixels.
pub(super) fn upright(stored: Array2<f32>, orientation: Orientation) -> Array2<f32> {
    use Orientation as O;
    let transposed = matches!(orientation, O::Rotate90 | O::Rotate270 | O::Rotate90FlipH | O::Rotate270FlipH);
    let mut picture = if transposed { stored.reversed_axes() } else { stored };
    if matches!(orientation, O::FlipHorizontal | O::Rotate180 | O::Rotate90 | O::Rotate270FlipH) {
        picture.invert_axis(Axis(1));
    }
    if matches!(orientation, O::FlipVertical | O::Rotate180 | O::Rotate270 | O::Rotate270FlipH) {
        picture.invert_axis(Axis(0));
    }
    if picture.is_standard_layout() { picture } else { picture.as_standard_layout().into_owned() }
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    #[test]
    fn the_first_row_and_column_come_where_exif_says() {
        // EXIF 2.32, tag 0x0112: where the visual "top left" pair of edges is for row 0 and column 0 of
        //   1 2 3
        //   4 5 6
        let cases = [
            (1, array![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]),
            (2, array![[3.0, 2.0, 1.0], [6.0, 5.0, 4.0]]),
            (3, array![[6.0, 5.0, 4.0], [3.0, 2.0, 1.0]]),
            (4, array![[4.0, 5.0, 6.0], [1.0, 2.0, 3.0]]),
            (5, array![[1.0, 4.0], [2.0, 5.0], [3.0, 6.0]]),
            (6, array![[4.0, 1.0], [5.0, 2.0], [6.0, 3.0]]),
            (7, array![[6.0, 3.0], [5.0, 2.0], [4.0, 1.0]]),
            (8, array![[3.0, 6.0], [2.0, 5.0], [1.0, 4.0]]),
        ];
        for (tag, expected) in cases {
            let orientation = Orientation::from_exif(tag).unwrap();
            let found = upright(array![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], orientation);
            assert_eq!(found, expected, "orientation {tag}");
            assert!(found.is_standard_layout());
        }
    }
}
