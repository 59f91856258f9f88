//! Opaque discs of all sizes, one upon the other: edges, occlusion and scale invariance as in photographs.

use crate::rng::Rng;
use crate::{Error, Result, check};
use ndarray::Array2;

/// Stream of the seed.
const STREAM: u64 = 0x5ce0_0001;
/// A pixel is finished when less than this share of it is still open; what is seen of it then stands for the whole.
const OPEN_SHARE: f64 = 1e-3;
/// Width in pixels over which the edge of a disc goes from full to nothing: two pixels, as a lens and a pixel give
/// together, keep the samples nearly free of aliasing.
const EDGE_PX: f64 = 2.0;

/// The leaves: discs with radii between two bounds, distributed as `r^-3`, and grey levels uniform between two bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeadLeaves {
    /// Least radius in pixels, at least 1.
    pub r_min_px: f64,
    /// Greatest radius in pixels, above the least and at most 1e5.
    pub r_max_px: f64,
    /// Darkest leaf, 0 to 255.
    pub grey_min: f64,
    /// Brightest leaf, `grey_min` to 255.
    pub grey_max: f64,
}

impl Default for DeadLeaves {
    /// Radii from 2 to 100 pixels, grey levels from 15 to 240.
    fn default() -> Self {
        Self { r_min_px: 2.0, r_max_px: 100.0, grey_min: 15.0, grey_max: 240.0 }
    }
}

impl DeadLeaves {
    fn check(&self) -> Result<()> {
        check::range("least radius in px", self.r_min_px, 1.0, 1e5, "1 to 1e5")?;
        check::range("greatest radius in px", self.r_max_px, self.r_min_px, 1e5, "above the least radius, to 1e5")?;
        if self.r_max_px <= self.r_min_px {
            let expected = "above the least radius";
            return Err(Error::Parameter { name: "greatest radius in px", value: self.r_max_px, expected });
        }
        check::range("darkest grey level", self.grey_min, 0.0, 255.0, "0 to 255")?;
        check::range("brightest grey level", self.grey_max, self.grey_min, 255.0, "the darkest to 255")?;
        Ok(())
    }
}

/// A dead-leaves picture of `rows` x `cols` pixels (1 to 32768 each), the same for a seed on every machine.
///
/// The leaves fall in reverse, the uppermost first, until nothing shines through: the picture is then an exact sample
/// of the stationary model, its borders included.
///
/// # Errors
/// [`Error::Size`] and [`Error::Parameter`] for values out of the ranges above.
///
/// *Reference*: Lee, Mumford & Huang, *Occlusion models for natural images*, IJCV 41 (2001) 35, section 3; sampling
/// from the front: Kendall & Thönnes, *Perfect simulation in stochastic geometry*, Pattern Recognition 32 (1999) 1569.
pub fn dead_leaves(seed: u64, rows: usize, cols: usize, leaves: &DeadLeaves) -> Result<Array2<f64>> {
    check::size(rows, cols)?;
    leaves.check()?;
    let mut rng = Rng::new(seed, STREAM);
    let mut canvas = Canvas::new(rows, cols);
    // The soft edge makes every leaf, and so the frame that it can touch, larger by half its width each way.
    let radii = HittingRadii::new(leaves, rows as f64 + EDGE_PX, cols as f64 + EDGE_PX);
    while canvas.unfinished > 0 {
        let radius = radii.sample(&mut rng);
        let reach = radius + 0.5 * EDGE_PX;
        let row = rng.uniform_in(-0.5 - reach, rows as f64 - 0.5 + reach);
        let col = rng.uniform_in(-0.5 - reach, cols as f64 - 0.5 + reach);
        let grey = rng.uniform_in(leaves.grey_min, leaves.grey_max);
        canvas.put_below(row, col, radius, grey);
    }
    Ok(canvas.finish())
}

/// Radii of the discs that can touch a frame: `r^-3` times the area `(rows + 2r)(cols + 2r)` where their centres lie.
///
/// The product is a mixture of three powers of `r`, each with a closed inverse distribution.
struct HittingRadii {
    least: f64,
    greatest: f64,
    cubic: f64,
    square: f64,
    total: f64,
}

impl HittingRadii {
    fn new(leaves: &DeadLeaves, rows: f64, cols: f64) -> Self {
        let (least, greatest) = (leaves.r_min_px, leaves.r_max_px);
        let cubic = rows * cols * 0.5 * (1.0 / (least * least) - 1.0 / (greatest * greatest));
        let square = 2.0 * (rows + cols) * (1.0 / least - 1.0 / greatest);
        let total = cubic + square + 4.0 * libm::log(greatest / least);
        Self { least, greatest, cubic, square, total }
    }

    fn sample(&self, rng: &mut Rng) -> f64 {
        let which = rng.uniform() * self.total;
        let at = rng.uniform();
        let (a, b) = (1.0 / self.least, 1.0 / self.greatest);
        if which < self.cubic {
            1.0 / (a * a - at * (a * a - b * b)).sqrt()
        } else if which < self.cubic + self.square {
            1.0 / (a - at * (a - b))
        } else {
            self.least * libm::exp(at * libm::log(self.greatest / self.least))
        }
    }
}

/// A picture seen through the leaves put so far.
struct Canvas {
    grey: Array2<f64>,
    /// Share of each pixel that no leaf covers yet.
    open: Array2<f64>,
    unfinished: usize,
}

impl Canvas {
    fn new(rows: usize, cols: usize) -> Self {
        Self { grey: Array2::zeros((rows, cols)), open: Array2::ones((rows, cols)), unfinished: rows * cols }
    }

    fn put_below(&mut self, row: f64, col: f64, radius: f64, grey: f64) {
        let (rows, cols) = self.open.dim();
        let reach = radius + 0.5 * EDGE_PX;
        let (inner, outer) = ((radius - 0.5 * EDGE_PX).max(0.0), reach);
        for y in pixels(row, reach, rows) {
            let dy = y as f64 - row;
            let half_chord = (outer * outer - dy * dy).max(0.0).sqrt();
            for x in pixels(col, half_chord, cols) {
                let open = self.open[[y, x]];
                if open < OPEN_SHARE {
                    continue;
                }
                let dx = x as f64 - col;
                let square = dx * dx + dy * dy;
                let cover = if square <= inner * inner { 1.0 } else { soft_step((outer - square.sqrt()) / EDGE_PX) };
                self.grey[[y, x]] += open * cover * grey;
                let open = open * (1.0 - cover);
                self.open[[y, x]] = open;
                if open < OPEN_SHARE {
                    self.unfinished -= 1;
                }
            }
        }
    }

    fn finish(self) -> Array2<f64> {
        let mut grey = self.grey;
        grey.zip_mut_with(&self.open, |grey, open| *grey /= 1.0 - open);
        grey
    }
}

/// Pixels of an axis of `len` within `reach` of `centre`.
fn pixels(centre: f64, reach: f64, len: usize) -> std::ops::Range<usize> {
    let first = (centre - reach).ceil().max(0.0) as usize;
    let end = ((centre + reach).floor() + 1.0).max(0.0) as usize;
    first..end.min(len)
}

/// 0 below 0, 1 above 1, `x^2 (3 - 2x)` between.
fn soft_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
