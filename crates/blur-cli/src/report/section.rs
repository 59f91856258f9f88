//! The section of one picture: the figures in their order.

use std::fmt::Write;

use blur_core::estimate::joint::Diagnosis;
use blur_core::estimate::{MotionBlur, Status};
use blur_core::image::{Region, Window, centre_square};
use blur_core::region::Mask;
use blur_core::spectrum::PowerSpectrum;
use ndarray::{Array2, ArrayView2, CowArray, Ix2};
use sha2::{Digest, Sha256};

use crate::map::Map;
use crate::measure::{Finding, Options};
use crate::picture::Picture;
use crate::record::Record;
use crate::report::figure;
use crate::report::html::{Figure, Text};
use crate::{Error, Result};

/// Spectra of methods that do not say which part of the picture they use are of a square of at most this side.
const SHOWN_PX: usize = 1024;
/// The window of these spectra.
const SHOWN_WINDOW: Window = Window::Tukey { taper: 0.25 };
/// The method whose likelihood can be looked at.
const LIKELIHOOD: &str = "whittle";

/// A figure, or why it could not be drawn.
type Drawing = fn(&Subject<'_>) -> Result<Figure>;

/// The figures in the order of the page.
const FIGURES: &[Drawing] = &[
    figure::picture::draw,
    figure::spectrum::draw,
    figure::likelihood::draw,
    figure::collapsed::draw,
    figure::psf::draw,
    figure::cepstrum::draw,
    figure::residuals::map,
    figure::evidence::draw,
    figure::residuals::histogram,
    figure::regions::draw,
    figure::restored::draw,
    figure::budget::draw,
    figure::repeat::draw,
];

/// Everything that the figures of a picture are drawn from.
pub struct Subject<'a> {
    /// The record, as in the JSON output.
    pub record: &'a Record,
    /// The result that the record was made from.
    pub blur: &'a MotionBlur,
    /// Column and row of the middle of what was measured.
    pub centre_px: [f64; 2],
    /// What was measured, and how.
    pub options: &'a Options,
    /// The picture.
    pub picture: &'a Picture,
    /// The part of the picture that the spectrum is of, and its pixels.
    pub region: Region,
    /// Its pixels; under a mask those less their mean, times the weights.
    pub part: CowArray<'a, f32, Ix2>,
    /// The window that belongs over them.
    pub window: Window,
    /// The weights of the pixels, where a mask says which were measured.
    pub mask: Option<&'a Mask>,
    /// The blur over the picture.
    pub map: Option<&'a Map>,
    /// Bytes of the file.
    pub file_bytes: usize,
    /// SHA-256 of the file in hexadecimal digits.
    pub sha256: String,
    /// Powers of the part.
    pub spectrum: PowerSpectrum,
    /// What lies behind the result, when the method has a likelihood.
    pub diagnosis: Option<Diagnosis>,
}

impl<'a> Subject<'a> {
    /// From a picture's file, its pixels and what was found in it.
    pub fn new(
        bytes: &[u8],
        picture: &'a Picture,
        finding: &'a Finding,
        options: &'a Options,
        mask: Option<&'a Mask>,
    ) -> Result<Self> {
        let (record, blur) = (&finding.record, &finding.blur);
        let (rows, columns) = picture.luma.dim();
        let asked = options.roi.unwrap_or(Region { x: 0, y: 0, width: columns, height: rows });
        let whole = asked.of(picture.luma.view())?;
        let settings = &options.settings;
        let diagnosis = match mask {
            Some(mask) => Diagnosis::of_weighted(whole, mask.weights(), settings, blur)?,
            None if record.method == LIKELIHOOD => Diagnosis::of(whole, settings, blur)?,
            None => None,
        };
        let region = if let Some(Diagnosis { part, .. }) = &diagnosis {
            Region { x: asked.x + part.x, y: asked.y + part.y, ..*part }
        } else {
            let (height, width) = match blur.evidence {
                Some(evidence) => (evidence.rows, evidence.columns),
                None if rows.max(columns) > SHOWN_PX => centre_square(whole, SHOWN_PX).dim(),
                None => whole.dim(),
            };
            let (x, y) = (asked.x + (asked.width - width) / 2, asked.y + (asked.height - height) / 2);
            Region { x, y, width, height }
        };
        let (part, window) = match mask {
            Some(mask) => (CowArray::from(weighted(picture.luma.view(), mask, region)?), Window::None),
            None => (CowArray::from(region.of(picture.luma.view())?), options.settings.window.unwrap_or(SHOWN_WINDOW)),
        };
        let spectrum = match &diagnosis {
            Some(diagnosis) => diagnosis.spectrum.clone(),
            None => PowerSpectrum::of(part.view(), window)?,
        };
        Ok(Self {
            record,
            blur,
            centre_px: finding.centre_px,
            options,
            picture,
            region,
            part,
            window,
            mask,
            map: finding.map.as_ref(),
            file_bytes: bytes.len(),
            sha256: hexadecimal(&Sha256::digest(bytes)),
            spectrum,
            diagnosis,
        })
    }

