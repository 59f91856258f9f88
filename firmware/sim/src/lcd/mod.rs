//! A display of two rows of 16 characters with an HD44780U controller on a four-bit bus, write only (R/W at ground).
//!
//! It reads the logs of the watched pins, while the program runs or afterwards, and holds the program to the
//! controller's times. The logs give a pin's change by the start of the instruction that made it, and OUT, SBI and STS
//! move the pin 1 or 2 cycles later: an interval is known to one cycle, 62.5 ns, which the bus times are judged with in
//! the program's favour.
//!
//! # Reference
//! Hitachi, HD44780U (ADE-207-272(Z), 1999): table 6 instructions, figure 24 initialisation by instruction, bus timing
//! characteristics at 2.7 V (the slower).

mod controller;

pub use controller::{COLUMNS, Controller};

use crate::{CYCLES_PER_SECOND, Mcu, Pin, pin::Change};

/// The pins of the Nano that the display hangs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LcdPins {
    /// Register select: low for commands, high for characters.
    pub rs: Pin,
    /// Enable.
    pub e: Pin,
    /// D4 to D7.
    pub d: [Pin; 4],
}

/// A rule of the data sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// 15 ms from power-up to the first instruction.
    PowerUp,
    /// 4.1 ms after the first function set of the initialisation, 100 µs after the second.
    Initialisation,
    /// 450 ns of E high.
    EnableHigh,
    /// 1 µs from rise to rise of E within a byte.
    EnableCycle,
    /// 60 ns of RS before E rises.
    AddressSetup,
    /// 195 ns of data before E falls.
    DataSetup,
    /// 20 ns of RS, 10 ns of data behind the fall of E.
    Hold,
    /// 37 µs after a command, 41 µs after a character, 1.52 ms after clear and home.
    Execution,
}

/// A time that was too short.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Violation {
    /// Cycle at which it was noticed.
    pub cycle: u64,
    /// The rule.
    pub rule: Rule,
    /// Time that there was, ns.
    pub took_ns: f64,
    /// Time that it takes, ns.
    pub needs_ns: f64,
}

const NS_PER_CYCLE: f64 = 1e9 / CYCLES_PER_SECOND as f64;

/// The display and its record.
#[derive(Debug, Clone)]
pub struct Lcd {
    pins: LcdPins,
    /// How much of each pin's log was read: RS, E, D4 to D7.
    read: [usize; 6],
    level: [bool; 6],
    moved: [u64; 6],
    enable_rise: Option<u64>,
    enable_fall: Option<u64>,
    /// Cycle from which, and for how long, ns, the controller is busy, and by which rule.
    busy: (u64, f64, Rule),
    controller: Controller,
    violations: Vec<Violation>,
}

const RS: usize = 0;
const E: usize = 1;
const D: usize = 2;

impl Lcd {
    /// A display that is powered at cycle 0. Its pins must be watched from then on ([`Lcd::watch`]).
    pub fn new(pins: LcdPins) -> Self {
        Self {
            pins,
            read: [0; 6],
            level: [false; 6],
            moved: [0; 6],
            enable_rise: None,
            enable_fall: None,
            busy: (0, 15e6, Rule::PowerUp),
            controller: Controller::default(),
            violations: Vec::new(),
        }
    }

    fn lines(&self) -> [Pin; 6] {
        let LcdPins { rs, e, d } = self.pins;
        [rs, e, d[0], d[1], d[2], d[3]]
    }

    /// Has the controller log the display's pins.
    pub fn watch(&self, mcu: &mut Mcu) {
        for pin in self.lines() {
            mcu.watch(pin);
        }
    }

    /// Reads what the pins did since the last call.
    pub fn follow(&mut self, mcu: &Mcu) {
        let logs = self.lines().map(|pin| mcu.changes(pin));
        self.feed(logs);
    }

