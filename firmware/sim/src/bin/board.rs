//! Runs a firmware on the simulated Nano and offers its serial port as a pseudo-terminal, for programs of the host that
//! expect a board.

use clap::Parser;
use slider_sim::{
    CYCLES_PER_SECOND, Mcu, Pin, SimError,
    encoder::{Encoder, Motion, edges},
    pty::Pty,
    wave::{self, Player, Start},
};
use std::{
    io::{Read, Write},
    path::PathBuf,
    process::ExitCode,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

/// Simulated time between two looks at the line, cycles: 1 ms.
const SLICE: u64 = CYCLES_PER_SECOND / 1000;
/// Simulated time for which `--fast` goes on after the last byte or edge, cycles: 0.2 s.
const LINGER: u64 = CYCLES_PER_SECOND / 5;
/// How far the simulation may fall behind the clock before it gives the lost time up.
const PATIENCE: Duration = Duration::from_millis(200);
/// Time from pass to pass of the built-in encoder, cycles: 5 s.
const USUALLY_EVERY: u64 = 5 * CYCLES_PER_SECOND;
/// How long the line is held open at the end for a host that has not read everything.
const LAST_WORDS: Duration = Duration::from_secs(5);
/// How long nothing has to be unread until everything counts as read: the system takes its time to hand bytes over, and
/// until then they show nowhere.
const SETTLED: Duration = Duration::from_millis(300);

/// Run a firmware (ELF for the ATmega328P) on a simulated Arduino Nano with its serial port as a pseudo-terminal.
///
/// The first line of output is "pty PATH"; whatever opens PATH talks to the board. Without --speed, --accel and --wave
/// the rig does nothing but hold the encoder's pin high.
///
/// The file of --wave has a line "cycle level" for each change of the encoder's pin: cycles of 62.5 ns from the arming,
/// 32000 (2 ms) or more, in rising order, and 0 for a tooth or 1 for a slit; the pin is high before. A blank line ends a
/// pass, and a line that begins with # is a comment. Each arming plays one pass, in turn, and the first one again after
/// the last; a firmware that is disarmed before the first edge calls it off.
///
/// Exit status: 0 after --for, --runs or --until-eof, 1 when the firmware crashed, the line failed or the waveform
/// cannot be used, 2 for wrong arguments.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// The firmware.
    elf: PathBuf,
    /// One second of the board is one second of the clock; this is the default.
    #[arg(long, conflicts_with = "fast")]
    real_time: bool,
    /// As fast as it goes while bytes pass either way, an encoder passes or --wave is armed, and 0.2 s of simulated time longer; in real
    /// time otherwise, so that a board that nobody talks to does not run away from its host.
    #[arg(long)]
    fast: bool,
    /// Encoder passes at this speed, m/s; with --accel, the speed at the first edge.
    #[arg(long, value_parser = not_negative)]
    speed: Option<f64>,
    /// Encoder passes with this acceleration, m/s².
    #[arg(long, value_parser = not_negative)]
    accel: Option<f64>,
    /// Encoder passes exactly as in this file, each time that the firmware is armed, that is, raises D13.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["speed", "accel"])]
    wave: Option<PathBuf>,
    /// End after so many passes of --wave, when D13 is low again.
    #[arg(long, value_name = "N", requires = "wave")]
    runs: Option<usize>,
    /// Simulated time from pass to pass, and before the first: "5s", "200ms"; 5s if not given. With it --wave does not
    /// wait for D13.
    #[arg(long, value_parser = time)]
    every: Option<u64>,
    /// The encoder's pin.
    #[arg(long, default_value = "D8", value_parser = pin)]
    pin: Pin,
    /// Mean width of the encoder's 13 teeth and 12 slits, mm; each is between half and one and a half times as wide.
    #[arg(long, default_value_t = 2.0, value_parser = not_negative)]
    tooth_mm: f64,
    /// Level of an input pin that nothing else drives: "D2=0". May be repeated.
    #[arg(long, value_name = "PIN=LEVEL", value_parser = level)]
    level: Vec<(Pin, bool)>,
    /// A wire from an output to an input: "D5:D8". May be repeated.
    #[arg(long, value_name = "FROM:TO", value_parser = wire)]
    wire: Vec<(Pin, Pin)>,
    /// Which encoder.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// End after this simulated time.
    #[arg(long = "for", value_parser = time)]
    duration: Option<u64>,
    /// End when standard input does, so that the board does not outlive the program that started it.
    #[arg(long)]
    until_eof: bool,
}

fn not_negative(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if number.is_finite() && number >= 0.0 { Ok(number) } else { Err("must be 0 or more".into()) }
}

/// Cycles of a time with its unit, seconds without one.
fn time(text: &str) -> Result<u64, String> {
    let (number, unit) = match (text.strip_suffix("ms"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 1e-3),
        (_, Some(number)) => (number, 1.0),
        _ => (text, 1.0),
    };
    let seconds = not_negative(number)? * unit;
    if seconds < 1e-3 {
        return Err("must be 1ms or more".into());
    }
    Ok((seconds * CYCLES_PER_SECOND as f64) as u64)
}

fn pin(text: &str) -> Result<Pin, String> {
    let found = Pin::ALL.into_iter().find(|pin| format!("{pin:?}").eq_ignore_ascii_case(text));
    found.ok_or_else(|| "no such pin: D0 to D13, A0 to A5".into())
}

fn level(text: &str) -> Result<(Pin, bool), String> {
    match text.split_once('=') {
        Some((name, "0")) => Ok((pin(name)?, false)),
        Some((name, "1")) => Ok((pin(name)?, true)),
        _ => Err("must be a pin and 0 or 1: D2=0".into()),
    }
}

