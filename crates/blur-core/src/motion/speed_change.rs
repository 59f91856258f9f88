//! Change of the speed while a rolling shutter reads the rows.

use super::{COVERAGE_K, Exposure, RolledBlur, RollingShutter};
use crate::estimate::AxialAngle;
use crate::image::Window;
use crate::{Error, Result};

/// Tiles must lie in at least so many rows: with fewer, a line is hardly told from scatter.
pub const LEAST_TILE_ROWS: usize = 4;
/// Least mean resultant length of the tiles' axes: below, they spread by more than about 20 degrees and are not one motion.
const LEAST_RESULTANT: f64 = 0.8;

/// The blur of one tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileMotion {
    /// Column and row of its centre among the pixels as the sensor reads them.
    pub centre_px: [f64; 2],
    /// Its blur in that frame.
    pub blur: RolledBlur,
}

/// By how much the speed along the common axis rises in a second, from the first rows read to the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedChange {
    /// Pixels per second squared; negative when the motion slows down.
    pub value_px_s2: f64,
    /// Its combined standard uncertainty.
    pub std_px_s2: f64,
    /// Number of tiles that it is from.
    pub tiles: usize,
}

impl SpeedChange {
    /// `|value|` in standard uncertainties.
    pub fn significance(&self) -> f64 {
        self.value_px_s2.abs() / self.std_px_s2
    }

    /// Whether it is more than the expanded uncertainty for [`COVERAGE_K`].
    pub fn is_significant(&self) -> bool {
        self.significance() > COVERAGE_K
    }
}

/// Speed along the common axis at the time that a tile was exposed.
struct Sample {
    time_s: f64,
    speed_px_s: f64,
    std_px_s: f64,
}

impl RollingShutter {
    /// The change of the speed over a picture in which everything moves alike, from the blur of square tiles of `tile_px`
    /// pixels measured under `window`.
    ///
    /// A line is fitted to the tiles' speeds along their mean axis against the times of their middle rows, weighted by
    /// their uncertainties. Tiles overlap, so that their errors go together: as the powers of their spectra do, by the
    /// squared autocorrelation of the window at their distance (Welch 1967). When the tiles scatter about the line by more
    /// than their uncertainties say, these are scaled up (Birge 1932). A motion downwards and one upwards give different
    /// speeds, see [`RollingShutter`]; the value is the mean of both, and half their difference a part of the uncertainty.
    ///
    /// Tiles without uncertainty do not count.
    ///
    /// # Errors
    /// [`Error::TooFewTileRows`] for tiles in fewer than [`LEAST_TILE_ROWS`] rows, [`Error::AxesDiffer`] for tiles that do
    /// not move along one axis, [`Error::Parameter`] for a shutter that reads all rows at once or too slowly for such blurs.
    ///
    /// # Reference
    /// P. D. Welch, *The use of fast Fourier transform for the estimation of power spectra*, 1967, for the correlation of
    /// overlapping segments; R. T. Birge, *The calculation of errors by the method of least squares*, 1932.
    pub fn speed_change(
        self,
        tiles: &[TileMotion],
        tile_px: usize,
        window: Window,
        exposure: Exposure,
    ) -> Result<SpeedChange> {
        if self.row_s() <= 0.0 {
            return Err(Error::Parameter {
                name: "readout (s)",
                value: self.row_s(),
                expected: "greater than 0 for a change during it",
            });
        }
        let certain = |tile: &&TileMotion| tile.blur.length_std_px.is_some_and(|std| std > 0.0 && std.is_finite());
        let tiles: Vec<TileMotion> = tiles.iter().filter(certain).copied().collect();
        let rows = rows_of(&tiles);
        if rows < LEAST_TILE_ROWS {
            return Err(Error::TooFewTileRows { rows, needed: LEAST_TILE_ROWS });
        }
        let axis = common_axis(&tiles)?;
        let correlation = Overlap::new(window, tile_px);
        let seconds = exposure.seconds();
        let fits: Vec<(f64, f64)> = [1.0, -1.0]
            .iter()
            .filter_map(|&sign| {
                let samples: Option<Vec<Sample>> =
                    tiles.iter().map(|tile| self.sample(tile, axis, seconds.value(), sign)).collect();
                Some(slope(&samples?, |i, j| correlation.of(tiles[i].centre_px, tiles[j].centre_px)))
            })
            .collect();
        let (highest, lowest, variance) =
            fits.iter().fold((f64::NEG_INFINITY, f64::INFINITY, 0.0_f64), |(high, low, most), &(value, variance)| {
                (high.max(value), low.min(value), most.max(variance))
            });
        let value_px_s2 = 0.5 * (highest + lowest);
        if !value_px_s2.is_finite() {
            return Err(Error::Parameter {
                name: "time from row to row (s)",
                value: self.row_s(),
                expected: "shorter for blurs of such length",
            });
        }
        let by_way = 0.5 * (highest - lowest);
        let by_exposure = value_px_s2 * seconds.std() / seconds.value();
        let std_px_s2 = (variance + by_way * by_way + by_exposure * by_exposure).sqrt();
        Ok(SpeedChange { value_px_s2, std_px_s2, tiles: tiles.len() })
    }

