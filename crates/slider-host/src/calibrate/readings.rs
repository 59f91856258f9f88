//! The files of readings: comma-separated values under a header.
//!
//! A `#` begins a comment line; empty lines, a byte order mark and Windows line ends do not matter. Numbers have a
//! decimal point. What cannot be read is refused with its line and column, both counted from 1, the column in
//! characters.

use crate::Error;

/// Readings of one width, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Widths {
    /// What was measured.
    pub section: Section,
    /// Readings, mm.
    pub readings_mm: Vec<f64>,
}

/// A part of the sheet, counted from 1, or the tooth that speeds are calibrated with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// A tooth.
    Tooth(u32),
    /// A slit, behind the tooth of the same number.
    Slit(u32),
    /// The calibration tooth.
    Calibration,
}

impl Section {
    /// Reads `tooth 3`, `slit 3` or `calibration tooth`; case and the number of spaces do not matter.
    fn read(text: &str) -> Option<Self> {
        let text = text.to_lowercase();
        let words: Vec<&str> = text.split_whitespace().collect();
        let number = |word: &str| word.parse::<u32>().ok().filter(|&number| (1..=32_768).contains(&number));
        match words.as_slice() {
            ["tooth", word] => number(word).map(Self::Tooth),
            ["slit", word] => number(word).map(Self::Slit),
            ["calibration", "tooth"] => Some(Self::Calibration),
            _ => None,
        }
    }
}

impl std::fmt::Display for Section {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Tooth(number) => write!(f, "tooth {number}"),
            Self::Slit(number) => write!(f, "slit {number}"),
            Self::Calibration => write!(f, "calibration tooth"),
        }
    }
}

/// Readings of one quantity by the slider and by a standard instrument, both of the same passes.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// The setting: number of the speed, or angle of the incline in degrees.
    pub setting: f64,
    /// Readings of the slider.
    pub system: Vec<f64>,
    /// Readings of the standard instrument.
    pub standard: Vec<f64>,
}

/// Reads caliper readings: header `section,reading_mm`, for example `tooth 1,3.17`. Sections come back in the order of
/// their first reading, with at least two positive readings each. `name` is what errors call the text.
pub fn widths(name: &str, text: &str) -> Result<Vec<Widths>, Error> {
    let mut all: Vec<(Widths, usize)> = Vec::new();
    let rows = Rows::new(name, text, &["section", "reading_mm"])?;
    for row in rows.all()? {
        let [section, reading] = row.cells.as_slice() else { continue };
        let found = Section::read(section.text).ok_or_else(|| {
            let what =
                format!("'{}' is not a section: write tooth 1, slit 1 or calibration tooth", shown(section.text));
            rows.error(row.line, section.column, what)
        })?;
        let reading = rows.positive(row.line, reading)?;
        match all.iter_mut().find(|(widths, _)| widths.section == found) {
            Some((widths, _)) => widths.readings_mm.push(reading),
            None => all.push((Widths { section: found, readings_mm: vec![reading] }, row.line)),
        }
    }
    if let Some((lonely, line)) = all.iter().find(|(widths, _)| widths.readings_mm.len() < 2) {
        return Err(rows.error(
            *line,
            1,
            format!("{} has one reading; its scatter needs at least two", lonely.section),
        ));
    }
    Ok(all.into_iter().map(|(widths, _)| widths).collect())
}

/// Reads times: header `speed,t_system_s,t_standard_s`, one line a pass; the speed is the number of the preset.
pub fn times(name: &str, text: &str) -> Result<Vec<Pairs>, Error> {
    pairs(name, text, &["speed", "t_system_s", "t_standard_s"])
}

/// Reads accelerations: header `angle_deg,a_system_m_s2,a_standard_m_s2`, one line a run.
pub fn accelerations(name: &str, text: &str) -> Result<Vec<Pairs>, Error> {
    pairs(name, text, &["angle_deg", "a_system_m_s2", "a_standard_m_s2"])
}

