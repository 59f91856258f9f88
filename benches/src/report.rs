//! The table at the end of a run.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::time::SystemTime;

use serde_json::Value;

/// The kind of the transform that everything is compared with.
pub const FFT: &str = "fft";

/// One benchmark: `kind/method/side`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Id {
    /// `fft`, `angle`, `length`, `pair`, `joint` or `restore`.
    pub kind: &'static str,
    /// Name of the method.
    pub method: String,
    /// Rows and columns of the picture.
    pub side: usize,
}

/// What a benchmark came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// Which benchmark.
    pub id: Id,
    /// Median time of one picture in nanoseconds.
    pub ns: f64,
}

/// The median in nanoseconds that criterion left for `id` in its folder, if it did so at or after `since`: estimates of
/// earlier runs stay there and do not count.
pub fn median_ns(criterion: &Path, id: &Id, since: SystemTime) -> Option<f64> {
    // Criterion's names of folders, for names of letters, digits, '-' and '+'.
    let path = criterion.join(id.kind).join(&id.method).join(id.side.to_string()).join("new").join("estimates.json");
    if fs::metadata(&path).ok()?.modified().ok()? < since {
        return None;
    }
    let estimates: Value = serde_json::from_slice(&fs::read(&path).ok()?).ok()?;
    estimates["median"]["point_estimate"].as_f64()
}

/// One row a method in the order given, one column a side: milliseconds and multiples of the transform of that side.
pub fn table(timings: &[Timing]) -> String {
    let mut sides: Vec<usize> = timings.iter().map(|timing| timing.id.side).collect();
    sides.sort_unstable();
    sides.dedup();
    let mut rows: Vec<(&str, &str)> = Vec::new();
    for Timing { id, .. } in timings {
        if !rows.contains(&(id.kind, &id.method)) {
            rows.push((id.kind, &id.method));
        }
    }
    let find = |kind: &str, method: Option<&str>, side: usize| {
        let found = |id: &Id| id.kind == kind && id.side == side && method.is_none_or(|method| id.method == method);
        timings.iter().find(|timing| found(&timing.id)).map(|timing| timing.ns)
    };

    // Writing to a String cannot fail.
    let mut text = format!("{:<7}{:<32}", "kind", "method");
    for side in &sides {
        let _ = write!(text, "{:>24}", format!("{side} x {side}"));
    }
    text.push('\n');
    for (kind, method) in rows {
        let _ = write!(text, "{kind:<7}{method:<32}");
        for &side in &sides {
            let cell = find(kind, Some(method), side).map_or_else(String::new, |ns| {
                let multiple = find(FFT, None, side).map_or_else(String::new, |fft| format!(" x {:7.2}", ns / fft));
                format!("{:.3} ms{multiple}", ns * 1e-6)
            });
            let _ = write!(text, "{cell:>24}");
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timing(kind: &'static str, method: &str, side: usize, ns: f64) -> Timing {
        Timing { id: Id { kind, method: method.to_owned(), side }, ns }
    }

    #[test]
    fn each_time_is_a_multiple_of_the_transform_of_its_size() {
        let text = table(&[
            timing(FFT, "real-2d", 256, 2e5),
            timing("angle", "a", 256, 1e6),
            timing(FFT, "real-2d", 512, 1e6),
            timing("angle", "a", 512, 2.5e6),
        ]);
        let row: Vec<&str> = text.lines().nth(2).unwrap().split_whitespace().collect();
        assert_eq!(row, ["angle", "a", "1.000", "ms", "x", "5.00", "2.500", "ms", "x", "2.50"]);
        assert!(text.lines().nth(1).unwrap().contains("x    1.00"));
    }

    #[test]
    fn without_the_transform_there_are_times_only() {
        let text = table(&[timing("length", "b", 64, 5e6)]);
        assert!(text.contains("5.000 ms") && !text.contains("ms x"), "{text}");
    }
}
