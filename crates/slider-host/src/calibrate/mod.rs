//! Calibration of the sheet, of speeds and of accelerations from readings, as chapter 8 of the thesis does it and as the
//! GUM does.
//!
//! Widths are read with a caliper, times and accelerations with the slider and a standard instrument at once. Each
//! result has the thesis's expanded uncertainty, k = 1.65, and beside it that of 95 % by Student's t with the effective
//! degrees of freedom.
//!
//! # Where the thesis and the GUM part
//!
//! - k = 1.65 is 95 % of a rectangle (√3 · 0.95). The thesis takes it wherever the time outweighs the width (eq. 8.14);
//!   but the time is a sum of scatter and deviation, and where no single rectangle outweighs all the rest, 1.65 covers
//!   less: 90 % of a normal distribution.
//! - Eq. 8.3 takes the accuracy class for the full width of the rectangle. Makers promise ±class, which is twice that:
//!   [`Instrument::accuracy`] is such a limit, [`Instrument::class_percent`] is eq. 8.3.
//! - Eq. 8.7 counts a known deviation from the standard as uncertainty. GUM 3.2.4 corrects it, and the corrected value
//!   is given too.
//! - The limits of the caliper are taken as independent from width to width, as `Sheet` supposes; a class is shared by
//!   all widths and goes to the sheet's common scale.
//!
//! # Reference
//!
//! Thesis 8.2.1 and 8.2.2, eq. 8.2 to 8.14, tables 8.1 to 8.3; JCGM 100:2008.

mod direct;
mod figures;
mod instrument;
mod readings;
mod simulated;
mod speed;
mod tables;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use metrology::{Budget, Combined, Correlation, Coverage, type_b};

pub use direct::Direct;
pub use instrument::{Instrument, Instruments};
pub use readings::{Pairs, Section, Widths, accelerations, times, widths};
pub use simulated::{Readings, files, readings};
pub use speed::Speed;

use crate::Error;
use crate::sheet::{Sheet, Width};
use crate::text::Table;

/// What to calibrate.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Options {
    /// Caliper readings, CSV: `section,reading_mm` (tooth 1, slit 1, ..., calibration tooth)
    #[arg(long, value_name = "FILE")]
    pub widths: Option<PathBuf>,
    /// Times of the calibration tooth, CSV: `speed,t_system_s,t_standard_s`; needs its width in --widths
    #[arg(long, value_name = "FILE", requires = "widths")]
    pub times: Option<PathBuf>,
    /// Accelerations, CSV: `angle_deg,a_system_m_s2,a_standard_m_s2`
    #[arg(long, value_name = "FILE")]
    pub accelerations: Option<PathBuf>,
    /// What the instruments promise, TOML; by default those of the thesis
    #[arg(long, value_name = "FILE")]
    pub instruments: Option<PathBuf>,
    /// Write the widths as the description of a sheet, TOML
    #[arg(long, value_name = "FILE")]
    pub sheet: Option<PathBuf>,
    /// Name of the sheet
    #[arg(long, value_name = "NAME", default_value = "calibrated")]
    pub name: String,
    /// Show the thesis's figures beside one's own
    #[arg(long)]
    pub thesis: bool,
    /// Show the whole budget of every result
    #[arg(long)]
    pub budgets: bool,
    /// Write the budgets as JSON, one object a line, instead of tables
    #[arg(long)]
    pub json: bool,
    /// Simulate the readings of the thesis's calibration from a seed instead of reading files
    #[arg(long, value_name = "SEED", conflicts_with_all = ["widths", "times", "accelerations"])]
    pub simulate: Option<u64>,
    /// Write the simulated readings to a folder: widths.csv, times.csv, accelerations.csv
    #[arg(long, value_name = "FOLDER", requires = "simulate")]
    pub readings: Option<PathBuf>,
}

/// Everything that comes out of a calibration.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// Tables 8.1 to 8.3, those for which there are readings.
    pub tables: Vec<Table>,
    /// The budgets of all rows.
    pub budgets: Vec<Budget>,
}

/// Evaluates readings; with `thesis`, the tables have the thesis's figures beside.
pub fn evaluate(readings: &Readings, instruments: &Instruments, thesis: bool) -> Result<Calibration, Error> {
    let k = instruments.coverage_k;
    let mut found = Calibration { tables: Vec::new(), budgets: Vec::new() };
    let widths = each(&readings.widths, |widths| Ok((widths, Direct::width(widths, instruments)?)))?;
    if !widths.is_empty() {
        found.tables.push(tables::widths(&widths, k, thesis));
        found.budgets.extend(widths.iter().map(|(_, direct)| direct.budget.clone()));
    }
    if !readings.times.is_empty() {
        let tooth = widths.iter().find(|(widths, _)| widths.section == Section::Calibration);
        let Some((_, tooth)) = tooth else {
            return Err(Error::Calibration("speeds need readings of 'calibration tooth' among the widths".to_owned()));
        };
        let speeds = each(&readings.times, |pairs| Speed::new(pairs, tooth, instruments))?;
        found.tables.push(tables::speeds(&speeds, k, thesis));
        found.budgets.extend(speeds.into_iter().map(|speed| speed.budget));
    }
    let accelerations = each(&readings.accelerations, |pairs| {
        let direct = Direct::acceleration(pairs, instruments)?;
        let inputs = direct::standard(pairs, &instruments.acceleration_standard, "m/s2")?;
        let value = inputs.iter().map(metrology::Input::value).sum();
        let ones = vec![1.0; inputs.len()];
        let combined = Combined::new(&inputs, &Correlation::independent(inputs.len()), value, ones)?;
        let coverage = Coverage::Probability(direct::PROBABILITY);
        let corrected = Budget::new(&direct.label, "m/s2", &inputs, &combined, coverage)?;
        Ok((pairs, direct, corrected))
    })?;
    if !accelerations.is_empty() {
        found.tables.push(tables::accelerations(&accelerations, k, thesis));
        found.budgets.extend(accelerations.into_iter().map(|(_, direct, _)| direct.budget));
    }
    Ok(found)
}

