//! The map of the blur: its tiles, and the regions that move as one.

use std::fmt::Write;

use blur_core::region::{STILL, UNKNOWN};
use ndarray::Array2;

use super::headline::split;
use crate::Result;
use crate::map::Map;
use crate::record::{MapFields, RegionFields, TileFields};
use crate::report::html::Figure;
use crate::report::raster;
use crate::report::section::Subject;
use crate::text::{decimals_of, with_uncertainty};

const TITLE: &str = "What moves, and what stands still";
/// Longest side of the picture and of the shades over it in the page.
const MOST_SIDE_PX: usize = 1024;
/// Red, green and blue of the regions, over and over: Okabe and Ito's colours, which the colour-blind tell apart, without
/// the two of the line segments.
const COLOURS: [[u8; 3]; 5] = [[0, 158, 115], [204, 121, 167], [0, 114, 178], [213, 94, 0], [240, 228, 66]];
/// Opacity of a region, and of the veil over what tells nothing.
const SHADE: u8 = 70;
const VEIL: u8 = 110;

/// The picture with a line segment for each tile and a shade for each region, and the table of the regions.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let (Some(map), Some(fields)) = (subject.map, &subject.record.map) else {
        return Ok(Figure { is_wide: true, ..Figure::absent(TITLE, "No map was asked for: --map.") });
    };
    let (rows, columns) = subject.picture.luma.dim();
    let photograph =
        raster::photograph(&raster::preview(subject.picture.luma.view(), MOST_SIDE_PX, subject.record.linearized))?;
    let shades = shades(subject, map)?;
    let longest = fields
        .tiles
        .iter()
        .filter_map(|tile| tile.blur.as_ref())
        .filter(|blur| blur.status != "no_motion_blur")
        .map(|blur| blur.length_px)
        .fold(0.0, f64::max);
    let scale = if longest > 0.0 { (0.85 * fields.step_px as f64 / longest).min(1.0) } else { 1.0 };
    let unit = rows.max(columns) as f64 / 400.0;
    let mut svg = format!(
        "<svg class=\"photo\" role=\"img\" aria-label=\"Map of the blur with {} tiles and {} moving regions\" \
         viewBox=\"0 0 {columns} {rows}\" preserveAspectRatio=\"xMinYMin\"><image href=\"{photograph}\" width=\"{columns}\" height=\"{rows}\" \
         preserveAspectRatio=\"none\"/>{shades}",
        fields.tiles.len(),
        fields.regions.len()
    );
    for tile in &fields.tiles {
        svg.push_str(&segment(tile, scale, unit));
    }
    for region in &fields.regions {
        svg.push_str(&words(region, columns as f64, unit));
    }
    svg.push_str("</svg>");
    Ok(Figure {
        title: TITLE,
        content: format!("{svg}{LEGEND}{}", table(fields)),
        caption: caption(fields, scale),
        is_wide: true,
    })
}

/// The labels as colours over the part that the map is of.
fn shades(subject: &Subject<'_>, map: &Map) -> Result<String> {
    let labels = &map.segmentation.labels;
    let (rows, columns) = labels.dim();
    let block = rows.max(columns).div_ceil(MOST_SIDE_PX).max(1);
    let small = Array2::from_shape_fn((rows.div_ceil(block), columns.div_ceil(block)), |(row, column)| {
        f64::from(labels[[row * block, column * block]])
    });
    let uri = raster::values(&small, |label| match label as u8 {
        STILL => [0; 4],
        UNKNOWN => [0, 0, 0, VEIL],
        label => {
            let [red, green, blue] = colour(label);
            [red, green, blue, SHADE]
        }
    })?;
    let (x, y) = subject.options.roi.map_or((0, 0), |roi| (roi.x, roi.y));
    let (width, height) = (small.ncols() * block, small.nrows() * block);
    Ok(format!(
        "<image href=\"{uri}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\"/>"
    ))
}

fn colour(label: u8) -> [u8; 3] {
    COLOURS[usize::from(label.saturating_sub(1)) % COLOURS.len()]
}

/// The blur of a tile: a line along it, `scale` times as long, or a dot where nothing moved.
fn segment(tile: &TileFields, scale: f64, unit: f64) -> String {
    let Some(blur) = &tile.blur else { return String::new() };
    if blur.status == "no_motion_blur" {
        return format!(
            "<circle class=\"still\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"{:.2}\" stroke-width=\"{:.2}\"/>",
            tile.x,
            tile.y,
            1.6 * unit,
            0.6 * unit
        );
    }
    let (sin, cos) = blur.angle_deg.to_radians().sin_cos();
    let half = 0.5 * scale * blur.length_px;
    let path = format!(
        "M{:.1} {:.1}L{:.1} {:.1}",
        tile.x - half * cos,
        tile.y + half * sin,
        tile.x + half * cos,
        tile.y - half * sin
    );
    format!(
        "<path class=\"halo\" d=\"{path}\" stroke-width=\"{:.2}\"/><path class=\"tile {}\" d=\"{path}\" \
         stroke-width=\"{:.2}\"/>",
        3.2 * unit,
        blur.status,
        1.6 * unit
    )
}

