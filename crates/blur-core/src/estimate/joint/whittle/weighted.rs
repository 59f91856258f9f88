//! The likelihood of a part of a picture of any shape.

use ndarray::{ArrayView1, ArrayView2, Axis, CowArray, Ix2, Slice};

use super::periodogram::Periodogram;
use super::view::View;
use super::{LARGEST_PX, MIDDLE_PX, Whittle, result, verdict};
use crate::estimate::joint::no_pattern;
use crate::estimate::{LengthRange, MotionBlur};
use crate::image::{MIN_SIDE, Region, Window};
use crate::spectrum::fast_size;
use crate::{Error, Result, image};

/// Extent of Hann's window in standard deviations of its square: `sin^4` over one period has the variance 0.02.
const EXTENT_IN_STDS: f64 = 7.071;

/// Plans and buffers for weights of one size and extent.
#[derive(Debug)]
pub(super) struct WeightedPlan {
    /// Rows and columns of the transform.
    padded: (usize, usize),
    extent_px: f64,
    range: LengthRange,
    view: View,
}

impl Whittle {
    /// As [`estimate`](crate::estimate::JointEstimator::estimate) for the part of `image` that `weights` marks: a number
    /// from 0 to 1 for each pixel.
    ///
    /// The weights take the place of the window, whatever the settings say of it, so they should fall off smoothly: an
    /// abrupt edge leaks into the dark lines of the spectrum. What lies under weights of 0 has no influence.
    ///
    /// The part should be wider than twice the blur; blurs are searched up to 0.6 of its least extent. That is the
    /// shorter side of its bounding box or, if less, of a Hann window with the least second moment of the squared
    /// weights in any direction. Of a part of more than 2048 rows or columns those about its centre count, under a
    /// Hann window along that side.
    ///
    /// # Errors
    /// Those of `estimate`; [`Error::WeightSize`], [`Error::Weight`] and [`Error::NoWeight`] for weights that do not fit
    /// the picture, are no numbers from 0 to 1 or all 0; [`Error::RegionTooNarrow`] when the least extent is below
    /// [`MIN_SIDE`] pixels; [`Error::Constant`] when all pixels that weigh anything are equal.
    pub fn estimate_weighted(
        &mut self,
        image: ArrayView2<'_, f32>,
        weights: ArrayView2<'_, f32>,
    ) -> Result<MotionBlur> {
        let part = Part::of(image, weights)?;
        let (padded, extent_px) = (part.padded(), part.extent_px);
        let range = self.settings.lengths_in(part.side_px());
        let kept =
            self.weighted.take().filter(|plan| plan.padded == padded && plan.extent_px.total_cmp(&extent_px).is_eq());
        let plan = self.weighted.insert(kept.unwrap_or_else(|| WeightedPlan {
            padded,
            extent_px,
            range,
            view: part.view(range),
        }));
        plan.view.set_weighted(part.image, part.weights.view());
        let Some(outcome) = plan.view.measure(&mut |_| ()) else { return Ok(no_pattern(plan.range)) };
        let accelerated = self.settings.acceleration.then(|| plan.view.acceleration(&outcome)).flatten();
        Ok(result(&outcome, verdict::status(&outcome, plan.range), part.weights.dim(), accelerated))
    }
}

/// The part of a picture that weights mark.
pub(super) struct Part<'a, 'b> {
    /// Where it is in the picture.
    pub(super) region: Region,
    pub(super) image: ArrayView2<'a, f32>,
    pub(super) weights: CowArray<'b, f32, Ix2>,
    extent_px: f64,
}

