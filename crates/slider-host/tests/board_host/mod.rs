//! A small host of the slider, written against the protocol only.
#![allow(dead_code, unreachable_pub, reason = "each test program uses only some of this")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a host that fails, fails the test")]

use std::io::{BufRead, BufReader, Read, Write};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use clap::Parser;
use serialport::SerialPort;
use slider_host::Error;
use slider_host::simulate::{self, Options};
use slider_proto::{ArmSettings, Command, Decoder, Edge, EndReason, MAX_FRAME, ProtoError, Report, encode};

#[derive(Parser)]
struct CommandLine {
    #[command(flatten)]
    options: Options,
}

/// The options that a command line gives.
pub fn options(arguments: &[&str]) -> Options {
    CommandLine::parse_from([&["slider"], arguments].concat()).options
}

/// Starts a virtual slider in a thread and returns the path of the timer's line.
pub fn start(arguments: &[&str]) -> (String, JoinHandle<Result<(), Error>>) {
    let (told, slider) = tell(arguments, 1);
    (told[0].strip_prefix("pty ").unwrap().to_owned(), slider)
}

/// Starts a virtual slider in a thread and returns the first lines that it tells.
pub fn tell(arguments: &[&str], lines: usize) -> (Vec<String>, JoinHandle<Result<(), Error>>) {
    let options = options(arguments);
    let (reader, mut writer) = std::io::pipe().unwrap();
    let slider = std::thread::spawn(move || simulate::run(&options, &mut writer));
    let told: Vec<_> = BufReader::new(reader).lines().take(lines).map(Result::unwrap).collect();
    assert_eq!(told.len(), lines, "{told:?}: {:?}", slider.join());
    (told, slider)
}

/// A run as it was told.
#[derive(Debug)]
pub struct Run {
    pub number: u16,
    pub edges: Vec<Edge>,
    pub late: u16,
    pub lost: u16,
    pub reason: EndReason,
}

pub struct Host {
    port: Box<dyn SerialPort>,
    decoder: Decoder<Report>,
    sequence: u8,
    /// What was told and not asked for yet.
    pub reports: Vec<Report>,
    pub errors: Vec<ProtoError>,
}

impl Host {
    pub fn open(path: &str) -> Self {
        let port = serialport::new(path, 57_600).timeout(Duration::from_millis(20)).open().unwrap();
        Self { port, decoder: Decoder::default(), sequence: 0, reports: Vec::new(), errors: Vec::new() }
    }

    fn listen(&mut self) {
        let mut bytes = [0; 256];
        // A timeout is no answer yet; a line that has gone away shows as none at all.
        let length = self.port.read(&mut bytes).unwrap_or(0);
        for byte in &bytes[..length] {
            match self.decoder.push(*byte) {
                None => {}
                Some(Ok(frame)) => self.reports.push(frame.message),
                Some(Err(error)) => self.errors.push(error),
            }
        }
    }

    /// Takes the first report that `is` what is awaited.
    pub fn wait(&mut self, is: impl Fn(&Report) -> bool) -> Report {
        let begun = Instant::now();
        loop {
            if let Some(at) = self.reports.iter().position(&is) {
                return self.reports.remove(at);
            }
            assert!(begun.elapsed() < Duration::from_secs(30), "not told: {:?} {:?}", self.reports, self.errors);
            self.listen();
        }
    }

    /// Sends a command and returns its answer.
    pub fn ask(&mut self, command: Command) -> Report {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let mut buffer = [0; MAX_FRAME];
        self.port.write_all(encode(&command, sequence, &mut buffer)).unwrap();
        self.wait(|report| match *report {
            Report::Ack { sequence: of } | Report::Nak { sequence: of, .. } => of == sequence,
            _ => false,
        })
    }

    pub fn order(&mut self, command: Command) {
        let answer = self.ask(command);
        assert!(matches!(answer, Report::Ack { .. }), "{command:?}: {answer:?}");
    }

    /// Arms the timer and collects a run.
    pub fn run(&mut self, settings: ArmSettings) -> Run {
        self.order(Command::Arm(settings));
        let end = self.wait(|report| matches!(report, Report::RunEnd { .. }));
        let Report::RunEnd { run, edges: count, late, lost, reason } = end else { unreachable!() };
        let mut edges = Vec::new();
        let mut started = None;
        self.reports.retain(|report| match report {
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
        assert_eq!(started, edges.first().map(|edge| edge.tick));
        assert_eq!(edges.len(), usize::from(count));
        Run { number: run, edges, late, lost, reason }
    }
}
