//! Views of a board: from pictures of it, or from lists of points.

use std::fs;
use std::path::Path;

use blur_core::camera::{Board, View};

use crate::picture::{self, Linearize};
use crate::{Error, Result};

/// A view and the size of the picture that it is from.
#[derive(Debug, Clone, PartialEq)]
pub struct SizedView {
    /// The points.
    pub view: View,
    /// Columns of the picture as it is stored.
    pub width_px: usize,
    /// Rows of it.
    pub height_px: usize,
}

/// Finds the board in a picture file. Points are in the pixels as stored, whichever way up the picture is shown: the
/// camera does not turn with it.
pub fn from_picture(path: &Path, board: &Board) -> Result<SizedView> {
    // A tone curve moves no corner between two dark and two bright squares, and the noise of its codes is more even.
    let picture = picture::read(path, Linearize::Off)?;
    let frame = picture.stored_frame();
    let found = board.find(picture.luma.view())?;
    Ok(SizedView {
        view: View { board: board.points(), image_px: found.into_iter().map(|point| frame.stored(point)).collect() },
        width_px: frame.stored_width_px(),
        height_px: frame.stored_height_px(),
    })
}

/// The points in a text file, two numbers each, any number of points on a line (as Zhang's: four corners of a square).
pub fn points(path: &Path) -> Result<Vec<[f64; 2]>> {
    let content = || -> Result<Vec<[f64; 2]>> {
        let text = fs::read_to_string(path).map_err(Error::Read)?;
        let mut points = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let in_line = |source| Error::InLine { line: index + 1, source: Box::new(source) };
            let numbers: Option<Vec<f64>> = line
                .split_whitespace()
                .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
                .collect();
            let refuse =
                || in_line(Error::Numbers { text: line.trim().to_owned(), expected: "points of two numbers each" });
            let numbers = numbers.ok_or_else(refuse)?;
            let (pairs, rest) = numbers.as_chunks::<2>();
            if !rest.is_empty() {
                return Err(refuse());
            }
            points.extend_from_slice(pairs);
        }
        Ok(points)
    };
    content().map_err(|error| error.in_file(path))
}

/// The view of a board whose points are listed in a file, in the order of `board`.
pub fn from_points(path: &Path, board: &[[f64; 2]]) -> Result<View> {
    let image_px = points(path)?;
    if image_px.len() != board.len() {
        return Err(Error::PointCount { found: image_px.len(), expected: board.len() });
    }
    Ok(View { board: board.to_vec(), image_px })
}