    /// The speed of a tile if it moved with (`sign` 1) or against (-1) the readout; `None` when it cannot have.
    fn sample(self, tile: &TileMotion, axis: AxialAngle, exposure_s: f64, sign: f64) -> Option<Sample> {
        let blur = &tile.blur;
        // From -90 to 90 degrees off the axis.
        let off = (blur.angle.rad() - axis.rad() + 0.5 * std::f64::consts::PI).rem_euclid(std::f64::consts::PI)
            - 0.5 * std::f64::consts::PI;
        let (sin, cos) = blur.angle.rad().sin_cos();
        let along_px = blur.length_px * off.cos();
        let during_s = exposure_s + sign * blur.length_px * sin.abs() * self.row_s();
        if during_s <= 0.0 {
            return None;
        }
        let speed_px_s = along_px / during_s;
        // First order in length and angle (GUM eq. 13).
        let per_px = exposure_s * off.cos() / (during_s * during_s);
        let per_rad = -blur.length_px * off.sin() / during_s
            - speed_px_s / during_s * sign * blur.length_px * cos * sin.signum() * self.row_s();
        let (by_length, by_angle) =
            (per_px * blur.length_std_px?, per_rad * blur.angle_std_deg.unwrap_or(0.0).to_radians());
        let variance = by_length.powi(2) + by_angle.powi(2) + 2.0 * blur.correlation * by_length * by_angle;
        let time_s = tile.centre_px[1] * self.row_s();
        (variance > 0.0).then(|| Sample { time_s, speed_px_s, std_px_s: variance.sqrt() })
    }
}

/// In how many rows the tiles lie.
fn rows_of(tiles: &[TileMotion]) -> usize {
    let mut rows: Vec<f64> = tiles.iter().map(|tile| tile.centre_px[1]).collect();
    rows.sort_by(f64::total_cmp);
    rows.dedup_by(|a, b| (*a - *b).abs() < 0.5);
    rows.len()
}

/// The mean axis: half the direction of the mean of unit vectors at twice the angles.
fn common_axis(tiles: &[TileMotion]) -> Result<AxialAngle> {
    let (sum_sin, sum_cos) = tiles.iter().fold((0.0, 0.0), |(sum_sin, sum_cos), tile| {
        let (sin, cos) = (2.0 * tile.blur.angle.rad()).sin_cos();
        (sum_sin + sin, sum_cos + cos)
    });
    let resultant = f64::hypot(sum_sin, sum_cos) / tiles.len() as f64;
    if resultant < LEAST_RESULTANT {
        return Err(Error::AxesDiffer { resultant, least: LEAST_RESULTANT });
    }
    Ok(AxialAngle::from_deg(0.5 * f64::atan2(sum_sin, sum_cos).to_degrees()))
}

