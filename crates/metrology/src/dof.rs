//! Effective degrees of freedom.

use crate::Correlation;

/// Effective degrees of freedom of a sum of independent contributions, by the Welch-Satterthwaite formula.
///
/// Each pair is a contribution to the standard uncertainty (`sensitivity * std`) and its degrees of freedom; infinite
/// ones add nothing to the sum. The result is infinite if no contribution with finite degrees of freedom is left.
///
/// ```
/// // GUM H.1.6, in nm: 16.7 degrees of freedom.
/// let dof = metrology::welch_satterthwaite(&[(25.0, 18.0), (9.7, 25.6), (2.9, 50.0), (16.6, 2.0)]);
/// assert!((dof - 16.7).abs() < 0.1);
/// ```
///
/// # Reference
///
/// GUM G.4.1 eq. G.2b.
pub fn welch_satterthwaite(contributions: &[(f64, f64)]) -> f64 {
    let groups: Vec<_> = contributions.iter().map(|&(u, dof)| (u * u, dof)).collect();
    from_variances(&groups)
}

/// The same, for independent groups given by their variances.
fn from_variances(groups: &[(f64, f64)]) -> f64 {
    let total: f64 = groups.iter().map(|(variance, _)| variance).sum();
    if total <= 0.0 {
        return f64::INFINITY;
    }
    // Fractions of the whole, so that fourth powers of small units do not underflow.
    1.0 / groups.iter().map(|(variance, dof)| (variance / total).powi(2) / dof).sum::<f64>()
}

/// Effective degrees of freedom where inputs may be correlated.
///
/// Inputs that are correlated, directly or through others, form a group. The groups are independent of each other and
/// combined by [`welch_satterthwaite`], each with its own variance, covariances included. A group observed simultaneously
/// has one number of degrees of freedom, which is that of its combined contribution exactly; where they differ inside a
/// group, no formula holds and the smallest is taken.
///
/// # Reference
///
/// R. Willink, *Metrologia* 44 (2007) 340; as GTC does it.
pub(crate) fn effective(contributions: &[(f64, f64)], correlation: &Correlation) -> f64 {
    let mut done = vec![false; contributions.len()];
    let mut groups = Vec::new();
    for first in 0..contributions.len() {
        if done[first] {
            continue;
        }
        done[first] = true;
        let mut members = vec![first];
        let mut next = 0;
        while next < members.len() {
            for (j, done) in done.iter_mut().enumerate() {
                if !*done && correlation.get(members[next], j) != 0.0 {
                    *done = true;
                    members.push(j);
                }
            }
            next += 1;
        }
        let pairs = members.iter().flat_map(|&i| members.iter().map(move |&j| (i, j)));
        let variance: f64 = pairs.map(|(i, j)| contributions[i].0 * contributions[j].0 * correlation.get(i, j)).sum();
        // An input that contributes nothing has no say.
        let speaking = members.iter().filter(|&&i| contributions[i].0 != 0.0);
        let dof = speaking.fold(f64::INFINITY, |least, &i| least.min(contributions[i].1));
        groups.push((variance.max(0.0), dof));
    }
    from_variances(&groups)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_contributions_add_their_degrees_of_freedom() {
        assert!((welch_satterthwaite(&[(1.0, 4.0), (-1.0, 4.0), (1.0, 4.0)]) - 12.0).abs() < 1e-12);
    }

    #[test]
    fn infinite_degrees_of_freedom_only_dilute() {
        // u^4 / (1 / 5) with u^2 = 2.
        assert!((welch_satterthwaite(&[(1.0, 5.0), (1.0, f64::INFINITY)]) - 20.0).abs() < 1e-12);
        assert_eq!(welch_satterthwaite(&[(1.0, f64::INFINITY)]), f64::INFINITY);
        assert_eq!(welch_satterthwaite(&[(0.0, 3.0)]), f64::INFINITY);
        assert_eq!(welch_satterthwaite(&[]), f64::INFINITY);
    }

    #[test]
    fn tiny_units_do_not_underflow() {
        assert!((welch_satterthwaite(&[(1e-120, 3.0), (1e-120, 3.0)]) - 6.0).abs() < 1e-12);
    }

    #[test]
    fn simultaneous_observations_keep_their_degrees_of_freedom() {
        // Three quantities observed five times together have 4 degrees of freedom, whatever their correlations.
        let r = Correlation::from_pairs(4, &[(0, 1, -0.36), (1, 2, 0.2)]).unwrap();
        let together = [(1.0, 4.0), (2.0, 4.0), (0.5, 4.0), (0.0, 1.0)];
        assert!((effective(&together, &r) - 4.0).abs() < 1e-12);
        let independent = Correlation::independent(4);
        assert!((effective(&together, &independent) - welch_satterthwaite(&together)).abs() < 1e-12);
    }
}
