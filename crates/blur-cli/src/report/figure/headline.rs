//! The result at a glance.

use std::fmt::Write;

use blur_core::motion::COVERAGE_K;

use crate::record::{NoSpeed, ReadoutFields, Record};
use crate::report::html::{Data, Text};
use crate::text::{decimals_of, with_uncertainty};

/// What stands below direction and length where there is no motion blur.
const REJECTED: &str = "of the best candidate, which was rejected: not a measurement";

/// Verdict and readings, as HTML.
pub fn draw(record: &Record) -> String {
    let mut html = verdict(record);
    html.push_str("<dl class=\"readings\">");
    // Writing to a String cannot fail, here and below.
    let rate = rate(record).unwrap_or_default();
    let _ = write!(html, "{}{}{rate}{}{}", direction(record), length(record), speed(record), acceleration(record));
    html.push_str("</dl>\n");
    if let Some(note) = &record.note {
        let _ = writeln!(html, "<p class=\"note\">Note: {}.</p>", Text(note));
    }
    html
}

fn verdict(record: &Record) -> String {
    let (class, word, meaning) = match record.status {
        "ok" => ("ok", "Trusted", "The method\u{2019}s own checks passed"),
        "low_confidence" => ("doubtful", "Doubtful", "There is an answer, and a reason not to trust it"),
        _ => ("none", "No motion blur", "The picture shows no blur that the method can call a motion"),
    };
    let reason = record.reason.as_ref().map_or_else(String::new, |reason| format!(": {}", Text(reason)));
    format!("<p class=\"verdict {class}\"><strong>{word}</strong> {meaning}{reason}.</p>\n")
}

/// A value to the decimals of its uncertainty, and the uncertainty.
pub(super) fn split(value: f64, uncertainty: Option<f64>, decimals: usize) -> (String, String) {
    let text = with_uncertainty(value, uncertainty, decimals);
    match text.split_once(" ± ") {
        Some((value, uncertainty)) => (value.to_owned(), uncertainty.to_owned()),
        None => (text, String::new()),
    }
}

/// One reading: its name, the value with its unit, and what stands below in small print.
fn reading(name: &str, value: &str, unit: &str, below: &str) -> String {
    format!(
        "<div><dt>{name}</dt><dd><span class=\"value\">{value}</span> <span class=\"unit\">{unit}</span>\
             <small>{below}</small></dd></div>"
    )
}

fn missing(name: &str, why: &str) -> String {
    format!(
        "<div class=\"missing\"><dt>{name}</dt><dd><span class=\"value\">\u{2013}</span><small>{}</small></dd></div>",
        Text(why)
    )
}

fn uncertain(field: &'static str, value: Option<f64>, shown: &str, unit: &str, what: &str) -> String {
    match value {
        Some(value) => format!("± {}{unit} ({what})", Data { field, value, shown }),
        None => String::from("the method states no uncertainty"),
    }
}

fn direction(record: &Record) -> String {
    let (shown, std) = split(record.angle_deg, record.angle_std_deg, 1);
    let below = uncertain("angle_std_deg", record.angle_std_deg, &std, "\u{b0}", "standard uncertainty");
    let below = if record.status == "no_motion_blur" { REJECTED } else { below.as_str() };
    let axis = Data { field: "angle_deg", value: record.angle_deg, shown: &shown };
    if let Some(deg) = record.direction_deg {
        let (direction, _) = split(deg, record.angle_std_deg, 1);
        let value = Data { field: "direction_deg", value: deg, shown: &direction };
        reading("Direction", &value.to_string(), "\u{b0}", &format!("{below}; along the axis {axis}\u{b0}"))
    } else {
        let below = format!("{below}; counter-clockwise from the right; to and fro look alike");
        reading("Direction", &axis.to_string(), "\u{b0}", &below)
    }
}

fn length(record: &Record) -> String {
    let (shown, std) = split(record.length_px, record.length_std_px, 1);
    let below = uncertain("length_std_px", record.length_std_px, &std, " px", "standard uncertainty");
    let below = if record.status == "no_motion_blur" { REJECTED } else { below.as_str() };
    reading(
        "Blur length",
        &Data { field: "length_px", value: record.length_px, shown: &shown }.to_string(),
        "px",
        below,
    )
}

