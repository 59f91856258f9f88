//! A board that runs its real firmware, spoken to in frames.

// Each test program uses only some of this.
#![allow(dead_code, unreachable_pub, clippy::expect_used, clippy::panic)]

use std::env;
use std::path::PathBuf;

use slider_proto::{ArmSettings, Command, Decoder, Edge, EndReason, MAX_FRAME, ProtoError, Report, encode};
use slider_sim::lcd::{Lcd, LcdPins};
use slider_sim::{Mcu, Pin};

pub const CYCLES_PER_MS: u64 = slider_sim::CYCLES_PER_SECOND / 1000;
/// Cycles of one tick of the timer.
pub const CYCLES_PER_TICK: u64 = 8;

/// The built firmware.
pub fn elf(program: &str) -> PathBuf {
    let target = env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target"), PathBuf::from);
    let elf = target.join("avr-none/release").join(format!("{program}.elf"));
    assert!(elf.exists(), "{} is not built: cargo xtask firmware", elf.display());
    elf
}

/// A run as the timer told it.
#[derive(Debug)]
pub struct Run {
    pub number: u16,
    pub edges: Vec<Edge>,
    pub late: u16,
    pub lost: u16,
    pub reason: EndReason,
}

/// A board and what it has said.
pub struct Board {
    pub mcu: Mcu,
    decoder: Decoder<Report>,
    sequence: u8,
    /// Reports with the cycle at which their last byte had come.
    pub reports: Vec<(u64, Report)>,
    pub errors: Vec<ProtoError>,
    display: Lcd,
}

const DISPLAY: LcdPins = LcdPins { rs: Pin::D4, e: Pin::D5, d: [Pin::D6, Pin::D7, Pin::D8, Pin::D9] };

impl Board {
    /// The timer just after reset, with its sensor and its end of travel open.
    pub fn timer() -> Self {
        let mut board = Self::load("timer");
        for pin in [Pin::D9, Pin::D13] {
            board.mcu.watch(pin);
        }
        board.mcu.set(Pin::D8, true);
        board.mcu.set(Pin::D2, true);
        board
    }

    /// The drive just after reset, with its limit switch closed and no light on its receiver.
    pub fn drive() -> Self {
        let mut board = Self::load("drive");
        board.display.watch(&mut board.mcu);
        for pin in [Pin::D11, Pin::D13, Pin::A0, Pin::A1] {
            board.mcu.watch(pin);
        }
        board.mcu.set(Pin::D2, false);
        board.mcu.set(Pin::D3, true);
        board
    }

    fn load(program: &str) -> Self {
        let mcu = Mcu::load(&elf(program)).expect("the firmware");
        Self {
            mcu,
            decoder: Decoder::default(),
            sequence: 0,
            reports: Vec::new(),
            errors: Vec::new(),
            display: Lcd::new(DISPLAY),
        }
    }

    pub fn run_ms(&mut self, ms: u64) {
        self.run_until(self.mcu.cycle() + ms * CYCLES_PER_MS);
    }

    pub fn run_until(&mut self, cycle: u64) {
        self.mcu.run_until(cycle).expect("the firmware runs");
        self.listen();
    }

    fn listen(&mut self) {
        for sent in self.mcu.take_sent() {
            match self.decoder.push(sent.byte) {
                None => {}
                Some(Ok(frame)) => {
                    let restarted = matches!(frame.message, Report::Hello { .. });
                    assert!(frame.lost == 0 || restarted, "the line of the simulator loses nothing");
                    self.reports.push((sent.cycle, frame.message));
                }
                Some(Err(error)) => self.errors.push(error),
            }
        }
    }

    /// Sends a command and runs until it is answered; returns the answer.
    pub fn ask(&mut self, command: Command) -> Report {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let mut buffer = [0; MAX_FRAME];
        self.mcu.send(encode(&command, sequence, &mut buffer));
        let answer = |report: &Report| match *report {
            Report::Ack { sequence: of } | Report::Nak { sequence: of, .. } => of == sequence,
            _ => false,
        };
        self.wait(answer, 200)
    }

    /// Sends a command that has to be accepted.
    pub fn order(&mut self, command: Command) {
        let answer = self.ask(command);
        assert!(matches!(answer, Report::Ack { .. }), "{command:?}: {answer:?}");
    }

    /// Runs until a report `is` there, from now on, takes it out of the list and returns it.
    pub fn wait(&mut self, is: impl Fn(&Report) -> bool, ms: u64) -> Report {
        let end = self.mcu.cycle() + ms * CYCLES_PER_MS;
        loop {
            if let Some(at) = self.reports.iter().position(|(_, report)| is(report)) {
                return self.reports.remove(at).1;
            }
            assert!(self.mcu.cycle() < end, "no such report within {ms} ms; there are {:?}", self.reports);
            self.run_until(self.mcu.cycle() + CYCLES_PER_MS / 4);
        }
    }

    /// Arms the timer.
    pub fn arm(&mut self, run: u16, trigger_ms: u16, quiet_ms: u16) {
        self.order(Command::Arm(ArmSettings { run, trigger_ms, quiet_ms }));
    }

    /// Plays edges into the armed timer and collects the run.
    pub fn pass(&mut self, wave: &[(u64, bool)]) -> Run {
        self.mcu.play(Pin::D8, wave.iter().copied());
        let last = wave.last().expect("edges").0;
        // A run may end before its edges do.
        while self.mcu.cycle() < last && !self.reports.iter().any(|(_, report)| matches!(report, Report::RunEnd { .. }))
        {
            self.run_until(last.min(self.mcu.cycle() + CYCLES_PER_MS));
        }
        let end = self.wait(|report| matches!(report, Report::RunEnd { .. }), 3000);
        let Report::RunEnd { run, edges: count, late, lost, reason } = end else { unreachable!() };
        let mut edges = Vec::new();
        let mut started = None;
        self.reports.retain(|(_, report)| match report {
            Report::RunStart { run: of, tick } => {
                assert_eq!(*of, run);
                started = Some(*tick);
                false
            }
            Report::Edges(batch) => {
                assert_eq!((batch.run, usize::from(batch.first_index)), (run, edges.len()), "no gap");
                edges.extend_from_slice(batch.edges());
                false
            }
            _ => true,
        });
        assert_eq!(started, edges.first().map(|edge| edge.tick), "the first edge");
        assert_eq!(edges.len(), usize::from(count), "edges told and sent");
        assert!(self.errors.is_empty(), "{:?}", self.errors);
        Run { number: run, edges, late, lost, reason }
    }

    /// Both rows of the display, without the blanks at their ends.
    pub fn lcd(&mut self) -> [String; 2] {
        self.display.follow(&self.mcu);
        [0, 1].map(|row| self.display.text(row).trim_end().to_owned())
    }

    /// The display has been given all the time that its data sheet asks for.
    pub fn check_lcd(&mut self) {
        self.display.follow(&self.mcu);
        assert!(self.display.violations().is_empty(), "{:?}", self.display.violations());
    }

    /// The stack has stayed clear of the variables.
    pub fn check_stack(&self) {
        let used = self.mcu.stack_high_water();
        assert!(used > 0 && used < 1000, "{used} bytes of stack");
    }
}
