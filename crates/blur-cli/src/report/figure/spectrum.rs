//! The log spectrum with the dark lines of the fitted blur.

use ndarray::Array2;

use crate::Result;
use crate::report::html::Figure;
use crate::report::raster::{self, quantile};
use crate::report::section::Subject;
use crate::report::svg::{Axis, Chart};

/// Most points of the map along a side.
const MOST_SIDE: usize = 256;
/// The map reaches this far beyond the band, at most to the end of the spectrum.
const BEYOND: f64 = 1.6;
/// Highest frequency of all, in cycles per pixel.
const EDGE: f64 = 0.5;
/// More lines than these on either side would hide what they show.
const MOST_LINES: usize = 12;

/// A square piece of the plane of frequencies.
pub(crate) struct Plane {
    /// Points along a side: no more than the part has bins.
    pub(crate) side: usize,
    /// Highest frequency on the axes, in cycles per pixel.
    pub(crate) edge: f64,
}

impl Plane {
    /// The piece around the band of the subject.
    pub(crate) fn of(subject: &Subject<'_>) -> Self {
        let edge = (BEYOND * subject.band()).min(EDGE);
        let bins = 2.0 * edge * subject.region.width.min(subject.region.height) as f64;
        Self { side: ((bins / 2.0) as usize * 2).clamp(2, MOST_SIDE), edge }
    }

    /// Its axes, `v` downwards.
    pub(crate) fn chart(&self) -> Chart {
        let u = Axis { label: "u, cycles/px (to the right)", from: -self.edge, to: self.edge };
        let v = Axis { label: "v, cycles/px (downwards)", from: self.edge, to: -self.edge };
        Chart::new(u, v, 1.0)
    }

    /// The ring of the highest frequency that the result rests on, where that is not the end of the spectrum.
    pub(crate) fn ring(chart: &mut Chart, band: f64) {
        if band < EDGE {
            let turns = (0..=120).map(|i| (f64::from(i) * 3.0).to_radians().sin_cos());
            chart.line("band", turns.map(|(y, x)| (band * x, band * y)));
        }
    }
}

/// The map with the lines over its one half.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let plane = Plane::of(subject);
    let map = levelled(subject.spectrum.map(plane.side, plane.edge, |_, bin| f64::from(bin.power)));
    let (black, white) = (quantile(&map, 0.01), quantile(&map, 0.995));
    let mut chart = plane.chart();
    chart.picture(&raster::values(&map, raster::grey(black, white))?);
    let band = subject.band();
    let (sin, cos) = subject.record.angle_deg.to_radians().sin_cos();
    // From along and across the motion to u and v, which points down.
    let place = |s: f64, t: f64| (s * cos + t * sin, t * cos - s * sin);
    let zeros: Vec<f64> = subject.zeros(band).take(MOST_LINES).collect();
    chart.pieces(
        "zero",
        zeros.iter().flat_map(|&s| {
            let end = (band * band - s * s).max(0.0).sqrt();
            [[place(s, 0.0), place(s, end)], [place(-s, 0.0), place(-s, end)]]
        }),
    );
    if subject.has_blur() {
        chart.pieces("axis", [[place(-band, 0.0), place(band, 0.0)]]);
    }
    Plane::ring(&mut chart, band);
    let lines = match zeros.len() {
        0 => String::from("No dark lines are drawn, since no blur was found or its first one lies outside the band."),
        n => format!(
            "The thin lines are where a uniform blur of the length found lets nothing through, the first {n} zeros of \
             sinc(L s) on either side, at multiples of 1/L = {:.4} cycles/px. They are drawn over one half only: the other \
             half shows whether the spectrum is really dark there.",
            1.0 / subject.record.length_px
        ),
    };
    let ring = if band < EDGE { " The ring is the highest frequency that the result rests on." } else { "" };
    Ok(Figure {
        title: "Spectrum and dark lines",
        content: chart.finish(&format!(
            "Log power spectrum with {} dark lines across {:.1} degrees",
            zeros.len(),
            subject.record.angle_deg
        )),
        caption: format!(
            "How strongly the picture holds each spatial frequency, bright for much, on a logarithmic scale; each ring about \
             the middle is brought to the same mean, since all photographs fall off outwards. A motion of constant speed \
             erases the frequencies on equidistant parallel lines across it. {lines}{ring}"
        ),
        is_wide: false,
    })
}

/// Logarithms of powers, less the mean of their ring about the middle.
fn levelled(powers: Array2<f64>) -> Array2<f64> {
    let n = powers.nrows();
    let ring = |row: usize, column: usize| {
        let from_middle = |i: usize| i as f64 - (n / 2) as f64;
        from_middle(row).hypot(from_middle(column)).round() as usize
    };
    let logs = powers.mapv_into(f64::log10);
    let mut sums = vec![(0.0, 0.0); n + 1];
    for ((row, column), &log) in logs.indexed_iter().filter(|(_, log)| log.is_finite()) {
        let (sum, count) = &mut sums[ring(row, column)];
        *sum += log;
        *count += 1.0;
    }
    let mut logs = logs;
    for ((row, column), log) in logs.indexed_iter_mut() {
        let (sum, count) = sums[ring(row, column)];
        *log -= sum / count;
    }
    logs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spectrum_that_falls_with_the_radius_alone_is_level() {
        let map = Array2::from_shape_fn((64, 64), |(row, column)| {
            let radius = (row as f64 - 32.0).hypot(column as f64 - 32.0).round();
            if radius > 31.0 { f64::NAN } else { (1.0 + radius).powi(-3) }
        });
        let level = levelled(map);
        assert!(level[[0, 0]].is_nan());
        assert!(level.iter().filter(|value| value.is_finite()).all(|value| value.abs() < 1e-12));
    }
}
