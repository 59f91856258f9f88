//! Results for people.

use std::fmt::Write;

use blur_core::motion::COVERAGE_K;

use crate::picture::RowsRun;
use crate::record::{
    CameraFields, ExposureSource, FocalLengthSource, MapFields, MetricAcceleration, NoSpeed, ReadoutFields, Record,
    RolledSpeedFields,
};

/// A record as two lines: the measurement, and how it came about; more for direction and acceleration if there are any.
/// After `±` stands one standard uncertainty or, where `(k = 2)` follows, the expanded uncertainty.
pub fn from_record(record: &Record) -> String {
    let angle = with_uncertainty(record.angle_deg, record.angle_std_deg, 1);
    let length = with_uncertainty(record.length_px, record.length_std_px, 1);
    let Record { image, width, height, status, .. } = record;
    let mut text = format!("{image}  {width}x{height}  angle {angle} deg  length {length} px");
    // Writing to a String cannot fail.
    if let Some(speed) = record.speed_m_s {
        let value = with_uncertainty(speed, record.speed_expanded_m_s, decimals_of(speed, 4));
        let _ = write!(text, "  speed {value} m/s");
    }
    if let Some(k) = record.coverage_k {
        let _ = write!(text, " (k = {k})");
    }
    let _ = write!(text, "  {status}");
    if let Some(reason) = &record.reason {
        let _ = write!(text, ": {reason}");
    }
    let _ = write!(text, "\n    {}, {:.1} ms", record.method, record.time_ms);
    if record.linearized {
        text.push_str(", linearized (sRGB)");
    }
    if let Some(mask) = &record.mask {
        let _ = write!(text, ", mask {mask}");
    }
    if let Some(seconds) = record.exposure_s {
        let source = match record.exposure_source {
            Some(ExposureSource::Exif) => " (EXIF)",
            Some(ExposureSource::Option) | None => "",
        };
        let _ = write!(text, ", exposure {}{source}", duration(seconds));
    }
    match record.no_speed {
        Some(NoSpeed::ScaleMissing) => text.push_str("; no speed: --scale is missing"),
        Some(NoSpeed::DistanceMissing) => text.push_str("; no speed: --distance is missing"),
        Some(NoSpeed::FocalLengthMissing) => {
            text.push_str(
                "; no angular rate: --camera is missing and the picture has no focal length in its EXIF data",
            );
        }
        Some(NoSpeed::ExposureMissing) => {
            text.push_str("; no speed: --exposure is missing and the picture has none in its EXIF data");
        }
        Some(NoSpeed::NoMotionBlur) => text.push_str("; no speed: no motion blur"),
        None => {}
    }
    if let Some(camera) = record.camera {
        camera_line(&mut text, &camera);
    }
    if let Some(deg) = record.direction_deg {
        // The direction is as uncertain as its axis.
        let direction = with_uncertainty(deg, record.angle_std_deg, 1);
        let _ = write!(text, "\n    direction {direction} deg");
    }
    if let Some(found) = record.acceleration {
        let limit = format!("{:.*}", decimals_of(found.limit, 2), found.limit);
        if found.detected {
            let ratio = with_uncertainty(found.ratio, Some(found.ratio_std), 2);
            let sign = match (found.is_signed, found.ratio < 0.0) {
                (false, _) => "",
                (true, false) => " (speeding up)",
                (true, true) => " (slowing down)",
            };
            // Along a mere axis there is no speeding up or slowing down, only a sign.
            let sign = if record.direction_deg.is_some() { sign } else { "" };
            let _ = write!(text, "\n    acceleration ratio {ratio}{sign}, detected above {limit}");
            if let Some(metric) = found.metric {
                let value = with_uncertainty(metric.value_m_s2, Some(metric.expanded_m_s2), 2);
                let _ = write!(text, "; acceleration {value} m/s2 (k = {COVERAGE_K})");
            }
        } else {
            let _ = write!(text, "\n    acceleration below detection limit: ratio under {limit}");
            if let Some(MetricAcceleration { limit_m_s2, .. }) = found.metric {
                let _ = write!(text, ", {limit_m_s2:.*} m/s2", decimals_of(limit_m_s2, 2));
            }
        }
    }
    if let Some(readout) = &record.readout {
        text.push_str(&from_readout(readout));
    }
    if let Some(map) = &record.map {
        text.push_str(&from_map(map, record.readout.as_ref().map(|readout| readout.rows_run)));
        if map.readout_ignored {
            text.push_str("; readout of the rows ignored: --readout is missing");
        }
    }
    if let (Some(path), Some(change)) = (&record.restored, record.sharpness_change) {
        let _ = write!(text, "\n    restored to {path}, sharpness {change:+.2}");
    }
    text
}

