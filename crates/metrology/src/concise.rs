//! Rounded results: the uncertainty to two significant digits, the value to the same place (GUM 7.2.2 and 7.2.6).

use std::fmt;
use std::str::FromStr;

use crate::{Error, Measurement};

/// More significant digits than a double has say nothing.
const MAX_DIGITS: usize = 17;

/// Value and uncertainty in decimal digits, both counted in units of `10^place`.
struct Rounded {
    negative: bool,
    value: String,
    std: String,
    place: i32,
}

impl Rounded {
    /// Rounds to so many significant digits of the uncertainty; an uncertainty of 0 keeps all digits of the value.
    fn new(measurement: Measurement, digits: usize) -> Self {
        let (value, std) = (measurement.value(), measurement.std());
        let digits = digits.clamp(1, MAX_DIGITS);
        let (std_digits, place) = if std > 0.0 {
            scientific(&format!("{std:.*e}", digits - 1))
        } else {
            (String::from("0"), scientific(&format!("{value:e}")).1.min(0))
        };
        let value_digits = match usize::try_from(-place) {
            Ok(decimals) => format!("{:.*}", decimals, value.abs()).replace('.', ""),
            Err(_) => format!("{:.0}", value.abs() / 10.0_f64.powi(place)),
        };
        let trimmed = value_digits.trim_start_matches('0');
        let value_digits = if trimmed.is_empty() { String::from("0") } else { trimmed.to_owned() };
        Self { negative: value < 0.0 && value_digits != "0", value: value_digits, std: std_digits, place }
    }

    fn sign(&self) -> &'static str {
        if self.negative { "-" } else { "" }
    }
}

/// Digits and place of the last one of a number printed as `d.ddde-dd`.
fn scientific(text: &str) -> (String, i32) {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
    (digits, exponent.parse::<i32>().unwrap_or(0) - decimals)
}

/// Digits with a point before the last `decimals`, zeros put in front as needed.
fn with_point(digits: &str, decimals: usize) -> String {
    if decimals == 0 {
        return digits.to_owned();
    }
    let padded = format!("{digits:0>width$}", width = decimals + 1);
    let (whole, fraction) = padded.split_at(padded.len() - decimals);
    format!("{whole}.{fraction}")
}

/// Concise notation: the uncertainty in parentheses, in units of the last digit of the value.
///
/// `digits` are the significant digits of the uncertainty, 1 to 17 (others are moved there); two is what GUM 7.2.6 asks
/// for at most. A power of ten follows where the last digit is worth ten or more, or the number begins after more
/// than three zeros behind the point. Rounding is that of the exact binary number; 0.0996 is 0.10 to two digits.
///
/// ```
/// use metrology::{Measurement, concise};
///
/// assert_eq!(concise(Measurement::new(100.021_471, 0.000_352)?, 2), "100.02147(35)"); // GUM 7.2.2
/// assert_eq!(concise(Measurement::new(12_345.0, 230.0)?, 2), "1.234(23)e4");
/// assert_eq!(concise(Measurement::new(0.02, 9.96)?, 2), "0(10)");
/// # Ok::<(), metrology::Error>(())
/// ```
pub fn concise(measurement: Measurement, digits: usize) -> String {
    let r = Rounded::new(measurement, digits);
    let longest = r.value.len().max(r.std.len());
    // Power of ten of the leading digit of the longer of the two.
    let leading = r.place + longest as i32 - 1;
    if r.place <= 0 && leading >= -4 {
        let decimals = r.place.unsigned_abs() as usize;
        return format!("{}{}({})", r.sign(), with_point(&r.value, decimals), r.std);
    }
    format!("{}{}({})e{leading}", r.sign(), with_point(&r.value, longest - 1), r.std)
}

/// Value and uncertainty as two decimal numbers rounded to the same place, without a power of ten.
///
/// ```
/// use metrology::{Measurement, rounded};
///
/// let v = Measurement::new(0.578_448, 0.005_418_5)?;
/// assert_eq!(rounded(v, 2), (String::from("0.5784"), String::from("0.0054")));
/// # Ok::<(), metrology::Error>(())
/// ```
pub fn rounded(measurement: Measurement, digits: usize) -> (String, String) {
    let r = Rounded::new(measurement, digits);
    let decimals = usize::try_from(-r.place).unwrap_or(0);
    let zeros = "0".repeat(usize::try_from(r.place).unwrap_or(0));
    let plain = |digits: &str| {
        let number = with_point(digits, decimals);
        if digits == "0" { number } else { number + &zeros }
    };
    (format!("{}{}", r.sign(), plain(&r.value)), plain(&r.std))
}

/// Concise notation with two digits of uncertainty.
impl fmt::Display for Measurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&concise(*self, 2))
    }
}

/// Reads concise notation: `3.174(35)`, `-1.23(4)e-5`, and `23.4(1.2)` where a point in the parentheses makes the
/// uncertainty a number of its own.
impl FromStr for Measurement {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        parse(text.trim()).ok_or_else(|| Error::Notation { text: text.to_owned() })
    }
}

