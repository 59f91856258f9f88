//! Pictures of known truth, on which methods are judged: [`pictures`] (sharp) → [`shots`] (blurred, recorded) →
//! [`statistics`] of the errors, beside what can be known at all ([`cramer_rao`]).

pub mod cramer_rao;
pub mod pictures;
pub mod shots;
pub mod statistics;
