//! The one error type of the crate.

use thiserror::Error;

use crate::homomorphic::Variant;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// What can be wrong with data or a model. Every variant carries the offending numbers.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A number in the data is NaN or infinite.
    #[error("{what} at row {row}, column {column} is {value}; every one must be a finite number")]
    NotFinite {
        /// What the number is.
        what: &'static str,
        /// Row.
        row: usize,
        /// Column.
        column: usize,
        /// The value.
        value: f64,
    },
    /// The data hold too few observations.
    #[error("{found} observations are too few: {needed} are needed {purpose}")]
    TooFew {
        /// Observations given.
        found: usize,
        /// Least number.
        needed: usize,
        /// What for.
        purpose: &'static str,
    },
    /// Two things that belong together differ in size.
    #[error("{what}: {found} given, {expected} expected")]
    Size {
        /// What is counted.
        what: &'static str,
        /// Found.
        found: usize,
        /// Expected.
        expected: usize,
    },
    /// A parameter is out of its range.
    #[error("{name} = {value} is not allowed: it must be {expected}")]
    Parameter {
        /// What the parameter is, with its unit.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// What would be allowed.
        expected: &'static str,
    },
    /// A decomposition or an optimisation did not come to an end.
    #[error("{what} did not converge on {rows} observations of {columns} numbers")]
    Convergence {
        /// What was computed.
        what: &'static str,
        /// Observations.
        rows: usize,
        /// Numbers in each.
        columns: usize,
    },
    /// No regression of this name exists.
    #[error("there is no regression called '{name}'; known: {known}")]
    UnknownRegression {
        /// The name asked for.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// The solver of the support vector machines refuses its settings.
    #[error("the support vector machine cannot be fitted: {0}")]
    SupportVectorMachine(#[from] linfa_svm::SvmError),
    /// A function of linfa that was called with one of these regressions failed.
    #[error("linfa: {0}")]
    Linfa(#[from] linfa::Error),
    /// A statistical function was asked for what it does not have.
    #[error(transparent)]
    Metrology(#[from] metrology::Error),
    /// The picture is refused.
    #[error(transparent)]
    Picture(#[from] blur_core::Error),
    /// A picture has another size than those it belongs with.
    #[error("the picture is {width}x{height} pixels; {expected_width}x{expected_height} are expected")]
    PictureSize {
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Columns expected.
        expected_width: usize,
        /// Rows expected.
        expected_height: usize,
    },
    /// A background is refused.
    #[error("background {number}: {source}")]
    Background {
        /// Its number, from 1.
        number: usize,
        /// Why.
        source: Box<Error>,
    },
    /// The spectra of backgrounds and pictures were made with different transforms.
    #[error("the backgrounds were transformed by {found:?}, the picture is to be by {expected:?}; use one for both")]
    OtherVariant {
        /// The backgrounds' transform.
        found: Variant,
        /// The picture's.
        expected: Variant,
    },
    /// Backgrounds and picture have nothing in common along the rows.
    #[error("the backgrounds carry no signal across the motion; take backgrounds and picture of a scene with texture")]
    NoCommonSignal,
    /// A picture is unlike those that a model was trained on.
    #[error(
        "the picture is unlike those the model was trained on (distance {distance:.2}, at most 1), which show accelerations of {accel_min_m_s2:.3} to {accel_max_m_s2:.3} m/s²: take it as they were taken, or train on such pictures"
    )]
    OutsideTraining {
        /// Distance in units of the largest that is accepted.
        distance: f64,
        /// Least acceleration of the training.
        accel_min_m_s2: f64,
        /// Greatest acceleration of the training.
        accel_max_m_s2: f64,
    },
    /// The content of a file is no model.
    #[error("not a model: 'accel train' writes models")]
    NotAModel,
    /// The file of a model ends too early.
    #[error("the model is cut short after {bytes} bytes: copy the file again or train anew")]
    ModelCutShort {
        /// Bytes there are.
        bytes: usize,
    },
    /// The file of a model was written by a later program.
    #[error("the model is of version {version}, and versions up to {known} can be read here: get {program}")]
    NewerModel {
        /// Version of the file.
        version: u64,
        /// Latest version that can be read.
        known: u64,
        /// What to get.
        program: String,
    },
    /// The file of a model is not what was written.
    #[error("the model is damaged ({reason}): copy the file again or train anew")]
    ModelDamaged {
        /// What is wrong.
        reason: String,
    },
    /// The content of a model makes no sense.
    #[error("the content of the model is not valid ({0}): train anew")]
    ModelContent(#[source] serde_json::Error),
}

/// Refuses two sizes that must be one.
pub(crate) fn check_size(what: &'static str, found: usize, expected: usize) -> Result<()> {
    if found == expected { Ok(()) } else { Err(Error::Size { what, found, expected }) }
}
