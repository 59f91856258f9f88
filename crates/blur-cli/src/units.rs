//! Quantities as people write them on a command line. A number without a unit is refused: nobody should have to
//! guess whether `--exposure 100` means seconds or milliseconds.

use blur_core::estimate::LengthRange;
use blur_core::image::Region;

use crate::{Error, Result};

/// Units of time; a number is divided by the second entry to give seconds. Longer suffixes stand first.
const TIME: &[(&str, f64)] = &[("ms", 1e3), ("us", 1e6), ("µs", 1e6), ("μs", 1e6), ("s", 1.0)];

/// Units of scale; a number is divided by the second entry to give metres per pixel.
const SCALE: &[(&str, f64)] =
    &[("mm/px", 1e3), ("cm/px", 1e2), ("um/px", 1e6), ("µm/px", 1e6), ("μm/px", 1e6), ("m/px", 1.0)];

/// Units of length; a number is divided by the second entry to give metres. Longer suffixes stand first.
const LENGTH: &[(&str, f64)] = &[("mm", 1e3), ("cm", 1e2), ("um", 1e6), ("µm", 1e6), ("μm", 1e6), ("m", 1.0)];

/// Seconds of a time such as `100ms`, `0.1 s`, `1/250s` or `250us`; at least 0.
///
/// ```
/// assert_eq!(blur_cli::units::seconds("1/250s").unwrap(), 0.004);
/// assert!(blur_cli::units::seconds("100").is_err());
/// ```
pub fn seconds(text: &str) -> Result<f64> {
    quantity(text, TIME).ok_or_else(|| Error::Quantity {
        text: text.to_owned(),
        quantity: "a time",
        units: names(TIME),
        example: "100ms, 0.1s or 1/250s",
    })
}

/// Metres per pixel of a scale such as `0.7789mm/px` or `1e-3 m/px`; at least 0.
pub fn metres_per_pixel(text: &str) -> Result<f64> {
    quantity(text, SCALE).ok_or_else(|| Error::Quantity {
        text: text.to_owned(),
        quantity: "a scale",
        units: names(SCALE),
        example: "0.7789mm/px or 1e-3m/px",
    })
}

/// Units of the sides of a board: those of length, and inches.
const SIDE: &[(&str, f64)] =
    &[("mm", 1e3), ("cm", 1e2), ("um", 1e6), ("µm", 1e6), ("μm", 1e6), ("m", 1.0), ("in", 1.0 / 0.0254)];

/// Metres of a side of a calibration board such as `25mm` or `0.5in`; at least 0.
pub fn side_metres(text: &str) -> Result<f64> {
    quantity(text, SIDE).ok_or_else(|| Error::Quantity {
        text: text.to_owned(),
        quantity: "a length",
        units: names(SIDE),
        example: "25mm or 0.5in",
    })
}

/// Columns and rows written `9x6`.
pub fn columns_and_rows(text: &str) -> Result<(usize, usize)> {
    let numbers = text.split_once(['x', 'X']).and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
    numbers.filter(|&(columns, rows)| columns > 0 && rows > 0).ok_or_else(|| Error::Numbers {
        text: text.to_owned(),
        expected: "columns and rows COLUMNSxROWS, for example 9x6",
    })
}

/// Metres of a length such as `1.21m` or `25 mm`; at least 0.
pub fn metres(text: &str) -> Result<f64> {
    quantity(text, LENGTH).ok_or_else(|| Error::Quantity {
        text: text.to_owned(),
        quantity: "a length",
        units: names(LENGTH),
        example: "1.21m or 25mm",
    })
}

/// Degrees of an angle: any finite number.
pub fn degrees(text: &str) -> Result<f64> {
    finite(text).ok_or_else(|| Error::Numbers { text: text.to_owned(), expected: "a number of degrees" })
}

/// A region of a picture written `X,Y,W,H` in whole pixels.
pub fn region(text: &str) -> Result<Region> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, width, height]) if width > 0 && height > 0 => Ok(Region { x, y, width, height }),
        _ => Err(Error::Numbers {
            text: text.to_owned(),
            expected: "a region X,Y,W,H: left column, top row, width and height in whole pixels, for example 100,50,512,512",
        }),
    }
}

