//! The one error type of the crate.

use thiserror::Error;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// What can be wrong with a picture or a parameter. Every variant carries the offending numbers.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The picture has too few rows or columns.
    #[error("the picture is {width}x{height} pixels; at least {min}x{min} are needed")]
    TooSmall {
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Least number of rows and of columns.
        min: usize,
    },
    /// A pixel is NaN or infinite.
    #[error("the pixel at row {row}, column {column} is {value}; every pixel must be a finite number")]
    NotFinite {
        /// Row of the first such pixel.
        row: usize,
        /// Column of the first such pixel.
        column: usize,
        /// Its value.
        value: f32,
    },
    /// All pixels are equal: there is nothing to measure.
    #[error("all pixels have the value {value}; a picture without contrast carries no blur")]
    Constant {
        /// The common value.
        value: f32,
    },
    /// The region of interest is not inside the picture.
    #[error(
        "the region x={x} y={y} {width}x{height} does not lie inside the picture of {image_width}x{image_height} pixels"
    )]
    RegionOutside {
        /// Left column of the region.
        x: usize,
        /// Top row of the region.
        y: usize,
        /// Columns of the region.
        width: usize,
        /// Rows of the region.
        height: usize,
        /// Columns of the picture.
        image_width: usize,
        /// Rows of the picture.
        image_height: usize,
    },
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
    /// No method of this name is registered.
    #[error("there is no {kind} method called '{name}'; known: {known}")]
    UnknownMethod {
        /// `angle`, `length` or `joint`.
        kind: &'static str,
        /// The name asked for.
        name: String,
        /// Names that exist, separated by spaces.
        known: String,
    },
    /// A method that compares with sharp pictures was given none.
    #[error("no sharp picture to compare with: give at least one still of the same scene")]
    NoStill,
    /// A picture has not the size of the stills it is compared with.
    #[error(
        "the picture is {other_width}x{other_height} pixels, the stills are {width}x{height}: all must have one size"
    )]
    StillSize {
        /// Columns of the stills.
        width: usize,
        /// Rows of the stills.
        height: usize,
        /// Columns of the picture.
        other_width: usize,
        /// Rows of the picture.
        other_height: usize,
    },
    /// Two stills do not show the same scene.
    #[error(
        "still {index} does not show the scene of the first: {:.0} % of its contrast is not explained; leave it out",
        100.0 * share
    )]
    StillsDiffer {
        /// Number of the still, from 1.
        index: usize,
        /// Share of its variance that the first does not explain.
        share: f64,
    },
}
