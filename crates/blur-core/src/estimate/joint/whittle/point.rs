//! The parameters of the likelihood.

use super::cells::{OCTAVES, PATCHES};
use super::likelihood::Vector;
use super::scene::{self, TERMS};

/// Parameters of the fit, in this order: `ln L`, the angle in radians, `ln` of the noise power, `ln` of the incoherent
/// share, `r^2`, then the amplitudes of the scene's spectrum.
pub(super) const PARAMETERS: usize = SCENE + TERMS;
pub(super) const LENGTH: usize = 0;
pub(super) const ANGLE: usize = 1;
pub(super) const NOISE: usize = 2;
pub(super) const SHARE: usize = 3;
pub(super) const RATIO2: usize = 4;
pub(super) const SCENE: usize = 5;

/// Prior of the logarithm of the incoherent share: anything from nothing to nearly everything.
pub(super) const SHARE_MEAN: f64 = -6.0;
pub(super) const SHARE_STD: f64 = 3.0;

/// Scatter of the patches in log power before the picture is seen, and the number of patches that this counts for.
pub(super) const ROUGHNESS: f64 = 0.3;
pub(super) const ROUGHNESS_COUNTS: f64 = 2.0;
pub(super) const LEAST_ROUGHNESS: f64 = 0.02;
/// A patch is told of by the picture when that weighs this much against the first guess.
pub(super) const LEAST_TOLD: f64 = 0.05;

/// Which kernel the spectrum is explained with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kernel {
    /// No blur.
    None,
    /// Uniform motion along a line.
    Line,
    /// Motion of constant acceleration along a line.
    AcceleratedLine,
    /// A lens out of focus; the length is the disk's diameter.
    Disk,
}

/// One point of the space of parameters.
#[derive(Debug, Clone)]
pub(super) struct Point {
    /// Length of the line or diameter of the disk in pixels.
    pub(super) length: f64,
    /// Radians.
    pub(super) angle: f64,
    /// Inverse prior variance of the angle about where it is: 0 when nothing is known of it.
    pub(super) angle_precision: f64,
    pub(super) log_noise: f64,
    /// The first guess of it, from the highest frequencies: bands without noise cannot tell.
    pub(super) guessed_log_noise: f64,
    /// Logarithm of the share of the light that the kernel does not explain.
    pub(super) log_share: f64,
    pub(super) ratio2: f64,
    pub(super) scene: [f64; TERMS],
    /// Deviation of each patch in log power.
    pub(super) patches: Vec<f64>,
    /// Scatter of the patches of each octave.
    pub(super) roughness: [f64; OCTAVES],
}

impl Point {
    /// A point with room for everything that a fit will change.
    pub(super) fn new() -> Self {
        Self {
            length: 1.0,
            angle: 0.0,
            angle_precision: 0.0,
            log_noise: 0.0,
            guessed_log_noise: 0.0,
            log_share: SHARE_MEAN,
            ratio2: 0.0,
            scene: scene::MEAN,
            patches: vec![0.0; PATCHES],
            roughness: [ROUGHNESS; OCTAVES],
        }
    }

    /// Starts from this length and angle, the noise power guessed and everything else unknown.
    pub(super) fn start(&mut self, length: f64, angle: f64, noise: f64) {
        (self.length, self.angle, self.log_noise) = (length, angle, noise.ln());
        self.guessed_log_noise = self.log_noise;
        (self.log_share, self.ratio2) = (SHARE_MEAN, 0.0);
        self.scene = scene::MEAN;
        self.patches.fill(0.0);
        self.roughness = [ROUGHNESS; OCTAVES];
    }

    /// The parameters in their order.
    pub(super) fn parameters(&self) -> Vector {
        let mut parameters = Vector::zeros();
        for (index, value) in [
            (LENGTH, self.length.ln()),
            (ANGLE, self.angle),
            (NOISE, self.log_noise),
            (SHARE, self.log_share),
            (RATIO2, self.ratio2),
        ] {
            parameters[index] = value;
        }
        parameters.rows_mut(SCENE, TERMS).copy_from_slice(&self.scene);
        parameters
    }

    /// Mean scatter of the patches in the octaves up to `most_frequency`.
    pub(super) fn roughness_within(&self, most_frequency: f64) -> f64 {
        let first = (super::periodogram::MOST_FREQUENCY / most_frequency).log2().round() as usize;
        let within = &self.roughness[first.min(OCTAVES - 1)..];
        within.iter().sum::<f64>() / within.len() as f64
    }

    /// Becomes `other` without allocating.
    pub(super) fn copy(&mut self, other: &Self) {
        (self.length, self.angle, self.log_noise) = (other.length, other.angle, other.log_noise);
        self.angle_precision = other.angle_precision;
        self.guessed_log_noise = other.guessed_log_noise;
        (self.log_share, self.ratio2) = (other.log_share, other.ratio2);
        (self.scene, self.roughness) = (other.scene, other.roughness);
        self.patches.copy_from_slice(&other.patches);
    }
}
