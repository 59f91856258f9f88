//! The motor drive's real ELF file.

#![allow(clippy::expect_used, clippy::panic, clippy::cast_precision_loss, clippy::cast_possible_truncation)]

mod rig;

use rig::{Board, CYCLES_PER_MS};
use slider_proto::drive::DEFAULT_PRESETS;
use slider_proto::remote::{ADDRESS, DIGITS, STOPS};
use slider_proto::{Command, Direction, DriveState, Preset, Refusal, Report, Unit};
use slider_sim::Pin;
use slider_sim::remote::{distorted, nec, nec_held, noise};

/// Longest time from the opening of the limit switch until the PWM is off: 100 us.
const CUT: u64 = 1600;

/// From a report of the drive's state: number, state.
fn state(report: &Report) -> Option<(u8, DriveState)> {
    if let Report::Preset { index, state, .. } = report { Some((*index, *state)) } else { None }
}

impl Board {
    /// Presses a key and lets it take effect.
    fn press(&mut self, command: u8) {
        let start = self.mcu.cycle() + CYCLES_PER_MS;
        self.mcu.play(Pin::D3, nec(ADDRESS, command, start));
        self.run_ms(75);
    }

    fn until(&mut self, index: u8, wanted: DriveState) {
        self.wait(|report| state(report) == Some((index, wanted)), 600);
    }

    /// Duty of the PWM now, `None` if it is off.
    fn duty(&self) -> Option<f64> {
        self.mcu.pwm(Pin::D11).last().and_then(|change| change.duty)
    }

    fn directions(&self) -> (bool, bool) {
        (self.mcu.level(Pin::A0), self.mcu.level(Pin::A1))
    }

    fn is_off(&self) -> bool {
        self.duty().is_none() && !self.mcu.level(Pin::D11) && self.directions() == (false, false)
    }

    /// Opens the limit switch at `cycle`, and returns the cycles until the PWM is off.
    fn hit(&mut self, cycle: u64) -> u64 {
        self.mcu.play(Pin::D2, [(cycle, true)]);
        self.run_until(cycle + 2 * CUT);
        assert!(self.is_off(), "{:?} {:?}", self.duty(), self.directions());
        let off = self.mcu.pwm(Pin::D11).last().copied().expect("a change");
        assert!(off.duty.is_none() && off.cycle >= cycle);
        off.cycle - cycle
    }
}

fn drive() -> Board {
    let mut drive = Board::drive();
    drive.run_ms(100);
    drive
}

#[test]
fn nothing_moves_at_power_up() {
    let mut drive = Board::drive();
    drive.run_ms(2000);
    assert!(drive.mcu.pwm(Pin::D11).iter().all(|change| change.duty.is_none()));
    for pin in [Pin::D11, Pin::A0, Pin::A1] {
        assert!(drive.mcu.changes(pin).iter().all(|change| !change.level), "{pin:?}");
    }
    drive.wait(|report| matches!(report, Report::Hello { unit: Unit::Drive, .. }), 1);
    drive.until(0, DriveState::Stopped);
    assert_eq!(drive.mcu.resets(), 0);
}

#[test]
fn every_digit_drives_its_preset_and_every_stop_key_stops() {
    for (digit, (&command, preset)) in (0..).zip(DIGITS.iter().zip(DEFAULT_PRESETS)) {
        let mut drive = drive();
        drive.press(command);
        drive.until(digit, DriveState::Running);
        let duty = drive.duty().expect("it moves");
        // Fast PWM is high for one count more than the register says.
        assert!((duty - (f64::from(preset.duty) + 1.0) / 256.0).abs() < 1e-9, "digit {digit}: {duty}");
        assert_eq!(drive.directions(), (true, false));
        let percent = (f64::from(preset.duty) / 2.55).round();
        drive.run_ms(20);
        assert_eq!(drive.lcd(), [format!("Preset {digit}  ->{percent:>3}%"), "running".to_owned()]);
        drive.press(STOPS[usize::from(digit) % STOPS.len()]);
        assert!(drive.is_off(), "digit {digit}");
        drive.until(digit, DriveState::Stopped);
        drive.run_ms(20);
        assert_eq!(drive.lcd()[1], "stopped");
        drive.check_stack();
        drive.check_lcd();
    }
}

