//! The cepstrum around the origin.

use blur_core::image::Taper;
use blur_core::spectrum::{Cepstrum, Dft2, Levelled};
use ndarray::Array2;

use crate::Result;
use crate::report::html::Figure;
use crate::report::raster::{self, quantile};
use crate::report::section::Subject;
use crate::report::svg::{Axis, Chart};

/// Lags are shown up to this many blur lengths, and at least this many pixels.
const REACH_LENGTHS: f64 = 1.6;
const LEAST_REACH_PX: f64 = 24.0;
/// Lags nearer to the origin hold the scene's own structure and are not counted for the scale of grey.
const NEAR_PX: f64 = 4.0;

/// The lags with rings where a blur of the length found puts its troughs.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let (rows, columns) = subject.part.dim();
    let mut dft = Dft2::new(rows, columns);
    Taper::new(subject.window, rows, columns).apply(subject.part.view(), dft.input());
    let mut levelled = Levelled::for_dft(rows, columns);
    levelled.set_from_dft(dft.transform());
    let mut cepstrum = Cepstrum::new(rows, columns);
    let lags = cepstrum.of_half_plane(levelled.bins());
    let most = (rows.min(columns) / 2 - 1) as f64;
    let reach = (REACH_LENGTHS * subject.record.length_px).clamp(LEAST_REACH_PX.min(most), most).floor();
    let side = 2 * reach as usize + 1;
    let wrapped = |i: usize, n: usize| (i + n - reach as usize) % n;
    let shown = Array2::from_shape_fn((side, side), |(row, column)| {
        f64::from(lags[[wrapped(row, rows), wrapped(column, columns)]])
    });
    let mut far = shown.clone();
    for ((row, column), value) in far.indexed_iter_mut() {
        if (row as f64 - reach).hypot(column as f64 - reach) < NEAR_PX {
            *value = f64::NAN;
        }
    }
    let (black, white) = (quantile(&far, 0.0), quantile(&far, 0.998));
    let edge = reach + 0.5;
    let x = Axis { label: "lag to the right, px", from: -edge, to: edge };
    let y = Axis { label: "lag downwards, px", from: edge, to: -edge };
    let mut chart = Chart::new(x, y, 1.0);
    chart.picture(&raster::values(&shown, raster::grey(black, white))?);
    let words = if subject.has_blur() {
        let (sin, cos) = subject.record.angle_deg.to_radians().sin_cos();
        let length = subject.record.length_px;
        for sign in [1.0, -1.0] {
            chart.ring("ringed", (sign * length * cos, -sign * length * sin), 9.0);
        }
        "The rings mark \u{b1}L along the direction found; a dark dot inside them is a witness that is independent of the \
         fit. It may be faint: noise and texture make dark dots too."
    } else {
        "No lag is marked, since no blur was found."
    };
    Ok(Figure {
        title: "Cepstrum",
        content: chart.finish("Cepstrum around the origin with rings at plus and minus the blur length"),
        caption: format!(
            "The spectrum of the log spectrum (levelled first, so that the scene counts little). Stripes that repeat every \
             1/L in the spectrum become one dark dot at the lag L along the motion, and its mirror image. {words}"
        ),
        is_wide: false,
    })
}
