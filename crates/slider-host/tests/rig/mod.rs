//! A board at the other end of a real pseudo-terminal, with a thread that plays it.

use std::collections::VecDeque;
use std::fs;
use std::io::{Read, Write};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use slider_proto::drive::{self, DriveUnit};
use slider_proto::timer::{self, TimerUnit};
use slider_proto::{Command, Decoder, Direction, Edge, Level, MAX_FRAME, Report, encode};

/// What is at the other end.
#[derive(Debug, Clone, Copy)]
pub enum Play {
    /// The timer; each time it is armed, a sheet of so many edges passes.
    Timer { edges: u32 },
    /// The timer, whose cable is pulled when so many edges of its run number so much have been sent.
    Pulled { edges: u32, after: u16, run: u16 },
    /// The timer, which is reset when so many edges of its first run have been sent.
    Reset { edges: u32, after: u16 },
    /// The drive.
    Drive,
    /// Something that says nothing.
    Silent,
    /// Something that sends bytes that are no frames.
    Noise,
    /// A board whose frames have this version of the format.
    Version(u8),
    /// A timer with this firmware.
    Firmware([u8; 3]),
    /// A board that sends status after status, but does not hear.
    Deaf,
}

/// A folder that is gone with the value, and in it `port`, which leads to the terminal.
pub struct Rig {
    folder: PathBuf,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    /// Edges of the runs, in the order in which they passed.
    pub passed: Arc<Mutex<Vec<Vec<Edge>>>>,
    /// Commands that came.
    pub heard: Arc<Mutex<Vec<Command>>>,
}

/// Held while a terminal is opened or a program started: until they are duplicated below, the ends of a terminal would be
/// inherited by that program, and a cable that another process holds cannot be pulled.
pub static INHERITED: Mutex<()> = Mutex::new(());

/// Both ends of a terminal, for this process alone, and its name.
fn pair() -> (TTYPort, TTYPort, String) {
    let _held = INHERITED.lock();
    let (master, slave) = TTYPort::pair().unwrap();
    (master.try_clone_native().unwrap(), slave.try_clone_native().unwrap(), slave.name().unwrap())
}

/// A command that has not come by then does not come.
const PATIENCE: Duration = Duration::from_secs(10);

static FOLDERS: AtomicU32 = AtomicU32::new(0);

