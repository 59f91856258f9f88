//! What the slider's two microcontrollers and their host share: the frames on the serial line and every decision that
//! the firmware takes, as plain `no_std` code without allocation that is tested on any machine.
//!
//! The **timer** stamps every edge of a toothed sheet that passes a slotted optical sensor and fires the camera on the
//! first tooth. The **drive** moves the carriage at one of ten presets, chosen by an infra-red remote or by the host,
//! and stops it at the limit switch.
//!
//! # The frame
//!
//! A frame is a body in [COBS] followed by one zero byte, so a zero is always the end of a frame and never data:
//!
//! | byte | meaning |
//! |---|---|
//! | 0 | version of the format, [`VERSION`] |
//! | 1 | sequence number of the sender, one more in each frame, from 255 to 0 |
//! | 2 | kind of the message |
//! | 3.. | payload, at most [`MAX_PAYLOAD`] bytes |
//! | last 4 | CRC-32 (ISO-HDLC, the one of Ethernet and zip) of all bytes before it, low byte first |
//!
//! Integers are little-endian. [`Decoder`] reports everything that is not a frame and goes on with the next one.
//! A unit sends one zero byte and a [`Report::Hello`] with the sequence number 0 at reset.
//!
//! # The messages
//!
//! The host sends a [`Command`] and gets one [`Report::Ack`] or [`Report::Nak`] with its sequence number; what else
//! happens is told by further [`Report`]s when it happens. Payloads are tabulated there.
//!
//! # Time
//!
//! One tick is 0.5 us ([`TICK_HZ`]); the counter has 32 bits and wraps every 35 min 47 s. Times are compared by
//! [`ticks_between`], which is right across the wrap; [`Unwrapper`] gives a host 64 bits.
//!
//! # Path of the data
//!
//! [`clock`] extends the captured 16 bits, [`ring`] carries edges from the interrupt to the main loop, [`timer`]
//! decides what to send and when to fire, [`message`] and [`frame`] put it on the wire; [`section`] turns edges into
//! teeth and slits. For the drive [`remote`] reads the infra-red pulses, [`drive`] decides, [`display`] writes the text.
//!
//! # Fuzzing
//!
//! The decoder has a fuzz target in `fuzz`, which needs a nightly compiler and `cargo install cargo-fuzz`. In the folder
//! of this crate:
//!
//! ```sh
//! cargo +nightly fuzz run decoder -- -max_total_time=60 -max_len=512
//! ```
//!
//! What it checks is also run on seeded inputs by `tests/fuzz_seed.rs`.
//!
//! [COBS]: https://doi.org/10.1109/90.769765

#![no_std]

pub mod clock;
pub mod display;
pub mod drive;
pub mod frame;
pub mod message;
pub mod remote;
pub mod ring;
pub mod section;
pub mod timer;
mod wire;

pub use clock::{TICK_HZ, Unwrapper, ticks_between, ticks_from_ms};
pub use frame::{Decoder, Frame, MAX_FRAME, MAX_PAYLOAD, ProtoError, VERSION, encode};
pub use message::{
    ArmSettings, Command, Direction, DriveState, Edge, EdgeBatch, EndReason, Level, Message, Preset, Refusal, Report,
    TimerState, Unit,
};
