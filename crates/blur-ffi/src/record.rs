//! The record of one measurement, as C has it.

use std::ffi::c_char;
use std::mem::offset_of;

use blur_core::estimate;
use blur_core::motion::COVERAGE_K;
use blur_core::record;

use crate::versioned::Versioned;

/// How far a result can be trusted.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The method's own checks passed.
    Ok = 0,
    /// There is an answer, and a reason not to trust it: see mb_meter_reason.
    LowConfidence = 1,
    /// The picture shows no motion blur that the method can see: see mb_meter_reason.
    NoMotionBlur = 2,
}

impl From<estimate::Status> for Status {
    fn from(status: estimate::Status) -> Self {
        match status {
            estimate::Status::Ok => Self::Ok,
            estimate::Status::NoMotionBlur(_) => Self::NoMotionBlur,
            // A status that is not known here is not one to be trusted.
            _ => Self::LowConfidence,
        }
    }
}

/// The name of a status in machine-readable output: "ok", "low_confidence" or "no_motion_blur"; empty for any other number.
#[unsafe(no_mangle)]
pub extern "C" fn mb_status_name(status: i32) -> *const c_char {
    const OK: i32 = Status::Ok as i32;
    const LOW_CONFIDENCE: i32 = Status::LowConfidence as i32;
    const NO_MOTION_BLUR: i32 = Status::NoMotionBlur as i32;
    let name = match status {
        OK => c"ok",
        LOW_CONFIDENCE => c"low_confidence",
        NO_MOTION_BLUR => c"no_motion_blur",
        _ => c"",
    };
    name.as_ptr()
}

/// All that one picture tells. A number that was not computed is NaN. Uncertainties are standard uncertainties (one standard
/// deviation). Begin with mb_record record = {sizeof record};
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Record {
    /// Its size in bytes: sizeof(mb_record). An older library sets it to what it knows, and leaves what is beyond as it was.
    pub struct_size: usize,
    /// Columns of the picture.
    pub width: usize,
    /// Rows of the picture.
    pub height: usize,
    /// How far to trust the result.
    pub status: Status,
    /// 1 if the sRGB tone curve was undone first, else 0.
    pub linearized: i32,
    /// 1 if the fit started from the result of the frame before instead of a search, else 0.
    pub tracked: i32,
    /// 1 if the acceleration stands out from a uniform motion, 0 if not, -1 if it was not looked for.
    pub accel_detected: i32,
    /// Axis of the motion in degrees, from 0 to below 180, counter-clockwise from +x as seen (y up).
    pub angle_deg: f64,
    /// Its standard uncertainty.
    pub angle_std_deg: f64,
    /// Where the content of the picture moved, in degrees, from 0 to below 360, when that is known.
    pub direction_deg: f64,
    /// Blur length in pixels.
    pub length_px: f64,
    /// Its standard uncertainty.
    pub length_std_px: f64,
    /// Correlation coefficient of angle and length.
    pub correlation: f64,
    /// The ratio a T / (2 v): without its sign unless the method knows it.
    pub accel_ratio: f64,
    /// Its standard uncertainty.
    pub accel_ratio_std: f64,
    /// The least ratio that counts as detected.
    pub accel_ratio_limit: f64,
    /// Acceleration in metres per second squared.
    pub accel_m_s2: f64,
    /// Its combined standard uncertainty.
    pub accel_std_m_s2: f64,
    /// Gain in log-likelihood over no blur, for each bin of signal.
    pub gain_per_bin: f64,
    /// Evidence for the best other blur, relative to the one found.
    pub rival_share: f64,
    /// Share of the light that does not follow the motion.
    pub incoherent_share: f64,
    /// Mean squared standardised residual of the spectrum.
    pub misfit: f64,
    /// Highest frequency that the result rests on, in cycles per pixel.
    pub band_cycles_per_px: f64,
    /// Exposure time in seconds.
    pub exposure_s: f64,
    /// Metres in the scene for each pixel of the blur as measured.
    pub scale_m_per_px: f64,
    /// Its standard uncertainty.
    pub scale_std_m_per_px: f64,
    /// Mean speed during the exposure in metres per second.
    pub speed_m_s: f64,
    /// Its combined standard uncertainty.
    pub speed_std_m_s: f64,
    /// Its expanded uncertainty, coverage_k times the standard uncertainty.
    pub speed_expanded_m_s: f64,
    /// The coverage factor: about 95 % for a normal distribution.
    pub coverage_k: f64,
    /// How fast the camera turned in radians per second, when it did in front of a scene at rest.
    pub angular_rate_rad_s: f64,
    /// Its combined standard uncertainty.
    pub angular_rate_std_rad_s: f64,
}

// SAFETY: `repr(C)`, the size first, and it is never read from a program's memory, only written there.
unsafe impl Versioned for Record {
    const NAME: &'static str = "mb_record";
    const LEAST_BYTES: usize = offset_of!(Self, angular_rate_std_rad_s) + size_of::<f64>();
}

impl From<&record::Record> for Record {
    fn from(record: &record::Record) -> Self {
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Self {
            struct_size: size_of::<Self>(),
            width: record.width,
            height: record.height,
            status: record.status.into(),
            linearized: record.linearized.into(),
            tracked: record.tracked.into(),
            accel_detected: record.accel_detected.map_or(-1, i32::from),
            angle_deg: record.angle_deg,
            angle_std_deg: or_nan(record.angle_std_deg),
            direction_deg: or_nan(record.direction_deg),
            length_px: record.length_px,
            length_std_px: or_nan(record.length_std_px),
            correlation: or_nan(record.correlation),
            accel_ratio: or_nan(record.accel_ratio),
            accel_ratio_std: or_nan(record.accel_ratio_std),
            accel_ratio_limit: or_nan(record.accel_ratio_limit),
            accel_m_s2: or_nan(record.accel_m_s2),
            accel_std_m_s2: or_nan(record.accel_std_m_s2),
            gain_per_bin: or_nan(record.gain_per_bin),
            rival_share: or_nan(record.rival_share),
            incoherent_share: or_nan(record.incoherent_share),
            misfit: or_nan(record.misfit),
            band_cycles_per_px: or_nan(record.band_cycles_per_px),
            exposure_s: or_nan(record.exposure_s),
            scale_m_per_px: or_nan(record.scale_m_per_px),
            scale_std_m_per_px: or_nan(record.scale_std_m_per_px),
            speed_m_s: or_nan(record.speed_m_s),
            speed_std_m_s: or_nan(record.speed_std_m_s),
            speed_expanded_m_s: or_nan(record.speed_expanded_m_s()),
            coverage_k: or_nan(record.speed_std_m_s.map(|_| COVERAGE_K)),
            angular_rate_rad_s: or_nan(record.angular_rate_rad_s),
            angular_rate_std_rad_s: or_nan(record.angular_rate_std_rad_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use blur_core::estimate::Doubt;

    use super::*;

    #[test]
    fn statuses_have_their_names() {
        let doubt = Doubt::NoPattern;
        for status in
            [estimate::Status::Ok, estimate::Status::LowConfidence(doubt), estimate::Status::NoMotionBlur(doubt)]
        {
            // SAFETY: names are constants that end in a zero byte.
            let name = unsafe { CStr::from_ptr(mb_status_name(Status::from(status) as i32)) };
            assert_eq!(name.to_str(), Ok(status.name()));
        }
        for other in [-1, 3, i32::MAX] {
            // SAFETY: as before.
            assert!(unsafe { CStr::from_ptr(mb_status_name(other)) }.is_empty());
        }
    }
}