fn pairs(name: &str, text: &str, header: &[&str; 3]) -> Result<Vec<Pairs>, Error> {
    let mut all: Vec<(Pairs, usize)> = Vec::new();
    let rows = Rows::new(name, text, header)?;
    for row in rows.all()? {
        let [setting, system, standard] = row.cells.as_slice() else { continue };
        let setting = rows.number(row.line, setting)?;
        let (system, standard) = (rows.positive(row.line, system)?, rows.positive(row.line, standard)?);
        match all.iter_mut().find(|(pairs, _)| pairs.setting == setting) {
            Some((pairs, _)) => {
                pairs.system.push(system);
                pairs.standard.push(standard);
            }
            None => all.push((Pairs { setting, system: vec![system], standard: vec![standard] }, row.line)),
        }
    }
    if let Some((lonely, line)) = all.iter().find(|(pairs, _)| pairs.system.len() < 2) {
        let what = format!("{} {} has one line; its scatter needs at least two", header[0], lonely.setting);
        return Err(rows.error(*line, 1, what));
    }
    Ok(all.into_iter().map(|(pairs, _)| pairs).collect())
}

/// Lines that are neither empty nor comments.
struct Rows<'a> {
    name: &'a str,
    header: Vec<&'a str>,
    lines: Vec<(usize, &'a str)>,
}

struct Row<'a> {
    line: usize,
    cells: Vec<Cell<'a>>,
}

struct Cell<'a> {
    column: usize,
    text: &'a str,
}

impl<'a> Rows<'a> {
    fn new(name: &'a str, text: &'a str, header: &[&'a str]) -> Result<Self, Error> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line));
        let mut lines: Vec<_> =
            lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#')).collect();
        let first = (!lines.is_empty()).then(|| lines.remove(0));
        let rows = Self { name, header: header.to_vec(), lines };
        let expected = header.join(",");
        let Some((line, content)) = first else {
            return Err(rows.error(1, 1, format!("nothing but empty lines; the first one must be {expected}")));
        };
        if !cells(content).iter().map(|cell| cell.text).eq(header.iter().copied()) {
            return Err(rows.error(line, 1, format!("'{}' must be the header {expected}", shown(content))));
        }
        if rows.lines.is_empty() {
            return Err(rows.error(line, 1, "no readings under the header".to_owned()));
        }
        Ok(rows)
    }

    fn all(&self) -> Result<Vec<Row<'a>>, Error> {
        self.lines.iter().map(|&(line, content)| self.row(line, content)).collect()
    }

    fn row(&self, line: usize, content: &'a str) -> Result<Row<'a>, Error> {
        let cells = cells(content);
        if cells.len() != self.header.len() {
            let hint = match cells.len() {
                1 if content.contains(';') => ": separate them by commas, not semicolons",
                found if found > self.header.len() => ": is a decimal comma among them? Write a point",
                _ => "",
            };
            // Where the surplus begins, or the line ends.
            let end = content.chars().count() + 1;
            let column = cells.get(self.header.len()).map_or(end, |cell| cell.column);
            let what = format!("{} fields where {} are expected{hint}", cells.len(), self.header.join(","));
            return Err(self.error(line, column, what));
        }
        Ok(Row { line, cells })
    }

    fn number(&self, line: usize, cell: &Cell<'_>) -> Result<f64, Error> {
        let number = cell.text.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| self.error(line, cell.column, format!("'{}' is not a number", shown(cell.text))))
    }

    fn positive(&self, line: usize, cell: &Cell<'_>) -> Result<f64, Error> {
        let number = self.number(line, cell)?;
        // Far outside of this, squares would leave the range of numbers.
        if !(1e-12..1e12).contains(&number) {
            return Err(self.error(
                line,
                cell.column,
                format!("'{}' must be above 0 and below 1e12", shown(cell.text)),
            ));
        }
        Ok(number)
    }

    fn error(&self, line: usize, column: usize, what: String) -> Error {
        Error::Readings { name: self.name.to_owned(), line, column, what }
    }
}

/// Fields with the columns where their text begins.
fn cells(line: &str) -> Vec<Cell<'_>> {
    let mut column = 1;
    line.split(',')
        .map(|field| {
            let text = field.trim();
            let blanks = field.chars().take_while(|c| c.is_whitespace()).count();
            let start = if text.is_empty() { column } else { column + blanks };
            column += field.chars().count() + 1;
            Cell { column: start, text }
        })
        .collect()
}

/// Text of a file for a message: short, and without control characters.
fn shown(text: &str) -> String {
    let mut short: String = text.chars().take(40).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(40).is_some() {
        short.push_str("...");
    }
    short
}
