//! Line kernels on the pixel grid.
//!
//! The weight of a pixel is the share of the exposure that a moving point spends inside the pixel's unit square: the
//! line density convolved with the unit square and sampled at the pixel centres. Every weight is exact (the line is
//! clipped at the pixel borders and the density integrated in closed form between them), none is negative, and their
//! sum is 1.
//!
//! **A rasterised kernel is aliased.** The unit square is not band-limited and neither is the line, so the discrete
//! transform of the kernel is *not* `sinc(L s)`: it has the square's own sinc in it and all its copies folded back. An
//! estimator tested on pictures blurred with such a kernel is tested on the kernel's errors too. For pictures of known
//! truth integrate the moving scene over the exposure, as the crate `blur-sim` does; these kernels are for display, for
//! restoration, and for comparison with programs that work this way.

use ndarray::Array2;

use super::accelerated::elapsed;
use crate::{Error, Result};

/// Longest line that is rasterised, in pixels; the kernel of a diagonal one has 268 MB.
pub const MAX_KERNEL_LENGTH_PX: f64 = 8192.0;

/// How far a line may reach into a pixel before the kernel grows by it, in pixels: the rounding of its end points.
const REACH_SLACK_PX: f64 = 1e-12;

/// The kernel of a uniform motion over `length_px` pixels in the direction `angle_deg`, centred.
///
/// - `length_px`: any real number in `[0, MAX_KERNEL_LENGTH_PX]`; 0 gives the 1x1 kernel `[[1]]`.
/// - `angle_deg`: any finite angle in degrees, counter-clockwise from +x as seen (y up). `theta` and `theta + 180` give
///   the same kernel.
///
/// Returns rows by columns, both odd and just large enough, row 0 at the top, the middle of the line at the middle of
/// the middle pixel.
///
/// # Errors
/// [`Error::Parameter`] when `length_px` is out of its range or `angle_deg` is not finite.
///
/// ```
/// let kernel = blur_core::psf::line_kernel(2.0, 0.0)?;
/// assert_eq!(kernel, ndarray::array![[0.25, 0.5, 0.25]]);
/// # Ok::<(), blur_core::Error>(())
/// ```
pub fn line_kernel(length_px: f64, angle_deg: f64) -> Result<Array2<f64>> {
    rasterise(length_px, angle_deg, |p| p)
}

/// The kernel of a uniformly accelerated motion over `length_px` pixels in the direction `angle_deg`.
///
/// `ratio` is the acceleration ratio `r = a T / (2 vbar)` in `[-1, 1]` of [`AcceleratedBlur`](super::AcceleratedBlur).
/// The motion goes from the tail to the head of the vector `(cos, -sin)` in (column, row), so a positive ratio makes
/// the tail the bright end. The middle of the *path* is at the middle of the middle pixel; the centroid of the kernel
/// is about `ratio length_px / 6` behind it. All else is as for [`line_kernel`].
///
/// # Errors
/// [`Error::Parameter`] when `length_px` or `ratio` is out of its range or `angle_deg` is not finite.
pub fn accelerated_line_kernel(length_px: f64, ratio: f64, angle_deg: f64) -> Result<Array2<f64>> {
    if ratio.abs() <= 1.0 {
        rasterise(length_px, angle_deg, |p| elapsed(p, ratio))
    } else {
        Err(Error::Parameter { name: "acceleration ratio", value: ratio, expected: "in [-1, 1]" })
    }
}

/// Clips the line at the pixel borders; `cumulative` is the share of the exposure at a share of the path.
fn rasterise(length_px: f64, angle_deg: f64, cumulative: impl Fn(f64) -> f64) -> Result<Array2<f64>> {
    if !(0.0..=MAX_KERNEL_LENGTH_PX).contains(&length_px) {
        return Err(Error::Parameter { name: "blur length (px)", value: length_px, expected: "in [0, 8192]" });
    }
    if !angle_deg.is_finite() {
        return Err(Error::Parameter { name: "angle (deg)", value: angle_deg, expected: "a finite number" });
    }
    let (sin, cos) = sin_cos_deg(angle_deg);
    let (columns, rows) = (Axis::new(length_px * cos), Axis::new(-length_px * sin));
    let mut kernel = Array2::zeros((rows.pixels(), columns.pixels()));

    let mut cuts = vec![0.0, 1.0];
    cuts.extend(columns.crossings().chain(rows.crossings()).filter(|p| (0.0..=1.0).contains(p)));
    cuts.sort_by(f64::total_cmp);
    let mut spent = 0.0;
    for pair in cuts.windows(2) {
        let [begin, end] = [pair[0], pair[1]];
        // Rounding must not let the time run backwards.
        let until = cumulative(end).max(spent);
        let middle = 0.5 * (begin + end);
        kernel[[rows.pixel_at(middle), columns.pixel_at(middle)]] += until - spent;
        spent = until;
    }
    Ok(kernel)
}

/// The line along one axis of the grid.
struct Axis {
    /// From the first to the last point of the line, in pixels, signed.
    extent: f64,
    /// Pixels on either side of the middle one.
    reach: usize,
}

impl Axis {
    fn new(extent: f64) -> Self {
        Self { extent, reach: (0.5 * extent.abs() - 0.5 - REACH_SLACK_PX).ceil().max(0.0) as usize }
    }

    fn pixels(&self) -> usize {
        2 * self.reach + 1
    }

    /// Shares of the path at which the line crosses from pixel to pixel.
    fn crossings(&self) -> impl Iterator<Item = f64> + '_ {
        let borders = 2 * self.reach;
        (0..borders).map(|k| 0.5 + (k as f64 - self.reach as f64 + 0.5) / self.extent)
    }

    /// Index of the pixel at a share of the path.
    fn pixel_at(&self, p: f64) -> usize {
        let nearest = ((p - 0.5) * self.extent).round() + self.reach as f64;
        (nearest.max(0.0) as usize).min(2 * self.reach)
    }
}

/// Sine and cosine of an angle in degrees, exact at every quarter turn.
fn sin_cos_deg(deg: f64) -> (f64, f64) {
    let deg = deg.rem_euclid(360.0);
    let quarter = (deg / 90.0).floor();
    let (sin, cos) = (deg - 90.0 * quarter).to_radians().sin_cos();
    match quarter as u8 {
        1 => (cos, -sin),
        2 => (-sin, -cos),
        3 => (-cos, sin),
        _ => (sin, cos),
    }
}
