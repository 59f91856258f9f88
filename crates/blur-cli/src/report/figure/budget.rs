//! The uncertainty budget of the speed, or of the angular rate of a camera that turned.

use std::fmt::Write;

use blur_core::motion::COVERAGE_K;
use metrology::{Budget, Correlation, Coverage, Dual, Input, propagate};

use super::headline::split;
use crate::Result;
use crate::camera::seen;
use crate::report::html::{Figure, Text};
use crate::report::section::Subject;
use crate::text::significant;

const SPEED: &str = "Uncertainty budget of the speed";
const RATE: &str = "Uncertainty budget of the angular rate";

/// A quantity as a product of powers of its inputs.
struct Equation {
    title: &'static str,
    name: &'static str,
    /// Its symbol and formula.
    formula: &'static str,
    unit: &'static str,
    inputs: Vec<Input>,
    /// Power of each input.
    powers: &'static [i32],
    /// What is worth knowing of the inputs.
    note: &'static str,
}

/// The table of what each input contributes.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let has_rate = subject.record.camera.is_some_and(|camera| camera.rate.is_some());
    let equation = if has_rate { rate(subject)? } else { speed(subject)? };
    Ok(match equation {
        Ok(equation) => table(&equation)?,
        Err(why) => {
            let title = if subject.options.rotating { RATE } else { SPEED };
            Figure { is_wide: true, ..Figure::absent(title, why) }
        }
    })
}

