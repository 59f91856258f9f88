//! The sharp scene from its stills.

use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex32;

use super::fit::{PLAIN, fit};
use super::grid::Grid;
use super::kernel::Kernel;
use super::model::{Model, Noise, STILL};
use super::path::Path;
use super::power::mean_power;
use super::residual::{MOST_UNEXPLAINED, Residual};
use crate::spectrum::{Dft2, InverseDft2};
use crate::{Error, Result, image};

/// Stills may be displaced from each other by this many pixels.
const MOST_SHIFT_PX: usize = 24;
/// No low pass: far beyond half a cycle per pixel.
pub(super) const ALL: f64 = 100.0;

/// What the stills say about the scene.
#[derive(Debug)]
pub(super) struct Scene {
    pub(super) grid: Grid,
    /// The mean still, brought to the mean position.
    pub(super) mean: Array2<f32>,
    /// Its spectrum.
    pub(super) spectrum: Array2<Complex32>,
    /// The mean power around each bin, noise included.
    pub(super) power: Array2<f32>,
    /// Variance of the noise of the mean still; `None` for a single one.
    pub(super) variance: Option<f64>,
}

impl Scene {
    /// Registers `stills` to each other and averages them.
    pub(super) fn new(stills: &[ArrayView2<'_, f32>]) -> Result<Self> {
        let Some(first) = stills.first() else { return Err(Error::NoStill) };
        let (height, width) = first.dim();
        for still in stills {
            image::check(*still)?;
            if still.dim() != first.dim() {
                let (other_height, other_width) = still.dim();
                return Err(Error::StillSize { width, height, other_width, other_height });
            }
        }
        let grid = Grid::new(first.dim());
        let mut dft = Dft2::new(grid.padded.0, grid.padded.1);
        grid.fill(*first, dft.input());
        let reference = dft.transform().to_owned();
        let registered = register(&grid, stills, &reference)?;

        let count = stills.len() as f64;
        let mean_shift: [f64; 2] = std::array::from_fn(|i| registered.iter().map(|r| r.shift[i]).sum::<f64>() / count);
        let mut spectrum = Array2::zeros(grid.spectrum());
        let mut phases = grid.phases();
        for (still, found) in stills.iter().zip(&registered) {
            grid.fill(*still, dft.input());
            grid.set_phases(std::array::from_fn(|i| mean_shift[i] - found.shift[i]), &mut phases);
            let share = (1.0 / (count * found.gain)) as f32;
            for ((row, column), value) in dft.transform().indexed_iter() {
                spectrum[[row, column]] += value * phases[0][row] * phases[1][column] * share;
            }
        }
        let mut power = Array2::zeros(grid.spectrum());
        mean_power(&grid, &spectrum, &mut power);
        let mut inverse = InverseDft2::new(grid.padded.0, grid.padded.1);
        inverse.input().assign(&spectrum);
        let padded = inverse.transform();
        let mean = Array2::from_shape_fn(grid.picture, |bin| padded[bin]);
        // The difference of two stills has twice the variance of one.
        let others = registered.len() - 1;
        let variance = (others > 0)
            .then(|| registered.iter().skip(1).map(|r| r.variance).sum::<f64>() / (2.0 * others as f64 * count));
        Ok(Self { grid, mean, spectrum, power, variance })
    }
}

/// A still against the first one.
struct Registered {
    shift: [f64; 2],
    gain: f64,
    /// Variance of the difference.
    variance: f64,
}

fn register(grid: &Grid, stills: &[ArrayView2<'_, f32>], reference: &Array2<Complex32>) -> Result<Vec<Registered>> {
    let mut registered = vec![Registered { shift: [0.0; 2], gain: 1.0, variance: 0.0 }];
    if stills.len() == 1 {
        return Ok(registered);
    }
    let mut kernel = Kernel::new(*grid, MOST_SHIFT_PX);
    kernel.set_still(stills[0]);
    let mut model = Model::new(*grid, 1.0, [0.0; 2]);
    let trust = Array2::zeros(grid.spectrum());
    let noise = Noise { picture: 1.0, still: 0.0 };
    for (index, still) in stills.iter().enumerate().skip(1) {
        kernel.set(*still);
        let start = Path::still(kernel.peak());
        model.set_data(*still, &start, noise, &trust, ALL);
        let fitted = fit(&mut model, reference, STILL, (start, PLAIN), 1.0)
            .filter(|fitted| fitted.gain[0] > 0.0)
            .ok_or(Error::StillsDiffer { index: index + 1, share: 1.0 })?;
        let share = Residual::new(&model, STILL, &fitted, noise).unexplained;
        if share > MOST_UNEXPLAINED {
            return Err(Error::StillsDiffer { index: index + 1, share });
        }
        registered.push(Registered {
            shift: fitted.path.centre,
            gain: fitted.gain[0],
            variance: fitted.rest / model.pixels(),
        });
    }
    Ok(registered)
}
