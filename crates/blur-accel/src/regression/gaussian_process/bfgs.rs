//! Minimum of a smooth function of a few variables.

use nalgebra::{DMatrix, DVector};

/// The search ends where no part of the gradient is larger: the likelihood of a coordinate's unit change.
const FLAT: f64 = 1e-6;
/// Largest first try of a step in any coordinate, which is a logarithm: a factor of about 7.
const LARGEST: f64 = 2.0;
/// Shares of decrease and slope that a step must reach (Armijo, Wolfe).
const DECREASE: f64 = 1e-4;
const SLOPE: f64 = 0.9;
/// So many steps that gain no more than this together are a walk along the floor of a valley, where the parameters
/// cannot be told apart: a likelihood that changes by so little is evidence of nothing.
const PATIENCE: usize = 10;
const GAIN: f64 = 1e-6;
const MOST_STEPS: usize = 500;
const MOST_TRIES: usize = 60;

/// Where a search ended.
pub(super) struct Minimum {
    pub(super) at: DVector<f64>,
    pub(super) value: f64,
}

/// Where `function` has a minimum; `None` where it has no value at the `start`, or no end is found. The function gives
/// its value and gradient, or nothing where it is not defined. The search is also at its end where rounding hides all
/// further decrease, and where ten steps gain less than 1e-6.
///
/// *Reference*: Nocedal & Wright, *Numerical Optimization*, 2nd ed. 2006, algorithm 6.1; the step by bisection after
/// Lewis & Overton, Mathematical Programming 141 (2013) 135, algorithm 2.6.
pub(super) fn minimise(
    start: &DVector<f64>,
    mut function: impl FnMut(&DVector<f64>) -> Option<(f64, DVector<f64>)>,
) -> Option<Minimum> {
    let mut at = start.clone();
    let (mut value, mut gradient) = function(&at)?;
    let mut inverse = DMatrix::identity(at.len(), at.len());
    let mut fresh = true;
    let mut earlier = f64::INFINITY;
    for count in 0..MOST_STEPS {
        if gradient.amax() <= FLAT {
            return Some(Minimum { at, value });
        }
        if count % PATIENCE == 0 {
            if earlier - value < GAIN {
                return Some(Minimum { at, value });
            }
            earlier = value;
        }
        let mut direction = -(&inverse * &gradient);
        if direction.amax() > LARGEST {
            direction *= LARGEST / direction.amax();
        }
        let Some((step, next_value, next_gradient)) = line_search(&at, value, &gradient, &direction, &mut function)
        else {
            if fresh {
                return Some(Minimum { at, value });
            }
            // The curvature learnt so far may mislead: once more along the gradient.
            inverse.fill_with_identity();
            fresh = true;
            continue;
        };
        let change = &next_gradient - &gradient;
        at += &step;
        (value, gradient) = (next_value, next_gradient);
        let curvature = step.dot(&change);
        if curvature > 0.0 {
            if fresh {
                inverse *= curvature / change.norm_squared();
                fresh = false;
            }
            let product = &inverse * &change;
            let factor = (1.0 + change.dot(&product) / curvature) / curvature;
            inverse += factor * &step * step.transpose()
                - (&product * step.transpose() + &step * product.transpose()) / curvature;
        }
    }
    None
}

/// A step along `direction` with the value and gradient at its end; `None` where there is no decrease to be seen.
fn line_search(
    at: &DVector<f64>,
    value: f64,
    gradient: &DVector<f64>,
    direction: &DVector<f64>,
    function: &mut impl FnMut(&DVector<f64>) -> Option<(f64, DVector<f64>)>,
) -> Option<(DVector<f64>, f64, DVector<f64>)> {
    let slope = gradient.dot(direction);
    let (mut low, mut high, mut length) = (0.0, f64::INFINITY, 1.0);
    let mut best = None;
    for _ in 0..MOST_TRIES {
        let step = direction * length;
        match function(&(at + &step)) {
            Some((end, end_gradient)) if end < value + DECREASE * length * slope => {
                let steep = end_gradient.dot(direction) < SLOPE * slope;
                best = Some((step, end, end_gradient));
                if !steep {
                    return best;
                }
                low = length;
            }
            _ => high = length,
        }
        length = if high.is_finite() { f64::midpoint(low, high) } else { 2.0 * low };
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn valley_of_rosenbrock_is_followed_to_its_end() {
        let found = minimise(&DVector::from_vec(vec![-1.2, 1.0]), |at| {
            let (x, y) = (at[0], at[1]);
            let gradient = vec![-400.0 * x * (y - x * x) - 2.0 * (1.0 - x), 200.0 * (y - x * x)];
            Some((100.0 * (y - x * x).powi(2) + (1.0 - x).powi(2), DVector::from_vec(gradient)))
        });
        // The smallest curvature at (1, 1) is 0.4: a gradient of 1e-6 is at most 2.5e-6 away from it.
        assert!((found.unwrap().at - DVector::from_vec(vec![1.0, 1.0])).amax() < 2.5e-6);
    }

    #[test]
    fn search_stays_where_the_function_is_defined() {
        // x - ln x beyond 0 has its minimum at 1; the first step leads far below 0.
        let found = minimise(&DVector::from_vec(vec![4.0]), |at| {
            (at[0] > 0.0).then(|| (at[0] - at[0].ln(), DVector::from_vec(vec![1.0 - 1.0 / at[0]])))
        });
        assert!((found.unwrap().at[0] - 1.0).abs() < 1e-6);
    }
}
