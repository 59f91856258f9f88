//! What a table gives back: rows for people and for programs, and boxplots.

use std::fmt;

use serde::Serialize;

use super::answer::Answer;
use super::outcome::Outcome;
use super::statistics::{Interval, Summary};
use crate::Result;

/// A finished table.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// What was measured and how, a line each.
    pub notes: Vec<String>,
    /// The table for people.
    pub text: TextTable,
    /// The table for programs: one JSON object a row, each on one line.
    pub rows: Vec<String>,
    /// Every picture, in an order that does not depend on the threads.
    pub outcomes: Vec<Outcome>,
    /// Every picture by every method, in such an order, of tables that compare methods.
    pub answers: Vec<Answer>,
    /// Pictures that are listed under the table in any case.
    pub listed: Vec<Outcome>,
    /// Absolute errors by level.
    pub boxplots: Vec<Boxplot>,
}

impl Report {
    /// Adds a row for programs.
    pub(super) fn push(&mut self, row: &impl Serialize) -> Result<()> {
        self.rows.push(serde_json::to_string(row)?);
        Ok(())
    }
}

/// The fields that every row has, whatever its table.
#[derive(Debug, Clone, Serialize)]
pub struct Row<T> {
    /// The table.
    pub table: &'static str,
    /// The method.
    pub method: String,
    /// Level of noise, or kind of picture.
    pub level: String,
    /// What is measured: `angle_deg`, `length_px` or another name with its unit; absent where it is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quantity: Option<&'static str>,
    /// Pictures.
    pub n: usize,
    /// Pictures whose answer is called `ok`.
    pub n_ok: usize,
    /// Absolute errors, of the answers called `ok` unless the table says otherwise: `mean`, `min`, `q1`, `median`, `q3`, `p90`, `max`.
    #[serde(flatten)]
    pub errors: Option<Summary>,
    /// The thesis's mean.
    pub thesis: Option<f64>,
    /// What this table alone states.
    #[serde(flatten)]
    pub details: T,
}

/// A measured quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The angle in degrees.
    Angle,
    /// The length in pixels.
    Length,
}

impl Quantity {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Angle, Self::Length];

    /// The name of the field, with its unit.
    pub fn field(self) -> &'static str {
        match self {
            Self::Angle => "angle_deg",
            Self::Length => "length_px",
        }
    }

    /// The name and the unit for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Angle => "angle, deg",
            Self::Length => "length, px",
        }
    }

    /// Its signed error in an answer to a picture of known truth.
    pub fn error(self, outcome: &Outcome) -> Option<f64> {
        match self {
            Self::Angle => outcome.angle_error_deg,
            Self::Length => outcome.length_error_px,
        }
    }

    /// Its stated standard uncertainty.
    pub fn std(self, outcome: &Outcome) -> Option<f64> {
        match self {
            Self::Angle => outcome.angle_std_deg,
            Self::Length => outcome.length_std_px,
        }
    }
}

/// Absolute errors of one quantity, a box for each level.
#[derive(Debug, Clone)]
pub struct Boxplot {
    /// File name without its ending.
    pub name: String,
    /// What is drawn.
    pub title: String,
    /// Axis of the errors, with its unit.
    pub axis: String,
    /// Level and summary.
    pub boxes: Vec<(String, Summary)>,
}

/// A table of right-aligned columns under a header; the first column is left-aligned.
#[derive(Debug, Clone, Default)]
pub struct TextTable {
    lines: Vec<Vec<String>>,
}

impl TextTable {
    pub(crate) fn new(header: &[&str]) -> Self {
        Self { lines: vec![header.iter().map(|&cell| cell.to_owned()).collect()] }
    }

    pub(crate) fn push(&mut self, cells: Vec<String>) {
        self.lines.push(cells);
    }
}

impl fmt::Display for TextTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.lines.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.lines.iter().filter_map(|line| line.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for line in &self.lines {
            for (column, (cell, width)) in line.iter().zip(&widths).enumerate() {
                match column {
                    0 => write!(f, "{cell:width$}")?,
                    _ => write!(f, "  {cell:>width$}")?,
                }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// `value` with `digits` decimals, or a dash.
pub(crate) fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}

/// A share in percent with its interval, or a dash.
pub(super) fn percent(share: Option<Interval>) -> String {
    share.map_or_else(
        || "-".to_owned(),
        |Interval { value, low, high }| format!("{:.1}% ({:.0}-{:.0})", 100.0 * value, 100.0 * low, 100.0 * high),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = TextTable::new(&["level", "n"]);
        table.push(vec!["36 dB".to_owned(), "1000".to_owned()]);
        assert_eq!(table.to_string(), "level     n\n36 dB  1000\n");
        assert_eq!(TextTable::default().to_string(), "");
    }

    #[test]
    fn a_row_is_one_flat_object() {
        #[derive(Serialize)]
        struct Extra {
            bias: f64,
        }
        let errors = Summary::of(&[1.0, 3.0], 5.0);
        let (method, level) = ("m".to_owned(), "clean".to_owned());
        let row = Row {
            table: "t",
            method,
            level,
            quantity: None,
            n: 4,
            n_ok: 2,
            errors,
            thesis: None,
            details: Extra { bias: 0.5 },
        };
        let json = serde_json::to_value(&row).unwrap();
        assert_eq!(
            (&json["n"], &json["n_ok"], &json["mean"], &json["bias"]),
            (&4.into(), &2.into(), &2.0.into(), &0.5.into())
        );
        for field in ["method", "level", "median", "q1", "q3", "min", "max", "thesis"] {
            assert!(json.get(field).is_some(), "{field}");
        }
    }
}