fn wire(text: &str) -> Result<(Pin, Pin), String> {
    let (from, to) = text.split_once(':').ok_or("must be two pins: D5:D8")?;
    Ok((pin(from)?, pin(to)?))
}

/// What passes the light barrier.
struct Rig {
    encoder: Encoder,
    motion: Option<Motion>,
    pin: Pin,
    every: u64,
    next: u64,
}

impl Rig {
    fn new(arguments: &Arguments) -> Self {
        let motion = match (arguments.speed, arguments.accel) {
            (None, None) => None,
            (Some(speed_m_s), None) => Some(Motion::Constant { speed_m_s }),
            (speed, Some(acceleration_m_s2)) => {
                Some(Motion::Accelerated { start_m_s: speed.unwrap_or(0.0), acceleration_m_s2 })
            }
        };
        let encoder = Encoder::uneven(13, arguments.tooth_mm / 1000.0, arguments.seed);
        let every = arguments.every.unwrap_or(USUALLY_EVERY);
        Self { encoder, motion, pin: arguments.pin, every, next: every }
    }

    /// Starts a pass when it is time; one that takes longer than that is let through first.
    fn act(&mut self, mcu: &mut Mcu) {
        let Some(motion) = self.motion else { return };
        if mcu.cycle() + SLICE >= self.next && !mcu.is_playing(self.pin) {
            let start = self.next.max(mcu.cycle());
            mcu.play(self.pin, edges(&self.encoder, &motion, start, CYCLES_PER_SECOND as f64));
            self.next = start + self.every;
        }
    }
}

/// Keeps the simulation from running ahead of the clock.
struct Pace {
    begun: Instant,
    at: u64,
}

impl Pace {
    fn from(cycle: u64) -> Self {
        Self { begun: Instant::now(), at: cycle }
    }

    fn wait(&mut self, cycle: u64) {
        let due = Duration::from_secs_f64((cycle - self.at) as f64 / CYCLES_PER_SECOND as f64);
        let elapsed = self.begun.elapsed();
        if elapsed < due {
            std::thread::sleep(due.saturating_sub(elapsed));
        } else if elapsed > due + PATIENCE {
            *self = Self::from(cycle);
        }
    }
}

/// Becomes true at the end of standard input, if that is asked for.
fn end_of_input(asked: bool) -> Arc<AtomicBool> {
    let ended = Arc::new(AtomicBool::new(false));
    if asked {
        let ended = Arc::clone(&ended);
        std::thread::spawn(move || {
            let mut part = [0; 64];
            while std::io::stdin().read(&mut part).is_ok_and(|length| length > 0) {}
            ended.store(true, Ordering::Relaxed);
        });
    }
    ended
}

fn run(arguments: &Arguments) -> Result<(), SimError> {
    let passes = arguments.wave.as_deref().map(wave::read).transpose()?;
    let mut mcu = Mcu::load(&arguments.elf)?;
    let mut pty = Pty::open()?;
    let mut rig = Rig::new(arguments);
    mcu.set(arguments.pin, true);
    let start = arguments.every.map_or(Start::Armed, Start::Every);
    let mut player = passes.map(|passes| Player::new(passes, arguments.pin, start, &mut mcu));
    let ended = end_of_input(arguments.until_eof);
    for &(pin, level) in &arguments.level {
        mcu.set(pin, level);
    }
    for &(from, to) in &arguments.wire {
        mcu.wire(from, to);
    }
    let mut out = std::io::stdout();
    writeln!(out, "pty {}", pty.path())?;
    out.flush()?;
    let mut pace = Pace::from(0);
    let mut busy_until = 0;
    while arguments.duration.is_none_or(|end| mcu.cycle() < end) && !ended.load(Ordering::Relaxed) {
        rig.act(&mut mcu);
        if let Some(player) = &mut player {
            player.act(&mut mcu);
            let last = arguments.runs.is_some_and(|runs| player.over() >= runs);
            // What it says of the last run takes its time on the line.
            if last && mcu.cycle() >= busy_until.max(player.over_at() + LINGER) {
                break;
            }
        }
        let input = pty.read()?;
        mcu.send(&input);
        mcu.run_for(SLICE)?;
        let output: Vec<u8> = mcu.take_sent().iter().map(|sent| sent.byte).collect();
        pty.write(&output)?;
        let cycle = mcu.cycle();
        let awaited = mcu.is_playing(arguments.pin) || player.as_ref().is_some_and(Player::is_busy);
        if !(input.is_empty() && output.is_empty()) || mcu.unsent() > 0 || awaited {
            busy_until = cycle + LINGER;
        }
        if arguments.fast && cycle < busy_until {
            pace = Pace::from(cycle);
        } else {
            pace.wait(cycle);
        }
    }
    if arguments.runs.is_some() { wait_for_reader(&pty) } else { Ok(()) }
}

/// Waits until the host has read everything: what is in the line goes with it when it is closed.
fn wait_for_reader(pty: &Pty) -> Result<(), SimError> {
    let ended = Instant::now();
    let mut unread_at = ended;
    while unread_at.elapsed() < SETTLED && ended.elapsed() < LAST_WORDS {
        std::thread::sleep(Duration::from_millis(5));
        if pty.unread()? > 0 {
            unread_at = Instant::now();
        }
    }
    Ok(())
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let sets_out = |value: Option<f64>| value.is_some_and(|value| value > 0.0);
    let passes = arguments.speed.is_some() || arguments.accel.is_some();
    if passes && !sets_out(arguments.speed) && !sets_out(arguments.accel) {
        eprintln!(
            "board: an encoder that neither moves nor is accelerated does not pass: give --speed or --accel above 0"
        );
        return ExitCode::from(2);
    }
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("board: {error}");
            ExitCode::FAILURE
        }
    }
}
