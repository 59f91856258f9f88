//! A budget as text: numbers rounded for the reader, columns aligned.

use std::fmt;

use super::{Budget, Row};
use crate::{Measurement, rounded};

const COLUMNS: usize = 9;
const HEADINGS: [&str; COLUMNS] =
    ["quantity", "estimate", "unit", "u", "distribution", "dof", "sensitivity", "contribution", "share"];
/// Columns of numbers, which are aligned at the right.
const NUMERIC: [bool; COLUMNS] = [false, true, false, true, false, true, true, true, true];
/// A plain decimal number longer than this is printed with a power of ten.
const LONGEST: usize = 12;

impl Budget {
    /// Aligned plain text with a line of the result below the table.
    pub fn to_text(&self) -> String {
        let cells = self.cells();
        let mut widths = HEADINGS.map(str::len);
        for row in &cells {
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = (*width).max(cell.chars().count());
            }
        }
        let headings = HEADINGS.map(String::from);
        let mut lines = vec![aligned(&headings, &widths), "-".repeat(widths.iter().sum::<usize>() + 2 * (COLUMNS - 1))];
        lines.extend(cells.iter().map(|row| aligned(row, &widths)));
        lines.push(lines[1].clone());
        lines.push(self.result());
        lines.join("\n") + "\n"
    }

    /// A Markdown table with the result as a paragraph below it.
    pub fn to_markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let rulers = NUMERIC.map(|numeric| String::from(if numeric { "---:" } else { "---" }));
        let mut text = line(&HEADINGS.map(String::from)) + &line(&rulers);
        for row in self.cells() {
            text += &line(&row.map(|cell| cell.replace('|', "\\|")));
        }
        format!("{text}\n{}\n", self.result())
    }

    fn cells(&self) -> Vec<[String; COLUMNS]> {
        self.rows.iter().map(cells_of).collect()
    }

    /// Result, combined and expanded uncertainty, each rounded to two digits of uncertainty (GUM 7.2.6).
    fn result(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let (value, expanded) = pair(self.value, self.expanded);
        let (_, std) = pair(self.value, self.std);
        format!(
            "{} = {value}{unit}, U = {expanded}{unit} (k = {:.2}: {}), u = {std}{unit}, dof = {}",
            self.measurand,
            self.coverage_k,
            self.coverage,
            dof(self.dof)
        )
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.to_text())
    }
}

fn cells_of(row: &Row) -> [String; COLUMNS] {
    let (value, std) = pair(row.value, row.std);
    [
        row.label.clone(),
        value,
        row.unit.clone(),
        std,
        row.distribution.to_string(),
        dof(row.dof),
        significant(row.sensitivity, 4),
        significant(row.contribution, 2),
        format!("{:.1} %", 100.0 * row.share),
    ]
}

fn aligned(cells: &[String; COLUMNS], widths: &[usize; COLUMNS]) -> String {
    let columns = cells.iter().zip(widths).zip(NUMERIC);
    let padded: Vec<String> = columns
        .map(|((cell, &width), numeric)| if numeric { format!("{cell:>width$}") } else { format!("{cell:<width$}") })
        .collect();
    padded.join("  ").trim_end().to_owned()
}

/// Value and uncertainty rounded to two digits of the uncertainty, with powers of ten where the decimals are many.
fn pair(value: f64, std: f64) -> (String, String) {
    let Ok(measurement) = Measurement::new(value, std) else {
        return (value.to_string(), std.to_string());
    };
    let (plain_value, plain_std) = rounded(measurement, 2);
    if std == 0.0 {
        let exact = value.to_string();
        return (if exact.len() <= LONGEST { exact } else { significant(value, 8) }, plain_std);
    }
    if plain_value.len().max(plain_std.len()) <= LONGEST {
        return (plain_value, plain_std);
    }
    // Every digit that the uncertainty leaves.
    let places = (value.abs().log10().floor() - std.log10().floor()).clamp(0.0, 15.0) as usize + 1;
    (format!("{value:.places$e}"), format!("{std:.1e}"))
}

/// At most so many significant digits, without zeros at the end.
fn significant(x: f64, digits: usize) -> String {
    if x == 0.0 {
        return String::from("0");
    }
    let scientific = format!("{x:.*e}", digits - 1);
    // The rounded number, whose shortest text has no digits that were rounded away.
    let rounded: f64 = scientific.parse().unwrap_or(x);
    let plain = rounded.to_string();
    if plain.len() <= LONGEST && (1e-4..1e6).contains(&rounded.abs()) { plain } else { format!("{rounded:e}") }
}

fn dof(dof: f64) -> String {
    if dof.is_infinite() { String::from("inf") } else { significant((dof * 10.0).round() / 10.0, 6) }
}