impl<'a, 'b> Part<'a, 'b> {
    /// The errors are those of [`Whittle::estimate_weighted`].
    pub(super) fn of(image: ArrayView2<'a, f32>, weights: ArrayView2<'b, f32>) -> Result<Self> {
        image::check(image)?;
        check(image, weights)?;
        let region = bounding_box(weights)?;
        let (region, weights) = cut(region, region.of(weights)?);
        let image = region.of(image)?;
        check_contrast(image, weights.view())?;
        let extent_px = extent(weights.view());
        if extent_px < MIN_SIDE as f64 {
            return Err(Error::RegionTooNarrow { extent_px, min: MIN_SIDE });
        }
        Ok(Self { region, image, weights, extent_px })
    }

    /// What the longest length is measured against.
    pub(super) fn side_px(&self) -> f64 {
        self.extent_px.min(MIDDLE_PX as f64)
    }

    /// Rows and columns of the transform.
    fn padded(&self) -> (usize, usize) {
        (fast_size(self.weights.nrows()), fast_size(self.weights.ncols()))
    }

    /// Plans for parts of this size and extent.
    pub(super) fn view(&self, range: LengthRange) -> View {
        let (rows, columns) = self.padded();
        View::of(Periodogram::weighted(rows, columns, self.extent_px), range)
    }
}

fn check(image: ArrayView2<'_, f32>, weights: ArrayView2<'_, f32>) -> Result<()> {
    if image.dim() != weights.dim() {
        let ((height, width), (other_height, other_width)) = (image.dim(), weights.dim());
        return Err(Error::WeightSize { width, height, other_width, other_height });
    }
    match weights.indexed_iter().find(|(_, weight)| !(0.0..=1.0).contains(*weight)) {
        Some(((row, column), &value)) => Err(Error::Weight { row, column, value }),
        None => Ok(()),
    }
}

/// The smallest rectangle that holds all weights above 0.
fn bounding_box(weights: ArrayView2<'_, f32>) -> Result<Region> {
    let (height, width) = weights.dim();
    let ends = |axis: Axis| {
        let mut lines = weights.axis_iter(axis).map(|line| line.iter().any(|&weight| weight > 0.0));
        let first = lines.position(|has_weight| has_weight)?;
        // What is left begins behind the first.
        let more = lines.rposition(|has_weight| has_weight).map_or(0, |last| last + 1);
        Some((first, 1 + more))
    };
    match (ends(Axis(0)), ends(Axis(1))) {
        (Some((y, height)), Some((x, width))) => Ok(Region { x, y, width, height }),
        _ => Err(Error::NoWeight { width, height }),
    }
}

/// The part of at most [`LARGEST_PX`] rows and columns about the centre of the weights, which `region` is the place of.
fn cut(region: Region, weights: ArrayView2<'_, f32>) -> (Region, CowArray<'_, f32, Ix2>) {
    let (mut region, mut weights) = (region, CowArray::from(weights));
    for axis in [Axis(0), Axis(1)] {
        let n = weights.len_of(axis);
        if n <= LARGEST_PX {
            continue;
        }
        let total = |line: ArrayView1<'_, f32>| line.iter().map(|&weight| f64::from(weight)).sum::<f64>();
        let totals = || weights.axis_iter(axis).map(total);
        let centre = totals().enumerate().map(|(i, total)| i as f64 * total).sum::<f64>() / totals().sum::<f64>();
        let first = (centre - 0.5 * LARGEST_PX as f64).round().clamp(0.0, (n - LARGEST_PX) as f64) as usize;
        let mut tapered = weights.slice_axis(axis, Slice::from(first..first + LARGEST_PX)).to_owned();
        for (mut line, weight) in tapered.axis_iter_mut(axis).zip(Window::Hann.weights(LARGEST_PX)) {
            line *= weight;
        }
        weights = CowArray::from(tapered);
        if axis == Axis(0) {
            (region.y, region.height) = (region.y + first, LARGEST_PX);
        } else {
            (region.x, region.width) = (region.x + first, LARGEST_PX);
        }
    }
    (region, weights)
}