    /// Reads logs of RS, E and D4 to D7, each in the order of time; what was read of them before is passed over.
    pub fn feed(&mut self, logs: [&[Change]; 6]) {
        loop {
            let heads = [0, 1, 2, 3, 4, 5].map(|line| logs[line].get(self.read[line]).map(|change| change.cycle));
            let Some(cycle) = heads.into_iter().flatten().min() else { break };
            // What moves together with a rise of E was there first; with its fall, the data follow it.
            let falls = logs[E].get(self.read[E]).is_some_and(|change| change.cycle == cycle && !change.level);
            let order = if falls { [E, RS, D, D + 1, D + 2, D + 3] } else { [RS, D, D + 1, D + 2, D + 3, E] };
            for line in order {
                while let Some(change) = logs[line].get(self.read[line]).filter(|change| change.cycle == cycle) {
                    self.read[line] += 1;
                    self.step(line, *change);
                }
            }
        }
    }

    fn step(&mut self, line: usize, change: Change) {
        if self.level[line] == change.level {
            return;
        }
        let cycle = change.cycle;
        if line == E {
            if change.level {
                self.rise(cycle);
            } else {
                self.fall(cycle);
            }
        } else if let Some(fall) = self.enable_fall.filter(|fall| *fall == cycle) {
            self.judge(Rule::Hold, fall, cycle, if line == RS { 20.0 } else { 10.0 }, 0);
        }
        self.level[line] = change.level;
        self.moved[line] = cycle;
    }

    /// Notes a violation when `from..to` is shorter than it must be even with `slack` cycles more.
    fn judge(&mut self, rule: Rule, from: u64, to: u64, needs_ns: f64, slack: u64) {
        let took_ns = (to - from) as f64 * NS_PER_CYCLE;
        if took_ns + slack as f64 * NS_PER_CYCLE < needs_ns {
            self.violations.push(Violation { cycle: to, rule, took_ns, needs_ns });
        }
    }

    fn rise(&mut self, cycle: u64) {
        if self.moved[RS] > 0 {
            self.judge(Rule::AddressSetup, self.moved[RS], cycle, 60.0, 0);
        }
        if let Some(rise) = self.enable_rise {
            self.judge(Rule::EnableCycle, rise, cycle, 1000.0, 1);
        }
        let (from, needs_ns, rule) = self.busy;
        self.judge(rule, from, cycle, needs_ns, 1);
        self.enable_rise = Some(cycle);
    }

    fn fall(&mut self, cycle: u64) {
        self.judge(Rule::EnableHigh, self.enable_rise.unwrap_or(cycle), cycle, 450.0, 1);
        let latest = self.moved[D..].iter().copied().max().unwrap_or(0);
        if latest > 0 {
            self.judge(Rule::DataSetup, latest, cycle, 195.0, 1);
        }
        self.enable_fall = Some(cycle);
        let nibble = self.level[D..].iter().rev().fold(0, |nibble, level| nibble << 1 | u8::from(*level));
        let busy = self.controller.nibble(self.level[RS], nibble);
        self.busy = (cycle, busy.needs_ns, busy.rule);
    }

    /// What a row (0 or 1) of the display shows, 16 characters; blanks while it is off.
    pub fn text(&self, row: usize) -> String {
        self.controller.text(row)
    }

