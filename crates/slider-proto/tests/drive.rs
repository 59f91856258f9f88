//! The drive moves as it is told, gently, and never against the limit switch.
#![allow(clippy::panic, reason = "a report that is not told fails the test")]

use proptest::prelude::*;
use slider_proto::drive::{CLEAR_OF_LIMIT, DEFAULT_PRESETS, DriveUnit, Port};
use slider_proto::remote::Key;
use slider_proto::{
    Command, Direction, DriveState, Frame, Preset, ProtoError, Refusal, Report, TICK_HZ, Unit, ticks_between,
};

const MS: u32 = TICK_HZ / 1000;
/// One turn of the main loop: 200 us.
const TURN: u32 = MS / 5;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Guard {
    On,
    Off,
    Cut,
}

/// The pins of the motor and the interrupt of its limit switch, as `firmware/slider-fw/src/motor.rs` has them.
struct Motor {
    now: u32,
    guard: Guard,
    /// The switch is open.
    open: bool,
    hit: Option<u32>,
    /// The enable input is connected to the PWM.
    enabled: bool,
    duty: u8,
    direction: Option<Direction>,
    /// What the motor did, each time it did something else: the direction, or `None` while it was off.
    history: Vec<Option<Direction>>,
}

impl Motor {
    fn new() -> Self {
        Self {
            now: 0,
            guard: Guard::On,
            open: false,
            hit: None,
            enabled: false,
            duty: 0,
            direction: None,
            history: vec![None],
        }
    }

    fn turning(&self) -> Option<(Direction, u8)> {
        self.direction.filter(|_| self.enabled).map(|direction| (direction, self.duty))
    }

    fn note(&mut self) {
        let turning = self.turning().map(|(direction, _)| direction);
        if self.history.last() != Some(&turning) {
            self.history.push(turning);
        }
        assert!(!self.open || turning != Some(Direction::Forward), "forward against the limit");
    }

    fn cut(&mut self) {
        self.enabled = false;
        self.direction = None;
        self.note();
    }

    fn on_limit(&mut self) {
        if self.guard == Guard::On {
            self.cut();
            self.guard = Guard::Cut;
            self.hit = Some(self.now);
        }
    }

    /// The switch opens or closes.
    fn switch(&mut self, open: bool) {
        if open && !std::mem::replace(&mut self.open, open) {
            self.on_limit();
        }
        self.open = open;
        self.note();
    }
}

impl Port for Motor {
    fn drive(&mut self, direction: Direction, duty: u8) {
        if duty == 0 {
            self.cut();
            return;
        }
        self.duty = duty;
        if self.guard == Guard::Cut {
            return;
        }
        self.direction = Some(direction);
        self.enabled = true;
        self.note();
    }

    fn release(&mut self, guard: bool) {
        self.guard = if guard { Guard::On } else { Guard::Off };
        if self.open {
            self.on_limit();
        }
    }

    fn limit(&self) -> bool {
        self.open
    }
}

/// The firmware's main loop.
struct Bench {
    unit: DriveUnit,
    motor: Motor,
    now: u32,
    told: Vec<Report>,
}

impl Bench {
    /// Just reset, with the switch as it is.
    fn reset(open: bool) -> Self {
        let mut motor = Motor::new();
        motor.open = open;
        Self { unit: DriveUnit::new([0, 1, 0], 2), motor, now: 0, told: Vec::new() }
    }

    /// Ready, with the carriage amid its travel.
    fn new() -> Self {
        let mut bench = Self::reset(false);
        bench.pass(100 * MS);
        bench.told.clear();
        bench
    }

    /// Stopped by the limit switch, which the carriage holds open.
    fn at_limit() -> Self {
        let mut bench = Self::new();
        bench.digit(5);
        bench.pass(300 * MS);
        bench.motor.switch(true);
        bench.pass(100 * MS);
        bench.told.clear();
        bench
    }

    /// One turn of the loop, `ticks` after the one before.
    fn turn(&mut self, ticks: u32) {
        self.now = self.now.wrapping_add(ticks);
        self.motor.now = self.now;
        if let Some(tick) = self.motor.hit.take() {
            self.unit.limit_hit(tick, &mut self.motor);
        }
        self.unit.step(self.now, &mut self.motor);
        self.told.extend(self.unit.report(&self.motor));
    }

