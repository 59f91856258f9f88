//! Calibration boards and their points in a picture.
//!
//! The way of the data: picture → features (saddle points of a [`checkerboard`], dark [`squares`]) → [`grid`] → points to a
//! fraction of a pixel ([`corner`], [`edge`]) in the order of [`Board::points`].

mod checkerboard;
mod corner;
mod edge;
mod grid;
mod smooth;
mod squares;

use ndarray::ArrayView2;

use crate::image::check;
use crate::{Error, Result};

/// What is printed on a board. All lengths are in one unit, of the user's choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pattern {
    /// Squares of two colours in turn; its points are the inner corners, where four squares meet.
    Checkerboard {
        /// Side of a square.
        square: f64,
    },
    /// Separate dark squares on white (Zhang 2000); its points are the four corners of each.
    Squares {
        /// Side of a square.
        square: f64,
        /// From one square to the same place on the next.
        pitch: f64,
    },
}

/// A plane calibration board.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Board {
    pattern: Pattern,
    columns: usize,
    rows: usize,
    corner_window_px: Option<usize>,
}

impl Board {
    /// A board of `columns` by `rows` inner corners, or separate squares.
    ///
    /// # Errors
    /// [`Error::Parameter`] for fewer than two columns or rows, sides that are not positive, or a pitch within the square.
    pub fn new(pattern: Pattern, columns: usize, rows: usize) -> Result<Self> {
        for (name, count) in [("columns of the board", columns), ("rows of the board", rows)] {
            if !(2..=1000).contains(&count) {
                return Err(Error::Parameter { name, value: count as f64, expected: "from 2 to 1000" });
            }
        }
        let (Pattern::Checkerboard { square } | Pattern::Squares { square, .. }) = pattern;
        if !(square > 0.0 && square.is_finite()) {
            return Err(Error::Parameter { name: "side of a square", value: square, expected: "greater than 0" });
        }
        if let Pattern::Squares { pitch, .. } = pattern
            && !(pitch > square && pitch.is_finite())
        {
            return Err(Error::Parameter {
                name: "pitch of the squares",
                value: pitch,
                expected: "longer than the side of a square",
            });
        }
        Ok(Self { pattern, columns, rows, corner_window_px: None })
    }

    /// Refines the corners of a checkerboard in squares that reach `half_px` pixels, 1 to 100, to each side of the corner,
    /// as `OpenCV`'s `cornerSubPix` does with this half window.
    ///
    /// Without it the window of each corner ends before the next edge of the board, so that nothing but its own two edges is
    /// in it. A fixed window is for comparison with published results: where the board is small or tilted, one that reaches
    /// the edges of the neighbours draws the corner away.
    ///
    /// # Errors
    /// [`Error::Parameter`] out of this range, or for separate squares, whose corners come from lines along their edges.
    pub fn with_corner_window(self, half_px: usize) -> Result<Self> {
        let expected = match self.pattern {
            Pattern::Squares { .. } => "absent for separate squares: their corners come from lines along the edges",
            Pattern::Checkerboard { .. } => "from 1 to 100",
        };
        if matches!(self.pattern, Pattern::Squares { .. }) || !(1..=100).contains(&half_px) {
            return Err(Error::Parameter { name: "half window of the corners (px)", value: half_px as f64, expected });
        }
        Ok(Self { corner_window_px: Some(half_px), ..self })
    }

    /// The points of the board, row by row, in the unit of its sides; the four of a square follow each other.
    pub fn points(&self) -> Vec<[f64; 2]> {
        let places = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column as f64, row as f64)));
        match self.pattern {
            Pattern::Checkerboard { square } => places.map(|(x, y)| [x * square, y * square]).collect(),
            Pattern::Squares { square, pitch } => places
                .flat_map(|(x, y)| squares::CORNERS.map(|[i, j]| [x * pitch + i * square, y * pitch + j * square]))
                .collect(),
        }
    }

    /// Where the points of the board are in a picture, as `(u, v)` in pixels, in the order of [`points`](Self::points).
    ///
    /// A board that looks the same when it is turned may be found turned, which makes no difference to a calibration.
    ///
    /// # Errors
    /// [`Error::BoardNotFound`] and [`Error::BoardLarger`], and those of a picture that is too small or not finite.
    pub fn find(&self, picture: ArrayView2<'_, f32>) -> Result<Vec<[f64; 2]>> {
        check(picture)?;
        match self.pattern {
            Pattern::Checkerboard { .. } => checkerboard::find(picture, self.columns, self.rows, self.corner_window_px),
            Pattern::Squares { square, pitch } => squares::find(picture, self.columns, self.rows, pitch / square),
        }
    }
}
