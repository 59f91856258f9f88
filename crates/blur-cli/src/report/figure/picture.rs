//! The picture with its motion drawn on it.

use std::fmt::Write;

use blur_core::image::Region;
use ndarray::ArrayView2;

use crate::Result;
use crate::report::html::Figure;
use crate::report::raster;
use crate::report::section::Subject;

/// Longest side of the picture in the page.
const MOST_SIDE_PX: usize = 1024;
/// The detail is so many blur lengths wide, within these bounds in pixels.
const DETAIL_LENGTHS: f64 = 6.0;
const LEAST_DETAIL_PX: f64 = 64.0;
const MOST_DETAIL_PX: f64 = 1024.0;
/// Steps of the outline of a mask along the longer side of what is shown.
const MOST_OUTLINE_SIDE: usize = 512;

/// The whole picture, and a detail in the middle of the part measured.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let record = subject.record;
    let (rows, columns) = subject.picture.luma.dim();
    let wanted = (DETAIL_LENGTHS * record.length_px).clamp(LEAST_DETAIL_PX, MOST_DETAIL_PX);
    // Of the shape of the picture, so that both are as high.
    let width = (wanted as usize).min(subject.region.width);
    let height = ((wanted * rows as f64 / columns as f64) as usize).clamp(1, subject.region.height);
    let region = Region {
        x: subject.region.x + (subject.region.width - width) / 2,
        y: subject.region.y + (subject.region.height - height) / 2,
        width,
        height,
    };
    let detail = region.of(subject.picture.luma.view())?;
    let linear = record.linearized;
    let whole = raster::photograph(&raster::preview(subject.picture.luma.view(), MOST_SIDE_PX, linear))?;
    let near = raster::photograph(&raster::preview(detail, MOST_SIDE_PX, linear))?;
    let all = Region { x: 0, y: 0, width: columns, height: rows };
    let content = format!(
        "<div class=\"pair\">{}{}</div>",
        panel(subject, &whole, all, &format!("The whole picture, {columns} by {rows} pixels")),
        panel(subject, &near, region, &format!("A detail of {width} by {height} pixels"))
    );
    let Region { x, y, width: w, height: h } = subject.region;
    let frame = match subject.mask {
        Some(_) => ", of these what the mask marks: its outline is where a pixel counts half",
        None if (w, h) == (columns, rows) => "",
        None => ", the dashed frame",
    };
    let words = if subject.has_blur() {
        let heads = if record.direction_deg.is_some() {
            "it points where the content of the picture moved"
        } else {
            "it has two heads because one picture cannot tell a motion from its opposite"
        };
        format!(
            "The arrow is as long as the blur: every point of the scene was smeared over this length, and edges across the \
             motion should look it; {heads}. The dial shows the direction, 0\u{b0} to the right and 90\u{b0} upwards."
        )
    } else {
        String::from("No arrow is drawn, since no motion was found.")
    };
    Ok(Figure {
        title: "The picture and its motion",
        content,
        caption: format!(
            "The whole picture as grey values (contrast stretched for the eye); measured were {w} \u{d7} {h} pixels from \
             column {x}, row {y}{frame}. Then a detail in the middle of that part, a check by eye. {words}"
        ),
        is_wide: true,
    })
}