    /// Turns of the loop until `ticks` have passed.
    fn pass(&mut self, ticks: u32) {
        let mut left = ticks;
        while left > 0 {
            let part = left.min(TURN);
            self.turn(part);
            left -= part;
        }
    }

    fn digit(&mut self, index: u8) {
        self.unit.key(Key::Digit(index), self.now, &mut self.motor);
    }

    fn command(&mut self, message: Command) -> Report {
        self.unit.command(Ok(Frame { sequence: 9, lost: 0, message }), self.now, &mut self.motor)
    }

    fn obey(&mut self, message: Command) {
        assert_eq!(self.command(message), Report::Ack { sequence: 9 });
    }

    fn refuse(&mut self, message: Command, reason: Refusal) {
        assert_eq!(self.command(message), Report::Nak { sequence: 9, reason });
    }

    fn set(&mut self, index: u8, duty: u8, direction: Direction) {
        self.obey(Command::SetPreset { index, preset: Preset { duty, direction } });
    }

    fn turning(&self) -> Option<(Direction, u8)> {
        self.motor.turning()
    }

    /// The last preset and state told.
    fn last_told(&self) -> (u8, DriveState, bool) {
        let told = self.told.iter().rev().find_map(|report| match *report {
            Report::Preset { index, state, limit, .. } => Some((index, state, limit)),
            _ => None,
        });
        told.unwrap_or_else(|| panic!("no state told: {:?}", self.told))
    }
}

use Direction::{Forward, Reverse};

#[test]
fn nothing_moves_at_power_up() {
    for open in [false, true] {
        let mut bench = Bench::reset(open);
        bench.pass(5000 * MS);
        assert_eq!(bench.motor.history, [None]);
        let state = if open { DriveState::AtLimit } else { DriveState::Stopped };
        assert_eq!((bench.unit.state(), bench.last_told()), (state, (0, state, open)));
        let hello = Report::Hello { unit: Unit::Drive, firmware: [0, 1, 0], tick_hz: 2_000_000, reset_cause: 2 };
        assert_eq!(bench.told[0], hello);
    }
}

#[test]
fn each_digit_drives_at_its_preset() {
    for index in 0..10 {
        let mut bench = Bench::new();
        bench.digit(index);
        bench.pass(300 * MS);
        // From a quarter of the supply to all of it.
        let duty = 66 + 21 * index;
        assert_eq!(bench.turning(), Some((Forward, duty)));
        assert_eq!((bench.unit.index(), bench.unit.state()), (index, DriveState::Running));
        assert_eq!(bench.last_told(), (index, DriveState::Running, false));
        // As the host does it, with a preset of its own.
        let duty = 250 - 20 * index;
        bench.set(index, duty, Reverse);
        bench.obey(Command::Go { index });
        bench.pass(300 * MS);
        assert_eq!(bench.turning(), Some((Reverse, duty)));
        assert_eq!(bench.unit.preset(), Preset { duty, direction: Reverse });
    }
    assert_eq!((DEFAULT_PRESETS[0].duty, DEFAULT_PRESETS[9].duty), (66, 255));
}

#[test]
fn soft_start_is_one_step_a_millisecond() {
    let mut bench = Bench::new();
    bench.digit(9);
    let start = bench.now;
    while bench.unit.state() == DriveState::Starting {
        bench.turn(TURN);
        let ms = (ticks_between(start, bench.now) / MS) as u8;
        assert_eq!(bench.turning(), (ms > 0).then_some((Forward, ms)));
    }
    assert_eq!(ticks_between(start, bench.now), 255 * MS);
    bench.pass(1000 * MS);
    assert_eq!(bench.turning(), Some((Forward, 255)));
}

#[test]
fn preset_of_nothing_does_not_turn() {
    let mut bench = Bench::new();
    bench.set(4, 0, Forward);
    bench.digit(4);
    bench.pass(300 * MS);
    assert_eq!(bench.motor.history, [None]);
}

#[test]
fn stop_stops_at_once() {
    for after_ms in [0, 1, 10, 100, 1000] {
        for by_key in [true, false] {
            let mut bench = Bench::new();
            bench.digit(8);
            bench.pass(after_ms * MS);
            if by_key {
                bench.unit.key(Key::Stop, bench.now, &mut bench.motor);
            } else {
                bench.obey(Command::Stop);
            }
            assert_eq!((bench.turning(), bench.unit.state()), (None, DriveState::Stopped));
            bench.pass(1000 * MS);
            assert_eq!((bench.turning(), bench.last_told()), (None, (8, DriveState::Stopped, false)));
        }
    }
}

