//! Runs of a sheet whose motion is known.
#![allow(dead_code, reason = "every test program uses a part")]

use slider_host::run::{End, Run};
use slider_host::sheet::{Sheet, Width};
use slider_proto::{Edge, EndReason, Level, TICK_HZ};

/// `SplitMix64` (Steele, Lea, Flood, OOPSLA 2014): a seed is a sequence.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Uniform in (0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0 + 5e-17
    }

    /// Standard normal (Box and Muller).
    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Time, s, at which a motion from x = 0 at speed `v0` with acceleration `a` reaches x, m; without cancellation.
pub(crate) fn time_of(v0: f64, a: f64) -> impl Fn(f64) -> f64 {
    move |x| 2.0 * x / (v0 + (v0 * v0 + 2.0 * a * x).sqrt()).max(1e-300)
}

/// Thirteen teeth whose widths are no pattern, as a laser cuts them, with standard uncertainties of `std_m`.
pub(crate) fn cut_sheet(std_m: f64) -> Sheet {
    let mut sheet = Sheet::nominal();
    let mut random = Random(13);
    for width in &mut sheet.sections {
        *width = Width { value_m: width.value_m + 50e-6 * random.normal(), std_m };
    }
    sheet
}

/// A sheet whose true widths are those of `sheet` with errors drawn from their uncertainties.
pub(crate) fn drawn(sheet: &Sheet, random: &mut Random) -> Sheet {
    let mut drawn = sheet.clone();
    let scale = 1.0 + sheet.scale_std * random.normal();
    for width in &mut drawn.sections {
        width.value_m = (width.value_m + width.std_m * random.normal()) * scale;
    }
    drawn
}

/// Edges at the times of all positions, with jitter of `jitter_s` and the ticks of the counter.
pub(crate) fn edges(
    positions_m: &[f64],
    time_of: impl Fn(f64) -> f64,
    jitter_s: f64,
    random: &mut Random,
) -> Vec<Edge> {
    let start_s = 1.0 + random.uniform();
    let mut level = Level::High;
    let ticks = positions_m.iter().map(|&x| {
        let time = start_s + time_of(x) + jitter_s * random.normal();
        (time * f64::from(TICK_HZ)).floor() as u32
    });
    ticks
        .map(|tick| {
            level = if level == Level::High { Level::Low } else { Level::High };
            Edge { tick, level, late: false }
        })
        .collect()
}

/// A run with its end told.
pub(crate) fn run_of(edges: Vec<Edge>) -> Run {
    let end = End::Told { reason: EndReason::Quiet, edges: edges.len() as u16, lost: 0 };
    Run { number: 1, tick_hz: TICK_HZ, edges, end }
}

/// A run of the sheet without jitter.
pub(crate) fn run(sheet: &Sheet, time_of: impl Fn(f64) -> f64) -> Run {
    run_of(edges(&sheet.positions_m(), time_of, 0.0, &mut Random(1)))
}
