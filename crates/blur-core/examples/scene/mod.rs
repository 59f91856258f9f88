//! What the cameras of the examples look at.

use ndarray::Array2;

/// Discs of all sizes and greys that cover one another, as objects in photographs do. Walls of equal stones would not do:
/// a picture of pieces that are all equally long cannot be told from one that is blurred.
pub(crate) fn scene(rows: usize, columns: usize) -> Array2<f32> {
    let mut state = 1_u64;
    let mut random = move || {
        // A linear congruential generator; its upper bits are random enough for a picture.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    let mut scene = Array2::from_elem((rows, columns), 128.0);
    for _ in 0..rows * columns / 25 {
        let radius = (1.5 / (1.0 - random()).sqrt()).min(60.0);
        let (y, x, grey) = (random() * rows as f32, random() * columns as f32, 20.0 + 215.0 * random());
        let (top, left) = ((y - radius).max(0.0) as usize, (x - radius).max(0.0) as usize);
        for row in top..rows.min((y + radius) as usize + 1) {
            for column in left..columns.min((x + radius) as usize + 1) {
                if (row as f32 - y).hypot(column as f32 - x) < radius {
                    scene[[row, column]] = grey;
                }
            }
        }
    }
    scene
}
