//! What the thesis states in its chapters 4 and 5.

use serde::Serialize;

/// A row of the thesis: mean absolute errors in degrees, pixels or percent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// Smallest.
    #[serde(rename = "thesis_min")]
    pub min: f64,
    /// Lower quartile.
    #[serde(rename = "thesis_q1")]
    pub q1: f64,
    /// Mean.
    #[serde(skip)]
    pub mean: f64,
    /// Upper quartile.
    #[serde(rename = "thesis_q3")]
    pub q3: f64,
    /// Largest.
    #[serde(rename = "thesis_max")]
    pub max: f64,
}

const fn figures([min, q1, mean, q3, max]: [f64; 5]) -> Figures {
    Figures { min, q1, mean, q3, max }
}

/// Table, our name of the method, figures.
#[allow(clippy::approx_constant, reason = "an error of 3.14 degrees has nothing to do with a circle")]
const FIGURES: &[(&str, &str, Figures)] = &[
    ("4.1", "dft-radon", figures([0.57, 1.00, 1.00, 1.00, 26.29])),
    ("4.1", "dft-cepstrum", figures([0.43, 1.00, 1.55, 1.00, 51.29])),
    ("4.1", "dft-gabor", figures([0.10, 0.11, 0.90, 1.00, 2.43])),
    ("4.1", "dft-hough", figures([0.10, 1.00, 1.08, 1.00, 3.14])),
    ("4.1", "dct-radon", figures([0.21, 0.43, 0.66, 0.71, 2.29])),
    ("4.2", "dft-radon", figures([1.20, 6.23, 17.52, 29.12, 33.15])),
    ("4.2", "dft-cepstrum", figures([1.48, 2.03, 10.01, 16.00, 30.88])),
    ("4.2", "dft-gabor", figures([0.85, 19.14, 19.87, 22.41, 33.30])),
    ("4.2", "dft-hough", figures([1.13, 6.57, 21.75, 35.82, 39.04])),
    ("4.2", "dct-radon", figures([0.93, 1.34, 1.70, 2.01, 2.59])),
    ("4.4", "autocorrelation", figures([8.10, 19.63, 26.78, 35.85, 39.70])),
    ("4.4", "dft-cepstrum", figures([1.00, 1.00, 8.04, 5.60, 61.85])),
    ("4.4", "dft-radon", figures([0.95, 3.32, 11.53, 15.84, 42.66])),
    ("4.4", "dct-pseudo-cepstrum", figures([0.80, 1.00, 0.99, 1.00, 1.00])),
    ("4.5", "autocorrelation", figures([26.78, 47.27, 45.78, 48.50, 48.50])),
    ("4.5", "dft-cepstrum", figures([8.04, 43.08, 39.75, 43.42, 43.48])),
    ("4.5", "dft-radon", figures([9.32, 11.89, 18.21, 24.71, 28.69])),
    ("4.5", "dct-pseudo-cepstrum", figures([0.99, 2.71, 7.78, 11.63, 19.13])),
    ("5.2", "dft-hough", figures([3.40, 5.03, 12.86, 7.05, 122.95])),
    ("5.2", "dft-radon", figures([1.10, 10.25, 14.36, 16.83, 78.25])),
    ("5.2", "dct-radon", figures([1.65, 3.83, 4.69, 5.43, 9.09])),
    ("5.2", "dct-hough", figures([0.65, 3.36, 4.88, 5.39, 24.45])),
    ("5.3", "autocorrelation", figures([77.39, 77.75, 83.27, 84.36, 106.14])),
    ("5.3", "dft-cepstrum", figures([78.97, 87.00, 88.29, 91.15, 92.21])),
    ("5.3", "dft-radon", figures([52.48, 57.88, 100.79, 131.01, 209.15])),
    ("5.3", "dct-pseudo-cepstrum", figures([2.69, 4.37, 5.15, 5.37, 9.03])),
];

/// Table, our name of the method, mean time of a 512x512 picture in milliseconds (MATLAB 2015b).
const TIMES_MS: &[(&str, &str, f64)] = &[
    ("4.3", "dft-radon", 600.0),
    ("4.3", "dft-cepstrum", 41.0),
    ("4.3", "dft-gabor", 2920.0),
    ("4.3", "dft-hough", 18.0),
    ("4.3", "dct-radon", 680.0),
    ("4.6", "autocorrelation", 58.146_7),
    ("4.6", "dft-cepstrum", 18.681_7),
    ("4.6", "dft-radon", 0.270),
    ("4.6", "dct-pseudo-cepstrum", 38.960_5),
];

/// The errors that a table of the thesis states of a method.
pub fn errors(table: &str, method: &str) -> Option<Figures> {
    FIGURES.iter().find(|row| row.0 == table && row.1 == method).map(|row| row.2)
}

/// The time in milliseconds that a table of the thesis states of a method.
pub fn time_ms(table: &str, method: &str) -> Option<f64> {
    TIMES_MS.iter().find(|row| row.0 == table && row.1 == method).map(|row| row.2)
}
