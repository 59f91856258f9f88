//! Lines of an evaluation for people and for programs.

use serde::Serialize;

use super::evaluate::{Kind, Line};
use crate::reproduce::report::{TextTable, number};

/// Columns of the table for people that [`cells`] fills.
pub const COLUMNS: [&str; 11] = [
    "RMSE",
    "R2",
    "MAE",
    "thesis RMSE",
    "thesis R2",
    "thesis MAE",
    "beats length",
    "within k = 2",
    "right sign",
    "detected",
    "n",
];

/// The cells of a line under [`COLUMNS`], errors in m/s².
pub fn cells(line: &Line) -> Vec<String> {
    let metrics = line.metrics.as_ref();
    let beats = match (line.kind, &line.comparison) {
        (Kind::Baseline, _) | (_, None) => "-",
        (_, Some(comparison)) if comparison.beats() => "yes",
        _ => "no",
    };
    vec![
        number(metrics.map(|metrics| metrics.rmse), 4),
        number(metrics.map(|metrics| metrics.r_squared), 2),
        number(metrics.map(|metrics| metrics.mae), 4),
        number(line.thesis.map(|thesis| thesis.rmse), 4),
        number(line.thesis.map(|thesis| thesis.r_squared), 2),
        number(line.thesis.map(|thesis| thesis.mae), 4),
        beats.to_owned(),
        percent(line.coverage),
        percent(line.right_sign()),
        line.detected().map_or_else(|| "-".to_owned(), |detected| detected.to_string()),
        line.n.to_string(),
    ]
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.1}%", 100.0 * share))
}

/// The table of an evaluation.
pub fn table(lines: &[Line]) -> TextTable {
    let header: Vec<&str> =
        ["regression, m/s2"].into_iter().chain(COLUMNS).chain(["training s", "pictures/s"]).collect();
    let mut table = TextTable::new(&header);
    for line in lines {
        let mut row = vec![line.title.to_owned()];
        row.extend(cells(line));
        row.push(number(line.speed.map(|(training_s, _)| training_s), 2));
        row.push(number(line.speed.map(|(_, per_s)| per_s), 0));
        table.push(row);
    }
    table
}

/// A line for programs.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Name of the method.
    pub method: &'static str,
    /// Pictures that it has an answer for.
    pub n: usize,
    /// All the rest.
    #[serde(flatten)]
    pub fields: Fields,
}

impl From<&Line> for Row {
    fn from(line: &Line) -> Self {
        Self { method: line.name, n: line.n, fields: line.into() }
    }
}

/// Figures of merit of a line.
#[derive(Debug, Clone, Serialize)]
pub struct Fields {
    /// Root mean square error in m/s².
    pub rmse_m_s2: Option<f64>,
    /// Coefficient of determination.
    pub r_squared: Option<f64>,
    /// Mean square error in (m/s²)².
    pub mse_m2_s4: Option<f64>,
    /// Mean absolute error in m/s².
    pub mae_m_s2: Option<f64>,
    /// RMSE of the thesis in m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thesis_rmse_m_s2: Option<f64>,
    /// Coefficient of determination of the thesis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thesis_r_squared: Option<f64>,
    /// Mean absolute error of the thesis in m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thesis_mae_m_s2: Option<f64>,
    /// Whether it does better than the blur length alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beats_length: Option<bool>,
    /// By how much its mean square error is smaller, in (m/s²)².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain_over_length_m2_s4: Option<f64>,
    /// Share of the answers within two standard uncertainties of the truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage_k2: Option<f64>,
    /// Share of the answers with the sign of the truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right_sign: Option<f64>,
    /// Answers of physics that claim an acceleration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub n_detected: Option<usize>,
    /// Time of all trainings in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub training_s: Option<f64>,
    /// Pictures predicted in a second from their PSFs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predictions_per_s: Option<f64>,
}

impl From<&Line> for Fields {
    fn from(line: &Line) -> Self {
        let metrics = line.metrics.as_ref();
        Self {
            rmse_m_s2: metrics.map(|metrics| metrics.rmse),
            r_squared: metrics.map(|metrics| metrics.r_squared),
            mse_m2_s4: metrics.map(|metrics| metrics.mse),
            mae_m_s2: metrics.map(|metrics| metrics.mae),
            thesis_rmse_m_s2: line.thesis.map(|thesis| thesis.rmse),
            thesis_r_squared: line.thesis.map(|thesis| thesis.r_squared),
            thesis_mae_m_s2: line.thesis.map(|thesis| thesis.mae),
            beats_length: line.comparison.map(|comparison| comparison.beats()),
            gain_over_length_m2_s4: line.comparison.map(|comparison| comparison.gain),
            coverage_k2: line.coverage,
            right_sign: line.right_sign(),
            n_detected: line.detected(),
            training_s: line.speed.map(|(training_s, _)| training_s),
            predictions_per_s: line.speed.map(|(_, per_s)| per_s),
        }
    }
}