#[test]
fn other_keys_and_other_remotes_do_nothing() {
    let mut drive = drive();
    drive.reports.clear();
    for command in (0..=255u8).filter(|command| !DIGITS.contains(command) && !STOPS.contains(command)).step_by(7) {
        drive.press(command);
    }
    let start = drive.mcu.cycle() + CYCLES_PER_MS;
    drive.mcu.play(Pin::D3, nec(ADDRESS + 1, DIGITS[5], start));
    drive.run_ms(100);
    assert!(drive.reports.is_empty() && drive.is_off());
}

#[test]
fn a_key_held_down_counts_once_and_a_cheap_remote_is_understood() {
    let mut drive = drive();
    let start = drive.mcu.cycle() + CYCLES_PER_MS;
    drive.mcu.play(Pin::D3, nec_held(ADDRESS, DIGITS[2], start, 8));
    drive.run_ms(1000);
    let starts = drive.reports.iter().filter(|(_, report)| state(report) == Some((2, DriveState::Starting))).count();
    assert_eq!(starts, 1);
    for (digit, error) in [(3, -8.0), (4, 8.0), (5, 0.0)] {
        let start = drive.mcu.cycle() + CYCLES_PER_MS;
        let clean = nec(ADDRESS, DIGITS[usize::from(digit)], start);
        drive.mcu.play(Pin::D3, distorted(&clean, error, 1200, u64::from(digit)));
        drive.run_ms(80);
        drive.until(digit, DriveState::Running);
    }
}

#[test]
fn ten_seconds_of_noise_on_the_receiver_change_nothing() {
    let mut drive = drive();
    drive.press(DIGITS[4]);
    drive.until(4, DriveState::Running);
    drive.run_ms(50);
    drive.reports.clear();
    let (duty, text, changes) = (drive.duty(), drive.lcd(), drive.mcu.pwm(Pin::D11).len());
    let start = drive.mcu.cycle() + 100;
    drive.mcu.play(Pin::D3, noise(start, 10 * slider_sim::CYCLES_PER_SECOND, 11));
    drive.run_ms(10_100);
    assert!(drive.reports.is_empty(), "{:?}", drive.reports);
    assert_eq!((drive.duty(), drive.lcd(), drive.mcu.pwm(Pin::D11).len()), (duty, text, changes));
    assert_eq!(drive.mcu.resets(), 0);
    // And the next key is read.
    drive.press(STOPS[0]);
    assert!(drive.is_off());
}

#[test]
fn the_start_is_soft() {
    let mut drive = drive();
    let before = drive.mcu.pwm(Pin::D11).len();
    drive.order(Command::Go { index: 9 });
    drive.until(9, DriveState::Running);
    let ramp = drive.mcu.pwm(Pin::D11)[before..].to_vec();
    let duties: Vec<_> = ramp.iter().filter_map(|change| change.duty.map(|duty| (change.cycle, duty))).collect();
    assert!(duties.len() > 200, "{} steps", duties.len());
    assert!(duties.windows(2).all(|pair| pair[1].1 >= pair[0].1 && pair[1].1 - pair[0].1 < 4.0 / 256.0), "no jumps");
    let (from, to) = (duties[0], duties[duties.len() - 1]);
    assert!(from.1 <= 3.0 / 256.0 && (to.1 - 1.0).abs() < 1e-9, "{from:?} {to:?}");
    let ms = (to.0 - from.0) as f64 / CYCLES_PER_MS as f64;
    assert!((250.0..260.0).contains(&ms), "{ms} ms");
    let frequency = ramp[ramp.len() / 2].frequency_hz;
    assert!((frequency - 976.5625).abs() < 0.1, "{frequency} Hz");
}