/// The speeds that a rolling shutter allows and how the speed changed meanwhile, as lines.
fn from_readout(readout: &ReadoutFields) -> String {
    let mut text = format!("\n    rolling shutter, readout {}", duration(readout.readout_s));
    match rolled(&readout.speeds, readout.rows_run) {
        Some(speeds) => text.push_str(&speeds),
        None => text.push_str(": no speed to correct"),
    }
    if let Some(change) = &readout.change {
        let expanded = COVERAGE_K * change.change_std_px_s2;
        let value = with_uncertainty(change.change_px_s2, Some(expanded), 0);
        let _ = write!(text, "\n    change of the speed during the readout {value} px/s2");
        if let Some(metric) = change.metric {
            let value = with_uncertainty(metric.change_m_s2, Some(metric.change_expanded_m_s2), 2);
            let _ = write!(text, ", {value} m/s2");
        }
        let verdict = if change.significant { "significant" } else { "not significant" };
        let _ = write!(text, " (k = {COVERAGE_K}), {verdict}");
    }
    if let Some(reason) = &readout.change_reason {
        let _ = write!(text, "\n    no change of the speed during the readout: {reason}");
    }
    text
}

/// The speeds for either way; `None` when neither is known.
fn rolled(speeds: &RolledSpeedFields, rows_run: RowsRun) -> Option<String> {
    let RolledSpeedFields { speed_down_m_s, speed_up_m_s, .. } = *speeds;
    speed_down_m_s.or(speed_up_m_s)?;
    let [along, against] = rows_run.ways();
    let either = [
        (along, speed_down_m_s, speeds.speed_down_expanded_m_s),
        (against, speed_up_m_s, speeds.speed_up_expanded_m_s),
    ];
    let mut text = String::new();
    for (way, speed, expanded) in either {
        let _ = match speed {
            Some(speed) => {
                let value = with_uncertainty(speed, expanded, decimals_of(speed, 4));
                write!(text, "; {value} m/s (k = {COVERAGE_K}) if it moved {way}")
            }
            None => write!(text, "; it cannot have moved {way}"),
        };
    }
    Some(text)
}

/// A map as a table of what moves.
fn from_map(map: &MapFields, rows_run: Option<RowsRun>) -> String {
    let ok = map.tiles.iter().filter(|tile| tile.blur.as_ref().is_some_and(|blur| blur.status == "ok")).count();
    let mut text = format!(
        "\n    map: {} tiles of {} px ({} ok); still {:.0} %, unknown {:.0} %, {} moving",
        map.tiles.len(),
        map.tile_px,
        ok,
        100.0 * map.still_share,
        100.0 * map.unknown_share,
        map.regions.len()
    );
    for region in &map.regions {
        let blur = &region.blur;
        let angle = with_uncertainty(blur.angle_deg, blur.angle_std_deg, 1);
        let length = with_uncertainty(blur.length_px, blur.length_std_px, 1);
        let _ = write!(
            text,
            "\n    {:>3}  at {:.0},{:.0}  {} px  angle {angle} deg  length {length} px",
            region.label, region.centroid_x, region.centroid_y, region.area_px
        );
        if let Some(speed) = region.speed_m_s {
            let value = with_uncertainty(speed, region.speed_expanded_m_s, decimals_of(speed, 4));
            let _ = write!(text, "  speed {value} m/s (k = {COVERAGE_K})");
        }
        let _ = write!(text, "  {}", blur.status);
        if let Some(reason) = &blur.reason {
            let _ = write!(text, ": {reason}");
        }
        if let Some(speeds) = region.rolled.zip(rows_run).and_then(|(speeds, rows_run)| rolled(&speeds, rows_run)) {
            text.push_str(&speeds);
        }
    }
    text
}

