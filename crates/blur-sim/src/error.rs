//! The one error type of the crate.

use thiserror::Error;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// What can be wrong with a scene, a motion or a sensor. Every variant carries the offending numbers.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A numeric parameter is out of its range.
    #[error("{name} = {value} is not allowed: it must be {expected}")]
    Parameter {
        /// What the parameter is, with its unit.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// What would be allowed.
        expected: &'static str,
    },
    /// A picture of this size cannot be made or used.
    #[error("a picture of {cols}x{rows} pixels is not allowed: each side must be {min}..={max}")]
    Size {
        /// Rows asked for or given.
        rows: usize,
        /// Columns asked for or given.
        cols: usize,
        /// Least number of rows and of columns.
        min: usize,
        /// Greatest number of rows and of columns.
        max: usize,
    },
    /// A pixel is NaN or infinite.
    #[error("the pixel at row {row}, column {col} is {value}; every pixel must be a finite number")]
    NotFinite {
        /// Row of the first such pixel.
        row: usize,
        /// Column of the first such pixel.
        col: usize,
        /// Its value.
        value: f64,
    },
    /// The blur is as large as the scene: no pixel sees only the scene.
    #[error("a blur over {blur_cols}x{blur_rows} pixels leaves nothing of a scene of {cols}x{rows} pixels")]
    BlurTooLong {
        /// Rows that the blur reaches over.
        blur_rows: usize,
        /// Columns that the blur reaches over.
        blur_cols: usize,
        /// Rows of the scene.
        rows: usize,
        /// Columns of the scene.
        cols: usize,
    },
    /// The scene is too small for the picture and the way that it moves.
    #[error("a scene of {cols}x{rows} pixels is too small: the picture and its motion need {need_cols}x{need_rows}")]
    SceneTooSmall {
        /// Rows of the scene.
        rows: usize,
        /// Columns of the scene.
        cols: usize,
        /// Rows that it needs.
        need_rows: usize,
        /// Columns that it needs.
        need_cols: usize,
    },
    /// A texture of a street has not the size of its background.
    #[error("the texture is {other_cols}x{other_rows} pixels, the background {cols}x{rows}: both must have one size")]
    StreetSize {
        /// Rows of the background.
        rows: usize,
        /// Columns of the background.
        cols: usize,
        /// Rows of the texture.
        other_rows: usize,
        /// Columns of the texture.
        other_cols: usize,
    },
    /// Two moving objects cross the same pixel, whose light then depends on which was there when.
    #[error("two moving objects meet at row {row}, column {col}: place them further apart")]
    MoversMeet {
        /// Row of the first such pixel.
        row: usize,
        /// Column of the first such pixel.
        col: usize,
    },
    /// There is no poster of this number.
    #[error("there is no poster {poster}: they are numbered from 0 to {last}")]
    NoPoster {
        /// The number asked for.
        poster: usize,
        /// Greatest number there is.
        last: usize,
    },
    /// The Fourier transform of this size failed, although its buffers were made for it.
    #[error("the Fourier transform of {cols}x{rows} samples failed")]
    Transform {
        /// Rows of the transform.
        rows: usize,
        /// Columns of the transform.
        cols: usize,
    },
}