/// A range of blur lengths written `MIN,MAX` in pixels.
pub fn length_range(text: &str) -> Result<LengthRange> {
    let numbers: Option<Vec<f64>> = text.split(',').map(finite).collect();
    match numbers.as_deref() {
        Some(&[min_px, max_px]) => Ok(LengthRange::new(min_px, max_px)?),
        _ => Err(Error::Numbers {
            text: text.to_owned(),
            expected: "a range MIN,MAX of blur lengths in pixels, for example 10,80",
        }),
    }
}

fn quantity(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let text = text.trim();
    let (number, divisor) = units.iter().find_map(|&(unit, divisor)| Some((text.strip_suffix(unit)?, divisor)))?;
    let value = match number.split_once('/') {
        Some((numerator, denominator)) => finite(numerator)? / finite(denominator)?,
        None => finite(number)?,
    } / divisor;
    (value.is_finite() && value >= 0.0).then_some(value)
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

fn names(units: &[(&str, f64)]) -> String {
    let ascii: Vec<_> = units.iter().map(|&(unit, _)| unit).filter(|unit| unit.is_ascii()).collect();
    ascii.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units_and_may_be_fractions() {
        for (text, expected) in
            [("100ms", 0.1), ("0.1s", 0.1), ("0.1 s", 0.1), ("1/250s", 0.004), ("250us", 250e-6), ("250µs", 250e-6)]
        {
            assert_eq!(seconds(text).unwrap(), expected, "{text}");
        }
        assert_eq!(seconds(" 1e2 ms ").unwrap(), 0.1);
    }

    #[test]
    fn scales_have_units() {
        for (text, expected) in [("0.7789mm/px", 0.7789e-3), ("1e-3m/px", 1e-3), ("0.8 m/px", 0.8), ("5um/px", 5e-6)] {
            assert!((metres_per_pixel(text).unwrap() - expected).abs() < 1e-18, "{text}");
        }
    }

    #[test]
    fn boards_have_sides_in_inches_too_and_whole_columns() {
        assert!((side_metres("0.5in").unwrap() - 0.0127).abs() < 1e-15);
        assert!((side_metres("25mm").unwrap() - 0.025).abs() < 1e-15);
        assert_eq!(columns_and_rows("9x6").unwrap(), (9, 6));
        for text in ["9", "9x", "x6", "0x6", "9x-1", "9.5x6", "9x6x2"] {
            assert!(columns_and_rows(text).is_err(), "{text}");
        }
    }

    #[test]
    fn lengths_have_units() {
        for (text, expected) in [("1.21m", 1.21), ("25 mm", 0.025), ("3cm", 0.03), ("5um", 5e-6)] {
            assert!((metres(text).unwrap() - expected).abs() < 1e-15, "{text}");
        }
        for text in ["1.21", "1km", "-1m", "m"] {
            assert!(metres(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_bare_number_is_refused_and_the_units_are_named() {
        let message = seconds("100").unwrap_err().to_string();
        assert!(message.contains("ms, us, s"), "{message}");
        let message = metres_per_pixel("0.7789").unwrap_err().to_string();
        assert!(message.contains("mm/px"), "{message}");
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "s", "ms", "1/0s", "0/0s", "-1s", "nan s", "inf s", "1e400s", "1h", "1//2s", "1 2s", "xms"] {
            assert!(seconds(text).is_err(), "{text}");
        }
        for text in ["1mm", "1px", "mm/px", "-1mm/px", "1km/px", "1/px"] {
            assert!(metres_per_pixel(text).is_err(), "{text}");
        }
        assert!(degrees("nan").is_err());
    }

    #[test]
    fn regions_and_ranges_are_lists() {
        assert_eq!(region("1, 2,30,40").unwrap(), Region { x: 1, y: 2, width: 30, height: 40 });
        for text in ["", "1,2,3", "1,2,3,4,5", "1,2,0,4", "1,2,3,0", "-1,2,3,4", "1.5,2,3,4"] {
            assert!(region(text).is_err(), "{text}");
        }
        assert_eq!(length_range("10,80").unwrap(), LengthRange::new(10.0, 80.0).unwrap());
        for text in ["", "10", "80,10", "1,80", "10,nan", "10,20,30"] {
            assert!(length_range(text).is_err(), "{text}");
        }
    }
}
