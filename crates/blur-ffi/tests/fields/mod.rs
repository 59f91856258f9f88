//! Records as text, one `name=value` a line, as the programs in `examples` print them.

use std::ffi::CStr;
use std::fmt::Write;

use blur_core::record::{self, Value};
use motion_blur::{Record, mb_status_name};

/// All 17 digits that tell a double from every other; Rust's shortest text that reads back the same does too.
fn push(text: &mut String, name: &str, value: f64) {
    if !value.is_nan() {
        writeln!(text, "{name}={value:?}").unwrap();
    }
}

/// From the fields of the record of Rust, in their order.
pub(crate) fn of_rust(record: &record::Record) -> String {
    let mut text = String::new();
    for (name, value) in record.fields() {
        match value {
            Value::Count(count) => writeln!(text, "{name}={count}").unwrap(),
            Value::Number(number) => push(&mut text, name, number),
            Value::Flag(flag) => writeln!(text, "{name}={}", u8::from(flag)).unwrap(),
            Value::Text(value) => writeln!(text, "{name}={value}").unwrap(),
        }
    }
    text
}

/// From a structure of C and the two texts that its meter gives.
pub(crate) fn of_c(record: &Record, method: &str, reason: &str) -> String {
    // SAFETY: names are constants that end in a zero byte.
    let status = unsafe { CStr::from_ptr(mb_status_name(record.status as i32)) }.to_str().unwrap();
    let mut text = format!(
        "width={}\nheight={}\nmethod={method}\nlinearized={}\ntracked={}\n",
        record.width, record.height, record.linearized, record.tracked
    );
    push(&mut text, "angle_deg", record.angle_deg);
    push(&mut text, "angle_std_deg", record.angle_std_deg);
    push(&mut text, "direction_deg", record.direction_deg);
    push(&mut text, "length_px", record.length_px);
    push(&mut text, "length_std_px", record.length_std_px);
    push(&mut text, "correlation", record.correlation);
    writeln!(text, "status={status}").unwrap();
    if !reason.is_empty() {
        writeln!(text, "reason={reason}").unwrap();
    }
    push(&mut text, "accel_ratio", record.accel_ratio);
    push(&mut text, "accel_ratio_std", record.accel_ratio_std);
    push(&mut text, "accel_ratio_limit", record.accel_ratio_limit);
    if record.accel_detected >= 0 {
        writeln!(text, "accel_detected={}", record.accel_detected).unwrap();
    }
    push(&mut text, "accel_m_s2", record.accel_m_s2);
    push(&mut text, "accel_std_m_s2", record.accel_std_m_s2);
    push(&mut text, "gain_per_bin", record.gain_per_bin);
    push(&mut text, "rival_share", record.rival_share);
    push(&mut text, "incoherent_share", record.incoherent_share);
    push(&mut text, "misfit", record.misfit);
    push(&mut text, "band_cycles_per_px", record.band_cycles_per_px);
    push(&mut text, "exposure_s", record.exposure_s);
    push(&mut text, "scale_m_per_px", record.scale_m_per_px);
    push(&mut text, "scale_std_m_per_px", record.scale_std_m_per_px);
    push(&mut text, "speed_m_s", record.speed_m_s);
    push(&mut text, "speed_std_m_s", record.speed_std_m_s);
    push(&mut text, "speed_expanded_m_s", record.speed_expanded_m_s);
    push(&mut text, "coverage_k", record.coverage_k);
    push(&mut text, "angular_rate_rad_s", record.angular_rate_rad_s);
    push(&mut text, "angular_rate_std_rad_s", record.angular_rate_std_rad_s);
    text
}