    /// The controller behind it.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// What was too fast for the display, in the order of time.
    pub fn violations(&self) -> &[Violation] {
        &self.violations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PINS: LcdPins = LcdPins { rs: Pin::D12, e: Pin::D10, d: [Pin::D4, Pin::D5, Pin::D6, Pin::D7] };

    /// A driver that writes pin logs with given times.
    struct Driver {
        logs: [Vec<Change>; 6],
        now: u64,
    }

    impl Driver {
        fn started() -> Self {
            let mut driver = Self { logs: Default::default(), now: 0 };
            for (wait_us, nibble) in [(15_000, 3), (4_100, 3), (100, 3), (37, 2)] {
                driver.now += wait_us * 16;
                driver.nibble(false, nibble, 8);
            }
            for command in [0x28, 0x0c, 0x06, 0x01] {
                driver.byte(false, command);
            }
            driver.now += 1_520 * 16;
            driver
        }

        fn put(&mut self, line: usize, level: bool) {
            self.logs[line].push(Change { cycle: self.now, level });
        }

        fn nibble(&mut self, rs: bool, nibble: u8, high: u64) {
            self.put(RS, rs);
            for bit in 0..4 {
                self.put(D + bit, nibble >> bit & 1 != 0);
            }
            self.now += 1;
            self.put(E, true);
            self.now += high;
            self.put(E, false);
            self.now += 8;
        }

        fn byte(&mut self, rs: bool, byte: u8) {
            self.now += 41 * 16;
            self.nibble(rs, byte >> 4, 8);
            self.nibble(rs, byte & 0xf, 8);
        }

        fn print(&mut self, text: &str) {
            text.bytes().for_each(|byte| self.byte(true, byte));
        }

        fn shown(&self) -> Lcd {
            let mut lcd = Lcd::new(PINS);
            lcd.feed([0, 1, 2, 3, 4, 5].map(|line| self.logs[line].as_slice()));
            lcd
        }
    }

    #[test]
    fn text_is_where_the_cursor_was_put() {
        let mut driver = Driver::started();
        driver.print("Speed");
        driver.byte(false, 0x80 | 0x42);
        driver.print("1.234 m/s");
        let lcd = driver.shown();
        assert_eq!((lcd.text(0).as_str(), lcd.text(1).as_str()), ("Speed           ", "  1.234 m/s     "));
        assert_eq!(lcd.violations(), []);
        driver.byte(false, 0x01);
        assert_eq!(driver.shown().text(1), " ".repeat(16));
    }

    #[test]
    fn reading_piece_by_piece_is_reading_at_once() {
        let mut driver = Driver::started();
        let mut online = driver.shown();
        driver.print("ab");
        online.feed([0, 1, 2, 3, 4, 5].map(|line| driver.logs[line].as_slice()));
        assert_eq!(online.text(0), driver.shown().text(0));
        assert_eq!(online.violations(), driver.shown().violations());
    }

    #[test]
    fn each_rule_is_held() {
        let rules = |act: fn(&mut Driver)| {
            let mut driver = Driver::started();
            act(&mut driver);
            driver.shown().violations().iter().map(|violation| violation.rule).collect::<Vec<_>>()
        };
        assert_eq!(rules(|driver| driver.print("fine")), []);
        assert_eq!(
            rules(|driver| {
                driver.now += 1000;
                driver.nibble(true, 4, 5);
                driver.nibble(true, 1, 10);
            }),
            [Rule::EnableHigh, Rule::EnableCycle]
        );
        assert_eq!(
            rules(|driver| {
                driver.byte(false, 0x02);
                driver.now += 1_500 * 16;
                driver.byte(true, b'x');
            }),
            [],
            "1.5 ms and the 41 us before each byte are enough"
        );
        assert_eq!(
            rules(|driver| {
                driver.byte(false, 0x02);
                driver.byte(true, b'x');
            }),
            [Rule::Execution]
        );
        assert_eq!(
            rules(|driver| {
                driver.now += 1000;
                driver.put(E, true);
                driver.put(RS, true);
                driver.now += 10;
                driver.put(E, false);
                driver.put(D + 3, true);
            }),
            [Rule::AddressSetup, Rule::Hold]
        );
        let mut early = Driver { logs: Default::default(), now: 14_000 * 16 };
        early.nibble(false, 3, 8);
        early.now += 4_000 * 16;
        early.nibble(false, 3, 8);
        let violations: Vec<_> = early.shown().violations().iter().map(|violation| violation.rule).collect();
        assert_eq!(violations, [Rule::PowerUp, Rule::Initialisation]);
    }
}
