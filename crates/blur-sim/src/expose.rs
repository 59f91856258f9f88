//! The exposure of a moving picture, or of one out of focus, exact to the band limit.
//!
//! The samples of the scene stand for the one band-limited picture that passes through them. Its time average along
//! the path is computed in the Fourier domain, `spectrum x H(s)` with the exact [`transfer`](Motion::transfer)
//! function, not with a rasterised kernel (whose transform is aliased and no longer `sinc(L s)`). The scene is
//! continued by reflection for the transform, and only pixels whose whole path lies inside the scene are returned.
//! Every other [`Blur`] is treated alike: for a path read the reach of its kernel.
//!
//! What the reflection cannot know is the picture beyond the border, which a band-limited interpolation reads with
//! alternating weights that fall off as the inverse distance. On dead leaves the error is at most 0.2 grey levels rms
//! in the outermost row of pixels (less than the rounding to eight bits) and 0.1 from 16 pixels inwards. Where that
//! matters, expose a larger scene and cut.

use crate::motion::Motion;
use crate::tabulated::Tabulated;
use crate::transform::{Filter, Planners, fast_size};
use crate::{Error, Result, check};
use ndarray::{Array2, ArrayView2};
use rustfft::num_complex::Complex;
use std::fmt;

/// Pixels of pure reflection beyond the reach of the blur.
const GUARD_PX: usize = 16;
/// Pixels over which the reflections of opposite borders fade into each other, so that the periodic continuation
/// has no seam.
const FADE_PX: usize = 32;

/// What an exposure does to every point of a scene: a linear blur, the same everywhere, given by its transfer function.
pub trait Blur {
    /// Rows and columns that the exposure costs: the size of the kernel, rounded up. A picture of `rows` x `cols`
    /// pixels needs a scene that is larger by this much.
    fn extent_px(&self) -> (usize, usize);

    /// The transfer function of `u` (along columns) and `v` (along rows, downwards) in cycles per pixel, each within
    /// half a cycle, made ready for about `uses` calls. Its value at `(-u, -v)` is the conjugate of that at `(u, v)`.
    fn gain(&self, uses: usize) -> impl Fn(f64, f64) -> Complex<f64>;
}

impl Blur for Motion {
    fn extent_px(&self) -> (usize, usize) {
        Motion::extent_px(self)
    }

    fn gain(&self, uses: usize) -> impl Fn(f64, f64) -> Complex<f64> {
        let (x, y) = self.direction();
        // The corners of the spectrum are at half a cycle per pixel each way.
        let transfer = Tabulated::new(self, 0.5 * (x.abs() + y.abs()), uses);
        move |u, v| transfer.at(u * x + v * y)
    }
}

/// Blurs many scenes: plans and buffers of the transforms are kept from call to call.
///
/// ```
/// use blur_core::estimate::AxialAngle;
/// use blur_sim::{expose::Exposer, motion::Motion, scene::DeadLeaves, scene::dead_leaves};
/// # fn main() -> blur_sim::Result<()> {
/// let motion = Motion::uniform(12.0, AxialAngle::from_deg(30.0))?;
/// let (rows, cols) = motion.extent_px();
/// let scene = dead_leaves(1, 100 + rows, 150 + cols, &DeadLeaves::default())?;
/// let picture = Exposer::new().expose(scene.view(), &motion)?;
/// assert_eq!(picture.dim(), (100, 150));
/// # Ok(())
/// # }
/// ```
pub struct Exposer {
    planners: Planners,
    filter: Option<Filter>,
    buffer: Vec<f64>,
}

impl fmt::Debug for Exposer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let planned = self.filter.as_ref().map(Filter::size);
        f.debug_struct("Exposer").field("planned_for", &planned).finish_non_exhaustive()
    }
}

impl Default for Exposer {
    fn default() -> Self {
        Self::new()
    }
}

impl Exposer {
    /// An exposer without any plans yet.
    pub fn new() -> Self {
        Self { planners: Planners::new(), filter: None, buffer: Vec::new() }
    }

    /// The blurred picture of the pixels whose whole path, or disk, lies inside the scene.
    ///
    /// `scene` is any `rows` x `cols` picture on any linear scale; the result is smaller by [`Blur::extent_px`] (for a
    /// motion `ceil |L sin angle|` rows and `ceil |L cos angle|` columns) and shows the middle of the scene: its first
    /// pixel is the scene's at half the extent, rounded down. The path is centred, so nothing is displaced.
    ///
    /// # Errors
    /// [`Error::Size`] for an empty or enormous scene, [`Error::NotFinite`] for a pixel that is no number,
    /// [`Error::BlurTooLong`] when no pixel is left.
    pub fn expose(&mut self, scene: ArrayView2<'_, f64>, blur: &impl Blur) -> Result<Array2<f64>> {
        let (rows, cols) = scene.dim();
        let (lost_rows, lost_cols) = blur.extent_px();
        if lost_rows >= rows || lost_cols >= cols {
            check::size(rows, cols)?;
            return Err(too_long(blur, rows, cols));
        }
        let width = self.blur_reflected(scene, blur)?;
        let (top, left) = (lost_rows / 2, lost_cols / 2);
        Ok(self.cut(width, (top, left), (rows - lost_rows, cols - lost_cols)))
    }

