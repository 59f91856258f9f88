//! Numbers and tables for people.

use std::fmt::{self, Write};

use metrology::{Measurement, rounded};

/// A value and its uncertainty: two significant digits of the uncertainty, as many decimals of the value (GUM 7.2.6).
///
/// ```
/// assert_eq!(slider_host::text::plus_minus(0.500_12, 0.0253), "0.500 ± 0.025");
/// ```
pub fn plus_minus(value: f64, uncertainty: f64) -> String {
    if let Some(measurement) = Measurement::new(value, uncertainty).ok().filter(|measurement| measurement.std() > 0.0) {
        let (value, uncertainty) = rounded(measurement, 2);
        return format!("{value} ± {uncertainty}");
    }
    let decimals = decimals_of(value, 4);
    format!("{value:.decimals$} ± {uncertainty:.decimals$}")
}

/// A number with so many significant digits, without an exponent between 0.001 and 100 000.
pub fn significant(x: f64, digits: usize) -> String {
    let size = x.abs();
    if x == 0.0 || !x.is_finite() || (1e-3..1e5).contains(&size) {
        format!("{x:.*}", decimals_of(x, digits))
    } else {
        format!("{x:.*e}", digits.saturating_sub(1))
    }
}

/// Degrees of freedom: whole ones without a point, `∞` if there is no limit.
pub fn degrees_of_freedom(dof: f64) -> String {
    match dof {
        dof if dof.is_infinite() => "\u{221e}".to_owned(),
        dof if (dof - dof.round()).abs() < 0.05 => format!("{:.0}", dof.round()),
        dof => significant(dof, 3),
    }
}

/// Decimals that show `digits` significant digits of `x`.
fn decimals_of(x: f64, digits: usize) -> usize {
    if x == 0.0 || !x.is_finite() {
        return 0;
    }
    // Scientific notation rounds first: 0.0996 with two digits is 1.0e-1.
    let scientific = format!("{x:.*e}", digits.saturating_sub(1));
    let exponent: i64 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let decimals = i64::try_from(digits).unwrap_or(0) - 1 - exponent;
    usize::try_from(decimals.clamp(0, 15)).unwrap_or(0)
}

/// A table of right-aligned columns under a header; the first column is left-aligned.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What it shows, on a line above it.
    pub title: String,
    lines: Vec<Vec<String>>,
    /// Remarks under it, a line each.
    pub notes: Vec<String>,
}

impl Table {
    /// An empty table.
    pub fn new(title: impl Into<String>, header: &[&str]) -> Self {
        let lines = vec![header.iter().map(|&cell| cell.to_owned()).collect()];
        Self { title: title.into(), lines, notes: Vec::new() }
    }

    /// Adds a line.
    pub fn push(&mut self, cells: Vec<String>) {
        self.lines.push(cells);
    }

    /// The lines of cells under the header.
    pub fn rows(&self) -> &[Vec<String>] {
        self.lines.get(1..).unwrap_or_default()
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.lines.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.lines.iter().filter_map(|line| line.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        writeln!(f, "{}", self.title)?;
        for line in &self.lines {
            let mut text = String::new();
            for (column, (cell, width)) in line.iter().zip(&widths).enumerate() {
                match column {
                    0 => write!(text, "{cell:width$}")?,
                    _ => write!(text, "  {cell:>width$}")?,
                }
            }
            writeln!(f, "  {}", text.trim_end())?;
        }
        for note in &self.notes {
            writeln!(f, "  {note}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_uncertainty_has_two_digits_and_its_value_as_many_decimals() {
        assert_eq!(plus_minus(93.5132, 0.414), "93.51 ± 0.41");
        assert_eq!(plus_minus(30.84, 12.3), "31 ± 12");
        assert_eq!(plus_minus(30.84, 0.0996), "30.84 ± 0.10");
        assert_eq!(plus_minus(30.84, 0.0), "30.84 ± 0.00");
        assert_eq!(plus_minus(12_345.0, 234.0), "12340 ± 230");
        assert_eq!(plus_minus(30.84, f64::NAN), "30.84 ± NaN");
    }

    #[test]
    fn a_number_shows_its_significant_digits() {
        assert_eq!(significant(0.123_456, 3), "0.123");
        assert_eq!(significant(-1234.6, 3), "-1235");
        assert_eq!(significant(1.23e-7, 2), "1.2e-7");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(f64::INFINITY, 3), "inf");
    }

    #[test]
    fn whole_degrees_of_freedom_have_no_point() {
        let texts = [24.0, 23.47, 1.0e7, f64::INFINITY].map(degrees_of_freedom);
        assert_eq!(texts, ["24", "23.5", "10000000", "\u{221e}"]);
    }

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new("widths", &["section", "mm"]);
        table.push(vec!["tooth 1".to_owned(), "3.174".to_owned()]);
        table.notes.push("k = 1.65".to_owned());
        assert_eq!(table.to_string(), "widths\n  section     mm\n  tooth 1  3.174\n  k = 1.65\n");
    }
}
