//! The display tells preset, direction, duty and state.

use slider_proto::display::{COLUMNS, text};
use slider_proto::drive::{DriveUnit, Port};
use slider_proto::{Command, Direction, DriveState, Frame, Preset, Report};

/// A motor that does as it is told, and its limit switch.
struct Motor {
    limit: bool,
}

impl Port for Motor {
    fn drive(&mut self, _: Direction, _: u8) {}

    fn release(&mut self, _: bool) {}

    fn limit(&self) -> bool {
        self.limit
    }
}

fn obey(unit: &mut DriveUnit, message: Command, now: u32, motor: &mut Motor) {
    let answer = unit.command(Ok(Frame { sequence: 0, lost: 0, message }), now, motor);
    assert_eq!(answer, Report::Ack { sequence: 0 });
}

/// The two rows by the description: name and number of the preset, arrow, per cent at the right; then the state.
fn expected(index: u8, preset: Preset, state: &str) -> [String; 2] {
    let arrow = match preset.direction {
        Direction::Forward => "->",
        Direction::Reverse => "<-",
    };
    // No duty lies half way between two per cent: 255 is odd.
    let percent = (f64::from(preset.duty) / 2.55).round();
    [format!("Preset {index}  {arrow}{percent:>3}%"), format!("{state:<16}")]
}

fn shown(unit: &DriveUnit) -> [String; 2] {
    text(unit).map(|row| String::from_utf8_lossy(&row).into_owned())
}

#[test]
fn every_preset_and_duty_is_shown_in_every_state() {
    for index in 0..10 {
        for duty in 0..=255 {
            for direction in [Direction::Forward, Direction::Reverse] {
                let preset = Preset { duty, direction };
                let mut motor = Motor { limit: false };
                let mut unit = DriveUnit::new([0, 1, 0], 0);
                obey(&mut unit, Command::SetPreset { index, preset }, 0, &mut motor);
                obey(&mut unit, Command::Go { index }, 0, &mut motor);
                assert_eq!((unit.state(), shown(&unit)), (DriveState::Starting, expected(index, preset, "starting")));
                unit.step(255 * 2000, &mut motor);
                assert_eq!((unit.state(), shown(&unit)), (DriveState::Running, expected(index, preset, "running")));
                obey(&mut unit, Command::Stop, 256 * 2000, &mut motor);
                assert_eq!((unit.state(), shown(&unit)), (DriveState::Stopped, expected(index, preset, "stopped")));
                motor.limit = true;
                unit.step(257 * 2000, &mut motor);
                let at_limit = expected(index, preset, "STOP: at limit");
                assert_eq!((unit.state(), shown(&unit)), (DriveState::AtLimit, at_limit));
            }
        }
    }
}

#[test]
fn text_of_the_third_preset_is_that_of_the_documentation() {
    let mut motor = Motor { limit: false };
    let mut unit = DriveUnit::new([0, 1, 0], 0);
    obey(&mut unit, Command::Go { index: 3 }, 0, &mut motor);
    assert_eq!(shown(&unit), ["Preset 3  -> 51%", "starting        "]);
    assert_eq!(COLUMNS, 16);
}

#[test]
fn power_up_shows_the_first_preset_stopped() {
    assert_eq!(shown(&DriveUnit::new([0, 1, 0], 0)), ["Preset 0  -> 26%", "stopped         "]);
}
