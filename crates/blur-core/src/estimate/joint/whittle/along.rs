//! The likelihood of the length along a known direction, of strips too: of the spectrum, and of the rows where they are short.

use std::f64::consts::FRAC_PI_2;

use ndarray::{Array2, ArrayView2};

use super::periodogram::Periodogram;
use super::rows::{Found, Rows};
use super::view::{SAME_LOG_LENGTH, View};
use super::{MIDDLE_PX, WHOLE_PX, WHOLE_WINDOW, verdict};
use crate::estimate::length::{no_length, range_along};
use crate::estimate::per_size::PerSize;
use crate::estimate::{AxialAngle, LengthEstimate, LengthRange, Settings, Status};
use crate::image::centre_square;

/// Up to here the spectrum of a picture tells neither a sharp scene nor a lens out of focus from a motion: its shorter side
/// in pixels. Of rows as short it says nothing that they do not say better.
const SILENT_PX: usize = 64;
/// The spectrum's own uncertainty holds where it is so many times as wide as the blur that it found.
const WIDE: f64 = 2.5;

/// The length along a known angle by the likelihood of [`Whittle`](super::Whittle).
#[derive(Debug)]
pub(in crate::estimate) struct Along {
    settings: Settings,
    plan: PerSize<Plan>,
}

/// Plans and buffers for pictures of one size.
#[derive(Debug)]
struct Plan {
    weights: Array2<f32>,
    /// For motions nearer to the rows.
    flat: View,
    /// For motions nearer to the columns, when the picture is not square.
    steep: Option<View>,
    /// For motions along the rows, and along the columns, where those are short.
    rows: Option<Rows>,
    columns: Option<Rows>,
}

impl Along {
    pub(in crate::estimate) fn new(settings: &Settings) -> Self {
        Self { settings: *settings, plan: PerSize::new() }
    }

    /// The length in `image`, of which the middle 1024 x 1024 pixels count when both sides are longer than 768.
    pub(in crate::estimate) fn estimate(&mut self, image: ArrayView2<'_, f32>, angle: AxialAngle) -> LengthEstimate {
        let side = image.nrows().min(image.ncols());
        let picture = if side <= WHOLE_PX { image } else { centre_square(image, MIDDLE_PX) };
        let range = range_along(&self.settings, picture.dim(), angle);
        let along_rows = angle.rad().cos().abs() >= angle.rad().sin().abs();
        let settings = self.settings;
        let Plan { weights, flat, steep, rows, columns } =
            self.plan.get(picture.dim(), |dim| Plan::new(&settings, dim));
        let (short, lines, turn) = if along_rows {
            (rows, picture, angle.rad())
        } else {
            (columns, picture.reversed_axes(), angle.rad() - FRAC_PI_2)
        };
        let within = range.within(lines.ncols() as f64);
        let short = short.as_mut().filter(|_| Rows::hold(within.max_px(), turn));
        let mut spectrum = None;
        if short.is_none() || lines.ncols() > SILENT_PX {
            let view = steep.as_mut().filter(|_| !along_rows).unwrap_or(flat);
            view.set_weighted(picture, weights.view());
            let Some(outcome) = view.measure_along(angle.rad(), range) else { return no_length(range) };
            let std_px = Some(outcome.length * outcome.covariance[0][0].sqrt());
            let status = verdict::status(&outcome, range);
            spectrum = Some(LengthEstimate { length_px: outcome.length, std_px, status });
        }
        let denied = side > SILENT_PX && spectrum.is_some_and(|of| matches!(of.status, Status::NoMotionBlur(_)));
        match (short.filter(|_| !denied).and_then(|short| short.measure(lines, within)), spectrum) {
            (Some(found), Some(spectrum)) => the_surer(&found, spectrum, within, lines.ncols()),
            (Some(found), None) => of_rows(&found, within),
            (None, spectrum) => spectrum.unwrap_or_else(|| no_length(within)),
        }
    }
}

/// What rows say.
fn of_rows(found: &Found, range: LengthRange) -> LengthEstimate {
    LengthEstimate {
        length_px: found.length,
        std_px: Some(found.length * found.variance.sqrt()),
        status: verdict::status_of_rows(found, range),
    }
}

/// What the spectrum says of rows of `width` pixels, which knows more of a scene, when it is sure and the rows are not sure of
/// something else; or else what the rows say, as far as they say anything.
fn the_surer(found: &Found, spectrum: LengthEstimate, range: LengthRange, width: usize) -> LengthEstimate {
    let rows = of_rows(found, range);
    let is_sure = spectrum.status == Status::Ok && width as f64 >= WIDE * spectrum.length_px;
    let is_same = (spectrum.length_px / rows.length_px).ln().abs() < SAME_LOG_LENGTH;
    let is_spectrum = match (is_sure, rows.status == Status::Ok) {
        (true, true) => is_same,
        (true, false) => true,
        (false, true) => false,
        (false, false) => matches!(spectrum.status, Status::LowConfidence(_)) && !verdict::rows_tell(found),
    };
    if is_spectrum { spectrum } else { rows }
}

impl Plan {
    fn new(settings: &Settings, dim: (usize, usize)) -> Self {
        let (rows, columns) = dim;
        let window = settings.window.unwrap_or(WHOLE_WINDOW);
        let (row_weights, column_weights) = (window.weights(rows), window.weights(columns));
        let weights = Array2::from_shape_fn(dim, |(row, column)| row_weights[row] * column_weights[column]);
        // Across the motion a strip may be as narrow as it likes: what leaks there leaks within a dark line.
        let view = |extent: usize| {
            let mut view = View::fit_only(Periodogram::weighted(rows, columns, extent as f64));
            // The weights are taken in now, so that a picture that is measured in another direction allocates nothing.
            view.set_weighted(Array2::zeros(dim).view(), weights.view());
            view
        };
        let (flat, steep) = (view(columns), (rows != columns).then(|| view(rows)));
        Self { weights, flat, steep, rows: Rows::new(rows, columns), columns: Rows::new(columns, rows) }
    }
}
