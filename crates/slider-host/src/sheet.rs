//! The toothed sheet: how wide its teeth and slits are, and how well that is known.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::Error;

/// A width with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Width {
    /// Width, m.
    pub value_m: f64,
    /// Standard uncertainty, m, independent of those of other widths.
    pub std_m: f64,
}

/// A sheet: tooth, slit, tooth, ..., tooth, in the order in which they pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Its name.
    pub name: String,
    /// Widths of teeth (at even indices) and slits (at odd ones): an odd number of them.
    pub sections: Vec<Width>,
    /// Relative standard uncertainty that all widths share: the scale of the instrument that measured them.
    pub scale_std: f64,
}

/// The file: widths in mm, as a caliper shows them, with uncertainties expanded by one factor.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    coverage_k: f64,
    #[serde(default)]
    scale_std: f64,
    tooth: Vec<FileWidth>,
    slit: Vec<FileWidth>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileWidth {
    width_mm: f64,
    expanded_mm: f64,
}

impl Sheet {
    /// Thirteen teeth of 3.1 mm and slits of 4.9 mm, exactly known: what a drawing says.
    pub fn nominal() -> Self {
        let width = |index: usize| if index.is_multiple_of(2) { 3.1e-3 } else { 4.9e-3 };
        let sections = (0..25).map(|index| Width { value_m: width(index), std_m: 0.0 }).collect();
        Self { name: "nominal".to_owned(), sections, scale_std: 0.0 }
    }

    /// Reads a description in TOML; `fixtures/encoder5.toml` shows its form.
    pub fn from_toml(text: &str) -> Result<Self, Error> {
        let file: File = toml::from_str(text).map_err(|error| Error::Sheet(error.to_string()))?;
        let File { name, coverage_k, scale_std, tooth, slit } = file;
        if !(coverage_k.is_finite() && coverage_k > 0.0) {
            return Err(Error::Sheet(format!("coverage_k {coverage_k} must be a number above 0")));
        }
        if !(scale_std.is_finite() && (0.0..1.0).contains(&scale_std)) {
            return Err(Error::Sheet(format!("scale_std {scale_std} must be from 0 to below 1")));
        }
        if slit.len() + 1 != tooth.len() {
            let (teeth, slits) = (tooth.len(), slit.len());
            return Err(Error::Sheet(format!(
                "{teeth} teeth need {} slits between them, not {slits}",
                teeth.max(1) - 1
            )));
        }
        let mut sections = Vec::with_capacity(tooth.len() + slit.len());
        let mut slits = slit.iter();
        for tooth in &tooth {
            sections.push(tooth);
            sections.extend(slits.next());
        }
        let sections = sections.into_iter().enumerate().map(|(index, width)| {
            let &FileWidth { width_mm, expanded_mm } = width;
            let what = if index.is_multiple_of(2) { "tooth" } else { "slit" };
            if !(width_mm.is_finite() && width_mm > 0.0) {
                return Err(Error::Sheet(format!("{what} {}: width_mm {width_mm} must be above 0", index / 2 + 1)));
            }
            if !(expanded_mm.is_finite() && expanded_mm >= 0.0) {
                return Err(Error::Sheet(format!(
                    "{what} {}: expanded_mm {expanded_mm} must be 0 or more",
                    index / 2 + 1
                )));
            }
            Ok(Width { value_m: width_mm / 1e3, std_m: expanded_mm / 1e3 / coverage_k })
        });
        Ok(Self { name, sections: sections.collect::<Result<_, _>>()?, scale_std })
    }

    /// The description in TOML, with uncertainties expanded by `coverage_k`.
    pub fn to_toml(&self, coverage_k: f64) -> Result<String, Error> {
        let widths = |first: usize| {
            let every_other = self.sections.iter().skip(first).step_by(2);
            every_other
                .map(|width| FileWidth { width_mm: width.value_m * 1e3, expanded_mm: width.std_m * 1e3 * coverage_k })
                .collect()
        };
        let file =
            File { name: self.name.clone(), coverage_k, scale_std: self.scale_std, tooth: widths(0), slit: widths(1) };
        toml::to_string_pretty(&file).map_err(|error| Error::Sheet(error.to_string()))
    }

    /// Positions of the edges, m, from the first one at 0: one more than there are sections.
    pub fn positions_m(&self) -> Vec<f64> {
        let mut positions = vec![0.0];
        let mut position = 0.0;
        for width in &self.sections {
            position += width.value_m;
            positions.push(position);
        }
        positions
    }

    /// Covariance of these positions, m^2. Each is a sum of widths, so two positions share the uncertainty of the widths
    /// before both; and all share the scale.
    pub fn covariance_m2(&self) -> DMatrix<f64> {
        let positions = DVector::from_vec(self.positions_m());
        let mut variances = vec![0.0];
        let mut variance = 0.0;
        for width in &self.sections {
            variance += width.std_m * width.std_m;
            variances.push(variance);
        }
        let shared = DMatrix::from_fn(positions.len(), positions.len(), |i, j| variances[i.min(j)]);
        shared + &positions * positions.transpose() * self.scale_std.powi(2)
    }
}
