//! The picture without its blur, beside the picture as it is.

use blur_core::image::Region;
use blur_core::restore::{LineBlur, Method};

use crate::Result;
use crate::picture::Picture;
use crate::report::html::Figure;
use crate::report::raster;
use crate::report::section::Subject;
use crate::restore::restored;

const TITLE: &str = "The blur undone";
/// Longest side of what is shown, at one pixel of the page for one of the picture.
const MOST_SIDE_PX: usize = 768;

/// The middle of the part measured before and after, with a slider between both where scripts run.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let Some(kernel) = LineBlur::measured(subject.blur)? else {
        return Ok(Figure {
            is_wide: true,
            ..Figure::absent(TITLE, "No motion blur was found, so there is none to undo.")
        });
    };
    let middle = |start: usize, size: usize| (start + (size - size.min(MOST_SIDE_PX)) / 2, size.min(MOST_SIDE_PX));
    let ((x, width), (y, height)) =
        (middle(subject.region.x, subject.region.width), middle(subject.region.y, subject.region.height));
    let piece = piece(subject.picture, Region { x, y, width, height })?;
    let method = subject.options.restore.as_ref().map_or_else(Method::default, |to| to.method);
    let after = raster::picture(&restored(&piece, &kernel, method)?)?;
    let before = match &piece.stored {
        Some(stored) => raster::picture(stored)?,
        None => raster::photograph(&raster::preview(piece.luma.view(), MOST_SIDE_PX, piece.linearized))?,
    };
    let name = method.title();
    let sign = if LineBlur::sign_is_assumed(subject.blur) {
        " It is restored as if the motion had sped up along the angle, since one picture does not tell the sign."
    } else {
        ""
    };
    let sharper = subject.record.sharpness_change.map_or_else(String::new, |change| {
        let verdict =
            if change > 0.0 { "above 0, so it did become sharper" } else { "not above 0, so the blur may be wrong" };
        format!(" Change of the sharpness: {change:.3}, {verdict}.")
    });
    Ok(Figure {
        title: TITLE,
        content: format!(
            "<div class=\"compare\"><div><img width=\"{width}\" height=\"{height}\" alt=\"As photographed\" src=\"{before}\">\
             <span>as photographed</span></div><div><img width=\"{width}\" height=\"{height}\" alt=\"With the blur undone\" \
             src=\"{after}\"><span>blur undone</span></div></div>"
        ),
        caption: format!(
            "A check of the result as a whole: the blur that was found is undone by {name} in the middle of the part measured, \
             {width} \u{d7} {height} pixels. If direction and length are right, edges become sharp and text readable; if not, \
             edges double or ring. What the blur erased cannot come back.{sign}{sharper}"
        ),
        is_wide: true,
    })
}

/// A piece of a picture as a picture of its own.
fn piece(picture: &Picture, region: Region) -> Result<Picture> {
    let Region { x, y, width, height } = region;
    Ok(Picture {
        luma: region.of(picture.luma.view())?.to_owned(),
        stored: picture.stored.as_ref().map(|stored| stored.crop_imm(x as u32, y as u32, width as u32, height as u32)),
        linearized: picture.linearized,
        exif: picture.exif.clone(),
    })
}