    /// Whether there is a blur to draw.
    pub fn has_blur(&self) -> bool {
        !matches!(self.blur.status, Status::NoMotionBlur(_))
    }

    /// Frequencies in cycles per pixel at which the blur leaves nothing: `k / L`, below `most`.
    pub fn zeros(&self, most: f64) -> impl Iterator<Item = f64> + use<> {
        let step = 1.0 / self.record.length_px;
        let last = if self.has_blur() { most } else { 0.0 };
        (1..).map(move |k| f64::from(k) * step).take_while(move |&s| s < last)
    }

    /// Highest frequency that the result rests on, in cycles per pixel.
    pub fn band(&self) -> f64 {
        self.blur.evidence.map_or(0.5, |evidence| evidence.band_cycles_per_px)
    }

    /// The likelihood, or the figure that says why there is none.
    pub fn likelihood(&self, title: &'static str) -> std::result::Result<&Diagnosis, Figure> {
        self.diagnosis.as_ref().ok_or_else(|| {
            if self.record.method == LIKELIHOOD {
                Figure::absent(title, "No pattern of a blur was found, so there is no fit to look at.")
            } else {
                let method = &self.record.method;
                Figure::absent(
                    title,
                    format!("This needs the likelihood of the method {LIKELIHOOD}; the method used was {method}."),
                )
            }
        })
    }
}

/// The pixels of a part less their mean, times the weights of a mask of the picture's size.
fn weighted(picture: ArrayView2<'_, f32>, mask: &Mask, region: Region) -> Result<Array2<f32>> {
    let (pixels, weights) = (region.of(picture)?, region.of(mask.weights())?);
    let sum = |value: &dyn Fn(f32, f32) -> f32| -> f64 {
        pixels.iter().zip(weights).map(|(&pixel, &weight)| f64::from(value(pixel, weight))).sum()
    };
    let mean = (sum(&|pixel, weight| pixel * weight) / sum(&|_, weight| weight)) as f32;
    Ok((&pixels - mean) * weights)
}

fn hexadecimal(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

/// The section of a picture, without the tag around it: what was found in `picture`, which `bytes` are the file
/// of, under `mask` if there is one.
pub fn of(bytes: &[u8], picture: &Picture, finding: &Finding, options: &Options, mask: Option<&Mask>) -> String {
    let mut html = figure::headline::draw(&finding.record);
    match Subject::new(bytes, picture, finding, options, mask) {
        Ok(subject) => {
            html.push_str("<div class=\"figures\">\n");
            for draw in FIGURES {
                let figure = draw(&subject).unwrap_or_else(|error| not_drawn(&error));
                // Writing to a String cannot fail.
                let _ = write!(html, "{figure}");
            }
            html.push_str("</div>\n");
        }
        Err(error) => {
            let _ = write!(html, "{}", not_drawn(&error));
        }
    }
    html
}

fn not_drawn(error: &Error) -> Figure {
    Figure::absent("A figure is missing", format!("It could not be drawn: {}", error.one_line()))
}

/// The section of a picture that has no result.
pub fn of_failure(error: &Error) -> String {
    format!(
        "<p class=\"verdict failed\"><strong>Not measured</strong> {}</p>\n<p class=\"note\">The other pictures of the run are \
         reported all the same.</p>\n",
        Text(error.one_line())
    )
}
