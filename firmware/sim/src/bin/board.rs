//! Runs a firmware on the simulated Nano and offers its serial port as a pseudo-terminal, for programs of the host that
//! expect a board.

use clap::Parser;
use slider_sim::{
    CYCLES_PER_SECOND, Mcu, Pin, SimError,
    encoder::{Encoder, Motion, edges},
    pty::Pty,
};
use std::{
    io::Write,
    path::PathBuf,
    process::ExitCode,
    time::{Duration, Instant},
};

/// Simulated time between two looks at the line, cycles: 1 ms.
const SLICE: u64 = CYCLES_PER_SECOND / 1000;
/// Simulated time for which `--fast` goes on after the last byte or edge, cycles: 0.2 s.
const LINGER: u64 = CYCLES_PER_SECOND / 5;
/// How far the simulation may fall behind the clock before it gives the lost time up.
const PATIENCE: Duration = Duration::from_millis(200);

/// Run a firmware (ELF for the ATmega328P) on a simulated Arduino Nano with its serial port as a pseudo-terminal.
///
/// The first line of output is "pty PATH"; whatever opens PATH talks to the board. Without --speed and --accel the rig
/// does nothing but hold the encoder's pin high.
///
/// Exit status: 0 after --for, 1 when the firmware crashed or the line failed, 2 for wrong arguments.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// The firmware.
    elf: PathBuf,
    /// One second of the board is one second of the clock; this is the default.
    #[arg(long, conflicts_with = "fast")]
    real_time: bool,
    /// As fast as it goes while bytes pass either way or an encoder passes, and 0.2 s of simulated time longer; in real
    /// time otherwise, so that a board that nobody talks to does not run away from its host.
    #[arg(long)]
    fast: bool,
    /// Encoder passes at this speed, m/s; with --accel, the speed at the first edge.
    #[arg(long, value_parser = not_negative)]
    speed: Option<f64>,
    /// Encoder passes with this acceleration, m/s².
    #[arg(long, value_parser = not_negative)]
    accel: Option<f64>,
    /// Simulated time from pass to pass, and before the first: "5s", "200ms".
    #[arg(long, default_value = "5s", value_parser = time)]
    every: u64,
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
        Self { encoder, motion, pin: arguments.pin, every: arguments.every, next: arguments.every }
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

fn run(arguments: &Arguments) -> Result<(), SimError> {
    let mut mcu = Mcu::load(&arguments.elf)?;
    let mut pty = Pty::open()?;
    let mut rig = Rig::new(arguments);
    mcu.set(arguments.pin, true);
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
    while arguments.duration.is_none_or(|end| mcu.cycle() < end) {
        rig.act(&mut mcu);
        let input = pty.read()?;
        mcu.send(&input);
        mcu.run_for(SLICE)?;
        let output: Vec<u8> = mcu.take_sent().iter().map(|sent| sent.byte).collect();
        pty.write(&output)?;
        let cycle = mcu.cycle();
        if !(input.is_empty() && output.is_empty()) || mcu.unsent() > 0 || mcu.is_playing(arguments.pin) {
            busy_until = cycle + LINGER;
        }
        if arguments.fast && cycle < busy_until {
            pace = Pace::from(cycle);
        } else {
            pace.wait(cycle);
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