#[test]
fn next_preset_of_the_same_direction_goes_on_from_the_present_duty() {
    let mut bench = Bench::new();
    bench.digit(0);
    bench.pass(300 * MS);
    bench.digit(2);
    bench.pass(10 * MS);
    assert_eq!(bench.turning(), Some((Forward, 66 + 10)));
    bench.pass(32 * MS);
    assert_eq!((bench.turning(), bench.unit.state()), (Some((Forward, 108)), DriveState::Running));
    // A slower one is reached in one step.
    bench.digit(0);
    bench.pass(MS);
    assert_eq!((bench.turning(), bench.unit.state()), (Some((Forward, 66)), DriveState::Running));
    assert_eq!(bench.motor.history, [None, Some(Forward)]);
}

#[test]
fn change_of_direction_passes_through_standstill_and_a_soft_start() {
    let mut bench = Bench::new();
    bench.set(1, 200, Reverse);
    for (index, direction) in [(9, Forward), (1, Reverse), (9, Forward)] {
        bench.digit(index);
        assert_eq!(bench.turning(), None);
        bench.pass(50 * MS);
        assert_eq!(bench.turning(), Some((direction, 50)));
        bench.pass(300 * MS);
    }
    assert_eq!(bench.motor.history, [None, Some(Forward), None, Some(Reverse), None, Some(Forward)]);
}

#[test]
fn presets_beyond_the_tenth_do_not_exist() {
    let mut bench = Bench::new();
    for index in 10..=255 {
        bench.refuse(Command::Go { index }, Refusal::NoSuchPreset);
        let preset = Preset { duty: 100, direction: Forward };
        bench.refuse(Command::SetPreset { index, preset }, Refusal::NoSuchPreset);
    }
    bench.pass(300 * MS);
    assert_eq!(bench.motor.history, [None]);
}

#[test]
fn commands_of_the_timer_and_garbled_ones_are_refused() {
    let mut bench = Bench::new();
    bench.digit(0);
    bench.pass(100 * MS);
    bench.refuse(Command::SelfTest, Refusal::NotMine);
    bench.refuse(Command::Arm(slider_proto::ArmSettings::default()), Refusal::NotMine);
    let garbled = bench.unit.command(Err(ProtoError::Empty), bench.now, &mut bench.motor);
    assert_eq!(garbled, Report::Nak { sequence: 0, reason: Refusal::Garbled });
    assert_eq!(bench.turning(), Some((Forward, 66)));
}

#[test]
fn setting_the_preset_in_use_stops_its_motion_and_no_other() {
    let mut bench = Bench::new();
    bench.digit(3);
    bench.pass(300 * MS);
    bench.set(4, 77, Reverse);
    bench.pass(10 * MS);
    assert_eq!(bench.turning(), Some((Forward, 66 + 63)));
    bench.told.clear();
    bench.set(3, 77, Reverse);
    assert_eq!(bench.turning(), None);
    bench.pass(300 * MS);
    assert_eq!(bench.turning(), None);
    let preset = Preset { duty: 77, direction: Reverse };
    assert_eq!(bench.told, [Report::Preset { index: 3, preset, state: DriveState::Stopped, limit: false }]);
}

#[test]
fn hello_and_status_are_told_when_asked_for() {
    let mut bench = Bench::new();
    bench.obey(Command::Hello);
    bench.obey(Command::Status);
    bench.pass(10 * MS);
    assert!(matches!(bench.told[..], [Report::Hello { unit: Unit::Drive, .. }, Report::Preset { index: 0, .. }]));
}

#[test]
fn limit_cuts_the_motor_off_and_is_told() {
    let mut bench = Bench::new();
    bench.digit(5);
    bench.pass(300 * MS);
    bench.told.clear();
    bench.motor.now = bench.now + 7;
    bench.motor.switch(true);
    assert_eq!(bench.turning(), None, "before the main loop knows");
    let hit = bench.now + 7;
    bench.pass(1000 * MS);
    assert_eq!(bench.turning(), None);
    assert_eq!(bench.told[0], Report::LimitHit { tick: hit });
    assert_eq!(bench.told.iter().filter(|report| matches!(report, Report::LimitHit { .. })).count(), 1);
    assert_eq!((bench.unit.state(), bench.last_told()), (DriveState::AtLimit, (5, DriveState::AtLimit, true)));
    // Nor does it start again when the switch closes.
    bench.motor.switch(false);
    bench.pass(1000 * MS);
    assert_eq!(bench.turning(), None);
    assert_eq!((bench.unit.state(), bench.last_told()), (DriveState::Stopped, (5, DriveState::Stopped, false)));
}

