//! Ranges and round numbers for the axes of figures.

/// The smallest and the largest finite number; (0, 1) if there is none.
pub(crate) fn range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let found = values.into_iter().filter(|value| value.is_finite()).fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((value.min(low), value.max(high))),
    });
    found.unwrap_or((0.0, 1.0))
}

/// A range with a margin of 4 %, and never empty.
pub(crate) fn widened((low, high): (f64, f64)) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    let margin = match high - low {
        span if span > 1e-12 * size => 0.04 * span,
        _ if size > 0.0 => 0.5 * size,
        _ => 1.0,
    };
    (low - margin, high + margin)
}

/// The round numbers within a range, at most some `most`, with their text: multiples of 1, 2 or 5 times a power of ten.
pub(crate) fn ticks((low, high): (f64, f64), most: u32) -> Vec<(f64, String)> {
    let Some(step) = step(high - low, most) else { return Vec::new() };
    marks((low / step - 1e-9).ceil(), (high / step + 1e-9).floor(), step)
}

/// The round numbers that a range lies between, likewise.
pub(crate) fn covering_ticks((low, high): (f64, f64), most: u32) -> Vec<(f64, String)> {
    let Some(step) = step(high - low, most) else { return Vec::new() };
    marks((low / step + 1e-9).floor(), (high / step - 1e-9).ceil(), step)
}

fn step(span: f64, most: u32) -> Option<f64> {
    let rough = span / f64::from(most.max(1));
    if !(rough.is_finite() && rough > 0.0) {
        return None;
    }
    let unit = 10.0_f64.powf(rough.log10().floor());
    Some([1.0, 2.0, 5.0].into_iter().map(|m| m * unit).find(|&step| step >= rough * 0.999).unwrap_or(10.0 * unit))
}

fn marks(first: f64, last: f64, step: f64) -> Vec<(f64, String)> {
    let decimals = (-(step * 1.001).log10().floor()).clamp(0.0, 12.0) as usize;
    let count = (last - first).clamp(-1.0, 50.0) as i32;
    (0..=count)
        .map(|i| {
            let multiple = first + f64::from(i);
            let tick = multiple * step;
            let text = format!("{:.decimals$}", if multiple == 0.0 { 0.0 } else { tick });
            (tick, text.replace('-', "\u{2212}"))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(marks: &[(f64, String)]) -> Vec<&str> {
        marks.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(texts(&ticks((-0.4, 10.4), 6)), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(texts(&ticks((-0.13, 0.13), 5)), ["\u{2212}0.1", "0.0", "0.1"]);
        assert!(ticks((0.0, f64::NAN), 5).is_empty());
        assert!(ticks((1.0, 1.0), 5).is_empty());
    }

    #[test]
    fn covering_ticks_hold_the_range() {
        assert_eq!(texts(&covering_ticks((-0.4, 10.4), 6)), ["\u{2212}2", "0", "2", "4", "6", "8", "10", "12"]);
        for (low, high) in [(0.0, 1.0), (-3e-7, 2e-9), (99_999.0, 100_001.0), (0.1, 0.3)] {
            let marks = covering_ticks((low, high), 4);
            let ends = (marks.first().unwrap().0, marks.last().unwrap().0);
            let slack = 1e-9 * (high - low);
            assert!(ends.0 <= low + slack && ends.1 >= high - slack, "{low} {high} {ends:?}");
        }
    }

    #[test]
    fn a_range_is_never_empty_and_passes_over_what_is_not_finite() {
        assert_eq!(range([f64::NAN, 2.0, f64::INFINITY, -1.0]), (-1.0, 2.0));
        assert_eq!(range([]), (0.0, 1.0));
        let (low, high) = widened((3.0, 3.0));
        assert!(low < 3.0 && high > 3.0);
        assert_eq!(widened((0.0, 0.0)), (-1.0, 1.0));
    }
}
