use thiserror::Error;

/// What cannot be evaluated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The value is NaN or infinite.
    #[error("the value {value} is not a finite number")]
    ValueNotFinite {
        /// The offending value.
        value: f64,
    },
    /// The standard uncertainty is negative, NaN or infinite.
    #[error("the standard uncertainty {std} must be a finite number >= 0")]
    InvalidUncertainty {
        /// The offending standard uncertainty.
        std: f64,
    },
    /// A parameter is outside its range.
    #[error("{name} is {value}, expected {expected}")]
    Parameter {
        /// Which parameter.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// The range.
        expected: &'static str,
    },
    /// There are too few observations, degrees of freedom or trials to answer.
    #[error("{count} {what}, at least {least} are needed")]
    TooFew {
        /// What there is too little of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are needed.
        least: usize,
    },
    /// Two lists do not belong together.
    #[error("{found} {what}, expected {expected}")]
    Count {
        /// What was counted.
        what: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// There is no such input or output.
    #[error("index {index} of {count}")]
    Index {
        /// The offending index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A correlation matrix is not symmetric.
    #[error("the correlation of {row} with {column} is {upper}, that of {column} with {row} is {lower}")]
    NotSymmetric {
        /// Index of one input.
        row: usize,
        /// Index of the other input.
        column: usize,
        /// Coefficient above the diagonal.
        upper: f64,
        /// Coefficient below the diagonal.
        lower: f64,
    },
    /// A correlation matrix that no random variables can have.
    #[error("the correlation matrix is not positive semi-definite: {residual:e} remains of it")]
    NotPositiveSemidefinite {
        /// Largest element that no sum of squares explains.
        residual: f64,
    },
    /// Trials of correlated inputs are drawn for normal distributions only.
    #[error("input {index} is correlated and not normal: its joint distribution is unknown")]
    CorrelatedNotNormal {
        /// Index of the input.
        index: usize,
    },
    /// A quantile is too far out, or too near 0, for the numbers of the machine: few degrees of freedom have long tails.
    #[error("the quantile of {probability:e} with {dof:e} degrees of freedom is out of reach")]
    QuantileOutOfReach {
        /// Probability of the tail or below the quantile.
        probability: f64,
        /// Degrees of freedom.
        dof: f64,
    },
    /// The model gave NaN or infinity.
    #[error("the model gives {value}")]
    ModelNotFinite {
        /// What it gave.
        value: f64,
    },
    /// A text is not a value with its uncertainty in parentheses.
    #[error("'{text}' is not like 3.174(35) or 1.23(4)e-5")]
    Notation {
        /// The offending text.
        text: String,
    },
    /// An argument does not have a row for each point.
    #[error("{found} {what} for {expected} points")]
    Shape {
        /// What it is.
        what: &'static str,
        /// Points of the design matrix.
        expected: usize,
        /// Rows of the argument.
        found: usize,
    },
    /// There are fewer points than coefficients.
    #[error("{points} points cannot determine {coefficients} coefficients")]
    TooFewPoints {
        /// Points.
        points: usize,
        /// Coefficients.
        coefficients: usize,
    },
    /// A number is NaN or infinite.
    #[error("point {index}: a number among the {what} is not finite")]
    NotFinite {
        /// Where it is.
        what: &'static str,
        /// The point.
        index: usize,
    },
    /// A weight is not a finite number above 0.
    #[error("point {index}: the weight {weight} must be a finite number above 0")]
    Weight {
        /// The point.
        index: usize,
        /// Its weight.
        weight: f64,
    },
    /// A column of the design matrix depends on the others.
    #[error("column {column} of the design matrix depends on the others")]
    RankDeficient {
        /// The column, from 0.
        column: usize,
    },
    /// The matrix is not a covariance: not symmetric, not finite, or with a negative variance in some direction.
    #[error("row {row}: the covariance matrix is not symmetric and positive semi-definite")]
    Covariance {
        /// A row where it shows.
        row: usize,
    },
    /// Data without uncertainty contradict each other.
    #[error("condition {condition} of the exactly known data contradicts the others")]
    Contradiction {
        /// Number of the condition, from 0.
        condition: usize,
    },
}

/// `value` if `holds`, else an [`Error::Parameter`].
pub(crate) fn check(holds: bool, name: &'static str, value: f64, expected: &'static str) -> Result<f64, Error> {
    if holds { Ok(value) } else { Err(Error::Parameter { name, value, expected }) }
}

/// A probability strictly between 0 and 1.
pub(crate) fn probability(value: f64) -> Result<f64, Error> {
    check(value > 0.0 && value < 1.0, "probability", value, "between 0 and 1, both excluded")
}

/// Degrees of freedom: positive, perhaps infinite.
pub(crate) fn degrees_of_freedom(value: f64) -> Result<f64, Error> {
    check(value > 0.0, "degrees of freedom", value, "greater than 0 (infinite is allowed)")
}