#[test]
fn the_limit_switch_cuts_the_motor_within_100_us_whatever_else_runs() {
    let mut worst = [0; 4];
    println!("limit switch to PWM off, 60 hits each:");
    for (case, worst) in worst.iter_mut().enumerate() {
        for n in 0..60u64 {
            let mut drive = drive();
            drive.order(Command::Go { index: 7 });
            drive.until(7, DriveState::Running);
            drive.run_ms(30);
            let now = drive.mcu.cycle();
            match case {
                // While the text is written to the display.
                1 => drive.order(Command::Go { index: (n % 7) as u8 }),
                // While a key is sent, at every phase of its frame.
                2 => drive.mcu.play(Pin::D3, nec(ADDRESS, DIGITS[1], now + 100)),
                // With everything at once: the display, noise on the receiver, and a line full of bytes.
                3 => {
                    drive.order(Command::Go { index: (n % 7) as u8 });
                    let now = drive.mcu.cycle();
                    // As fast as its interrupt can take.
                    drive.mcu.play(Pin::D3, (0..400).map(|i| (now + i * 160, i % 2 == 1)));
                    drive.mcu.send(&[0x55; 40]);
                }
                _ => {}
            }
            let now = drive.mcu.cycle();
            let phase = if case == 2 { n * 18_011 } else { n * 331 };
            *worst = (*worst).max(drive.hit(now + 500 + phase));
            // It stays off.
            drive.run_ms(30);
            assert!(drive.is_off());
        }
    }
    for (name, worst) in ["at rest", "display being written", "key being sent", "all at once"].iter().zip(worst) {
        println!("  {name:<22} at most {worst} cycles ({:.1} us)", worst as f64 / 16.0);
        assert!(worst <= CUT, "{name}: {worst} cycles");
    }
}

#[test]
fn a_hit_is_told_and_shown_and_forward_is_refused_there() {
    let mut drive = drive();
    drive.press(DIGITS[5]);
    drive.until(5, DriveState::Running);
    let now = drive.mcu.cycle();
    drive.hit(now + 1000);
    drive.wait(|report| matches!(report, Report::LimitHit { .. }), 20);
    drive.until(5, DriveState::AtLimit);
    drive.run_ms(30);
    assert_eq!(drive.lcd()[1], "STOP: at limit");
    drive.check_lcd();
    let answer = drive.ask(Command::Go { index: 2 });
    assert!(matches!(answer, Report::Nak { reason: Refusal::AtLimit, .. }), "{answer:?}");
    drive.press(DIGITS[2]);
    drive.run_ms(300);
    assert!(drive.is_off());
}

#[test]
fn a_wire_that_is_broken_from_the_start_lets_nothing_move() {
    let mut drive = Board::drive();
    drive.mcu.set(Pin::D2, true);
    drive.run_ms(100);
    drive.press(DIGITS[3]);
    drive.run_ms(300);
    assert!(drive.mcu.pwm(Pin::D11).iter().all(|change| change.duty.is_none()));
    assert_eq!(drive.lcd()[1], "STOP: at limit");
}

#[test]
fn the_carriage_backs_off_a_bouncing_switch_and_is_guarded_again() {
    let mut drive = drive();
    let back = Preset { duty: 120, direction: Direction::Reverse };
    drive.order(Command::SetPreset { index: 1, preset: back });
    drive.order(Command::Go { index: 5 });
    drive.until(5, DriveState::Running);
    let now = drive.mcu.cycle();
    drive.hit(now + 1000);
    drive.run_ms(50);
    drive.order(Command::Go { index: 1 });
    drive.run_ms(40);
    assert_eq!(drive.directions(), (false, true));
    // The switch closes and bounces for 5 ms.
    let now = drive.mcu.cycle();
    drive.mcu.play(Pin::D2, (0..11).map(|i| (now + 100 + i * 8000, i % 2 == 1)));
    drive.until(1, DriveState::Running);
    assert!((drive.duty().expect("it moves") - 121.0 / 256.0).abs() < 1e-9);
    let now = drive.mcu.cycle();
    let cycles = drive.hit(now + 1000);
    assert!(cycles <= CUT);
}