/// Number, length and speed of a region at its centre, kept inside the picture.
fn words(region: &RegionFields, columns: f64, unit: f64) -> String {
    let size = 11.0 * unit;
    let room = 5.0 * size;
    let x = if columns > 2.0 * room { region.centroid_x.clamp(room, columns - room) } else { 0.5 * columns };
    let mut lines = vec![format!("{}: {:.1} px", region.label, region.blur.length_px)];
    if let Some(speed) = region.speed_m_s {
        lines.push(format!("{speed:.*} m/s", decimals_of(speed, 3)));
    }
    let mut text = String::new();
    for (line, words) in lines.iter().enumerate() {
        let y = region.centroid_y + size * (1.1 * line as f64 - 0.2);
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size:.1}\" stroke-width=\"{:.1}\">{words}</text>",
            0.25 * size
        );
    }
    text
}

const LEGEND: &str = "<ul class=\"legend\" aria-label=\"Legend\">\
     <li><svg class=\"photo\" viewBox=\"0 0 28 13\" aria-hidden=\"true\"><path class=\"tile ok\" d=\"M4 6.5h20\"/></svg>blur of a tile</li>\
     <li><svg class=\"photo\" viewBox=\"0 0 28 13\" aria-hidden=\"true\"><path class=\"tile low_confidence\" d=\"M4 6.5h20\"/></svg>\
     doubtful</li>\
     <li><svg class=\"photo\" viewBox=\"0 0 28 13\" aria-hidden=\"true\"><circle class=\"still\" cx=\"14\" cy=\"6.5\" r=\"3\"/></svg>\
     no motion blur</li><li>colour: moves as one</li><li>dark: tells nothing</li></ul>";

fn table(fields: &MapFields) -> String {
    if fields.regions.is_empty() {
        return String::new();
    }
    let mut rows = String::new();
    for region in &fields.regions {
        let (blur, [red, green, blue]) = (&region.blur, colour(region.label));
        let angle = with_uncertainty(blur.angle_deg, blur.angle_std_deg, 1);
        let length = with_uncertainty(blur.length_px, blur.length_std_px, 1);
        let speed = region.speed_m_s.map_or_else(
            || String::from("\u{2013}"),
            |speed| {
                let (value, expanded) = split(speed, region.speed_expanded_m_s, decimals_of(speed, 4));
                if expanded.is_empty() { format!("{value} m/s") } else { format!("{value} ± {expanded} m/s") }
            },
        );
        let verdict = match blur.status {
            "ok" => "trusted",
            "low_confidence" => "doubtful",
            _ => "no motion blur",
        };
        // Writing to a String cannot fail.
        let _ = write!(
            rows,
            "<tr><th scope=\"row\"><svg class=\"key\" viewBox=\"0 0 1 1\" aria-hidden=\"true\"><rect width=\"1\" height=\"1\" \
             fill=\"rgb({red},{green},{blue})\"/></svg>{}</th><td>{angle}\u{b0}</td><td>{length} px</td><td>{speed}</td><td>{} \
             px\u{b2}</td><td>{verdict}</td></tr>",
            region.label, region.area_px
        );
    }
    format!(
        "<div class=\"scroll\" tabindex=\"0\"><table aria-label=\"Regions that move\"><thead><tr><th scope=\"col\">Region</th><th scope=\"col\">\
         Direction</th><th scope=\"col\">Blur length</th><th scope=\"col\">Speed (k = 2)</th><th scope=\"col\">Area</th>\
         <th scope=\"col\">Verdict</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )
}

fn caption(fields: &MapFields, scale: f64) -> String {
    let drawn = if scale < 1.0 {
        format!("{scale:.2} times as long as the blur, so that neighbours do not touch")
    } else {
        String::from("as long as the blur")
    };
    format!(
        "The blur measured in {} half-overlapping tiles of {} pixels each way, a line along it for each, {drawn}. Neighbours that \
         agree are a region that moves as one; each was measured again as a whole, and the table is of that. Of \
         the picture {:.0} % stands still and {:.0} % has too little contrast to tell. After ± stands one standard uncertainty, for the speed \
         the expanded one.",
        fields.tiles.len(),
        fields.tile_px,
        100.0 * fields.still_share,
        100.0 * fields.unknown_share
    )
}
