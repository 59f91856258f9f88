//! A calibration for people.

use std::fmt::Write;

use blur_core::camera::{Calibration, PARAMETER_NAMES};

use crate::text::with_uncertainty;

/// Relative standard uncertainty of a focal length beyond which more or other views are advised.
const LOOSE_FOCAL: f64 = 0.01;
/// A view tilted by less than this, in degrees, hardly tells the focal length from the distance.
const TILTED_DEG: f64 = 10.0;
/// Fewest tilted views of a calibration to rely on.
const MIN_TILTED: usize = 3;
/// A coefficient within this many standard uncertainties of 0 may as well be 0.
const INSIGNIFICANT: f64 = 2.0;
/// A view whose residuals are this many times those of all may hold misplaced points.
const ODD_VIEW: f64 = 2.0;

/// The residuals and tilts of all views, in the order of their `names`, and the parameters with one standard uncertainty.
pub fn table(names: &[String], calibration: &Calibration) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{:>9} {:>9}  view", "rms (px)", "tilt");
    let views = calibration.view_rms_px.iter().zip(&calibration.view_tilt_deg);
    for (name, (rms, tilt)) in names.iter().zip(views) {
        let _ = writeln!(text, "{rms:9.3} {tilt:5.1} deg  {name}");
    }
    let intrinsics = &calibration.intrinsics;
    let _ = writeln!(
        text,
        "\ncamera of {}x{} pixels from {} views with {} points: rms {:.3} px",
        intrinsics.width_px(),
        intrinsics.height_px(),
        calibration.view_rms_px.len(),
        calibration.points,
        calibration.rms_px
    );
    let fitted = calibration.model.fitted();
    for (index, name) in PARAMETER_NAMES.iter().enumerate().filter(|&(index, _)| fitted[index]) {
        let value = with_uncertainty(intrinsics.parameters()[index], Some(intrinsics.stds()[index]), 6);
        let (name, unit) = name.strip_suffix("_px").map_or((*name, ""), |name| (name, " px"));
        let _ = writeln!(text, "  {name:<5} {value}{unit}");
    }
    text
}

/// What should be known before this calibration is relied on, one warning each.
pub fn warnings(names: &[String], calibration: &Calibration) -> Vec<String> {
    let (values, stds) = (calibration.intrinsics.parameters(), calibration.intrinsics.stds());
    let mut warnings = Vec::new();
    let tilted = calibration.view_tilt_deg.iter().filter(|&&tilt| tilt > TILTED_DEG).count();
    if tilted < MIN_TILTED {
        warnings.push(format!(
            "only {tilted} of {} views are tilted by more than {TILTED_DEG} degrees: tilt the board in {MIN_TILTED} or more",
            calibration.view_tilt_deg.len()
        ));
    }
    for index in 0..2 {
        let relative = stds[index] / values[index];
        if relative > LOOSE_FOCAL {
            warnings.push(format!(
                "{} is known to {:.1} % only: take more views, tilted in several directions",
                PARAMETER_NAMES[index].trim_end_matches("_px"),
                100.0 * relative
            ));
        }
    }
    let fitted = calibration.model.fitted();
    // Only the last coefficients can be left out.
    let last = (0..PARAMETER_NAMES.len()).rev().find(|&index| fitted[index]);
    if let Some(index) = last.filter(|&index| index > 6 && values[index].abs() < INSIGNIFICANT * stds[index]) {
        warnings.push(format!(
            "{} = {} is not told from 0: fewer coefficients may do (--distortion)",
            PARAMETER_NAMES[index],
            with_uncertainty(values[index], Some(stds[index]), 6)
        ));
    }
    for (name, &rms) in names.iter().zip(&calibration.view_rms_px) {
        if rms > ODD_VIEW * calibration.rms_px {
            warnings
                .push(format!("{name}: its rms of {rms:.3} px stands out: is the board flat and the picture sharp?"));
        }
    }
    warnings
}
