//! Grey values of colour pictures.

/// Luma of a gamma-encoded colour by ITU-R BT.601: `0.299 R + 0.587 G + 0.114 B`, on the scale of its inputs.
pub fn bt601_luma(red: f32, green: f32, blue: f32) -> f32 {
    0.299 * red + 0.587 * green + 0.114 * blue
}

/// Linear light in `[0, 1]` of an sRGB code value in `[0, 1]` (IEC 61966-2-1).
pub fn linear_from_srgb(code: f32) -> f32 {
    if code <= 0.040_45 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// sRGB code value in `[0, 1]` of linear light in `[0, 1]` (IEC 61966-2-1): undoes [`linear_from_srgb`].
pub fn srgb_from_linear(light: f32) -> f32 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_stays_grey_and_green_is_brightest() {
        assert!((bt601_luma(77.0, 77.0, 77.0) - 77.0).abs() < 1e-4);
        assert!((bt601_luma(0.0, 255.0, 0.0) - 149.685).abs() < 1e-3);
    }

    #[test]
    fn srgb_has_its_published_fixed_points() {
        assert_eq!(linear_from_srgb(0.0), 0.0);
        assert!((linear_from_srgb(1.0) - 1.0).abs() < 1e-6);
        // sRGB 188 is close to half of the light: 0.5029.
        assert!((linear_from_srgb(188.0 / 255.0) - 0.502_886).abs() < 1e-5);
        let (below, above) = (linear_from_srgb(0.040_449), linear_from_srgb(0.040_451));
        assert!((above - below).abs() < 1e-5);
    }

    #[test]
    fn srgb_codes_come_back_from_their_light() {
        for code in 0..=255 {
            let code = code as f32 / 255.0;
            assert!((srgb_from_linear(linear_from_srgb(code)) - code).abs() < 1e-5, "{code}");
        }
    }
}