    /// The blurred picture of every pixel of the scene, which is continued by reflection at its borders.
    ///
    /// Pixels nearer to a border than half the blur are invented; use [`expose`](Self::expose) for measurements.
    ///
    /// # Errors
    /// As for [`expose`](Self::expose); the blur must be no larger than the scene.
    pub fn expose_padded(&mut self, scene: ArrayView2<'_, f64>, blur: &impl Blur) -> Result<Array2<f64>> {
        let (rows, cols) = scene.dim();
        let (extent_rows, extent_cols) = blur.extent_px();
        if extent_rows > rows || extent_cols > cols {
            check::size(rows, cols)?;
            return Err(too_long(blur, rows, cols));
        }
        let width = self.blur_reflected(scene, blur)?;
        Ok(self.cut(width, (0, 0), (rows, cols)))
    }

    /// The blurred picture of a scene that repeats itself endlessly: the scene is one period, and so is the result.
    ///
    /// This is the exact reference for closed forms: a sinusoid of whole periods comes out multiplied by
    /// [`Motion::transfer`]. Pictures for estimators must not wrap around; use [`expose`](Self::expose) for them.
    ///
    /// # Errors
    /// [`Error::Size`] and [`Error::NotFinite`] as for [`expose`](Self::expose).
    pub fn expose_periodic(&mut self, scene: ArrayView2<'_, f64>, blur: &impl Blur) -> Result<Array2<f64>> {
        let (rows, cols) = scene.dim();
        check::size(rows, cols)?;
        check::finite(scene)?;
        self.buffer.clear();
        self.buffer.extend(scene.iter());
        self.blur_buffer((rows, cols), blur)?;
        Ok(self.cut(cols, (0, 0), (rows, cols)))
    }

    /// Fills the buffer with the blurred continuation of the scene, its origin first; returns the buffer's width.
    fn blur_reflected(&mut self, scene: ArrayView2<'_, f64>, blur: &impl Blur) -> Result<usize> {
        let (rows, cols) = scene.dim();
        check::size(rows, cols)?;
        check::finite(scene)?;
        let (extent_rows, extent_cols) = blur.extent_px();
        let down = Continuation::new(rows, extent_rows);
        let across = Continuation::new(cols, extent_cols);
        self.buffer.clear();
        self.buffer.reserve(down.len * across.len);
        for row in scene.rows() {
            self.buffer.extend(row.iter());
            self.buffer.extend((cols..across.len).map(|i| {
                let (after, before, share) = across.sources(i);
                row[after] + share * (row[before] - row[after])
            }));
        }
        for i in rows..down.len {
            let (after, before, share) = down.sources(i);
            for col in 0..across.len {
                let (a, b) = (self.buffer[after * across.len + col], self.buffer[before * across.len + col]);
                self.buffer.push(a + share * (b - a));
            }
        }
        self.blur_buffer((down.len, across.len), blur)?;
        Ok(across.len)
    }

    fn blur_buffer(&mut self, (rows, cols): (usize, usize), blur: &impl Blur) -> Result<()> {
        let kept = self.filter.take().filter(|filter| filter.size() == (rows, cols));
        let filter = self.filter.insert(kept.unwrap_or_else(|| Filter::new(&mut self.planners, rows, cols)));
        filter.apply(&mut self.buffer, blur.gain(rows * (cols / 2 + 1)))
    }

    fn cut(&self, width: usize, (top, left): (usize, usize), size: (usize, usize)) -> Array2<f64> {
        Array2::from_shape_fn(size, |(row, col)| self.buffer[(row + top) * width + col + left])
    }
}

/// [`Exposer::expose`] for a single picture.
///
/// # Errors
/// Those of [`Exposer::expose`].
pub fn expose(scene: ArrayView2<'_, f64>, blur: &impl Blur) -> Result<Array2<f64>> {
    Exposer::new().expose(scene, blur)
}

/// [`Exposer::expose_padded`] for a single picture.
///
/// # Errors
/// Those of [`Exposer::expose_padded`].
pub fn expose_padded(scene: ArrayView2<'_, f64>, blur: &impl Blur) -> Result<Array2<f64>> {
    Exposer::new().expose_padded(scene, blur)
}

fn too_long(blur: &impl Blur, rows: usize, cols: usize) -> Error {
    let (blur_rows, blur_cols) = blur.extent_px();
    Error::BlurTooLong { blur_rows, blur_cols, rows, cols }
}

/// Periodic continuation of `inner` samples along one axis: the reflection of the end, then that of the beginning.
struct Continuation {
    inner: usize,
    /// Period, a size with a fast transform.
    len: usize,
    /// Samples at either border that are pure reflection.
    pure: usize,
}

impl Continuation {
    fn new(inner: usize, extent: usize) -> Self {
        let pure = extent.div_ceil(2) + GUARD_PX;
        Self { inner, len: fast_size(inner + 2 * pure + FADE_PX), pure }
    }

    /// For the sample `i` in `inner..len`: its mirror image at the end, that at the beginning, and the share of the
    /// latter, from 0 to 1.
    fn sources(&self, i: usize) -> (usize, usize, f64) {
        let (gap, into) = (self.len - self.inner, i - self.inner);
        let along = (into as f64 + 0.5 - self.pure as f64) / (gap - 2 * self.pure) as f64;
        let along = along.clamp(0.0, 1.0);
        let share = along * along * along * (along * (along * 6.0 - 15.0) + 10.0);
        (self.reflect(i), self.reflect(self.len - 1 - i), share)
    }

    /// The sample in `0..inner` seen at `i >= 0` in mirrors half a sample outside both ends. The sample at `-1 - i`
    /// is the same one.
    fn reflect(&self, i: usize) -> usize {
        let i = i % (2 * self.inner);
        if i < self.inner { i } else { 2 * self.inner - 1 - i }
    }
}