#[test]
fn limit_cuts_in_the_middle_of_a_turn_of_the_loop() {
    // The interrupt comes when the loop has looked for it already, and goes on to raise the duty.
    let mut bench = Bench::new();
    bench.digit(9);
    bench.pass(100 * MS);
    bench.motor.switch(true);
    bench.motor.switch(false);
    bench.unit.step(bench.now + MS, &mut bench.motor);
    assert_eq!(bench.turning(), None);
    bench.digit(8);
    bench.unit.step(bench.now + 3 * MS, &mut bench.motor);
    assert_eq!(bench.turning(), None);
    bench.pass(1000 * MS);
    assert_eq!(bench.turning(), None);
}

#[test]
fn forward_is_refused_at_the_limit() {
    let mut bench = Bench::at_limit();
    bench.refuse(Command::Go { index: 2 }, Refusal::AtLimit);
    bench.digit(3);
    bench.pass(300 * MS);
    assert_eq!((bench.turning(), bench.unit.index()), (None, 5));
    assert_eq!(bench.unit.state(), DriveState::AtLimit);
}

#[test]
fn limit_that_is_open_at_power_up_is_one() {
    let mut bench = Bench::reset(true);
    bench.pass(MS);
    bench.refuse(Command::Go { index: 2 }, Refusal::AtLimit);
    bench.set(1, 100, Reverse);
    bench.digit(1);
    bench.pass(50 * MS);
    assert_eq!(bench.turning(), Some((Reverse, 50)));
}

#[test]
fn carriage_backs_off_a_bouncing_switch_which_then_guards_again() {
    let mut bench = Bench::at_limit();
    bench.set(1, 200, Reverse);
    bench.digit(1);
    bench.pass(30 * MS);
    assert_eq!(bench.turning(), Some((Reverse, 30)));
    // It closes and opens for 15 ms, in all sorts of times.
    for us in [40, 900, 2500, 100, 3000, 500, 10, 4000, 2500, 1450] {
        bench.motor.switch(!bench.motor.open);
        bench.pass(us * MS / 1000);
    }
    assert!(bench.motor.open);
    bench.motor.switch(false);
    let closed = bench.now;
    bench.pass(CLEAR_OF_LIMIT - TURN - 1);
    assert_eq!(bench.motor.guard, Guard::Off);
    bench.pass(TURN + 1);
    assert_eq!(bench.motor.guard, Guard::On, "{} ticks", ticks_between(closed, bench.now));
    bench.pass(300 * MS);
    assert_eq!(bench.turning(), Some((Reverse, 200)));
    assert_eq!((CLEAR_OF_LIMIT, bench.unit.state()), (20 * MS, DriveState::Running));
    // Its wire breaks.
    bench.motor.switch(true);
    assert_eq!(bench.turning(), None);
}

#[test]
fn carriage_that_did_not_get_clear_is_guarded_against_going_back() {
    let mut bench = Bench::at_limit();
    bench.set(1, 200, Reverse);
    bench.digit(1);
    bench.pass(30 * MS);
    bench.motor.switch(false);
    bench.pass(5 * MS);
    // Forward again before the switch has been closed for 20 ms.
    bench.digit(2);
    bench.pass(5 * MS);
    assert_eq!(bench.turning(), Some((Forward, 5)));
    bench.motor.switch(true);
    assert_eq!(bench.turning(), None);
    bench.pass(300 * MS);
    assert_eq!((bench.turning(), bench.unit.state()), (None, DriveState::AtLimit));
}

#[test]
fn carriage_stopped_while_backing_off_can_back_off_again() {
    let mut bench = Bench::at_limit();
    bench.set(1, 200, Reverse);
    for _ in 0..3 {
        bench.digit(1);
        bench.pass(30 * MS);
        assert_eq!(bench.turning(), Some((Reverse, 30)));
        bench.obey(Command::Stop);
        bench.pass(30 * MS);
        assert_eq!((bench.turning(), bench.unit.state()), (None, DriveState::AtLimit));
    }
    bench.refuse(Command::Go { index: 2 }, Refusal::AtLimit);
}

