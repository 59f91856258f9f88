//! Several outputs of one model (JCGM 102).

use crate::error::{check, probability};
use crate::propagate::jacobian;
use crate::{Combined, Correlation, Dual, Error, Input, chi_squared_quantile};

/// Estimates of several outputs with their covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    outputs: Vec<Combined>,
    /// Row-major.
    covariance: Vec<f64>,
}

/// Propagates inputs through a model of `M` outputs, first order: `U_y = C U_x C^T` with the Jacobian `C`.
///
/// ```
/// use metrology::{Correlation, Input, propagate_joint};
///
/// // Sum and difference of two equally uncertain inputs are uncorrelated.
/// let inputs = [Input::new("a", 3.0, 0.1)?, Input::new("b", 2.0, 0.1)?];
/// let joint = propagate_joint(&inputs, &Correlation::independent(2), |q| [q[0] + q[1], q[0] - q[1]])?;
/// assert_eq!(joint.output(0)?.value(), 5.0);
/// assert!(joint.correlation(0, 1)?.abs() < 1e-15);
/// # Ok::<(), metrology::Error>(())
/// ```
///
/// # Reference
///
/// JCGM 102 6.2.1.3 eq. 3; GUM H.2.
pub fn propagate_joint<const M: usize>(
    inputs: &[Input],
    correlation: &Correlation,
    model: impl Fn(&[Dual]) -> [Dual; M],
) -> Result<Joint, Error> {
    let at: Vec<f64> = inputs.iter().map(Input::value).collect();
    let constants: Vec<Dual> = at.iter().map(|&x| Dual::constant(x)).collect();
    let values = model(&constants).map(Dual::value);
    let rows = jacobian(model, &at);
    let outputs: Vec<Combined> = values
        .into_iter()
        .zip(rows)
        .map(|(value, row)| Combined::new(inputs, correlation, value, row))
        .collect::<Result<_, _>>()?;
    let mut covariance = Vec::with_capacity(M * M);
    for a in &outputs {
        for b in &outputs {
            let terms = a.contributions().iter().enumerate().map(|(i, x)| {
                x * b.contributions().iter().enumerate().map(|(j, y)| correlation.get(i, j) * y).sum::<f64>()
            });
            covariance.push(terms.sum());
        }
    }
    Ok(Joint { outputs, covariance })
}

impl Joint {
    /// Output `i` with its own budget.
    pub fn output(&self, i: usize) -> Result<&Combined, Error> {
        self.outputs.get(i).ok_or(Error::Index { index: i, count: self.outputs.len() })
    }

    /// All outputs in their order.
    pub fn outputs(&self) -> &[Combined] {
        &self.outputs
    }

    /// Covariance of outputs `i` and `j`.
    pub fn covariance(&self, i: usize, j: usize) -> Result<f64, Error> {
        self.output(i.max(j))?;
        Ok(self.covariance[i * self.outputs.len() + j])
    }

    /// Correlation coefficient of outputs `i` and `j`; 0 where one of them is exact.
    pub fn correlation(&self, i: usize, j: usize) -> Result<f64, Error> {
        let scale = self.output(i)?.std() * self.output(j)?.std();
        let covariance = self.covariance(i, j)?;
        if i == j {
            return Ok(1.0);
        }
        Ok(if scale > 0.0 { (covariance / scale).clamp(-1.0, 1.0) } else { 0.0 })
    }

    /// Correlation matrix, for the next model.
    pub fn correlations(&self) -> Result<Correlation, Error> {
        let mut pairs = Vec::new();
        for i in 0..self.outputs.len() {
            for j in i + 1..self.outputs.len() {
                pairs.push((i, j, self.correlation(i, j)?));
            }
        }
        Correlation::from_pairs(self.outputs.len(), &pairs)
    }

    /// Ellipse around outputs `i` (abscissa) and `j` (ordinate) for a coverage factor of [`ellipse_factor`] or
    /// [`ellipse_factor_with_dof`].
    ///
    /// # Reference
    ///
    /// JCGM 102 6.5.2.3 and 6.5.2.4.
    pub fn ellipse(&self, i: usize, j: usize, coverage_k: f64) -> Result<Ellipse, Error> {
        check(coverage_k.is_finite() && coverage_k > 0.0, "coverage factor", coverage_k, "finite and greater than 0")?;
        let (a, b, c) = (self.covariance(i, i)?, self.covariance(i, j)?, self.covariance(j, j)?);
        // Eigenvalues of [[a, b], [b, c]]; the smaller one by the determinant, which does not cancel as much.
        let large = f64::midpoint(a, c) + f64::hypot((a - c) / 2.0, b);
        let small = if large > 0.0 { ((a * c - b * b) / large).max(0.0) } else { 0.0 };
        Ok(Ellipse {
            center: [self.output(i)?.value(), self.output(j)?.value()],
            semi_major: coverage_k * large.sqrt(),
            semi_minor: coverage_k * small.sqrt(),
            angle_rad: 0.5 * (2.0 * b).atan2(a - c),
        })
    }
}

