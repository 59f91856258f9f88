//! Results for people.

use std::fmt::Write;

use blur_core::motion::COVERAGE_K;

use crate::record::{ExposureSource, MetricAcceleration, NoSpeed, Record};

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
    if let Some(seconds) = record.exposure_s {
        let source = match record.exposure_source {
            Some(ExposureSource::Exif) => " (EXIF)",
            Some(ExposureSource::Option) | None => "",
        };
        let _ = write!(text, ", exposure {}{source}", duration(seconds));
    }
    match record.no_speed {
        Some(NoSpeed::ScaleMissing) => text.push_str("; no speed: --scale is missing"),
        Some(NoSpeed::ExposureMissing) => {
            text.push_str("; no speed: --exposure is missing and the picture has none in its EXIF data");
        }
        Some(NoSpeed::NoMotionBlur) => text.push_str("; no speed: no motion blur"),
        None => {}
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
    text
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
fn decimals_of(x: f64, digits: i32) -> usize {
    // Scientific notation rounds first: 0.0996 with two digits is 1.0e-1.
    let scientific = format!("{:.*e}", usize::try_from(digits - 1).unwrap_or(0), x);
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    usize::try_from((digits - 1 - exponent).clamp(0, 12)).unwrap_or(0)
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
            linearized: false,
            angle_deg: 93.51,
            angle_std_deg: Some(0.41),
            direction_deg: None,
            length_px: 30.84,
            length_std_px: Some(0.25),
            correlation: None,
            status: "ok",
            reason: None,
            acceleration: None,
            evidence: None,
            exposure_s: Some(0.01),
            exposure_source: Some(ExposureSource::Exif),
            speed_m_s: Some(0.1234),
            speed_std_m_s: Some(0.0006),
            speed_expanded_m_s: Some(0.0012),
            coverage_k: Some(2.0),
            time_ms: 12.34,
            no_speed: None,
            note: None,
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
