//! All that is needed to measure the picture again.

use std::fmt::Write;

use blur_core::image::{Region, Window};

use crate::Result;
use crate::picture::Linearize;
use crate::record::ExposureSource;
use crate::report::html::{Figure, Text};
use crate::report::section::Subject;

/// The list of parameters, and the record as JSON.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let (record, options) = (subject.record, subject.options);
    let mut list = String::new();
    let mut entry = |name: &str, value: &str| {
        // Writing to a String cannot fail.
        let _ = write!(list, "<div><dt>{name}</dt><dd>{}</dd></div>", Text(value));
    };
    entry("Picture", &record.image);
    entry("File", &format!("{} bytes, SHA-256 {}", subject.file_bytes, subject.sha256));
    entry("Size", &format!("{} \u{d7} {} pixels, upright", record.width, record.height));
    let Region { x, y, width, height } = subject.region;
    let roi = options.roi.map_or("", |_| ", inside --roi");
    entry("Part measured", &format!("{width} \u{d7} {height} pixels from column {x}, row {y}{roi}"));
    entry("Method", &record.method);
    entry("Acceleration looked for", if options.settings.acceleration { "yes (--accel)" } else { "no" });
    let range = options.settings.length_range.map_or_else(
        || String::from("the method\u{2019}s own: from 4 px to what the size of the picture allows"),
        |range| format!("{} to {} px (--range)", range.min_px(), range.max_px()),
    );
    entry("Lengths searched", &range);
    entry("Window", &window(subject));
    entry("Tone curve", &tone(options.linearize, record.linearized));
    let exposure = match (record.exposure_s, record.exposure_source) {
        (Some(seconds), Some(ExposureSource::Exif)) => format!("{seconds} s from the EXIF data"),
        (Some(seconds), _) => format!("{seconds} s (--exposure)"),
        (None, _) => String::from("not known: neither --exposure nor EXIF data"),
    };
    entry("Exposure", &format!("{exposure}, standard uncertainty {} s", options.exposure_std_s));
    let scale = options.scale.map_or_else(
        || String::from("not given"),
        |scale| {
            let scale = scale.m_per_px();
            format!("{} m/px, standard uncertainty {} m/px", scale.value(), scale.std())
        },
    );
    entry("Scale", &scale);
    let camera = subject.record.camera.filter(|_| options.camera.is_some()).map_or_else(
        || String::from("not given"),
        |camera| {
            let (value, std) = (camera.focal_length_px, camera.focal_length_std_px);
            format!(
                "focal length {value} px, standard uncertainty {std} px (--camera; the file stands in the command line)"
            )
        },
    );
    entry("Camera", &camera);
    let distance = options.distance_m.map_or_else(
        || String::from("not given"),
        |metres| format!("{} m, standard uncertainty {} m (--distance)", metres.value(), metres.std()),
    );
    entry("Distance", &distance);
    entry("Camera turned", if options.rotating { "yes (--rotating)" } else { "no" });
    let readout =
        options.readout_s.map_or_else(|| String::from("not given"), |seconds| format!("{seconds} s (--readout)"));
    entry("Readout of the rows", &readout);
    let mask = record.mask.as_deref().map_or_else(|| String::from("none"), |mask| format!("{mask} (--mask)"));
    entry("Mask", &mask);
    let map = record.map.as_ref().map_or_else(
        || String::from("not asked for"),
        |map| {
            let (tile, step, window) = (map.tile_px, map.step_px, map.window);
            format!("tiles of {tile} px, at most {step} px apart, window {window} (--map)")
        },
    );
    entry("Map", &map);
    let restored = match (&options.restore, &record.restored) {
        (Some(to), Some(path)) => format!("{path} by {} (--restore)", to.method.title()),
        (Some(_), None) => String::from("asked for, not written"),
        (None, _) => String::from("not asked for; shown here only"),
    };
    entry("Restored picture", &restored);
    let exif = &subject.picture.exif;
    let stated = exif.exposure_s.map_or_else(|| String::from("no exposure"), |seconds| format!("exposure {seconds} s"));
    entry("EXIF data", &format!("{stated}, orientation {}", exif.orientation.to_exif()));
    entry("Time", &format!("{:.1} ms for the estimate, without reading and this report", record.time_ms));
    let json = serde_json::to_string(record)?;
    Ok(Figure {
        title: "To repeat this measurement",
        content: format!(
            "<dl class=\"parameters\">{list}</dl><details><summary>The record as JSON</summary><pre class=\"record\">{}</pre>\
             </details>",
            Text(json)
        ),
        caption: String::from(
            "Command line, version and date of the run stand at the head of the page. The same program with the same file and \
             options gives the same numbers on every machine, the time apart.",
        ),
        is_wide: true,
    })
}

fn window(subject: &Subject<'_>) -> String {
    if let Some(mask) = subject.mask {
        return format!("the mask, hard edges tapered over {:.1} px", mask.taper_px());
    }
    let used = subject.diagnosis.as_ref().and_then(|diagnosis| diagnosis.window).or(subject.options.settings.window);
    let name = match used {
        Some(Window::None) => String::from("none"),
        Some(Window::Hann) => String::from("Hann"),
        Some(Window::Tukey { taper }) => format!("Tukey, {taper} of the length tapered"),
        _ => return String::from("the method\u{2019}s own"),
    };
    let chosen = if subject.options.settings.window.is_some() { "--window" } else { "the method\u{2019}s own" };
    format!("{name} ({chosen})")
}

fn tone(asked: Linearize, done: bool) -> String {
    let asked = match asked {
        Linearize::Auto => "auto: on for JPEG files",
        Linearize::On => "on",
        Linearize::Off => "off",
    };
    let done = if done { "sRGB curve undone, grey values are linear light" } else { "grey values as stored" };
    format!("{done} (--linearize {asked})")
}
