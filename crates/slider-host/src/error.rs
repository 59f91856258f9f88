//! What can go wrong.

use std::path::PathBuf;

use slider_proto::{Refusal, Unit, VERSION};

/// What stopped the host, with the numbers and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read or written.
    #[error("{path}: {source}", path = .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The description of an encoder sheet cannot be used.
    #[error("sheet: {0}")]
    Sheet(String),
    /// A line of a file of runs or points is wrong.
    #[error("{path}, line {line}: {why}", path = .path.display())]
    Log {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        why: String,
    },
    /// There is no such port.
    #[error("{port}: there is no such port: is the board plugged in? 'slider ports' lists the ports")]
    NoPort {
        /// The port.
        port: String,
    },
    /// The user may not open the port.
    #[error(
        "{port}: permission denied: become a member of the group that owns it ('sudo usermod -aG dialout $USER', or \
         uucp on some systems), then log in anew"
    )]
    Permission {
        /// The port.
        port: String,
    },
    /// Another program has the port.
    #[error("{port}: another program uses this port: close it (a serial monitor, another 'slider')")]
    Busy {
        /// The port.
        port: String,
    },
    /// The port cannot be opened for another reason.
    #[error("{port}: cannot be opened as a serial port: {why}")]
    Open {
        /// The port.
        port: String,
        /// What the system says.
        why: String,
    },
    /// Nothing came.
    #[error(
        "{port}: nothing received in {waited_s:.1} s: is the board on, and is this its port? 'slider ports' lists them"
    )]
    Silent {
        /// The port.
        port: String,
        /// How long was waited, s.
        waited_s: f64,
    },
    /// Something came, but no frame.
    #[error(
        "{port}: {bytes} bytes received and no frame among them: another baud rate than {baud} (--baud), or another \
         device"
    )]
    NoFrame {
        /// The port.
        port: String,
        /// Bytes received.
        bytes: u64,
        /// Baud rate of the port.
        baud: u32,
    },
    /// Frames of another version of the format came.
    #[error(
        "{port}: the board speaks version {found} of the format and this program version {VERSION}: {}",
        if *found > VERSION { "update this program" } else { "flash the board with the newer firmware" }
    )]
    FormatVersion {
        /// The port.
        port: String,
        /// Version of the board.
        found: u8,
    },
    /// The board is the other one.
    #[error("{port}: this is the {}, and the {} is needed: use its port", unit_name(*found), unit_name(*wanted))]
    WrongUnit {
        /// The port.
        port: String,
        /// The unit that answered.
        found: Unit,
        /// The unit that was expected.
        wanted: Unit,
    },
    /// The board talks but does not answer.
    #[error("{port}: the board sends frames but does not answer to {command}: reset it, and see its wire to the host")]
    NoAnswer {
        /// The port.
        port: String,
        /// What was asked.
        command: &'static str,
    },
    /// A command was refused.
    #[error("{port}: {command} was refused: {}", refusal(*.reason))]
    Refused {
        /// The port.
        port: String,
        /// What was asked.
        command: &'static str,
        /// Why not.
        reason: Refusal,
    },
    /// The board was reset while an answer was awaited.
    #[error("{port}: the board was reset in between ({})", crate::reader::reset_cause(*.cause))]
    Reset {
        /// The port.
        port: String,
        /// The cause, as in `Hello`.
        cause: u8,
    },
    /// The port was there and is not any more.
    #[error("{port}: the line went away ({why}): is the cable plugged in, and is the board on?")]
    LineLost {
        /// The port.
        port: String,
        /// What the system says.
        why: String,
    },
    /// The simulated slider cannot be what was asked for.
    #[error("simulation: {0}")]
    Simulation(String),
    /// The pseudo-terminal of the simulated slider could not be opened, or failed.
    #[error("pseudo-terminal: {0}")]
    PseudoTerminal(std::io::Error),
    /// The program that runs the firmware could not be found, could not be run or failed.
    #[error("firmware: {0}")]
    Firmware(String),
    /// The terminal cannot show the live view.
    #[error("terminal: {0}")]
    View(#[source] std::io::Error),
    /// A line of points cannot be read.
    #[error("points, line {line}: {reason}")]
    Points {
        /// The line, from 1.
        line: usize,
        /// Why.
        reason: String,
    },
    /// A run of which too few edges are left.
    #[error("{edges} usable edges, at least 3 are needed")]
    TooFewEdges {
        /// How many are left.
        edges: usize,
    },
    /// A run that does not begin with a tooth.
    #[error("the first edge leads to a slit: the run did not begin before the first tooth")]
    FirstEdge,
    /// The polynomial that was asked for is none of those that are offered.
    #[error("degree {degree}: 1 fits the speed, 2 the acceleration")]
    Degree {
        /// What was asked for.
        degree: u8,
    },
    /// An option of the fit is outside its range.
    #[error("{name} is {value}, expected {expected}")]
    Option {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range.
        expected: &'static str,
    },
    /// The points do not determine the polynomial, or a statistic cannot be evaluated.
    #[error("evaluation: {0}")]
    Evaluation(#[from] metrology::Error),
    /// Runs that cannot be pooled.
    #[error("runs: {0}")]
    Runs(String),
    /// A file of readings cannot be read.
    #[error("{name}:{line}:{column}: {what}")]
    Readings {
        /// The file.
        name: String,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What is wrong there.
        what: String,
    },
    /// The description of the instruments cannot be used.
    #[error("instruments: {0}")]
    Instruments(String),
    /// A calibration lacks something.
    #[error("{0}")]
    Calibration(String),
    /// The output cannot be written.
    #[error("cannot be written: {0}")]
    Write(#[source] std::io::Error),
    /// The user ended it.
    #[error("stopped")]
    Stopped,
}

/// The unit in words.
pub fn unit_name(unit: Unit) -> &'static str {
    match unit {
        Unit::Timer => "timer",
        Unit::Drive => "drive",
    }
}

/// The refusal in words, with what to do.
pub fn refusal(reason: Refusal) -> &'static str {
    match reason {
        Refusal::Garbled => "the board could not read the command; try again",
        Refusal::NotMine => "this board does not have that command; is it the right one?",
        Refusal::Busy => "a run or a self-test is going on; wait for its end or use 'slider stop'",
        Refusal::SensorBlocked => "the sensor is blocked; move the sheet out of it, or open jumper JP1",
        Refusal::NoSuchPreset => "there is no such preset; they are numbered 0 to 9",
        Refusal::AtLimit => "the carriage is at the limit switch; use a preset in reverse",
        Refusal::OutOfRange => "a value is out of range",
    }
}