fn check_contrast(image: ArrayView2<'_, f32>, weights: ArrayView2<'_, f32>) -> Result<()> {
    let mut inside = image.iter().zip(weights).filter(|(_, weight)| **weight > 0.0).map(|(pixel, _)| *pixel);
    match inside.next() {
        Some(first) if inside.any(|pixel| pixel != first) => Ok(()),
        Some(value) => Err(Error::Constant { value }),
        None => Err(Error::NoWeight { width: weights.ncols(), height: weights.nrows() }),
    }
}

/// Least extent of the weights in any direction, in pixels: that of a window over the same number of pixels.
fn extent(weights: ArrayView2<'_, f32>) -> f64 {
    let mut sums = [0.0_f64; 6];
    for ((row, column), &weight) in weights.indexed_iter() {
        let (square, x, y) = (f64::from(weight).powi(2), column as f64, row as f64);
        for (sum, value) in sums.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
            *sum += square * value;
        }
    }
    let [x, y, xx, xy, yy] = [1, 2, 3, 4, 5].map(|i| sums[i] / sums[0]);
    let (a, b, c) = (xx - x * x, xy - x * y, yy - y * y);
    // The lesser eigenvalue of the matrix of second moments.
    let least = 0.5 * (a + c) - (0.25 * (a - c).powi(2) + b * b).sqrt();
    let (rows, columns) = weights.dim();
    (EXTENT_IN_STDS * least.max(0.0).sqrt()).min(rows.min(columns) as f64)
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;

    #[test]
    fn the_box_holds_all_weights() {
        let mut weights = Array2::zeros((9, 12));
        assert_eq!(bounding_box(weights.view()), Err(Error::NoWeight { width: 12, height: 9 }));
        weights[[3, 11]] = 0.5;
        assert_eq!(bounding_box(weights.view()), Ok(Region { x: 11, y: 3, width: 1, height: 1 }));
        weights[[7, 2]] = 1e-6;
        assert_eq!(bounding_box(weights.view()), Ok(Region { x: 2, y: 3, width: 10, height: 5 }));
    }

    #[test]
    fn the_extent_is_that_of_a_window_or_the_width_of_a_slanted_strip() {
        let window = |window: Window| {
            let (rows, columns) = (window.weights(60), window.weights(90));
            extent(Array2::from_shape_fn((60, 90), |(r, c)| rows[r] * columns[c]).view())
        };
        assert!((window(Window::Hann) - 60.0).abs() < 1e-9);
        assert!((window(Window::Tukey { taper: 0.25 }) - 60.0).abs() < 1e-9);
        // A hard strip of the width w has the variance w^2/12 across.
        let strip = Array2::from_shape_fn((200, 200), |(r, c)| {
            if (r as f64 - c as f64).abs() < 10.0 * 2.0_f64.sqrt() { 1.0 } else { 0.0 }
        });
        let expected = EXTENT_IN_STDS * 20.0 / 12.0_f64.sqrt();
        assert!((extent(strip.view()) / expected - 1.0).abs() < 0.05, "{}", extent(strip.view()));
    }

    #[test]
    fn of_a_large_part_the_middle_counts() {
        let mut weights = Array2::zeros((40, LARGEST_PX + 500));
        weights.slice_axis_mut(Axis(1), Slice::from(400..)).fill(1.0);
        let place = Region { x: 30, y: 20, width: LARGEST_PX + 500, height: 40 };
        let (part, tapered) = cut(place, weights.view());
        // The middle of 400..2548 is 1474, so the part ends with the weights' last column but 50.
        assert_eq!(part, Region { x: 480, y: 20, width: LARGEST_PX, height: 40 });
        assert_eq!(tapered.dim(), (40, LARGEST_PX));
        assert!(tapered[[0, 0]] < 1e-4 && tapered[[0, LARGEST_PX / 2]] > 0.999);
        let small = weights.slice_axis(Axis(1), Slice::from(..LARGEST_PX));
        let (same, kept) = cut(Region { width: LARGEST_PX, ..place }, small);
        assert!(same == Region { width: LARGEST_PX, ..place } && kept.is_view());
    }
}