#[test]
fn spike_at_the_limit_cuts_and_is_over_after_20_ms() {
    // Shorter than a turn of the loop, which never sees the switch open.
    let mut bench = Bench::new();
    bench.digit(5);
    bench.pass(300 * MS);
    bench.motor.switch(true);
    bench.motor.switch(false);
    bench.pass(CLEAR_OF_LIMIT - TURN);
    assert_eq!((bench.turning(), bench.unit.state()), (None, DriveState::AtLimit));
    bench.pass(3 * TURN);
    assert_eq!(bench.unit.state(), DriveState::Stopped);
    assert_eq!(bench.last_told(), (5, DriveState::Stopped, false));
    bench.pass(1000 * MS);
    assert_eq!(bench.turning(), None);
    bench.digit(5);
    bench.pass(300 * MS);
    assert_eq!(bench.turning(), Some((Forward, 66 + 105)));
}

#[test]
fn carriage_backs_off_a_switch_that_the_loop_has_not_seen_open() {
    let mut bench = Bench::new();
    bench.set(1, 200, Reverse);
    bench.digit(5);
    bench.pass(300 * MS);
    // The interrupt comes just after the loop has read the time.
    bench.motor.now = bench.now + TURN + 3;
    bench.motor.switch(true);
    bench.motor.switch(false);
    bench.motor.now = bench.now;
    bench.turn(TURN);
    bench.digit(1);
    bench.pass(5 * MS);
    bench.motor.switch(true);
    bench.motor.switch(false);
    bench.pass(5 * MS);
    assert_eq!(bench.turning(), Some((Reverse, 10)));
}

#[test]
fn stop_while_the_switch_bounces_is_not_at_the_limit_for_ever() {
    // Also when it was open last more than half a turn of the counter ago.
    for idle in [0, u32::MAX / 2 + 1000 * MS] {
        let mut bench = Bench::new();
        bench.turn(idle);
        bench.motor.guard = Guard::Off;
        bench.motor.switch(true);
        bench.obey(Command::Stop);
        assert_eq!(bench.unit.state(), DriveState::AtLimit);
        bench.motor.switch(false);
        bench.pass(30 * MS);
        assert_eq!(bench.unit.state(), DriveState::Stopped);
    }
}

#[test]
fn drive_works_across_the_wrap_of_the_counter() {
    let mut bench = Bench::new();
    bench.now = u32::MAX - 100 * MS;
    bench.digit(9);
    bench.pass(255 * MS);
    assert_eq!((bench.turning(), bench.unit.state()), (Some((Forward, 255)), DriveState::Running));
}

#[test]
fn switch_closed_for_half_an_hour_is_still_clear() {
    // Times are compared modulo 35 min 47 s.
    let mut bench = Bench::at_limit();
    bench.motor.switch(false);
    bench.pass(100 * MS);
    bench.set(1, 200, Reverse);
    for _ in 0..60 {
        bench.turn(u32::MAX / 20);
        bench.digit(1);
        assert_eq!(bench.motor.guard, Guard::On);
        bench.obey(Command::Stop);
        assert_eq!(bench.unit.state(), DriveState::Stopped);
    }
}

/// What happens in one turn of the loop. The switch may change at four places of it.
#[derive(Debug, Clone)]
struct Turn {
    ticks: u32,
    open: [Option<bool>; 4],
    key: Option<Key>,
    command: Option<Command>,
}

fn turns() -> impl Strategy<Value = Turn> {
    let open = || prop::option::weighted(0.05, any::<bool>());
    let key = prop_oneof![3 => (0..10_u8).prop_map(Key::Digit), 1 => Just(Key::Stop)];
    let preset = (any::<u8>(), any::<bool>())
        .prop_map(|(duty, forward)| Preset { duty, direction: if forward { Forward } else { Reverse } });
    let command = prop_oneof![
        4 => (0..12_u8).prop_map(|index| Command::Go { index }),
        4 => (0..12_u8, preset).prop_map(|(index, preset)| Command::SetPreset { index, preset }),
        1 => Just(Command::Stop),
        1 => Just(Command::Status),
        1 => Just(Command::SelfTest),
    ];
    // Some turns are many turns in which nothing else happens.
    let ticks = prop_oneof![8 => 1..2 * TURN, 3 => 1..10 * MS, 2 => 10 * MS..60 * MS];
    let open = [open(), open(), open(), open()];
    (ticks, open, prop::option::weighted(0.15, key), prop::option::weighted(0.2, command))
        .prop_map(|(ticks, open, key, command)| Turn { ticks, open, key, command })
}

