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
    /// The picture is too short along the motion.
    #[error("the picture measures {along_px:.1} pixels along the motion; at least {min_px:.0} are needed")]
    TooShort {
        /// Longest straight line of the motion's direction in the picture, in pixels.
        along_px: f64,
        /// Least length.
        min_px: f64,
    },
    /// Rows of a picture begin nearer to each other than they are long.
    #[error("rows of {width} pixels take {needed} bytes, but begin {row_bytes} bytes apart")]
    RowTooShort {
        /// Bytes from the start of a row to that of the next.
        row_bytes: usize,
        /// Columns of the picture.
        width: usize,
        /// Bytes of a row.
        needed: usize,
    },
    /// A picture has more pixels than its memory holds.
    #[error("a picture of {width}x{height} pixels takes {needed} bytes; {bytes} were given")]
    TooFewBytes {
        /// Bytes given.
        bytes: usize,
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Bytes that the picture takes.
        needed: usize,
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
    /// Weights or a mask have not the size of the picture they belong to.
    #[error(
        "the weights are {other_width}x{other_height} pixels, the picture is {width}x{height}: both must have one size"
    )]
    WeightSize {
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Columns of the weights.
        other_width: usize,
        /// Rows of the weights.
        other_height: usize,
    },
    /// A weight is no number from 0 to 1.
    #[error("the weight at row {row}, column {column} is {value}; every weight must be a number from 0 to 1")]
    Weight {
        /// Row of the first such weight.
        row: usize,
        /// Column of the first such weight.
        column: usize,
        /// Its value.
        value: f32,
    },
    /// Too few rows of tiles for a change along the picture.
    #[error(
        "tiles with a certain blur lie in {rows} rows; at least {needed} are needed for a change along the picture"
    )]
    TooFewTileRows {
        /// Rows that hold such a tile.
        rows: usize,
        /// Least number.
        needed: usize,
    },
    /// The tiles of a picture do not move along one axis.
    #[error(
        "the axes of the tiles have a mean resultant length of {resultant:.2}; a common motion has at least {least}"
    )]
    AxesDiffer {
        /// Mean resultant length, 0 to 1.
        resultant: f64,
        /// Least value.
        least: f64,
    },
    /// No pixel weighs anything.
    #[error("no pixel of the {width}x{height} weights is above 0; the part to measure must have some")]
    NoWeight {
        /// Columns of the weights.
        width: usize,
        /// Rows of the weights.
        height: usize,
    },
    /// The part of the picture that has weight is too narrow.
    #[error("the part to measure is {extent_px:.0} pixels wide where it is narrowest; at least {min} are needed")]
    RegionTooNarrow {
        /// Its least extent in any direction, in pixels.
        extent_px: f64,
        /// Least extent that can be measured.
        min: usize,
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
    /// A tile is larger than the picture.
    #[error(
        "tiles of {tile_px} pixels do not fit into a picture of {width}x{height}: give smaller ones, from 64 pixels"
    )]
    TileTooLarge {
        /// Side of a tile.
        tile_px: usize,
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
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
    /// A measured number is refused.
    #[error(transparent)]
    Measurement(#[from] metrology::Error),
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
    /// A method was asked to follow a motion from frame to frame and cannot.
    #[error("the method '{method}' cannot follow a motion from frame to frame; these can: {known}")]
    NoTracking {
        /// Name of the method.
        method: String,
        /// Names of those that can, separated by spaces.
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
    /// A blur that is to be undone is as long as the picture.
    #[error("a blur of {length_px:.1} px leaves nothing to restore of a picture of {width}x{height} pixels")]
    BlurTooLong {
        /// Length of the blur in pixels.
        length_px: f64,
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
    },
    /// A picture has not the size that was prepared for.
    #[error("the picture is {other_width}x{other_height} pixels, but {width}x{height} were prepared for")]
    OtherSize {
        /// Columns prepared for.
        width: usize,
        /// Rows prepared for.
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
    /// A pixel lies where the distortion of the lens cannot be undone.
    #[error(
        "a point at {radius:.3} focal lengths from the centre cannot be undistorted: the camera's model ends at {limit:.3}"
    )]
    BeyondLens {
        /// Distance of the distorted point from the centre, in focal lengths.
        radius: f64,
        /// Largest distance that the model reaches.
        limit: f64,
    },
    /// A matrix is no covariance.
    #[error("the covariance of {row} and {column} is {value}: not that of a measurement")]
    Covariance {
        /// Name of the parameter of the row.
        row: &'static str,
        /// Name of the parameter of the column.
        column: &'static str,
        /// The entry.
        value: f64,
    },
    /// A picture has other proportions than those of the camera.
    #[error(
        "the picture is {width}x{height} pixels, the camera was calibrated at {camera_width}x{camera_height}: another shape, so it was cut or taken otherwise"
    )]
    OtherShape {
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Columns of the camera's pictures.
        camera_width: usize,
        /// Rows of the camera's pictures.
        camera_height: usize,
    },
    /// Too few pictures of the board.
    #[error("{views} views of the board are too few to calibrate a camera: at least {needed} are needed")]
    TooFewViews {
        /// Views given.
        views: usize,
        /// Least number.
        needed: usize,
    },
    /// The points of one view are of no use.
    #[error("view {number} with {points} points cannot be used: {reason}")]
    View {
        /// Number of the view, from 1.
        number: usize,
        /// Points in it.
        points: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// The views leave the focal length open.
    #[error(
        "the views do not fix the focal length ({focal_px:.0} px, standard uncertainty {std_px:.0} px): tilt the board in several directions"
    )]
    ViewsTooAlike {
        /// The focal length found in pixels, NaN if none.
        focal_px: f64,
        /// Its standard uncertainty.
        std_px: f64,
    },
    /// The board is not in the picture, or not all of it.
    #[error(
        "no board of {columns}x{rows} found: the best grid has {found} of {needed} points; show all of the board, sharp and evenly lit"
    )]
    BoardNotFound {
        /// Columns of the board.
        columns: usize,
        /// Rows of the board.
        rows: usize,
        /// Points of the best grid.
        found: usize,
        /// Points of the board.
        needed: usize,
    },
    /// The board in the picture is larger than the one asked for.
    #[error(
        "a board larger than {columns}x{rows} found: which part is meant is not known; count its inner corners again"
    )]
    BoardLarger {
        /// Columns asked for.
        columns: usize,
        /// Rows asked for.
        rows: usize,
    },
}