/// `shown` of the picture, with the frame of the part measured, the arrow and the dial.
fn panel(subject: &Subject<'_>, uri: &str, shown: Region, what: &str) -> String {
    let record = subject.record;
    let Region { width, height, .. } = shown;
    // One unit of drawing is this many pixels, whatever the size of the picture.
    let unit = width.max(height) as f64 / 400.0;
    let middle = (
        subject.region.x as f64 + 0.5 * subject.region.width as f64 - shown.x as f64,
        subject.region.y as f64 + 0.5 * subject.region.height as f64 - shown.y as f64,
    );
    let mut svg = format!(
        "<svg class=\"photo\" role=\"img\" aria-label=\"{what}, blurred over {:.1} pixels along {:.1} degrees\" \
         viewBox=\"0 0 {width} {height}\"><image href=\"{uri}\" width=\"{width}\" height=\"{height}\" \
         preserveAspectRatio=\"none\"/>",
        record.length_px, record.angle_deg
    );
    if let Some(mask) = subject.mask {
        let outline = outline(mask.weights(), shown);
        // Writing to a String cannot fail, here and below.
        let _ = write!(svg, "<path class=\"part\" d=\"{outline}\" stroke-width=\"{:.2}\"/>", 1.5 * unit);
    } else if (width, height) != (subject.region.width, subject.region.height) && width >= subject.region.width {
        let Region { x, y, width: w, height: h } = subject.region;
        let _ = write!(
            svg,
            "<rect class=\"part\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" stroke-width=\"{:.2}\" \
             stroke-dasharray=\"{:.2}\"/>",
            1.5 * unit,
            5.0 * unit
        );
    }
    if subject.has_blur() {
        let deg = record.direction_deg.unwrap_or(record.angle_deg);
        let stroke = (2.2 * unit).min(0.12 * record.length_px);
        for (class, stroke) in [("halo", 2.2 * stroke), ("arrow", stroke)] {
            svg.push_str(&arrow(class, middle, record.length_px, deg, record.direction_deg.is_none(), stroke));
        }
        svg.push_str(&dial(
            (34.0 * unit, height as f64 - 34.0 * unit),
            24.0 * unit,
            deg,
            record.direction_deg.is_none(),
        ));
    }
    svg.push_str("</svg>");
    svg
}

/// The line between weights above and below one half, in the part `shown`.
fn outline(weights: ArrayView2<'_, f32>, shown: Region) -> String {
    let step = shown.width.max(shown.height).div_ceil(MOST_OUTLINE_SIDE).max(1);
    let is_inside = |x: usize, y: usize| weights.get((shown.y + y, shown.x + x)).is_some_and(|&weight| weight > 0.5);
    let mut path = String::new();
    for y in (step..shown.height).step_by(step) {
        for x in (step..shown.width).step_by(step) {
            if is_inside(x, y) != is_inside(x - step, y) {
                let _ = write!(path, "M{x} {y}v{step}");
            }
            if is_inside(x, y) != is_inside(x, y - step) {
                let _ = write!(path, "M{x} {y}h{step}");
            }
        }
    }
    path
}

/// An arrow of `length` around `middle`, along `deg`, with a head at its end, or at both.
fn arrow(class: &str, (x, y): (f64, f64), length: f64, deg: f64, both: bool, stroke: f64) -> String {
    let (sin, cos) = deg.to_radians().sin_cos();
    let half = 0.5 * length;
    let head = 0.22 * length;
    // Along the motion and across it, y downwards.
    let at = |along: f64, across: f64| (x + along * cos + across * sin, y - along * sin + across * cos);
    let mut path = String::new();
    let mut go = |from: (f64, f64), to: (f64, f64)| {
        let _ = write!(path, "M{:.2} {:.2}L{:.2} {:.2}", from.0, from.1, to.0, to.1);
    };
    go(at(-half, 0.0), at(half, 0.0));
    for side in [-0.6, 0.6] {
        go(at(half, 0.0), at(half - head, side * head));
        if both {
            go(at(-half, 0.0), at(head - half, side * head));
        }
    }
    format!("<path class=\"{class}\" d=\"{path}\" stroke-width=\"{stroke:.2}\"/>")
}

/// A dial with a mark every 30 degrees and its hand along `deg`.
fn dial((x, y): (f64, f64), radius: f64, deg: f64, both: bool) -> String {
    let mut marks = String::new();
    for mark in 0..12 {
        let (sin, cos) = (30.0 * f64::from(mark)).to_radians().sin_cos();
        let inner = if mark % 3 == 0 { 0.78 } else { 0.88 } * radius;
        let _ = write!(
            marks,
            "M{:.2} {:.2}L{:.2} {:.2}",
            x + inner * cos,
            y - inner * sin,
            x + radius * cos,
            y - radius * sin
        );
    }
    let hand = if both {
        arrow("arrow", (x, y), 1.4 * radius, deg, true, 0.09 * radius)
    } else {
        let (sin, cos) = deg.to_radians().sin_cos();
        arrow("arrow", (x + 0.35 * radius * cos, y - 0.35 * radius * sin), 0.7 * radius, deg, false, 0.09 * radius)
    };
    format!(
        "<circle class=\"dial\" cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{:.2}\"/><path class=\"dialmark\" d=\"{marks}\" \
         stroke-width=\"{:.2}\"/>{hand}",
        1.15 * radius,
        0.05 * radius
    )
}
