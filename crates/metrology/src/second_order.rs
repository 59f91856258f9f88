use crate::propagate::jacobian;
use crate::{Dual, Error, Input, values_of};

/// Step of the differences, as a part of the standard uncertainty: small against the curvature, large against rounding.
const STEP: f64 = 0.1;

/// Standard uncertainty with the terms of the next order, for independent inputs distributed symmetrically about their
/// estimates: it tells whether a model is straight enough for [`propagate`](crate::propagate()).
///
/// The first derivatives are exact, their changes are taken by differences over a tenth of a standard uncertainty.
///
/// ```
/// // y = x^2 at 0: first order says 0, the truth for a normal x is sqrt(2) u^2.
/// let x = [metrology::Input::new("x", 0.0, 0.1)?];
/// let u = metrology::second_order_std(&x, |q| q[0] * q[0])?;
/// assert!((u - 2.0_f64.sqrt() * 0.01).abs() < 1e-12);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// GUM 5.1.2, note: `sum_i (f_i u_i)^2 + sum_ij (f_ij^2 / 2 + f_i f_ijj) u_i^2 u_j^2`, which holds for normal inputs.
pub fn second_order_std(inputs: &[Input], model: impl Fn(&[Dual]) -> Dual) -> Result<f64, Error> {
    let gradient = |at: &[f64]| {
        // A derivative may be finite where the model has no value.
        let value = values_of(&model)(at);
        let [row] = jacobian(|q| [model(q)], at);
        if value.is_finite() { Ok(row) } else { Err(Error::ModelNotFinite { value }) }
    };
    let mut at: Vec<f64> = inputs.iter().map(Input::value).collect();
    let here = gradient(&at)?;
    let first: f64 = here.iter().zip(inputs).map(|(slope, x)| (slope * x.std()).powi(2)).sum();
    let mut second = 0.0;
    for (j, moved) in inputs.iter().enumerate() {
        let step = STEP * moved.std();
        // An input without uncertainty, or with one below the digits of its estimate, moves nothing.
        if moved.value() + step == moved.value() {
            continue;
        }
        at[j] = moved.value() + step;
        let above = gradient(&at)?;
        at[j] = moved.value() - step;
        let below = gradient(&at)?;
        at[j] = moved.value();
        for (i, x) in inputs.iter().enumerate() {
            // f_ij u_j and f_ijj u_j^2.
            let change = (above[i] - below[i]) / (2.0 * STEP);
            let bend = (above[i] - 2.0 * here[i] + below[i]) / (STEP * STEP);
            second += (0.5 * change * change + here[i] * bend) * x.std() * x.std();
        }
    }
    let variance = first + second;
    if !variance.is_finite() {
        return Err(Error::ModelNotFinite { value: variance });
    }
    Ok(variance.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_has_the_variance_of_a_cubed_normal_to_fourth_order() {
        // Moments of (1 + u z)^3: 9 u^2 + 36 u^4 + 15 u^6, of which the last term is of the order left out.
        let u = 0.05_f64;
        let x = [Input::new("x", 1.0, u).unwrap()];
        let variance = second_order_std(&x, |q| q[0].powi(3)).unwrap().powi(2);
        let expected = 9.0 * u.powi(2) + 36.0 * u.powi(4);
        assert!((variance - expected).abs() < 15.0 * u.powi(6), "{variance} {expected}");
    }

    #[test]
    fn a_straight_model_gains_nothing() {
        let x = [Input::new("a", 1e9, 1e-9).unwrap(), Input::new("b", -2.0, 0.3).unwrap()];
        let std = second_order_std(&x, |q| q[0] + 2.0 * q[1]).unwrap();
        assert!((std - 0.6).abs() < 1e-12, "{std}");
        assert!(second_order_std(&x, |q| q[1].ln()).is_err());
    }
}