fn speed(record: &Record) -> String {
    let Some(speed) = record.speed_m_s else {
        let why = match record.no_speed {
            Some(NoSpeed::ScaleMissing) => "no scale given: --scale",
            Some(NoSpeed::DistanceMissing) => "no distance given: --distance",
            Some(NoSpeed::ExposureMissing) => "no exposure given: --exposure",
            Some(NoSpeed::FocalLengthMissing) => "no focal length known: --camera",
            Some(NoSpeed::NoMotionBlur) => "no motion, no speed",
            None if record.camera.is_some_and(|camera| camera.rate.is_some()) => {
                "the camera turned, the scene stood still"
            }
            None => "needs --exposure and --scale",
        };
        return missing("Speed", why);
    };
    let (shown, expanded) = split(speed, record.speed_expanded_m_s, decimals_of(speed, 4));
    let k = record.coverage_k.map_or_else(String::new, |k| format!("expanded uncertainty, k = {k}"));
    let below = uncertain("speed_expanded_m_s", record.speed_expanded_m_s, &expanded, " m/s", &k);
    let below = format!("{below}{}", record.readout.as_ref().map_or_else(String::new, either_way));
    reading("Speed", &Data { field: "speed_m_s", value: speed, shown: &shown }.to_string(), "m/s", &below)
}

/// The speeds that a rolling shutter allows, one for each way that the content may have moved.
fn either_way(readout: &ReadoutFields) -> String {
    let speed = |way: &str, value: Option<f64>, expanded: Option<f64>, [field, field_expanded]: [&'static str; 2]| {
        let Some(value) = value else { return format!("it cannot have moved {way}") };
        let (shown, uncertainty) = split(value, expanded, decimals_of(value, 4));
        let uncertainty = expanded.map_or_else(String::new, |value| {
            format!(" ± {}", Data { field: field_expanded, value, shown: &uncertainty })
        });
        format!("<b>{}</b>{uncertainty} m/s if it moved {way}", Data { field, value, shown: &shown })
    };
    let [along, against] = readout.rows_run.ways();
    format!(
        "; as if all rows were exposed at once. The rows were read one after the other: {}, {}",
        speed(
            along,
            readout.speeds.speed_down_m_s,
            readout.speeds.speed_down_expanded_m_s,
            ["speed_down_m_s", "speed_down_expanded_m_s"]
        ),
        speed(
            against,
            readout.speeds.speed_up_m_s,
            readout.speeds.speed_up_expanded_m_s,
            ["speed_up_m_s", "speed_up_expanded_m_s"]
        )
    )
}

/// How fast the camera turned, where that was asked for.
fn rate(record: &Record) -> Option<String> {
    let rate = record.camera?.rate?;
    let value = rate.value_rad_s;
    let (shown, expanded) = split(value, rate.expanded_rad_s, decimals_of(value, 4));
    let k = format!("expanded uncertainty, k = {COVERAGE_K}");
    let below = uncertain("angular_rate_expanded_rad_s", rate.expanded_rad_s, &expanded, " rad/s", &k);
    Some(reading(
        "Angular rate",
        &Data { field: "angular_rate_rad_s", value, shown: &shown }.to_string(),
        "rad/s",
        &below,
    ))
}

fn acceleration(record: &Record) -> String {
    let Some(found) = record.acceleration else {
        let why =
            if record.status == "no_motion_blur" { "no motion, no acceleration" } else { "not asked for: --accel" };
        return missing("Acceleration", why);
    };
    let limit = format!("{:.*}", decimals_of(found.limit, 2), found.limit);
    let limit = Data { field: "accel_ratio_limit", value: found.limit, shown: &limit };
    let (shown, std) = split(found.ratio, Some(found.ratio_std), 2);
    let ratio = Data { field: "accel_ratio", value: found.ratio, shown: &shown };
    let ratio_std = Data { field: "accel_ratio_std", value: found.ratio_std, shown: &std };
    let sign = if found.is_signed { "" } else { ", without its sign" };
    match found.metric {
        _ if !found.detected => {
            let below = format!("below the detection limit: ratio under {limit}");
            reading("Acceleration", "none seen", "", &below)
        }
        Some(metric) => {
            let (shown, expanded) = split(metric.value_m_s2, Some(metric.expanded_m_s2), 2);
            let value = Data { field: "accel_m_s2", value: metric.value_m_s2, shown: &shown };
            let expanded = Data { field: "accel_expanded_m_s2", value: metric.expanded_m_s2, shown: &expanded };
            let below =
                format!("± {expanded} m/s\u{b2} (k = 2){sign}; ratio {ratio} ± {ratio_std}, seen above {limit}");
            reading("Acceleration", &value.to_string(), "m/s\u{b2}", &below)
        }
        None => {
            let below = format!("± {ratio_std} (standard uncertainty){sign}; seen above {limit}");
            reading("Acceleration ratio", &ratio.to_string(), "", &below)
        }
    }
}
