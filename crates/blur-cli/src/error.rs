//! The one error type of the crate.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// What can go wrong between the command line and a measurement. The path of a picture is not repeated here: whoever
/// reports an error knows it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[source] io::Error),
    /// A folder holds no picture.
    #[error("the folder holds no picture (a file named .{})", .extensions.join(", ."))]
    NoPictureInFolder {
        /// Extensions that are looked for.
        extensions: &'static [&'static str],
    },
    /// A pattern matches nothing.
    #[error("no file has this name, and as a pattern it matches none")]
    NoMatch,
    /// A pattern has wrong syntax.
    #[error("not a valid file pattern: {0}")]
    Pattern(#[from] glob::PatternError),
    /// A picture file is refused.
    #[error(transparent)]
    Picture(#[from] blur_picture::Error),
    /// The picture or a parameter of the measurement is refused.
    #[error(transparent)]
    Estimate(#[from] blur_core::Error),
    /// The data of a regression, or a model, are refused.
    #[error(transparent)]
    Accel(#[from] blur_accel::Error),
    /// A value or its uncertainty is not a possible measurement.
    #[error(transparent)]
    Measurement(#[from] metrology::Error),
    /// No method of this name finds angle and length together.
    #[error("no method called '{name}' finds angle and length together; known: {known}")]
    UnknownMethod {
        /// The name asked for.
        name: String,
        /// What may be asked for.
        known: String,
    },
    /// No method of this name measures what a table compares.
    #[error("no method called '{name}' measures the {quantity}; known: {known}")]
    NoCandidate {
        /// The name asked for.
        name: String,
        /// What the table compares.
        quantity: &'static str,
        /// What may be asked for.
        known: String,
    },
    /// The method compares with sharp pictures, and none were given.
    #[error("the method '{method}' compares with sharp pictures of the scene: name them after --reference")]
    NeedsStills {
        /// The method asked.
        method: String,
    },
    /// Sharp pictures were given to a method that has no use for them.
    #[error("the method '{method}' does not compare with sharp pictures; with --reference: {known}")]
    NoUseForStills {
        /// The method asked.
        method: String,
        /// Those that do.
        known: String,
    },
    /// The method does not fit the likelihood, so it cannot tell an acceleration.
    #[error("the method '{method}' cannot look for an acceleration; known: {known}")]
    NoAcceleration {
        /// The method asked.
        method: String,
        /// Those that can.
        known: String,
    },
    /// The method does not fit the likelihood, so it cannot weigh pixels.
    #[error("the method '{method}' cannot measure the part that a mask marks; known: {known}")]
    NoMask {
        /// The method asked.
        method: String,
        /// Those that can.
        known: String,
    },
    /// No method is registered for what was asked.
    #[error("no {kind} method is registered")]
    NoMethod {
        /// `angle` or `length`.
        kind: &'static str,
    },
    /// A quantity without a unit, or with an unknown one, or whose number cannot be read.
    #[error("'{text}' is not {quantity}: write a number and a unit ({units}), for example {example}")]
    Quantity {
        /// What was written.
        text: String,
        /// What it should be.
        quantity: &'static str,
        /// Units that exist.
        units: String,
        /// Values as they should be written.
        example: &'static str,
    },
    /// A list of numbers that cannot be read.
    #[error("'{text}' is not {expected}")]
    Numbers {
        /// What was written.
        text: String,
        /// What it should be.
        expected: &'static str,
    },
    /// Something went wrong with one file of many.
    #[error("{}: {source}", .path.display())]
    InFile {
        /// The file or folder.
        path: PathBuf,
        /// What went wrong.
        source: Box<Error>,
    },
    /// A table names no blurred picture.
    #[error("the table names no blurred picture: there is nothing to learn from")]
    NoBlurred,
    /// The stills of a scene do not go together.
    #[error("scene '{scene}': {source}")]
    InScene {
        /// Name of the scene.
        scene: String,
        /// What is wrong.
        source: Box<Error>,
    },
    /// Something is wrong with one line of a table.
    #[error("line {line}: {source}")]
    InLine {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        source: Box<Error>,
    },
    /// A table lacks a column.
    #[error("there is no column '{column}': the first line must name the columns {needed}, with commas between them")]
    NoColumn {
        /// The column.
        column: &'static str,
        /// All that are needed.
        needed: String,
    },
    /// A line has more or fewer fields than the table has columns.
    #[error(
        "{fields} fields where the first line names {expected} columns; is a decimal comma among them? Write a point"
    )]
    FieldCount {
        /// Fields in the line.
        fields: usize,
        /// Columns of the table.
        expected: usize,
    },
    /// A field that is needed is empty.
    #[error("the column '{column}' is empty")]
    EmptyColumn {
        /// The column.
        column: &'static str,
    },
    /// A field holds no number, or one that is impossible.
    #[error("'{text}' in the column '{column}' is not {expected}")]
    ColumnNumber {
        /// The column.
        column: &'static str,
        /// What was written.
        text: String,
        /// What it should be.
        expected: &'static str,
    },
    /// A picture is neither still nor blurred.
    #[error("'{kind}' in the column 'kind' is neither still nor blurred")]
    PictureKind {
        /// What was written.
        kind: String,
    },
    /// A table names a file that does not exist.
    #[error("there is no file '{image}' (paths are seen from the folder of the table)")]
    NoPicture {
        /// The name of the file.
        image: String,
    },
    /// A table names a picture twice.
    #[error("the picture '{image}' is already in the table")]
    RepeatedPicture {
        /// The name of the file.
        image: String,
    },
    /// Nothing tells how a scene looks at rest.
    #[error("the scene '{scene}' has no still: at least one picture of it at rest is needed")]
    NoStills {
        /// Name of the scene.
        scene: String,
    },
    /// A table cannot be read, or not be written.
    #[error(transparent)]
    Csv(csv::Error),
    /// A folder that is to be filled holds something.
    #[error("the folder is not empty: name one that is, or one that does not exist yet")]
    FolderNotEmpty,
    /// Several restored pictures are to go into one file.
    #[error("{inputs} pictures cannot be restored into the one file {}: name a folder that exists or ends in /", .path.display())]
    RestoreFolder {
        /// The file.
        path: PathBuf,
        /// Number of inputs.
        inputs: usize,
    },
    /// A restored picture is to be written in a format that is not written.
    #[error("restored pictures are written as .png or .tif; '{}' is neither, nor is it a folder that exists or ends in /", .path.display())]
    RestoreFormat {
        /// The file.
        path: PathBuf,
    },
    /// A restored picture would take the place of an input.
    #[error("the restored picture would overwrite the input {}: name another file or folder", .path.display())]
    RestoreOverwrites {
        /// The file.
        path: PathBuf,
    },
    /// The virtual rig refuses its settings.
    #[error(transparent)]
    Rig(#[from] blur_sim::Error),
    /// No picture is left to be blurred.
    #[error("no picture is left to be measured")]
    NoSharpPicture,
    /// A picture of known truth could not be made.
    #[error("{image}: {source}")]
    Simulating {
        /// The sharp picture.
        image: String,
        /// Why.
        source: blur_sim::Error,
    },
    /// A method refused a picture of known truth.
    #[error("{image}: {source}")]
    Measuring {
        /// The picture.
        image: String,
        /// Why.
        source: blur_core::Error,
    },
    /// There is no table of this name.
    #[error("there is no table called '{name}'; known: {known}")]
    UnknownTable {
        /// The name asked for.
        name: String,
        /// What may be asked for.
        known: String,
    },
    /// A row could not be written as JSON.
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A plot, a picture or a table cannot be written.
    #[error("cannot be written: {0}")]
    Write(#[source] io::Error),
    /// A picture cannot be encoded.
    #[error("cannot be encoded: {0}")]
    Encode(#[source] image::ImageError),
    /// A plot cannot be drawn.
    #[error("cannot be drawn: {reason}")]
    Plot {
        /// What the drawing library says.
        reason: String,
    },
    /// The report has no folder to go to.
    #[error("this is a file: name a folder for the report, which may not exist yet")]
    ReportIsFile,
    /// A file that should describe a camera does not.
    #[error("not the file of a camera: make one with the program calibrate")]
    NotACamera,
    /// The file of a camera is of a later version.
    #[error("a camera of version {version}, known up to version {known}: read it with {program}")]
    NewerCamera {
        /// Its version.
        version: u64,
        /// Latest version that can be read.
        known: u64,
        /// The program that can.
        program: String,
    },
    /// The file of a camera is not as it was written.
    #[error("the camera is damaged: {reason}")]
    CameraDamaged {
        /// What is wrong.
        reason: String,
    },
    /// Views of one camera have different sizes.
    #[error("the picture is {width}x{height} pixels, the first was {first_width}x{first_height}: one camera, one size")]
    ViewSize {
        /// Columns of the picture as stored.
        width: usize,
        /// Rows.
        height: usize,
        /// Columns of the first picture.
        first_width: usize,
        /// Rows.
        first_height: usize,
    },
    /// A list of points does not fit the board.
    #[error("{found} points; the board has {expected}")]
    PointCount {
        /// Points in the list.
        found: usize,
        /// Points of the board.
        expected: usize,
    },
    /// A bag is refused, or cannot be written.
    #[error(transparent)]
    Ros(#[from] blur_ros::Error),
    /// A bag is one of several inputs.
    #[error("one of the {inputs} inputs is a bag: measure a bag alone")]
    BagAmongOthers {
        /// Number of inputs.
        inputs: usize,
    },
    /// An option has no meaning for bags.
    #[error("{option} cannot be used with a bag: it is for picture files")]
    NotForBags {
        /// The option.
        option: &'static str,
    },
    /// An option has a meaning only for bags.
    #[error("{option} needs a bag of ROS 2 as the input")]
    OnlyForBags {
        /// The option.
        option: &'static str,
    },
    /// The distance of a motion tells nothing without a camera.
    #[error("--distance needs --camera")]
    DistanceAlone,
    /// The worker threads could not be started.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

impl Error {
    /// The error with the file or folder that it concerns.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
        Self::InFile { path: path.to_owned(), source: Box::new(self) }
    }

    /// The message on a single line, for logs and JSON; decoders put line breaks into theirs.
    pub fn one_line(&self) -> String {
        self.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
    }
}
