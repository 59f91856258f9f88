//! How often and how long the interrupts run, and how long they wait.

use crate::avr::VECTORS;

/// Names of the vectors as in the datasheet (table 12-6), by number; the first is the reset.
pub const VECTOR_NAMES: [&str; VECTORS] = [
    "RESET",
    "INT0",
    "INT1",
    "PCINT0",
    "PCINT1",
    "PCINT2",
    "WDT",
    "TIMER2_COMPA",
    "TIMER2_COMPB",
    "TIMER2_OVF",
    "TIMER1_CAPT",
    "TIMER1_COMPA",
    "TIMER1_COMPB",
    "TIMER1_OVF",
    "TIMER0_COMPA",
    "TIMER0_COMPB",
    "TIMER0_OVF",
    "SPI_STC",
    "USART_RX",
    "USART_UDRE",
    "USART_TX",
    "ADC",
    "EE_READY",
    "ANALOG_COMP",
    "TWI",
    "SPM_READY",
];

/// Cycles of RETI, which ends a run.
const RETI_CYCLES: u64 = 4;

/// What is known of one vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Interrupt {
    /// Number of the vector.
    pub vector: u8,
    /// Times its handler was entered.
    pub runs: u64,
    /// Cycles that its longest run took from the core: the 4 of the entry, the jump from the table, the handler, RETI,
    /// and whatever interrupted it.
    pub longest_run: u64,
    /// Most cycles from the request (flag raised and enabled in its mask register, the global bit notwithstanding) to
    /// the start of the entry.
    pub longest_latency: u64,
}

impl Interrupt {
    /// The vector's name in the datasheet.
    pub fn name(&self) -> &'static str {
        VECTOR_NAMES[usize::from(self.vector)]
    }
}

/// One run of a handler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// Number of the vector.
    pub vector: u8,
    /// Cycle of the request.
    pub requested: u64,
    /// Cycle at which the entry began.
    pub entered: u64,
    /// Cycle after RETI.
    pub left: u64,
}

#[derive(Debug, Clone, Copy, Default)]
struct State {
    requested: Option<u64>,
    entered: Option<(u64, u64)>,
}

/// Counts of all vectors and, on demand, every run.
///
/// simavr itself charges nothing for entering an interrupt; the harness adds the hardware's 4 cycles, 8 out of sleep.
#[derive(Debug)]
pub struct InterruptLog {
    vectors: [Interrupt; VECTORS],
    states: [State; VECTORS],
    runs: Option<Vec<Run>>,
}

impl Default for InterruptLog {
    fn default() -> Self {
        let mut vectors = [Interrupt::default(); VECTORS];
        for (number, vector) in vectors.iter_mut().enumerate() {
            vector.vector = number as u8;
        }
        Self { vectors, states: [State::default(); VECTORS], runs: None }
    }
}

impl InterruptLog {
    /// The vector of a name as in the datasheet, `"TIMER1_CAPT"`; `None` when there is no such vector.
    pub fn of(&self, name: &str) -> Option<Interrupt> {
        self.iter().find(|vector| vector.name() == name)
    }

    /// All vectors but the reset.
    pub fn iter(&self) -> impl Iterator<Item = Interrupt> + '_ {
        self.vectors[1..].iter().copied()
    }

    /// Every finished run since the log was switched on, in the order of their ends; empty while it is off.
    pub fn runs(&self) -> &[Run] {
        self.runs.as_deref().unwrap_or_default()
    }

    pub(crate) fn record(&mut self, on: bool) {
        self.runs = on.then(Vec::new);
    }

    pub(crate) fn reset(&mut self) {
        self.states = [State::default(); VECTORS];
    }

    pub(crate) fn pending(&mut self, vector: usize, pending: bool, cycle: u64) {
        let requested = &mut self.states[vector].requested;
        *requested = if pending { Some(requested.unwrap_or(cycle)) } else { None };
    }

    pub(crate) fn enter(&mut self, vector: usize, cycle: u64) {
        let state = &mut self.states[vector];
        let requested = state.requested.take().unwrap_or(cycle);
        state.entered = Some((requested, cycle));
        let counts = &mut self.vectors[vector];
        counts.runs += 1;
        counts.longest_latency = counts.longest_latency.max(cycle.saturating_sub(requested));
    }

    pub(crate) fn leave(&mut self, vector: usize, cycle: u64) {
        let Some((requested, entered)) = self.states[vector].entered.take() else { return };
        let left = cycle + RETI_CYCLES;
        let counts = &mut self.vectors[vector];
        counts.longest_run = counts.longest_run.max(left - entered);
        if let Some(runs) = &mut self.runs {
            runs.push(Run { vector: vector as u8, requested, entered, left });
        }
    }
}
