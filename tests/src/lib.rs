//! What the end-to-end tests and the accuracy tables share: the measured data, the protocol, its statistics.

pub mod data;
pub mod protocol;
pub mod statistics;