/// A new folder for a test.
pub fn folder() -> PathBuf {
    let number = FOLDERS.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("slider-host-{}-{number}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

impl Rig {
    pub fn new(play: Play) -> Self {
        let mut rig = Self {
            folder: folder(),
            stop: Arc::default(),
            thread: None,
            passed: Arc::default(),
            heard: Arc::default(),
        };
        rig.plug(play);
        rig
    }

    /// Waits until `command` is the last that came: what a program has written is read when it has ended, or later.
    pub fn hears_at_last(&self, command: Command) {
        let start = Instant::now();
        while self.heard.lock().unwrap().last() != Some(&command) {
            assert!(start.elapsed() < PATIENCE, "{:?}", self.heard.lock().unwrap());
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Plugs a board in where the last one was, which has to be gone.
    pub fn plug(&mut self, play: Play) {
        let (mut master, slave, name) = pair();
        master.set_timeout(Duration::from_millis(2)).unwrap();
        let new = self.folder.join("new");
        symlink(name, &new).unwrap();
        fs::rename(&new, self.folder.join("port")).unwrap();
        let (stop, passed, heard) = (self.stop.clone(), self.passed.clone(), self.heard.clone());
        let port = self.folder.join("port");
        self.thread = Some(thread::spawn(move || {
            let mut board = Board { master, stop, passed, heard, sequence: 0, version: slider_proto::VERSION };
            board.play(play);
            // First the name goes, so that nobody opens a terminal that another test has by then.
            drop(fs::remove_file(port));
            drop((board, slave));
        }));
    }

    /// What the host opens.
    pub fn port(&self) -> String {
        self.folder.join("port").to_str().unwrap().to_owned()
    }

    /// A folder for files.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Waits for the cable to be pulled.
    pub fn wait(&mut self) {
        self.thread.take().unwrap().join().unwrap();
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Time of the board in ticks, near the wrap of its counter.
fn now(begun: Instant) -> u32 {
    (u32::MAX - 1_000_000).wrapping_add((begun.elapsed().as_nanos() / 500) as u32)
}

#[derive(Default)]
struct Sensor {
    waiting: VecDeque<Edge>,
    arms: u32,
}

impl timer::Port for Sensor {
    fn arm(&mut self) -> Level {
        self.arms += 1;
        Level::High
    }
    fn start_self_test(&mut self) {
        let level = |i: u32| if i.is_multiple_of(2) { Level::High } else { Level::Low };
        let edge = |i| Edge { tick: i * timer::REFERENCE_TICKS, level: level(i), late: false };
        self.waiting = (0..26).map(edge).collect();
    }
    fn stop_capture(&mut self) {}
    fn next_edge(&mut self) -> Option<Edge> {
        self.waiting.pop_front()
    }
    fn waiting(&self) -> u8 {
        self.waiting.len() as u8
    }
    fn lost(&self) -> u16 {
        0
    }
    fn release_trigger(&mut self) {}
    fn sensor(&self) -> Level {
        Level::High
    }
    fn limit(&self) -> bool {
        false
    }
}

struct Motor;

impl drive::Port for Motor {
    fn drive(&mut self, _: Direction, _: u8) {}
    fn release(&mut self, _: bool) {}
    fn limit(&self) -> bool {
        false
    }
}

struct Board {
    master: TTYPort,
    stop: Arc<AtomicBool>,
    passed: Arc<Mutex<Vec<Vec<Edge>>>>,
    heard: Arc<Mutex<Vec<Command>>>,
    sequence: u8,
    version: u8,
}

impl Board {
    fn play(&mut self, play: Play) {
        match play {
            Play::Timer { edges } => self.timer([0, 1, 0], edges, |_| None),
            Play::Firmware(firmware) => self.timer(firmware, 4, |_| None),
            Play::Version(version) => {
                self.version = version;
                self.timer([0, 1, 0], 4, |_| None);
            }
            Play::Pulled { edges, after, run } => self.timer([0, 1, 0], edges, move |report| match report {
                Report::Edges(batch) if batch.run == run && reached(batch, after) => Some(Accident::Pulled),
                _ => None,
            }),
            Play::Reset { edges, after } => self.timer([0, 1, 0], edges, move |report| match report {
                Report::Edges(batch) if batch.run == 1 && reached(batch, after) => Some(Accident::Reset),
                _ => None,
            }),
            Play::Drive => self.drive(),
            Play::Silent => {
                while !self.stopped() {
                    self.hear(&mut Decoder::default());
                }
            }
            Play::Noise => {
                let mut value = 1_u32;
                while !self.stopped() {
                    value = value.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let _ = self.master.write_all(&value.to_be_bytes());
                    self.hear(&mut Decoder::default());
                }
            }
            Play::Deaf => {
                while !self.stopped() {
                    self.send(&Report::LimitHit { tick: 1 });
                    self.hear(&mut Decoder::default());
                }
            }
        }
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Frames that came within some milliseconds.
    fn hear(
        &mut self,
        decoder: &mut Decoder<Command>,
    ) -> Vec<Result<slider_proto::Frame<Command>, slider_proto::ProtoError>> {
        let mut bytes = [0; 256];
        let count = self.master.read(&mut bytes).unwrap_or_default();
        let frames: Vec<_> = bytes[..count].iter().filter_map(|&byte| decoder.push(byte)).collect();
        self.heard.lock().unwrap().extend(frames.iter().flatten().map(|frame| frame.message));
        frames
    }

    fn send(&mut self, report: &Report) {
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(report, self.sequence, &mut buffer).to_vec();
        self.sequence = self.sequence.wrapping_add(1);
        let frame = if self.version == slider_proto::VERSION { frame } else { with_version(&frame, self.version) };
        let _ = self.master.write_all(&frame);
    }

    fn timer(&mut self, firmware: [u8; 3], edges: u32, accident: impl Fn(&Report) -> Option<Accident>) {
        let begun = Instant::now();
        let mut unit = TimerUnit::new(firmware, 2);
        let mut sensor = Sensor::default();
        let mut decoder = Decoder::default();
        let (mut arms, mut coming) = (0, VecDeque::new());
        let mut accidents = 0;
        let _ = self.master.write_all(&[0]);
        while !self.stopped() {
            for frame in self.hear(&mut decoder) {
                let answer = unit.command(frame, now(begun), &mut sensor);
                self.send(&answer);
            }
            if std::mem::replace(&mut arms, sensor.arms) != sensor.arms {
                let first = now(begun).wrapping_add(40_000);
                let level = |i: u32| if i.is_multiple_of(2) { Level::Low } else { Level::High };
                let edge = |i| Edge { tick: first.wrapping_add(4000 * i), level: level(i), late: i == 5 };
                coming = (0..edges).map(edge).collect();
                self.passed.lock().unwrap().push(coming.iter().copied().collect());
            }
            while let Some(edge) = coming.front().copied() {
                if now(begun).wrapping_sub(edge.tick) > u32::MAX / 2 {
                    break;
                }
                sensor.waiting.extend(coming.pop_front());
            }
            unit.step(now(begun), &mut sensor);
            while let Some(report) = unit.report(now(begun), &mut sensor) {
                self.send(&report);
                match accident(&report).filter(|_| accidents == 0) {
                    None => {}
                    Some(Accident::Pulled) => {
                        // What is sent arrives; then the terminal goes.
                        thread::sleep(Duration::from_millis(500));
                        return;
                    }
                    Some(Accident::Reset) => {
                        accidents += 1;
                        let _ = self.master.write_all(&[3, 0]);
                        self.sequence = 0;
                        unit = TimerUnit::new(firmware, 4);
                        (sensor, decoder, arms) = (Sensor::default(), Decoder::default(), 0);
                        coming.clear();
                    }
                }
                unit.step(now(begun), &mut sensor);
            }
        }
    }

    fn drive(&mut self) {
        let begun = Instant::now();
        let mut unit = DriveUnit::new([0, 1, 0], 2);
        let mut decoder = Decoder::default();
        let _ = self.master.write_all(&[0]);
        while !self.stopped() {
            for frame in self.hear(&mut decoder) {
                let answer = unit.command(frame, now(begun), &mut Motor);
                self.send(&answer);
            }
            unit.step(now(begun), &mut Motor);
            while let Some(report) = unit.report(&Motor) {
                self.send(&report);
            }
        }
    }
}

enum Accident {
    Pulled,
    Reset,
}

fn reached(batch: &slider_proto::EdgeBatch, after: u16) -> bool {
    usize::from(batch.first_index) + batch.edges().len() >= usize::from(after)
}

/// The same frame with another version of the format, its checksum right.
fn with_version(frame: &[u8], version: u8) -> Vec<u8> {
    let mut body = Vec::new();
    let mut rest = &frame[..frame.len() - 1];
    while let Some((&length, after)) = rest.split_first() {
        let (group, left) = after.split_at(usize::from(length) - 1);
        body.extend_from_slice(group);
        if !left.is_empty() {
            body.push(0);
        }
        rest = left;
    }
    body.truncate(body.len() - 4);
    body[0] = version;
    let crc = body.iter().fold(!0, |crc: u32, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
    });
    body.extend((!crc).to_le_bytes());
    let mut frame: Vec<u8> =
        body.split(|&byte| byte == 0).flat_map(|group| [&[group.len() as u8 + 1], group].concat()).collect();
    frame.push(0);
    frame
}
