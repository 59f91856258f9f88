//! What hangs on the wall: five printed patterns with fine structure along the motion.

use crate::Result;
use crate::scene::{Bars, DeadLeaves, FIELD_MEAN, bars, dead_leaves, gaussian_field};
use ndarray::Array2;

/// Darkest and brightest print. With a gain of 1.05 and noise of 40 dB the brightest is 4 standard deviations below
/// the clipping.
const GREY_MIN: f64 = 20.0;
const GREY_MAX: f64 = 230.0;

/// Contrast of the Gaussian field, so that black and white are 4 standard deviations away.
const FIELD_CONTRAST: f64 = 0.8;

/// The posters, in the order of their numbers.
pub const POSTERS: [Poster; 5] = [
    Poster { name: "leaves", seed: 101, print: Print::Leaves { r_min_px: 2.0, r_max_px: 100.0 } },
    Poster { name: "fine-leaves", seed: 102, print: Print::Leaves { r_min_px: 1.5, r_max_px: 15.0 } },
    Poster { name: "discs", seed: 103, print: Print::Leaves { r_min_px: 5.0, r_max_px: 30.0 } },
    Poster { name: "field", seed: 104, print: Print::Field { exponent: 2.0 } },
    Poster { name: "bars", seed: 105, print: Print::Bars },
];

/// A poster: the same print in every experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Poster {
    /// Its name.
    pub name: &'static str,
    seed: u64,
    print: Print,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Print {
    /// Opaque discs of these radii.
    Leaves { r_min_px: f64, r_max_px: f64 },
    /// A Gaussian random field whose power falls as `f^-exponent`.
    Field { exponent: f64 },
    /// Bands of bars.
    Bars,
}

impl Poster {
    /// The sharp print on `side_px` x `side_px` pixels, light on the scale 0..255.
    ///
    /// # Errors
    /// [`Error::Size`](crate::Error::Size) when the side is not from 2 to 16384.
    pub fn scene(&self, side_px: usize) -> Result<Array2<f64>> {
        match self.print {
            Print::Leaves { r_min_px, r_max_px } => {
                let leaves = DeadLeaves { r_min_px, r_max_px, grey_min: GREY_MIN, grey_max: GREY_MAX };
                dead_leaves(self.seed, side_px, side_px, &leaves)
            }
            Print::Field { exponent } => {
                let field = gaussian_field(self.seed, side_px, side_px, exponent)?;
                Ok(field.mapv_into(|x| FIELD_MEAN + FIELD_CONTRAST * (x - FIELD_MEAN)))
            }
            Print::Bars => {
                let print = Bars { grey_min: GREY_MIN, grey_max: GREY_MAX, ..Bars::default() };
                bars(self.seed, side_px, side_px, &print)
            }
        }
    }
}