/// Slope of the weighted line through the samples and its variance, when the errors of samples `i` and `j` have the
/// correlation coefficient `correlation(i, j)`.
fn slope(samples: &[Sample], correlation: impl Fn(usize, usize) -> f64) -> (f64, f64) {
    let weight = |sample: &Sample| 1.0 / (sample.std_px_s * sample.std_px_s);
    let total: f64 = samples.iter().map(weight).sum();
    let mean = |value: &dyn Fn(&Sample) -> f64| samples.iter().map(|s| weight(s) * value(s)).sum::<f64>() / total;
    let (time_s, speed_px_s) = (mean(&|sample| sample.time_s), mean(&|sample| sample.speed_px_s));
    let spread: f64 = samples.iter().map(|s| weight(s) * (s.time_s - time_s).powi(2)).sum();
    let shares: Vec<f64> = samples.iter().map(|s| weight(s) * (s.time_s - time_s) / spread).collect();
    let slope: f64 = samples.iter().zip(&shares).map(|(sample, share)| share * sample.speed_px_s).sum();
    let errors: Vec<f64> = samples.iter().zip(&shares).map(|(sample, share)| share * sample.std_px_s).collect();
    let mut variance = 0.0;
    for (i, a) in errors.iter().enumerate() {
        let others: f64 = (0..i).map(|j| errors[j] * correlation(i, j)).sum();
        variance += a * (a + 2.0 * others);
    }
    let squares: f64 =
        samples.iter().map(|s| weight(s) * (s.speed_px_s - speed_px_s - slope * (s.time_s - time_s)).powi(2)).sum();
    // Four rows or more leave at least two degrees of freedom.
    let birge = squares / (samples.len() as f64 - 2.0);
    (slope, variance * birge.max(1.0))
}

/// How much the spectra of overlapping tiles go together.
struct Overlap {
    /// Squared autocorrelation of the window at each distance along one axis.
    at_px: Vec<f64>,
}

impl Overlap {
    fn new(window: Window, tile_px: usize) -> Self {
        let taper: Vec<f64> = (0..tile_px).map(|i| window.weight(i, tile_px)).collect();
        let product = |lag: usize| taper.iter().zip(&taper[lag..]).map(|(a, b)| a * b).sum::<f64>();
        let power = product(0);
        Self { at_px: (0..tile_px).map(|lag| (product(lag) / power).powi(2)).collect() }
    }

    /// Correlation coefficient for tiles with these centres.
    fn of(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let along = |i: usize| self.at_px.get((a[i] - b[i]).abs().round() as usize).copied().unwrap_or(0.0);
        along(0) * along(1)
    }
}

#[cfg(test)]
mod tests {
    use metrology::Measurement;

    use super::*;

    fn tile(column: f64, row: f64, length_px: f64, angle_deg: f64) -> TileMotion {
        let blur = RolledBlur {
            length_px,
            length_std_px: Some(0.2),
            angle: AxialAngle::from_deg(angle_deg),
            angle_std_deg: Some(0.5),
            correlation: 0.0,
        };
        TileMotion { centre_px: [column, row], blur }
    }

    /// 1000 rows in 20 ms, 10 ms of exposure.
    fn change(tiles: &[TileMotion]) -> Result<SpeedChange> {
        let exposure = Exposure::new(Measurement::exact(0.01).unwrap()).unwrap();
        RollingShutter::new(0.02, 1000).unwrap().speed_change(tiles, 100, Window::Hann, exposure)
    }

    #[test]
    fn a_line_through_distant_tiles_is_that_of_the_textbook() {
        // 30 px in 10 ms at the first row, 3 px more at the last of 1000: 300 px/s in 20 ms.
        let mut tiles: Vec<TileMotion> =
            (0..5).map(|i| f64::from(i) * 200.0).map(|y| tile(0.0, y, 30.0 + 3e-3 * y, 0.0)).collect();
        // A tilt, known or not, changes how long a row is exposed.
        for tile in &mut tiles {
            tile.blur.angle_std_deg = Some(0.0);
        }
        let found = change(&tiles).unwrap();
        assert!((found.value_px_s2 - 15_000.0).abs() < 1e-6, "{found:?}");
        // u(v) / sqrt(sum (t - mean)^2) with u(v) = 20 px/s and times 4 ms apart.
        let spread_s = 4e-3 * 10.0_f64.sqrt();
        assert!((found.std_px_s2 / (20.0 / spread_s) - 1.0).abs() < 1e-9, "{found:?}");
        assert!((found.significance() - 15_000.0 / found.std_px_s2).abs() < 1e-9);
        assert_eq!((found.tiles, found.is_significant()), (5, true));
    }