/// Follows what the motor does; its duty may rise by one for each millisecond.
struct Watch {
    at: u32,
    duty: u8,
    /// When a preset was chosen last, and when last from standstill.
    chosen: u32,
    started: u32,
}

impl Watch {
    /// After preset `index` was asked for, which may have been refused.
    fn choose(&mut self, index: u8, bench: &Bench) {
        if (bench.unit.index(), bench.unit.state()) != (index, DriveState::Starting) {
            return;
        }
        self.chosen = bench.now;
        if bench.turning().is_none() {
            self.started = bench.now;
        }
    }

    fn look(&mut self, bench: &Bench) {
        let now = bench.now;
        let ms = |since| ticks_between(since, now) / MS;
        if let Some((direction, duty)) = bench.turning() {
            let preset = bench.unit.preset();
            assert_eq!(direction, preset.direction);
            assert!(u32::from(duty) <= ms(self.started), "{duty} after {} ms", ms(self.started));
            assert!(u32::from(duty) <= u32::from(self.duty) + ms(self.at) + 1, "{duty} after {}", self.duty);
            // A slower preset is reached within a millisecond.
            let slowing = duty == self.duty && ms(self.chosen) < 1;
            assert!(duty <= preset.duty || slowing, "{duty} of {}", preset.duty);
        }
        (self.at, self.duty) = (now, bench.turning().map_or(0, |(_, duty)| duty));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    /// That it never turns forward while the switch is open is checked by the motor itself.
    #[test]
    fn whatever_happens_the_motor_is_started_softly_and_guarded(
        open: bool,
        presets in prop::collection::vec((any::<u8>(), any::<bool>()), 10),
        turns in prop::collection::vec(turns(), 1..150),
    ) {
        let mut bench = Bench::reset(open);
        for (index, (duty, forward)) in (0..).zip(presets) {
            bench.set(index, duty, if forward { Forward } else { Reverse });
        }
        let mut watch = Watch { at: 0, duty: 0, chosen: 0, started: 0 };
        for Turn { mut ticks, open, key, command } in turns {
            while ticks > 10 * MS {
                bench.turn(TURN);
                watch.look(&bench);
                ticks -= TURN;
            }
            bench.now += ticks;
            bench.motor.now = bench.now;
            let mut changes = open.into_iter();
            let mut change = |bench: &mut Bench| {
                if let Some(open) = changes.next().flatten() {
                    bench.motor.switch(open);
                }
            };
            change(&mut bench);
            if let Some(tick) = bench.motor.hit.take() {
                bench.unit.limit_hit(tick, &mut bench.motor);
                prop_assert_eq!((bench.unit.state(), bench.turning()), (DriveState::AtLimit, None));
            }
            change(&mut bench);
            if let Some(key) = key {
                bench.unit.key(key, bench.now, &mut bench.motor);
                if let Key::Digit(index) = key {
                    watch.choose(index, &bench);
                }
            }
            change(&mut bench);
            bench.unit.step(bench.now, &mut bench.motor);
            watch.look(&bench);
            change(&mut bench);
            if let Some(command) = command {
                bench.command(command);
                if let Command::Go { index } = command {
                    watch.choose(index, &bench);
                }
            }
            watch.look(&bench);
            bench.told.extend(bench.unit.report(&bench.motor));
        }
        // Never from one direction straight to the other.
        for pair in bench.motor.history.windows(2) {
            prop_assert!(pair.contains(&None), "{pair:?}");
        }
        // The switch guards in the end, if it is closed and the carriage clear of it.
        bench.motor.switch(false);
        bench.pass(100 * MS);
        if bench.turning().is_some() {
            prop_assert_eq!(bench.motor.guard, Guard::On);
        }
        bench.obey(Command::Stop);
        prop_assert_eq!((bench.turning(), bench.unit.state()), (None, DriveState::Stopped));
        bench.pass(100 * MS);
        prop_assert_eq!(bench.turning(), None);
        let preset = bench.unit.preset();
        let told = bench.told.iter().rev().find(|report| matches!(report, Report::Preset { .. }));
        let index = bench.unit.index();
        prop_assert_eq!(told, Some(&Report::Preset { index, preset, state: DriveState::Stopped, limit: false }));
    }
}