fn each<'a, T, R>(items: &'a [T], f: impl Fn(&'a T) -> Result<R, Error>) -> Result<Vec<R>, Error> {
    items.iter().map(f).collect()
}

/// The sheet that these widths describe; slits behind the last tooth are left out. Every tooth and slit up to the last
/// tooth must be there.
pub fn sheet(name: &str, widths: &[Widths], instruments: &Instruments) -> Result<Sheet, Error> {
    let teeth = widths.iter().filter_map(|widths| match widths.section {
        Section::Tooth(number) => Some(number),
        Section::Slit(_) | Section::Calibration => None,
    });
    let Some(last) = teeth.max() else {
        return Err(Error::Calibration("a sheet needs at least one tooth".to_owned()));
    };
    let expected = (1..=last).flat_map(|n| [Section::Tooth(n), Section::Slit(n)]).take(2 * last as usize - 1);
    let sections = expected.map(|section| {
        let found = widths.iter().find(|widths| widths.section == section);
        let widths =
            found.ok_or_else(|| Error::Calibration(format!("a sheet of {last} teeth needs readings of {section}")))?;
        let direct = Direct::width(widths, instruments)?;
        // The class is the same for all widths: it is the scale below.
        let own = type_b::rectangular_std(instruments.caliper.accuracy)?;
        let std_mm = [direct.type_a, own, direct.type_b2].iter().map(|u| u * u).sum::<f64>().sqrt();
        Ok(Width { value_m: direct.mean / 1e3, std_m: std_mm / 1e3 })
    });
    let sections = sections.collect::<Result<_, Error>>()?;
    let scale_std = type_b::accuracy_class_std(instruments.caliper.class_percent, 1.0)?;
    Ok(Sheet { name: name.to_owned(), sections, scale_std })
}

/// Tables 8.1 to 8.3 from readings simulated with the thesis's instruments, beside the thesis's figures.
///
/// The documentation of [`readings`] says which of the inputs are inferred.
pub fn thesis(seed: u64) -> Result<Vec<Table>, Error> {
    let instruments = Instruments::default();
    Ok(evaluate(&readings(seed, &instruments)?, &instruments, true)?.tables)
}

/// Calibrates as the options say and writes the tables to `out`.
pub fn run(options: &Options, out: &mut dyn Write) -> Result<(), Error> {
    let instruments = match &options.instruments {
        Some(path) => {
            let name = path.display();
            Instruments::from_toml(&read(path)?).map_err(|error| Error::Calibration(format!("{name}: {error}")))?
        }
        None => Instruments::default(),
    };
    let found = match options.simulate {
        Some(seed) => readings(seed, &instruments)?,
        None => Readings {
            widths: parsed(options.widths.as_deref(), widths)?,
            times: parsed(options.times.as_deref(), times)?,
            accelerations: parsed(options.accelerations.as_deref(), accelerations)?,
        },
    };
    if found.widths.is_empty() && found.times.is_empty() && found.accelerations.is_empty() {
        let what = "nothing to calibrate: give --widths, --accelerations or --simulate SEED";
        return Err(Error::Calibration(what.to_owned()));
    }
    if let Some(folder) = &options.readings {
        fs::create_dir_all(folder).map_err(|source| Error::File { path: folder.clone(), source })?;
        for (name, content) in files(&found) {
            write(&folder.join(name), &content)?;
        }
    }
    let calibration = evaluate(&found, &instruments, options.thesis)?;
    if let Some(path) = &options.sheet {
        write(path, &sheet(&options.name, &found.widths, &instruments)?.to_toml(instruments.coverage_k)?)?;
    }
    if options.json {
        for budget in &calibration.budgets {
            let line = serde_json::to_string(budget).map_err(|error| Error::Write(error.into()))?;
            writeln!(out, "{line}").map_err(Error::Write)?;
        }
        return Ok(());
    }
    let budgets = options.budgets.then_some(&calibration.budgets).into_iter().flatten().map(ToString::to_string);
    let parts: Vec<String> = calibration.tables.iter().map(ToString::to_string).chain(budgets).collect();
    out.write_all(parts.join("\n").as_bytes()).map_err(Error::Write)?;
    if options.simulate.is_some() {
        writeln!(out, "\nThe readings are simulated; what the thesis does not tell of them is guessed.")
            .map_err(Error::Write)?;
    }
    Ok(())
}

fn parsed<T>(path: Option<&Path>, parse: fn(&str, &str) -> Result<Vec<T>, Error>) -> Result<Vec<T>, Error> {
    path.map_or_else(|| Ok(Vec::new()), |path| parse(&path.display().to_string(), &read(path)?))
}

fn read(path: &Path) -> Result<String, Error> {
    fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })
}

fn write(path: &Path, content: &str) -> Result<(), Error> {
    fs::write(path, content).map_err(|source| Error::File { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests;
