//! Pictures of known truth, on which methods are judged: [`pictures`] (sharp) → [`shots`] (blurred, recorded) →
//! [`statistics`] of the errors.

pub mod pictures;
pub mod shots;
pub mod statistics;