/// A coverage region for two outputs; the outputs should have one unit if its axes are to have a meaning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// The estimates.
    pub center: [f64; 2],
    /// Longer semi-axis.
    pub semi_major: f64,
    /// Shorter semi-axis, 0 where the outputs are fully correlated.
    pub semi_minor: f64,
    /// Angle of the longer axis from the abscissa, -pi/2..=pi/2 radians.
    pub angle_rad: f64,
}

impl Ellipse {
    /// Whether a point is inside or on the ellipse.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        let (dx, dy) = (point[0] - self.center[0], point[1] - self.center[1]);
        let (sin, cos) = self.angle_rad.sin_cos();
        let (along, across) = (cos * dx + sin * dy, cos * dy - sin * dx);
        let radius = |d: f64, axis: f64| if d == 0.0 { 0.0 } else { d / axis };
        radius(along, self.semi_major).hypot(radius(across, self.semi_minor)) <= 1.0
    }
}

/// Coverage factor of an ellipse of a probability in (0, 1) for two normal outputs: `sqrt(-2 ln(1 - p))`.
///
/// ```
/// assert!((metrology::joint::ellipse_factor(0.95)? - 2.45).abs() < 0.005); // JCGM 102 6.5.2.3
/// # Ok::<(), metrology::Error>(())
/// ```
pub fn ellipse_factor(probability: f64) -> Result<f64, Error> {
    Ok((-2.0 * (-self::probability(probability)?).ln_1p()).sqrt())
}

/// The same where covariances come from simultaneous observations with `dof` degrees of freedom, greater than 1, as in
/// GUM H.2: `sqrt(2 dof / (dof - 1) F_p(2, dof - 1)) = sqrt(dof ((1 - p)^(-2 / (dof - 1)) - 1))`.
///
/// # Reference
///
/// Hotelling's T squared for two variables, Anderson, *An Introduction to Multivariate Statistical Analysis*, 5.3.
pub fn ellipse_factor_with_dof(probability: f64, dof: f64) -> Result<f64, Error> {
    check(dof > 1.0, "degrees of freedom", dof, "greater than 1")?;
    if dof.is_infinite() {
        return ellipse_factor(probability);
    }
    let exponent = -2.0 / (dof - 1.0) * (-self::probability(probability)?).ln_1p();
    Ok((dof * exponent.exp_m1()).sqrt())
}

/// Coverage factor of a hyper-ellipsoid of a probability in (0, 1) for `outputs` (1 to 1000) normal outputs: the root of
/// the quantile of chi squared (JCGM 102 6.5.2.3).
pub fn ellipsoid_factor(probability: f64, outputs: usize) -> Result<f64, Error> {
    check((1..=1000).contains(&outputs), "number of outputs", outputs as f64, "in 1..=1000")?;
    Ok(chi_squared_quantile(probability, outputs as f64)?.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_of_jcgm_102_table_1() {
        // p = 0.95 for 2 outputs 2.45, 3 outputs 2.80.
        assert!((ellipsoid_factor(0.95, 2).unwrap() - ellipse_factor(0.95).unwrap()).abs() < 1e-12);
        assert!((ellipsoid_factor(0.95, 3).unwrap() - 2.80).abs() < 0.005);
        assert!((ellipsoid_factor(0.95, 1).unwrap() - 1.96).abs() < 0.005);
        let many = ellipse_factor_with_dof(0.95, 1e9).unwrap();
        assert!((many - ellipse_factor(0.95).unwrap()).abs() < 1e-7);
    }

    #[test]
    fn an_ellipse_turns_with_the_correlation() {
        let inputs = [Input::new("a", 1.0, 2.0).unwrap(), Input::new("b", 1.0, 1.0).unwrap()];
        let turned = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let model = |q: &[Dual]| [cos * q[0] - sin * q[1], sin * q[0] + cos * q[1]];
            propagate_joint(&inputs, &Correlation::independent(2), model).unwrap().ellipse(0, 1, 1.5).unwrap()
        };
        for angle in [-1.2, 0.0, 0.3, 1.5] {
            let e = turned(angle);
            assert!((e.semi_major - 3.0).abs() < 1e-14 && (e.semi_minor - 1.5).abs() < 1e-14);
            assert!((e.angle_rad - angle).abs() < 1e-14, "{angle}");
            let tip = |r: f64| [e.center[0] + r * angle.cos(), e.center[1] + r * angle.sin()];
            assert!(e.contains(tip(2.999)) && !e.contains(tip(3.001)));
        }
    }
}
