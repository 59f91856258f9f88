//! Runs on disk: every edge as it was received, before anything is computed.
//!
//! One file a run, of JSON objects on a line each (JSON Lines), which only ever grows:
//!
//! ```json
//! {"header":{"format":"slider-run","version":1,"program":"0.1.0","port":"/dev/ttyUSB0","unit":"timer","firmware":"0.1.0","tick_hz":2000000,"started_s":1790000000.25,"sheet":"encoder 5","run":3,"tick":100}}
//! {"edges":{"first":0,"tick":[100,9240],"level":[0,1],"late":[0,0]}}
//! {"end":{"reason":"quiet","edges":2,"late":0,"lost":0}}
//! {"result":{}}
//! ```
//!
//! - `header`: who received what. `started_s` is the time of day in seconds since 1970-01-01 UTC, from the computer's
//!   clock; `sheet` is left out when none was given; `tick` is that of the first edge as the start of the run told it.
//! - `edges`: each batch when it came. `first` is the index of its first edge, `tick` raw ticks modulo 2^32, `level` the
//!   level after the edge (0: a tooth begins, 1: it ends), `late` as in [`slider_proto::Edge`].
//! - `end`, what the timer told, or `incomplete` with the `reason` why that is missing and the number of `edges`.
//! - `result`: what was computed of it, later; nothing that is needed to compute it anew.
//!
//! A line is handed to the system in one piece when it is complete, and the file is synchronised with the disk at least
//! every second and at the end of the run. If the power fails, the last line may be torn: [`load`] leaves it out. Files may
//! be joined. A file of every version stays readable.

mod line;
mod load;
mod name;
mod recorder;
mod write;

pub use line::{Header, reason_word};
pub use load::{Logged, load, parse, read};
pub use name::file_name;
pub use recorder::{Recorder, Saved, Source};
pub use write::Log;

/// Version of the format that is written.
pub const VERSION: u32 = 1;
