//! `slider status`, `slider stop`, `slider selftest`.

use std::time::Duration;

use serde_json::json;
use slider_host::Error;
use slider_host::error::unit_name;
use slider_proto::{Command, Direction, DriveState, Level, Report, TimerState, Unit};

use super::connect::PortArgs;
use super::output::Output;

/// How long a status or the result of a self-test may take.
const ANSWER: Duration = Duration::from_secs(2);
/// Edges of a good self-test, and the largest error of an interval in ticks that quantisation makes.
const EDGES: u8 = 26;
const WORST_ERROR_TICKS: u16 = 1;

#[derive(clap::Args)]
pub(crate) struct StatusArgs {
    #[command(flatten)]
    port: PortArgs,

    /// One JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
pub(crate) struct StopArgs {
    #[command(flatten)]
    port: PortArgs,
}

#[derive(clap::Args)]
pub(crate) struct SelftestArgs {
    #[command(flatten)]
    port: PortArgs,

    /// One JSON object on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn status(args: &StatusArgs, output: &mut Output) -> Result<bool, Error> {
    output.json = args.json;
    let (mut line, greeting) = args.port.open(None, output)?;
    let report = line.answer(Command::Status, ANSWER, |report| match report {
        Report::Status { .. } | Report::Preset { .. } => Some(*report),
        _ => None,
    })?;
    let head = format!("{} {}", unit_name(greeting.unit), greeting.version());
    let mut object = json!({"unit": unit_name(greeting.unit), "firmware": greeting.version()});
    let (text, fields) = match report {
        Report::Status { state, run, edges, sensor, limit } => {
            let state = timer_state(state);
            let light = if sensor == Level::High { "open" } else { "blocked" };
            let end = if limit { "reached" } else { "not reached" };
            (
                format!("{head}: {state}, run {run}, {edges} edges, sensor {light}, end of travel {end}"),
                json!({"state": state, "run": run, "edges": edges, "sensor": light, "limit": limit}),
            )
        }
        Report::Preset { index, preset, state, limit } => {
            let (state, direction) = (drive_state(state), direction_name(preset.direction));
            let duty = preset.duty;
            let switch = if limit { "open (hit)" } else { "closed" };
            (
                format!("{head}: {state}, preset {index}: duty {duty} {direction}, limit switch {switch}"),
                json!({"state": state, "preset": index, "duty": duty, "direction": direction, "limit": limit}),
            )
        }
        _ => return Ok(false),
    };
    if let (Some(object), serde_json::Value::Object(fields)) = (object.as_object_mut(), fields) {
        object.extend(fields);
    }
    output.result(&text, &object)?;
    Ok(true)
}

pub(crate) fn stop(args: &StopArgs, output: &mut Output) -> Result<bool, Error> {
    let (mut line, _) = args.port.open(None, output)?;
    line.ask(Command::Stop)?;
    Ok(true)
}

pub(crate) fn selftest(args: &SelftestArgs, output: &mut Output) -> Result<bool, Error> {
    output.json = args.json;
    let (mut line, _) = args.port.open(Some(Unit::Timer), output)?;
    let (edges, worst) = line.answer(Command::SelfTest, ANSWER, |report| match *report {
        Report::SelfTest { edges, worst_error_ticks } => Some((edges, worst_error_ticks)),
        _ => None,
    })?;
    let passed = edges == EDGES && worst <= WORST_ERROR_TICKS;
    let verdict = match (edges, worst) {
        _ if passed => "good",
        (0, _) => "no edge: is D5 wired to D8 (JP1), and the sensor unplugged?",
        (edges, _) if edges < EDGES => "edges are missing: a bad contact at JP1?",
        (_, u16::MAX) => "an edge was missed: noise, a long wire, or the sensor still plugged in",
        _ => "intervals are off: noise, a long wire, or the sensor still plugged in",
    };
    let text = format!("{edges} of {EDGES} edges, worst error {worst} ticks: {verdict}");
    output.result(&text, &json!({"edges": edges, "worst_error_ticks": worst, "passed": passed}))?;
    if !passed && output.json {
        output.tell(verdict);
    }
    Ok(passed)
}

fn timer_state(state: TimerState) -> &'static str {
    match state {
        TimerState::Idle => "idle",
        TimerState::Armed => "armed",
        TimerState::Running => "running",
        TimerState::SelfTest => "self-test",
    }
}

fn drive_state(state: DriveState) -> &'static str {
    match state {
        DriveState::Stopped => "stopped",
        DriveState::Starting => "starting",
        DriveState::Running => "running",
        DriveState::AtLimit => "at the limit",
    }
}

fn direction_name(direction: Direction) -> &'static str {
    match direction {
        Direction::Forward => "forward",
        Direction::Reverse => "reverse",
    }
}