fn parse(text: &str) -> Option<Measurement> {
    let (value, rest) = text.split_once('(')?;
    let (std, exponent) = rest.split_once(')')?;
    let exponent: i32 = match exponent.strip_prefix(['e', 'E']) {
        Some(power) => power.parse().ok()?,
        None if exponent.is_empty() => 0,
        None => return None,
    };
    let unsigned = value.strip_prefix(['-', '+']).unwrap_or(value);
    if !is_decimal(unsigned) || !is_decimal(std) {
        return None;
    }
    let decimals = unsigned.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let last_place = if std.contains('.') { exponent } else { exponent.checked_sub(i32::try_from(decimals).ok()?)? };
    // Decimal text all the way: a product would round twice.
    let value = format!("{value}e{exponent}").parse().ok()?;
    let std = format!("{std}e{last_place}").parse().ok()?;
    Measurement::new(value, std).ok()
}

/// Digits with at most one point among them, at least one digit.
fn is_decimal(text: &str) -> bool {
    let digits = text.bytes().filter(u8::is_ascii_digit).count();
    let points = text.bytes().filter(|&b| b == b'.').count();
    digits > 0 && points <= 1 && digits + points == text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: f64, std: f64) -> String {
        Measurement::new(value, std).unwrap().to_string()
    }

    fn read(text: &str) -> Option<(f64, f64)> {
        text.parse::<Measurement>().ok().map(|m| (m.value(), m.std()))
    }

    #[test]
    fn the_value_is_rounded_to_the_place_of_two_digits_of_uncertainty() {
        // GUM 7.2.6: 10.05762 ohm with 27 mohm is 10.058; 28.05 kHz is 28 kHz.
        assert_eq!(of(10.057_62, 0.027), "10.058(27)");
        assert_eq!(rounded(Measurement::new(0.0, 28.05).unwrap(), 2).1, "28");
        assert_eq!(of(3.174, 0.035), "3.174(35)");
        assert_eq!(of(-0.578_448, 0.005_418_5), "-0.5784(54)");
        assert_eq!(concise(Measurement::new(3.174, 0.035).unwrap(), 1), "3.17(4)");
    }

    #[test]
    fn a_carry_makes_the_uncertainty_one_place_coarser() {
        assert_eq!(of(123.456, 9.96), "123(10)");
        assert_eq!(of(123.456, 0.0996), "123.46(10)");
        assert_eq!(of(99.996, 0.011), "99.996(11)");
        assert_eq!(of(99.999_6, 0.011), "100.000(11)");
    }

    #[test]
    fn an_uncertainty_larger_than_the_value_keeps_its_digits() {
        assert_eq!(of(0.001, 2.3), "0.0(23)");
        assert_eq!(of(-0.001, 2.3), "0.0(23)");
        assert_eq!(of(1e-5, 2.3e-3), "0.0000(23)");
        assert_eq!(of(0.0, 0.0), "0(0)");
    }

    #[test]
    fn an_exact_value_keeps_all_its_digits() {
        assert_eq!(of(0.1, 0.0), "0.1(0)");
        assert_eq!(of(1200.0, 0.0), "1200(0)");
        assert_eq!(of(1.5e-9, 0.0), "1.5(0)e-9");
    }

    #[test]
    fn large_and_small_numbers_have_a_power_of_ten() {
        assert_eq!(of(1.23e-5, 4e-7), "1.230(40)e-5");
        assert_eq!(of(6.022_140_76e23, 2e17), "6.0221408(20)e23");
        assert_eq!(of(120.0, 340.0), "1.2(34)e2");
        assert_eq!(rounded(Measurement::new(12_345.0, 234.0).unwrap(), 2), ("12340".into(), "230".into()));
    }

    #[test]
    fn notation_of_the_thesis_and_others_is_read() {
        assert_eq!(read("23.40(20)"), Some((23.40, 0.20)));
        assert_eq!(read("0.4120(15)"), Some((0.4120, 0.0015)));
        assert_eq!(read("1.23(4)e-5"), Some((1.23e-5, 0.04e-5)));
        assert_eq!(read(" -3.164(107) "), Some((-3.164, 0.107)));
        assert_eq!(read("23.4(1.2)"), Some((23.4, 1.2)));
        assert_eq!(read("100(23)"), Some((100.0, 23.0)));
        assert_eq!(read("1.5(0)"), Some((1.5, 0.0)));
    }

    #[test]
    fn anything_else_is_refused() {
        for text in
            ["", "1.5", "1.5()", "(3)", "1.5(3", "1.5(-3)", "1.5(3)x", "1.5(3)e", "nan(1)", "1.2.3(4)", "1e5(3)"]
        {
            assert_eq!(text.parse::<Measurement>(), Err(Error::Notation { text: text.into() }), "{text}");
        }
        assert!(read("1(1)e999").is_none());
        assert!(read("--1(1)").is_none());
    }
}
