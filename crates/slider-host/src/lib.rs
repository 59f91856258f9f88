//! The host of the slider: from the frames of its encoder timer to speed and acceleration with their uncertainties.
//!
//! # Path of the data
//!
//! ```text
//! port -> reader -> log -> run -> points (with the sheet) -> fit -> outcome -> live, report
//! ```
//!
//! [`port`] opens a serial line and says in one line what is wrong with it; [`reader`] makes runs of its bytes;
//! [`log`] keeps every received edge on disk before anything is computed; [`sheet`] knows where the edges of the toothed
//! sheet are, and how well; [`points`] puts both together; [`fit`] fits x(t); [`outcome`] is what a user gets.
//! [`calibrate`] makes sheets and budgets, [`simulate`] is a slider without hardware.
//!
//! # Conventions
//!
//! SI units, which stand in the names of fields. Position grows in the direction of travel from the first edge of the
//! sheet, where x = 0 and t = 0. `std` is a standard uncertainty.

mod axis;
pub mod calibrate;
pub mod error;
pub mod fit;
pub mod live;
pub mod log;
pub mod outcome;
pub mod points;
pub mod port;
pub mod reader;
pub mod report;
pub mod run;
pub mod sheet;
pub mod simulate;
pub mod text;

pub use error::Error;
