//! The figures of the thesis, tables 8.1 to 8.3: value and expanded uncertainty, k = 1.65.

use super::readings::Section;

/// Table 8.1, mm.
pub(super) const WIDTHS_MM: [(Section, f64, f64); 10] = [
    (Section::Tooth(1), 3.174, 0.035),
    (Section::Slit(1), 4.893, 0.038),
    (Section::Tooth(2), 3.067, 0.035),
    (Section::Slit(2), 4.908, 0.036),
    (Section::Tooth(3), 3.091, 0.035),
    (Section::Slit(3), 4.908, 0.035),
    (Section::Tooth(4), 3.108, 0.036),
    (Section::Slit(4), 4.897, 0.037),
    (Section::Tooth(5), 3.164, 0.107),
    (Section::Slit(5), 4.903, 0.036),
];

/// Table 8.2: number of the speed, m/s.
pub(super) const SPEEDS_M_S: [(f64, f64, f64); 10] = [
    (0.0, 0.173, 0.012),
    (1.0, 0.229, 0.016),
    (2.0, 0.324, 0.019),
    (3.0, 0.395, 0.022),
    (4.0, 0.457, 0.023),
    (5.0, 0.500, 0.025),
    (6.0, 0.533, 0.027),
    (7.0, 0.573, 0.028),
    (8.0, 0.591, 0.028),
    (9.0, 0.666, 0.031),
];

/// Table 8.3: angle in degrees, m/s^2.
pub(super) const ACCELERATIONS_M_S2: [(f64, f64, f64); 8] = [
    (15.0, 2.463, 0.029),
    (13.3, 2.178, 0.023),
    (11.5, 1.863, 0.012),
    (10.1, 1.541, 0.016),
    (7.9, 1.229, 0.013),
    (6.1, 0.942, 0.009),
    (4.5, 0.644, 0.007),
    (2.9, 0.351, 0.004),
];

/// Width of the calibration tooth, mm.
pub(super) const CALIBRATION_TOOTH_MM: f64 = 25.2;
/// Readings of each width, passes at each speed, runs at each angle.
pub(super) const READINGS: usize = 20;

/// The thesis's width of a section, mm, and its expanded uncertainty.
pub(super) fn width(section: Section) -> Option<(f64, f64)> {
    WIDTHS_MM.iter().find(|row| row.0 == section).map(|row| (row.1, row.2))
}

/// The thesis's speed of this number, m/s, likewise.
pub(super) fn speed(index: f64) -> Option<(f64, f64)> {
    SPEEDS_M_S.iter().find(|row| row.0 == index).map(|row| (row.1, row.2))
}

/// The thesis's acceleration at this angle, m/s^2, likewise.
pub(super) fn acceleration(angle_deg: f64) -> Option<(f64, f64)> {
    ACCELERATIONS_M_S2.iter().find(|row| row.0 == angle_deg).map(|row| (row.1, row.2))
}
