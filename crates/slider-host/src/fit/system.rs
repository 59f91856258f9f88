//! The points with their covariance, ready for polynomials of any degree.

use metrology::least_squares::{Design, Fit, generalised, ordinary};
use nalgebra::{DMatrix, DVector};

use super::{EdgeShift, Options, has_edges};
use crate::Error;
use crate::points::{Points, Positions};

/// Standard uncertainty of a position that nothing else makes uncertain, m: far less than anything here is known to, and
/// enough to make a covariance definite.
const FLOOR_M: f64 = 1e-9;
/// Speeds for the covariance come from a parabola; after two rounds they change by less than their uncertainty squared.
const ROUNDS: usize = 2;

/// The points that are fitted.
#[derive(Debug, Clone)]
pub(super) struct System<'a> {
    points: &'a Points,
    /// Which of the points.
    kept: Vec<usize>,
    /// Covariance of the kept positions, m^2; the identity if nothing is known.
    covariance: DMatrix<f64>,
    known: bool,
}

impl<'a> System<'a> {
    pub(super) fn new(points: &'a Points, options: &Options) -> Result<Self, Error> {
        let n = points.t_s.len();
        let kept = (0..n).collect();
        let Some(positions) = points.positions.covariance_m2() else {
            return Ok(Self { points, kept, covariance: DMatrix::identity(n, n), known: false });
        };
        let floor = FLOOR_M.powi(2) + options.edge_std_m.powi(2);
        let time_var: Vec<f64> =
            points.time_std_s.iter().map(|std| std.powi(2) + options.jitter_std_s.powi(2)).collect();
        let mut system = Self { points, kept, covariance: DMatrix::identity(n, n), known: true };
        let degree = 2.min(n.saturating_sub(1));
        for _ in 0..ROUNDS {
            let speeds = system.speeds(degree)?;
            let own = speeds.iter().zip(&time_var).map(|(v, time)| v * v * time + floor);
            system.covariance = &positions + DMatrix::from_diagonal(&DVector::from_iterator(n, own));
        }
        Ok(system)
    }

    /// Whether the covariance is known, and not only that all points are equally good.
    pub(super) fn is_known(&self) -> bool {
        self.known
    }

    /// Number of points that are fitted.
    pub(super) fn len(&self) -> usize {
        self.kept.len()
    }

    /// The points that are fitted, by their indices.
    pub(super) fn kept(&self) -> &[usize] {
        &self.kept
    }

    pub(super) fn covariance(&self) -> &DMatrix<f64> {
        &self.covariance
    }

    /// The same without the kept point of number `place`.
    pub(super) fn without(&self, place: usize) -> Self {
        let mut system = self.clone();
        system.kept.remove(place);
        system.covariance = self.covariance.clone().remove_row(place).remove_column(place);
        system
    }

    /// The fit of a polynomial in t, with the shift as the last coefficient if it is wanted and there are edges.
    pub(super) fn fit(&self, degree: usize, shift: EdgeShift) -> Result<Fit, Error> {
        let t: Vec<f64> = self.kept.iter().map(|&index| self.points.t_s[index]).collect();
        if shift == EdgeShift::None || !has_edges(self.points) {
            return self.solve(&Design::polynomial(&t, degree));
        }
        let powers = Design::polynomial(&t, degree);
        let columns = powers.columns();
        let mut matrix = powers.rounded().clone().insert_column(columns, 0.0);
        for (row, &index) in self.kept.iter().enumerate() {
            matrix[(row, columns)] = -self.side(index) / 2.0;
        }
        self.solve(&Design::from(matrix))
    }

    /// A polynomial in time from -1 to 1, where high degrees are well conditioned; with its design.
    pub(super) fn fit_scaled(&self, degree: usize, shift: EdgeShift) -> Result<(Fit, DMatrix<f64>), Error> {
        let t = |index: usize| self.points.t_s[index];
        let (first, last) = (t(self.kept[0]), t(self.kept[self.len() - 1]));
        let with_shift = shift == EdgeShift::Fitted && has_edges(self.points);
        let columns = degree + 1 + usize::from(with_shift);
        let design = DMatrix::from_fn(self.len(), columns, |row, column| {
            let index = self.kept[row];
            if column > degree {
                self.side(index) / 2.0
            } else {
                ((2.0 * t(index) - first - last) / (last - first)).powi(column as i32)
            }
        });
        Ok((self.solve(&Design::from(design.clone()))?, design))
    }

