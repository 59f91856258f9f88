//! One timer's waveform generator.

use super::PwmChange;
use crate::{avr::Bus, pin::Pin};

const HZ: f64 = crate::CYCLES_PER_SECOND as f64;

/// How a timer counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shape {
    Normal,
    Ctc,
    Fast,
    PhaseCorrect,
}

/// Where TOP is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Top {
    Fixed(u32),
    Ocr,
    Icr,
}

/// Register addresses of a timer.
pub(super) struct Layout {
    pub(super) control_a: u16,
    pub(super) control_b: u16,
    pub(super) count: u16,
    pub(super) capture: u16,
    pub(super) compare: [u16; 2],
    wide: bool,
    pub(super) pins: [Pin; 2],
}

pub(super) const LAYOUTS: [Layout; 3] = [
    Layout {
        control_a: 0x44,
        control_b: 0x45,
        count: 0x46,
        capture: 0,
        compare: [0x47, 0x48],
        wide: false,
        pins: [Pin::D6, Pin::D5],
    },
    Layout {
        control_a: 0x80,
        control_b: 0x81,
        count: 0x84,
        capture: 0x86,
        compare: [0x88, 0x8a],
        wide: true,
        pins: [Pin::D9, Pin::D10],
    },
    Layout {
        control_a: 0xb0,
        control_b: 0xb1,
        count: 0xb2,
        capture: 0,
        compare: [0xb3, 0xb4],
        wide: false,
        pins: [Pin::D11, Pin::D3],
    },
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Act {
    Set,
    Clear,
    Toggle,
}

#[derive(Debug, Default)]
pub(super) struct Channel {
    /// COM bits as they act: 0 when the mode has the pin left to PORT.
    pub(super) com: u8,
    ocr: u32,
    pub(super) level: bool,
    next: Option<(u64, Act)>,
    pub(super) log: Vec<PwmChange>,
}

#[derive(Debug)]
pub(super) struct Unit {
    /// Cycles of a timer clock, 0 when it stands.
    prescaler: i64,
    shape: Shape,
    top_from: Top,
    top: u32,
    /// Cycle at which the count is 0 and going up.
    epoch: i64,
    /// Where the timer stands, ticks from BOTTOM, when it does.
    standing: i64,
    /// When new values leave their buffers.
    latch: Option<u64>,
    pub(super) channels: [Channel; 2],
}

impl Default for Unit {
    fn default() -> Self {
        Self {
            prescaler: 0,
            shape: Shape::Normal,
            top_from: Top::Fixed(0xff),
            top: 0xff,
            epoch: 0,
            standing: 0,
            latch: None,
            channels: Default::default(),
        }
    }
}

impl Channel {
    pub(super) fn note(&mut self, cycle: u64, duty: Option<f64>, frequency_hz: f64) {
        let (last_duty, last_frequency) = self.log.last().map_or((None, 0.0), |last| (last.duty, last.frequency_hz));
        if (last_duty, last_frequency) != (duty, frequency_hz) {
            self.log.push(PwmChange { cycle, duty, frequency_hz });
        }
    }
}

fn read(layout: &Layout, bus: Bus<'_>, address: u16) -> u32 {
    let high = if layout.wide { u32::from(bus.data(address + 1)) << 8 } else { 0 };
    high | u32::from(bus.data(address))
}

/// Waveform generation modes, tables 15-8 and 16-4.
fn mode(layout: &Layout, a: u8, b: u8) -> (Shape, Top) {
    use Shape::{Ctc, Fast, Normal, PhaseCorrect};
    let fixed = |bits: u32| Top::Fixed((1 << bits) - 1);
    if !layout.wide {
        return match (a & 0b11, b >> 3 & 1) {
            (1, 0) => (PhaseCorrect, fixed(8)),
            (1, _) => (PhaseCorrect, Top::Ocr),
            (2, 0) => (Ctc, Top::Ocr),
            (3, 0) => (Fast, fixed(8)),
            (3, _) => (Fast, Top::Ocr),
            _ => (Normal, fixed(8)),
        };
    }
    match a & 0b11 | b >> 1 & 0b1100 {
        n @ 1..=3 => (PhaseCorrect, fixed(7 + u32::from(n))),
        4 => (Ctc, Top::Ocr),
        n @ 5..=7 => (Fast, fixed(3 + u32::from(n))),
        8 | 10 => (PhaseCorrect, Top::Icr),
        9 | 11 => (PhaseCorrect, Top::Ocr),
        12 => (Ctc, Top::Icr),
        14 => (Fast, Top::Icr),
        15 => (Fast, Top::Ocr),
        _ => (Normal, fixed(16)),
    }
}

fn prescaler(layout: &Layout, b: u8) -> i64 {
    let usual = [0, 1, 8, 64, 256, 1024, 0, 0];
    let second = [0, 1, 8, 32, 64, 128, 256, 1024];
    (if layout.control_b == 0xb1 { second } else { usual })[usize::from(b & 0b111)]
}

impl Unit {
    pub(super) fn due(&self) -> Option<u64> {
        let edges = self.channels.iter().filter_map(|channel| channel.next.map(|(cycle, _)| cycle));
        edges.chain(self.latch).min()
    }

    fn period(&self) -> i64 {
        match self.shape {
            Shape::PhaseCorrect => 2 * i64::from(self.top.max(1)),
            _ => i64::from(self.top) + 1,
        }
    }

    /// Ticks since BOTTOM; below 0 while a count beyond TOP runs out.
    fn ticks(&self, cycle: u64) -> i64 {
        if self.prescaler == 0 {
            return self.standing;
        }
        let elapsed = (cycle as i64 - self.epoch).div_euclid(self.prescaler);
        if elapsed < 0 { elapsed } else { elapsed % self.period() }
    }

    /// Duty and frequency of a connected channel.
    pub(super) fn wave(&self, i: usize) -> (f64, f64) {
        let channel = &self.channels[i];
        let steady = (if channel.level { 1.0 } else { 0.0 }, 0.0);
        if self.prescaler == 0 {
            return steady;
        }
        let clock = HZ / self.prescaler as f64 / self.period() as f64;
        let share = match self.shape {
            _ if channel.com == 1 => return (0.5, clock / 2.0),
            Shape::Normal | Shape::Ctc => return steady,
            Shape::Fast => f64::from(channel.ocr.min(self.top) + 1) / f64::from(self.top + 1),
            Shape::PhaseCorrect => f64::from(channel.ocr.min(self.top)) / f64::from(self.top.max(1)),
        };
        let duty = if channel.com == 2 { share } else { 1.0 - share };
        (duty, if share == 0.0 || share == 1.0 { 0.0 } else { clock })
    }

    /// The edges of one period in ticks from BOTTOM.
    fn edges(&self, i: usize) -> [Option<(i64, Act)>; 2] {
        let channel = &self.channels[i];
        let (ocr, top) = (i64::from(channel.ocr), i64::from(self.top));
        let (up, down) = if channel.com == 3 { (Act::Clear, Act::Set) } else { (Act::Set, Act::Clear) };
        let matched = (ocr <= top).then_some((ocr + 1) % self.period());
        match (self.shape, channel.com) {
            (_, 0) => [None, None],
            (Shape::PhaseCorrect, 1) => [Some((ocr.min(top), Act::Toggle)), None],
            (_, 1) => [matched.map(|tick| (tick, Act::Toggle)), None],
            (Shape::Normal | Shape::Ctc, 2) => [matched.map(|tick| (tick, Act::Clear)), None],
            (Shape::Normal | Shape::Ctc, _) => [matched.map(|tick| (tick, Act::Set)), None],
            (Shape::Fast | Shape::PhaseCorrect, _) if ocr >= top => [Some((0, up)), None],
            (Shape::Fast, _) => [Some((0, up)), Some((ocr + 1, down))],
            (Shape::PhaseCorrect, _) if ocr == 0 => [Some((0, down)), None],
            (Shape::PhaseCorrect, _) => [Some((ocr, down)), Some((2 * top - ocr, up))],
        }
    }

    /// The level that a connected PWM output has in the middle of a period.
    fn level_at(&self, i: usize, cycle: u64) -> bool {
        let tick = self.ticks(cycle);
        let last = self.edges(i).into_iter().flatten();
        // Before the first edge of a period the last one of the period before holds.
        let act = last.max_by_key(|(edge, _)| if *edge <= tick { edge + self.period() } else { *edge });
        act.map_or(self.channels[i].level, |(_, act)| act == Act::Set)
    }

    /// Finds each channel's first edge at `from` or later.
    fn plan(&mut self, from: u64) {
        for i in 0..2 {
            let edges = self.edges(i);
            let running = self.prescaler != 0;
            let cycles = edges.into_iter().flatten().filter(|_| running).map(|(tick, act)| {
                let first = self.epoch + tick * self.prescaler;
                let period = self.period() * self.prescaler;
                let late = (from as i64 - first).max(0);
                ((first + (late + period - 1) / period * period) as u64, act)
            });
            let next = cycles.min_by_key(|(cycle, _)| *cycle);
            self.channels[i].next = next;
        }
    }

    pub(super) fn event(&mut self, layout: &Layout, bus: Bus<'_>, due: u64) {
        if self.latch.take_if(|latch| *latch <= due).is_some() {
            self.take_over(layout, bus);
            let tick = if self.shape == Shape::PhaseCorrect { i64::from(self.top) } else { 0 };
            self.epoch = due as i64 - tick * self.prescaler;
            self.plan(due);
        }
        let mut acted = false;
        for channel in &mut self.channels {
            if let Some((_, act)) = channel.next.filter(|(cycle, _)| *cycle <= due) {
                channel.level = match act {
                    Act::Set => true,
                    Act::Clear => false,
                    Act::Toggle => !channel.level,
                };
                acted = true;
            }
        }
        if acted {
            self.plan(due + 1);
        }
    }

    /// Compare values and TOP from the registers.
    fn take_over(&mut self, layout: &Layout, bus: Bus<'_>) {
        for i in 0..2 {
            self.channels[i].ocr = read(layout, bus, layout.compare[i]);
        }
        self.top = match self.top_from {
            Top::Fixed(top) => top,
            Top::Ocr => self.channels[0].ocr,
            Top::Icr => read(layout, bus, layout.capture),
        };
    }

    pub(super) fn written(&mut self, layout: &Layout, bus: Bus<'_>, address: u16) {
        let now = bus.cycle();
        let is_pwm = matches!(self.shape, Shape::Fast | Shape::PhaseCorrect);
        if layout.compare.contains(&address) && is_pwm && self.prescaler != 0 {
            self.latch = Some(self.next_update(now));
            return;
        }
        let count = if address == layout.count {
            i64::from(read(layout, bus, layout.count))
        } else {
            let ticks = self.ticks(now);
            let max = if layout.wide { 0x1_0000 } else { 0x100 };
            if ticks < 0 { ticks + max } else { ticks }
        };
        let (a, b) = (bus.data(layout.control_a), bus.data(layout.control_b));
        let was = (self.shape, self.prescaler, [self.channels[0].com, self.channels[1].com]);
        let old_top = self.top;
        (self.shape, self.top_from) = mode(layout, a, b);
        self.prescaler = prescaler(layout, b);
        if self.latch.is_none() || (self.shape, self.prescaler) != (was.0, was.1) {
            self.latch = None;
            self.take_over(layout, bus);
        }
        let is_pwm = matches!(self.shape, Shape::Fast | Shape::PhaseCorrect);
        for (i, shift) in [6, 4].into_iter().enumerate() {
            let com = a >> shift & 0b11;
            // Tables 15-3 and 15-6: a toggling output exists in PWM modes only for A, and only where OCRA is TOP.
            let toggles = !is_pwm || i == 0 && self.top_from == Top::Ocr;
            self.channels[i].com = if com == 1 && !toggles { 0 } else { com };
        }
        let moved =
            address == layout.count || (self.shape, self.prescaler) != (was.0, was.1) || !is_pwm || self.top != old_top;
        if moved {
            self.restart(layout, now, count, self.prescaler == was.1);
            if self.latch.is_some() {
                self.latch = Some(self.next_update(now));
            }
        }
        for i in 0..2 {
            if is_pwm && self.channels[i].com > 1 && (self.channels[i].com != was.2[i] || moved) {
                self.channels[i].level = self.level_at(i, now);
            }
        }
        self.plan(now + 1);
    }

    /// Cycle of the next BOTTOM (fast) or TOP (phase correct), where new values leave their buffers.
    fn next_update(&self, now: u64) -> u64 {
        let target = if self.shape == Shape::PhaseCorrect { i64::from(self.top) } else { 0 };
        let ticks = (target - self.ticks(now) - 1).rem_euclid(self.period()) + 1;
        let tick_start = (now as i64 - self.epoch).div_euclid(self.prescaler) * self.prescaler + self.epoch;
        (tick_start + ticks * self.prescaler) as u64
    }

    /// Lets the timer count on from `count` with what the registers say now.
    fn restart(&mut self, layout: &Layout, now: u64, count: i64, same_clock: bool) {
        let beyond = count >= self.period();
        let max = if layout.wide { 0x1_0000 } else { 0x100 };
        let ticks = if beyond { count - max } else { count };
        self.standing = ticks;
        if self.prescaler != 0 {
            let phase = if same_clock { (now as i64 - self.epoch).rem_euclid(self.prescaler) } else { 0 };
            self.epoch = now as i64 - ticks * self.prescaler - phase;
        }
    }
}
