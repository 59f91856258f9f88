//! The report of some runs as one HTML page.
//!
//! The page needs nothing but itself: styles and figures are inside, there are no scripts. It follows the reader's
//! choice of light or dark, fits a phone and prints.

mod figure;
mod page;
mod plot;

pub(crate) use figure::{fitted_m, main_value};

use crate::outcome::{Outcome, Value};
use crate::sheet::Sheet;

/// A value that several runs agree on.
#[derive(Debug, Clone, PartialEq)]
pub struct Pooled {
    /// What it is and of which runs, for example `speed of runs 1-20`.
    pub label: String,
    /// Its unit.
    pub unit: String,
    /// The value.
    pub value: Value,
}

/// What a report says beside the runs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Context {
    /// Heading of the page.
    pub title: String,
    /// When and where it was measured, or anything else that belongs under the heading.
    pub subtitle: String,
    /// The sheet, for its table.
    pub sheet: Option<Sheet>,
    /// Values of several runs together.
    pub pooled: Vec<Pooled>,
    /// Names and versions of programs and firmware.
    pub versions: Vec<(String, String)>,
    /// The command line that makes this report again.
    pub command: String,
}

/// The page, as text in UTF-8.
///
/// The band around the residuals is twice [`Outcome::residual_stds_m`].
pub fn html(outcomes: &[Outcome], context: &Context) -> String {
    page::page(outcomes, context)
}

/// `text` as it may stand in HTML, also in an attribute between double quotes.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // Not allowed in HTML.
            c if c.is_control() && c != '\n' && c != '\t' => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests;