    #[test]
    fn overlapping_tiles_tell_less_than_as_many_apart() {
        let column = |step: f64| -> Vec<TileMotion> {
            (0..6)
                .flat_map(|i| (0..6).map(move |j| tile(step * f64::from(j), 50.0 * f64::from(i), 30.0, 0.0)))
                .collect()
        };
        let (apart, half, same) =
            (change(&column(100.0)).unwrap(), change(&column(50.0)).unwrap(), change(&column(0.0)).unwrap());
        assert!(apart.std_px_s2 < half.std_px_s2 && half.std_px_s2 < 1.2 * apart.std_px_s2, "{apart:?} {half:?}");
        // Six times the same tile is one tile.
        assert!((same.std_px_s2 / apart.std_px_s2 / 6.0_f64.sqrt() - 1.0).abs() < 0.05, "{same:?} {apart:?}");
    }

    #[test]
    fn hann_windows_half_a_window_apart_go_together_by_a_36th() {
        // Welch (1967): the products of two halves of Hann sum up to a sixth of the squares.
        let overlap = Overlap::new(Window::Hann, 1000);
        assert!((overlap.of([0.0, 0.0], [500.0, 0.0]) - 1.0 / 36.0).abs() < 1e-3);
        assert_eq!(overlap.of([0.0, 0.0], [0.0, 1000.0]), 0.0);
        assert!((Overlap::new(Window::None, 10).of([0.0, 0.0], [5.0, 5.0]) - 0.0625).abs() < 1e-12);
    }

    #[test]
    fn scatter_beyond_the_uncertainties_counts() {
        let scattered = |px: f64| -> Vec<TileMotion> {
            (0..8).map(|i| tile(0.0, 120.0 * f64::from(i), 30.0 + if i % 2 == 0 { px } else { -px }, 0.0)).collect()
        };
        let (calm, wild) = (change(&scattered(0.0)).unwrap(), change(&scattered(2.0)).unwrap());
        assert!(wild.std_px_s2 > 8.0 * calm.std_px_s2, "{calm:?} {wild:?}");
        assert!(!wild.is_significant());
    }

    #[test]
    fn both_ways_of_a_vertical_motion_are_inside() {
        let tiles: Vec<TileMotion> =
            (0..5).map(|i| f64::from(i) * 200.0).map(|y| tile(0.0, y, 60.0 + 6e-3 * y, 90.0)).collect();
        let found = change(&tiles).unwrap();
        for sign in [1.0, -1.0] {
            let speed = |y: f64| {
                let length = 60.0 + 6e-3 * y;
                length / (0.01 + sign * length * 2e-5)
            };
            let slope = (speed(800.0) - speed(0.0)) / (800.0 * 2e-5);
            assert!((found.value_px_s2 - slope).abs() < found.std_px_s2, "{found:?} {slope}");
        }
    }

    #[test]
    fn too_little_is_refused() {
        let rows = |rows: u32| -> Vec<TileMotion> {
            (0..2 * rows).map(|i| tile(100.0 * f64::from(i % 2), 100.0 * f64::from(i / 2), 30.0, 0.0)).collect()
        };
        assert_eq!(change(&rows(3)), Err(Error::TooFewTileRows { rows: 3, needed: 4 }));
        assert!(change(&rows(4)).is_ok());
        let crossed: Vec<TileMotion> =
            (0..8).map(|i| tile(0.0, 100.0 * f64::from(i), 30.0, 90.0 * f64::from(i % 2))).collect();
        assert!(matches!(change(&crossed), Err(Error::AxesDiffer { .. })));
        let exposure = Exposure::new(Measurement::exact(0.01).unwrap()).unwrap();
        let global = RollingShutter::new(0.0, 1000).unwrap();
        assert!(global.speed_change(&rows(4), 100, Window::Hann, exposure).is_err());
    }
}