#[test]
fn a_change_of_direction_passes_through_rest() {
    let mut drive = drive();
    let back = Preset { duty: 200, direction: Direction::Reverse };
    drive.order(Command::SetPreset { index: 1, preset: back });
    drive.order(Command::Go { index: 8 });
    drive.until(8, DriveState::Running);
    let before = drive.mcu.pwm(Pin::D11).len();
    drive.order(Command::Go { index: 1 });
    drive.until(1, DriveState::Running);
    assert_eq!(drive.directions(), (false, true));
    let ramp = &drive.mcu.pwm(Pin::D11)[before..];
    assert!(ramp[0].duty.is_none(), "off first");
    assert!(ramp[1].duty.expect("on again") <= 3.0 / 256.0);
    // Both directions at once would be a brake, and never are on.
    let (mut forward, mut reverse) = (drive.mcu.changes(Pin::A0).to_vec(), drive.mcu.changes(Pin::A1).to_vec());
    let off = forward.pop().expect("forward ends");
    let on = reverse.pop().expect("reverse begins");
    assert!(!off.level && on.level && off.cycle < on.cycle);
}

#[test]
fn the_host_sets_presets() {
    let mut drive = drive();
    for (index, duty) in [(0, 255), (3, 1), (9, 128)] {
        drive.order(Command::SetPreset { index, preset: Preset { duty, direction: Direction::Forward } });
        drive.order(Command::Go { index });
        drive.until(index, DriveState::Running);
        let expected = (f64::from(duty) + 1.0) / 256.0;
        assert!((drive.duty().expect("it moves") - expected).abs() < 1e-9);
        drive.order(Command::Stop);
        drive.run_ms(5);
        assert!(drive.is_off());
    }
    let preset = Preset { duty: 1, direction: Direction::Forward };
    for command in [Command::SetPreset { index: 10, preset }, Command::Go { index: 10 }] {
        let answer = drive.ask(command);
        assert!(matches!(answer, Report::Nak { reason: Refusal::NoSuchPreset, .. }), "{answer:?}");
    }
    // Setting the preset that is running stops it.
    drive.order(Command::Go { index: 9 });
    drive.until(9, DriveState::Running);
    drive.order(Command::SetPreset { index: 9, preset });
    drive.run_ms(2);
    assert!(drive.is_off());
}

#[test]
fn a_hung_drive_stops_the_motor() {
    let mut drive = drive();
    drive.order(Command::Go { index: 9 });
    drive.until(9, DriveState::Running);
    drive.mcu.jump("__stop_program").expect("the endless loop at the end of every program");
    drive.run_ms(300);
    assert_eq!(drive.mcu.resets(), 1);
    assert!(drive.is_off());
    drive.run_ms(1000);
    assert!(drive.is_off());
}

/// The figures of the README.
#[test]
fn interrupts_are_as_short_as_documented() {
    let mut drive = drive();
    for digit in [3, 8] {
        drive.press(DIGITS[digit]);
        for _ in 0..20 {
            drive.ask(Command::Status);
        }
    }
    let now = drive.mcu.cycle();
    drive.hit(now + 1000);
    for interrupt in drive.mcu.interrupts().iter().filter(|interrupt| interrupt.runs > 0) {
        println!(
            "{:<12} {:>5} runs, at most {:>3} cycles ({:>4.1} us), begun at most {:>3} cycles after its request",
            interrupt.name(),
            interrupt.runs,
            interrupt.longest_run,
            interrupt.longest_run as f64 / 16.0,
            interrupt.longest_latency
        );
        assert!(interrupt.longest_run < 400, "{}", interrupt.name());
    }
    println!("stack: {} bytes used", drive.mcu.stack_high_water());
}