    fn solve(&self, design: &Design) -> Result<Fit, Error> {
        let x: Vec<f64> = self.kept.iter().map(|&index| self.points.x_m[index]).collect();
        Ok(if self.known { generalised(design, &x, &self.covariance)? } else { ordinary(design, &x)? })
    }

    /// Speed at every point, m/s, of a polynomial through all of them.
    fn speeds(&self, degree: usize) -> Result<Vec<f64>, Error> {
        let b = self.fit(degree, EdgeShift::None)?.coefficients;
        let slope = |t: f64| (1..=degree).rev().fold(0.0, |slope, k| slope * t + k as f64 * b[k]);
        Ok(self.points.t_s.iter().map(|&t| slope(t)).collect())
    }

    /// +1 where a tooth begins, -1 where it ends: with a shift s the edge is seen s/2 further in this direction.
    fn side(&self, index: usize) -> f64 {
        match &self.points.positions {
            Positions::Edges { indices, .. } if !indices[index].is_multiple_of(2) => -1.0,
            _ => 1.0,
        }
    }

    /// Position less fit, m, at all points, those that were left out included.
    pub(super) fn residuals(&self, fit: &Fit, degree: usize) -> Vec<f64> {
        let b = &fit.coefficients;
        let shift = b.iter().nth(degree + 1).copied().unwrap_or(0.0);
        let seen = |(index, &t): (usize, &f64)| {
            let position = (0..=degree).rev().fold(0.0, |sum, k| sum * t + b[k]);
            self.points.x_m[index] - position + shift * self.side(index) / 2.0
        };
        self.points.t_s.iter().enumerate().map(seen).collect()
    }

    /// Standard deviation of the residual at every point, m, NaN where it was left out: with the covariance V of the
    /// points and the design A it is the root of the diagonal of V - A (A' V^-1 A)^-1 A'.
    pub(super) fn residual_stds(&self, fit: &Fit, degree: usize) -> Vec<f64> {
        let variance = if self.known || fit.dof == 0 { 1.0 } else { fit.chi2 / fit.dof as f64 };
        // What the coefficients take up: the covariance of the fitted positions with the measured ones is A gain V.
        let taken = &fit.gain * &self.covariance;
        let columns = fit.coefficients.len();
        let mut stds = vec![f64::NAN; self.points.t_s.len()];
        for (place, &index) in self.kept.iter().enumerate() {
            let t = self.points.t_s[index];
            let row = |column: usize| {
                if column > degree { -self.side(index) / 2.0 } else { t.powi(column as i32) }
            };
            let fitted: f64 = (0..columns).map(|column| row(column) * taken[(column, place)]).sum();
            stds[index] = ((self.covariance[(place, place)] - fitted).max(0.0) * variance).sqrt();
        }
        stds
    }

    /// Standard uncertainties of the sheet's widths, m, in the order of its description; none without a sheet.
    pub(super) fn width_stds(&self) -> Vec<f64> {
        let Positions::Edges { sheet, reversed, .. } = &self.points.positions else { return Vec::new() };
        let mut stds: Vec<f64> = sheet.sections.iter().map(|width| width.std_m).collect();
        if *reversed {
            stds.reverse();
        }
        stds
    }

    /// Change of a coefficient with each of these widths: all edges after a section move with it.
    pub(super) fn width_sensitivities(&self, fit: &Fit, coefficient: usize) -> Vec<f64> {
        let Positions::Edges { sheet, reversed, indices } = &self.points.positions else { return Vec::new() };
        let gains = fit.gain.row(coefficient);
        let after = |section: usize| {
            let behind = self.kept.iter().enumerate().filter(|&(_, &index)| indices[index] > section);
            behind.map(|(place, _)| gains[place]).sum()
        };
        let mut sensitivities: Vec<f64> = (0..sheet.sections.len()).map(after).collect();
        if *reversed {
            sensitivities.reverse();
        }
        sensitivities
    }
}
