//! The real firmware between the rig and the line, in a simulated chip that is a program of its own.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

use slider_proto::Level;

use super::rig::{Pass, Truth};
use super::{Options, Track};
use crate::Error;

/// Clock of the chip, Hz.
const CYCLE_HZ: f64 = 16e6;
/// Passes that are written when their number was not given; after the last one they begin again.
const PASSES: u32 = 32;
/// What names the program that simulates the chip.
const BOARD: &str = "SLIDER_BOARD";

/// A running program, ended with this.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A file that is removed with this.
struct Temporary(PathBuf);

impl Temporary {
    fn write(content: &str) -> Result<Self, Error> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("slider-{}-{number}.wave", std::process::id()));
        let file = Self(path);
        fs::write(&file.0, content).map_err(|source| Error::File { path: file.0.clone(), source })?;
        Ok(file)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// The folder of the firmware, here or above.
fn folder(given: Option<&Path>) -> Result<PathBuf, Error> {
    if let Some(folder) = given {
        return Ok(folder.to_owned());
    }
    let here = std::env::current_dir().map_err(|source| Error::File { path: ".".into(), source })?;
    let found = here.ancestors().map(|folder| folder.join("firmware")).find(|folder| folder.is_dir());
    found.ok_or_else(|| {
        Error::Firmware(format!("no folder firmware in {} or above: give it with --firmware DIR", here.display()))
    })
}

/// The program that simulates the chip.
fn board(given: Option<&Path>, folder: &Path) -> Result<PathBuf, Error> {
    let named = given.map(Path::to_owned).or_else(|| std::env::var_os(BOARD).map(PathBuf::from));
    if let Some(path) = named {
        return if path.is_file() {
            Ok(path)
        } else {
            Err(Error::Firmware(format!("there is no program {}", path.display())))
        };
    }
    let name = format!("board{}", std::env::consts::EXE_SUFFIX);
    let target = folder.join("target");
    let built = fs::read_dir(&target).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut candidates = built.chain([target.clone()]).map(|folder| folder.join("release").join(&name));
    candidates.find(|path| path.is_file()).ok_or_else(|| {
        Error::Firmware(format!(
            "no program board in {}/*/release: (cd {} && cargo build --release --bin board), or name it with --board or {BOARD}",
            target.display(),
            folder.join("sim").display()
        ))
    })
}

fn elf(given: Option<&Path>, folder: &Path) -> Result<PathBuf, Error> {
    let path = given.map_or_else(|| folder.join("target/avr-none/release/timer.elf"), Path::to_owned);
    if path.is_file() {
        Ok(path)
    } else {
        Err(Error::Firmware(format!("{} is not there: cargo xtask firmware, or name it with --elf", path.display())))
    }
}

/// The passes as the program reads them: a line `cycle level` for each edge, a blank line between passes, cycles from the
/// moment when the timer is armed.
fn wave(track: &Track, passes: u32) -> (String, Vec<Truth>) {
    let mut text = "# Edges of the virtual slider: cycles of 62.5 ns from the arming, level from then on\n".to_owned();
    let mut truths = Vec::new();
    let rate = CYCLE_HZ * (1.0 + track.rig.clock().ppm * 1e-6);
    for Pass { crossings, truth, .. } in (0..passes).map_while(|index| track.pass(index)) {
        for crossing in crossings {
            let cycle = ((track.delay_s + crossing.time_s) * rate).round();
            // A string takes everything.
            let _ = writeln!(text, "{cycle} {}", u8::from(crossing.level == Level::High));
        }
        text.push('\n');
        truths.push(truth);
    }
    (text, truths)
}

pub(super) fn run(options: &Options, track: &Track, out: &mut dyn Write) -> Result<(), Error> {
    let folder = folder(options.firmware.as_ref().and_then(Option::as_deref))?;
    let (program, elf) = (board(options.board.as_deref(), &folder)?, elf(options.elf.as_deref(), &folder)?);
    let (text, truths) = wave(track, options.runs.unwrap_or(PASSES));
    let file = Temporary::write(&text)?;
    if let Some(path) = &options.truth {
        let lines: Result<Vec<_>, _> = truths.iter().map(serde_json::to_string).collect();
        let lines = lines.map_err(|error| Error::Simulation(error.to_string()))?;
        let text = lines.into_iter().map(|line| line + "\n").collect::<String>();
        fs::write(path, text).map_err(|source| Error::File { path: path.clone(), source })?;
    }
    let mut command = Command::new(&program);
    command.arg(&elf).arg("--wave").arg(&file.0).arg("--until-eof");
    if let Some(runs) = options.runs {
        command.arg("--runs").arg(runs.to_string());
    }
    if options.fast {
        command.arg("--fast");
    }
    // It ends when its input does, so also when this program is killed.
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let failed = |error: io::Error| Error::Firmware(format!("{}: {error}", program.display()));
    let mut running = Running(command.spawn().map_err(failed)?);
    for line in running.0.stdout.take().map(BufReader::new).into_iter().flat_map(BufRead::lines) {
        let line = line.map_err(failed)?;
        writeln!(out, "{line}").and_then(|()| out.flush()).map_err(Error::PseudoTerminal)?;
    }
    let mut said = String::new();
    if let Some(mut stderr) = running.0.stderr.take() {
        stderr.read_to_string(&mut said).map_err(failed)?;
    }
    // Waiting closes its input.
    let status = running.0.wait().map_err(failed)?;
    let said = said.trim();
    if status.success() { Ok(()) } else { Err(Error::Firmware(format!("{}: {status}: {said}", program.display()))) }
}