/// The speed from blur, scale and exposure, or why there is none.
fn speed(subject: &Subject<'_>) -> Result<std::result::Result<Equation, &'static str>> {
    let record = subject.record;
    let (Some(_), Some(exposure_s)) = (record.speed_m_s, record.exposure_s) else {
        return Ok(Err(if subject.options.rotating {
            "There is no angular rate: it needs a motion, an exposure time and a focal length (--exposure, --camera)."
        } else {
            "There is no speed: it needs a motion, an exposure time and a scale (--exposure; --scale, or --camera with \
             --distance)."
        }));
    };
    let Some(length_std) = record.length_std_px else {
        return Ok(Err("The method states no uncertainty of the length, so the speed has none."));
    };
    let length = Input::new("blur length L", record.length_px, length_std)?.with_unit("px");
    let exposure = Input::new("exposure time T", exposure_s, subject.options.exposure_std_s)?.with_unit("s");
    let of_camera = record.camera.and_then(|camera| camera.scale_m_per_px.zip(camera.scale_std_m_per_px));
    Ok(match (of_camera, subject.options.distance_m, subject.options.scale) {
        (Some((scale, scale_std)), Some(distance), _) => {
            // The scale is n / f: what of its uncertainty is not the distance's is that of the focal length.
            let focal_length = distance.value() / scale;
            let share = (scale_std / scale).powi(2) - (distance.std() / distance.value()).powi(2);
            Ok(Equation {
                title: SPEED,
                name: "v",
                formula: "speed v = n L / (f T)",
                unit: "m/s",
                inputs: vec![
                    length,
                    Input::new("focal length f", focal_length, focal_length * share.max(0.0).sqrt())?.with_unit("px"),
                    Input::new("distance n", distance.value(), distance.std())?.with_unit("m"),
                    exposure,
                ],
                powers: &[1, -1, 1, -1],
                note: " The focal length is the one that counts at this place of the picture along this direction: the \
                       distortion of the lens and the uncertainty of the direction are in it.",
            })
        }
        (_, _, Some(scale)) => {
            let scale = scale.m_per_px();
            Ok(Equation {
                title: SPEED,
                name: "v",
                formula: "speed v = k L / T",
                unit: "m/s",
                inputs: vec![length, Input::new("scale k", scale.value(), scale.std())?.with_unit("m/px"), exposure],
                powers: &[1, 1, -1],
                note: "",
            })
        }
        _ => Err("The scale of the speed is not known."),
    })
}

/// The angular rate from blur, focal length and exposure, or why there is none.
fn rate(subject: &Subject<'_>) -> Result<std::result::Result<Equation, &'static str>> {
    let (record, options) = (subject.record, subject.options);
    // Once as it was found, and once as if the blur were exact: what is left is the camera's.
    let turn = |blur| -> Result<_> {
        let seen = seen::seen(options.camera.as_ref(), subject.picture, subject.centre_px, blur)?;
        Ok(seen.map(|seen| seen.ideal.turn_rad()).transpose()?)
    };
    let mut exact = *subject.blur;
    (exact.length_std_px, exact.angle_std_deg) = (None, None);
    let (Some(whole), Some(of_camera), Some(exposure_s)) = (turn(subject.blur)?, turn(&exact)?, record.exposure_s)
    else {
        return Ok(Err("There is no angular rate: no focal length is known."));
    };
    if record.length_std_px.is_none() {
        return Ok(Err("The method states no uncertainty of the length, so the angular rate has none."));
    }
    let turn_rad = whole.value();
    let by_blur = (whole.std().powi(2) - of_camera.std().powi(2)).max(0.0).sqrt();
    let (length, focal_length) = (record.length_px, record.length_px / turn_rad);
    Ok(Ok(Equation {
        title: RATE,
        name: "w",
        formula: "angular rate \u{3c9} = L / (f T)",
        unit: "rad/s",
        inputs: vec![
            Input::new("blur length L", length, length * by_blur / turn_rad)?.with_unit("px"),
            Input::new("focal length f", focal_length, focal_length * of_camera.std() / turn_rad)?.with_unit("px/rad"),
            Input::new("exposure time T", exposure_s, options.exposure_std_s)?.with_unit("s"),
        ],
        powers: &[1, -1, -1],
        note: " The focal length is the one that counts at this place of the picture along this direction, in pixels for each \
               radian of the turn; the uncertainty of the direction is in that of the length.",
    }))
}

fn table(equation: &Equation) -> Result<Figure> {
    let Equation { title, name, formula, unit, inputs, powers, note } = equation;
    let combined = propagate(inputs, &Correlation::independent(inputs.len()), |q| {
        q.iter().zip(*powers).fold(Dual::constant(1.0), |product, (value, &power)| product * value.powi(power))
    })?;
    let budget = Budget::new(*name, *unit, inputs, &combined, Coverage::Factor(COVERAGE_K))?;
    let mut rows = String::new();
    for row in &budget.rows {
        let (value, std) = rounded(row.value, row.std);
        let unit = Text(&row.unit);
        // A share of -0 is 0.
        let share = row.share + 0.0;
        // Writing to a String cannot fail.
        let _ = write!(
            rows,
            "<tr><th scope=\"row\">{}</th><td>{value}&nbsp;{unit}</td><td>{std}&nbsp;{unit}</td><td>{}</td><td>{}</td><td>\
             {:.1}&nbsp;% <meter min=\"0\" max=\"1\" value=\"{:.4}\"></meter></td></tr>",
            Text(&row.label),
            significant(row.sensitivity, 4).replace('-', "\u{2212}"),
            significant(row.contribution, 2),
            100.0 * share,
            share,
        );
    }
    let (value, std) = rounded(budget.value, budget.std);
    let content = format!(
        "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">Quantity</th><th scope=\"col\">Value</th>\
         <th scope=\"col\">Standard uncertainty</th><th scope=\"col\">Sensitivity, {unit} per unit</th><th scope=\"col\">\
         Contribution, {unit}</th><th scope=\"col\">Share</th></tr></thead><tbody>{rows}</tbody><tfoot><tr><th scope=\"row\">\
         {formula}</th><td>{value}&nbsp;{unit}</td><td>{std}&nbsp;{unit}</td><td colspan=\"3\">expanded (k = {COVERAGE_K}): \
         {}&nbsp;{unit}</td></tr></tfoot></table></div>",
        rounded(budget.value, budget.expanded).1
    );
    Ok(Figure {
        title,
        content,
        caption: format!(
            "Where the uncertainty comes from (GUM, first order, independent inputs): each contribution is the sensitivity times \
             the standard uncertainty, and the contributions add in squares. The largest share is what is worth improving. An \
             uncertainty of 0 means that the input was taken as exact.{note}"
        ),
        is_wide: true,
    })
}

/// A value to the decimals of its uncertainty, and the uncertainty; an exact value with all its digits.
fn rounded(value: f64, std: f64) -> (String, String) {
    if std > 0.0 { split(value, Some(std), 0) } else { (significant(value, 8), String::from("0")) }
}