/// What the camera adds, on a line of its own.
fn camera_line(text: &mut String, camera: &CameraFields) {
    let (source, focal) = match camera.focal_length_source {
        FocalLengthSource::Camera => {
            ("camera", with_uncertainty(camera.focal_length_px, Some(camera.focal_length_std_px), 1))
        }
        FocalLengthSource::Exif => {
            ("rough, from EXIF", with_uncertainty(camera.focal_length_px, Some(camera.focal_length_std_px), 0))
        }
    };
    let CameraFields { angle_deg, length_px, .. } = camera;
    let _ = write!(
        text,
        "\n    without distortion: angle {angle_deg:.2} deg, length {length_px:.2} px; focal length {focal} px ({source})"
    );
    if let Some(scale) = camera.scale_m_per_px {
        let scale = with_uncertainty(1e3 * scale, camera.scale_std_m_per_px.map(|std| 1e3 * std), 4);
        let _ = write!(text, "; scale {scale} mm/px");
    }
    if let Some(rate) = camera.rate {
        let value = with_uncertainty(rate.value_rad_s, rate.expanded_rad_s, decimals_of(rate.value_rad_s, 4));
        let _ = write!(text, "\n    angular rate {value} rad/s");
        if rate.expanded_rad_s.is_some() {
            let _ = write!(text, " (k = {COVERAGE_K})");
        }
    }
}

/// A value to as many decimals as its uncertainty has with two significant digits (GUM 7.2.6), or to `decimals`
/// without one.
pub fn with_uncertainty(value: f64, uncertainty: Option<f64>, decimals: usize) -> String {
    match uncertainty {
        Some(u) => {
            let decimals = if u > 0.0 { decimals_of(u, 2) } else { decimals };
            format!("{value:.decimals$} ± {u:.decimals$}")
        }
        None => format!("{value:.decimals$}"),
    }
}

/// Decimals that show `digits` significant digits of `x`.
pub(crate) fn decimals_of(x: f64, digits: i32) -> usize {
    // Scientific notation rounds first: 0.0996 with two digits is 1.0e-1.
    let scientific = format!("{:.*e}", usize::try_from(digits - 1).unwrap_or(0), x);
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    usize::try_from((digits - 1 - exponent).clamp(0, 12)).unwrap_or(0)
}

/// So many significant digits, without zeros at the end; with a power of ten where plain digits would be many.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let scientific = format!("{x:.*e}", digits.saturating_sub(1));
    // The rounded number, whose shortest text has no digits that were rounded away.
    let rounded: f64 = scientific.parse().unwrap_or(x);
    if (1e-4..1e7).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// A time in the unit that people use for it.
fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s >= 1.0 => (s, "s"),
        s if s >= 1e-3 => (s * 1e3, "ms"),
        s => (s * 1e6, "us"),
    };
    let digits = format!("{value:.*}", decimals_of(value, 4));
    let short = if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { &digits };
    format!("{short} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::AccelerationFields;

    #[test]
    fn an_uncertainty_has_two_digits_and_its_value_as_many_decimals() {
        assert_eq!(with_uncertainty(93.5132, Some(0.414), 1), "93.51 ± 0.41");
        assert_eq!(with_uncertainty(0.123_44, Some(0.001_18), 1), "0.1234 ± 0.0012");
        assert_eq!(with_uncertainty(30.84, Some(12.3), 1), "31 ± 12");
        assert_eq!(with_uncertainty(30.84, Some(0.0996), 1), "30.84 ± 0.10");
        assert_eq!(with_uncertainty(30.84, None, 1), "30.8");
        assert_eq!(with_uncertainty(30.84, Some(0.0), 1), "30.8 ± 0.0");
        assert_eq!(with_uncertainty(30.84, Some(f64::NAN), 1), "30.8 ± NaN");
    }

    #[test]
    fn significant_digits_are_counted_from_the_first() {
        for (x, digits, text) in [
            (0.001_234_56, 3, "0.00123"),
            (123_456.0, 2, "120000"),
            (1.5e-7, 2, "1.5e-7"),
            (0.0, 3, "0"),
            (2.0, 4, "2"),
            (-0.099_96, 3, "-0.1"),
        ] {
            assert_eq!(significant(x, digits), text);
        }
    }

    #[test]
    fn a_time_is_written_as_people_say_it() {
        for (seconds, text) in [(0.1, "100 ms"), (0.004, "4 ms"), (1.0 / 30.0, "33.33 ms"), (2.5, "2.5 s")] {
            assert_eq!(duration(seconds), text);
        }
        assert_eq!(duration(250e-6), "250 us");
        assert_eq!(duration(120.0), "120 s");
    }

    #[test]
    fn a_record_says_what_it_knows_and_what_is_missing() {
        let mut record = Record {
            image: "a.png".to_owned(),
            width: 640,
            height: 480,
            method: "x+y".to_owned(),
            angle_deg: 93.51,
            angle_std_deg: Some(0.41),
            length_px: 30.84,
            length_std_px: Some(0.25),
            status: "ok",
            exposure_s: Some(0.01),
            exposure_source: Some(ExposureSource::Exif),
            speed_m_s: Some(0.1234),
            speed_std_m_s: Some(0.0006),
            speed_expanded_m_s: Some(0.0012),
            coverage_k: Some(2.0),
            time_ms: 12.34,
            ..Record::default()
        };
        assert_eq!(
            from_record(&record),
            "a.png  640x480  angle 93.51 ± 0.41 deg  length 30.84 ± 0.25 px  speed 0.1234 ± 0.0012 m/s (k = 2)  ok\n    \
             x+y, 12.3 ms, exposure 10 ms (EXIF)"
        );
        record.speed_m_s = None;
        record.speed_expanded_m_s = None;
        record.coverage_k = None;
        record.no_speed = Some(NoSpeed::ScaleMissing);
        record.status = "low_confidence";
        record.reason = Some("weak".to_owned());
        assert_eq!(
            from_record(&record),
            "a.png  640x480  angle 93.51 ± 0.41 deg  length 30.84 ± 0.25 px  low_confidence: weak\n    \
             x+y, 12.3 ms, exposure 10 ms (EXIF); no speed: --scale is missing"
        );
        record.no_speed = None;
        let mut found = AccelerationFields {
            ratio: 0.523,
            ratio_std: 0.0412,
            limit: 0.214,
            detected: true,
            is_signed: false,
            metric: None,
        };
        record.acceleration = Some(found);
        let text = from_record(&record);
        assert_eq!(text.lines().last(), Some("    acceleration ratio 0.523 ± 0.041, detected above 0.21"));
        found.detected = false;
        record.acceleration = Some(found);
        let text = from_record(&record);
        assert_eq!(text.lines().last(), Some("    acceleration below detection limit: ratio under 0.21"));
        let metric = MetricAcceleration { value_m_s2: 1.234, std_m_s2: 0.05, expanded_m_s2: 0.1, limit_m_s2: 0.512 };
        found.metric = Some(metric);
        record.acceleration = Some(found);
        let text = from_record(&record);
        assert_eq!(text.lines().last(), Some("    acceleration below detection limit: ratio under 0.21, 0.51 m/s2"));
        found.detected = true;
        record.acceleration = Some(found);
        let text = from_record(&record);
        let expected =
            "    acceleration ratio 0.523 ± 0.041, detected above 0.21; acceleration 1.23 ± 0.10 m/s2 (k = 2)";
        assert_eq!(text.lines().last(), Some(expected));
        (found.metric, found.is_signed, found.ratio) = (None, true, -0.523);
        (record.acceleration, record.direction_deg) = (Some(found), Some(273.51));
        let text = from_record(&record);
        let lines: Vec<_> = text.lines().skip(2).collect();
        assert_eq!(
            lines,
            [
                "    direction 273.51 ± 0.41 deg",
                "    acceleration ratio -0.523 ± 0.041 (slowing down), detected above 0.21"
            ]
        );
    }
}
