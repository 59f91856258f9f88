//! What the end-to-end tests and the accuracy tables share: the measured data and the programs.

pub mod data;
pub mod program;
