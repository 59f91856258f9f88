//! How strongly two series go together, and how well that is known.

use metrology::f_tail;
use serde::Serialize;

use super::statistics::Z_95;

/// A correlation coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coefficient {
    /// -1 to 1.
    pub value: f64,
    /// Lower end of its 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Probability of one as far from 0 in series that have nothing to do with each other.
    pub p: f64,
}

/// Pearson's coefficient of linear correlation of equally long series; `None` for fewer than four pairs, or when one series
/// is constant.
///
/// # Reference
/// Fisher, *Statistical Methods for Research Workers*: the interval by `atanh r`, of variance `1 / (n - 3)`, and the test
/// by Student's t of `n - 2` degrees of freedom.
pub fn pearson(x: &[f64], y: &[f64]) -> Option<Coefficient> {
    coefficient(x, y, x.len() as f64, |_| 1.0)
}

/// Spearman's coefficient of rank correlation: that of Pearson of the ranks, equal values sharing the mean of theirs.
///
/// # Reference
/// Bonett, Wright, *Sample size requirements for estimating Pearson, Kendall and Spearman correlations*, Psychometrika 65
/// (2000) 23: `atanh` of it has the variance `(1 + r^2 / 2) / (n - 3)`.
pub fn spearman(x: &[f64], y: &[f64]) -> Option<Coefficient> {
    coefficient(&ranks(x), &ranks(y), x.len() as f64, |r| 1.0 + 0.5 * r * r)
}

/// Pearson's coefficient of the deviations from the means of `groups`, one number of a group for each pair: what goes
/// together within groups, whatever differs between them. Every group but one costs a degree of freedom.
pub fn pearson_within(x: &[f64], y: &[f64], groups: &[usize]) -> Option<Coefficient> {
    let mut distinct = groups.to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    let n = (x.len() + 1).saturating_sub(distinct.len());
    coefficient(&deviations(x, groups), &deviations(y, groups), n as f64, |_| 1.0)
}

/// `widening` is what the variance of `atanh r` is larger by than that of normal numbers.
fn coefficient(x: &[f64], y: &[f64], n: f64, widening: impl Fn(f64) -> f64) -> Option<Coefficient> {
    let (x, y) = (deviations(x, &vec![0; x.len()]), deviations(y, &vec![0; y.len()]));
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scale = (sum(&x, &x) * sum(&y, &y)).sqrt();
    if n < 4.0 || scale <= 0.0 {
        return None;
    }
    let value = (sum(&x, &y) / scale).clamp(-1.0, 1.0);
    let half = Z_95 * (widening(value) / (n - 3.0)).sqrt();
    let end = |half: f64| (value.atanh() + half).tanh();
    // The square of t is an F of one degree of freedom in the numerator; it is infinite for a perfect correlation.
    let f = value * value * (n - 2.0) / (1.0 - value * value);
    Some(Coefficient {
        value,
        low: end(-half),
        high: end(half),
        p: if f.is_finite() { f_tail(f, 1, n - 2.0) } else { 0.0 },
    })
}

fn deviations(values: &[f64], groups: &[usize]) -> Vec<f64> {
    let mean = |group: usize| {
        let own: Vec<f64> = values.iter().zip(groups).filter(|(_, g)| **g == group).map(|(value, _)| *value).collect();
        own.iter().sum::<f64>() / own.len() as f64
    };
    values.iter().zip(groups).map(|(value, &group)| value - mean(group)).collect()
}

/// Ranks from 1; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let below = |value: f64| values.iter().filter(|&&other| other < value).count() as f64;
    let equal = |value: f64| values.iter().filter(|&&other| other == value).count() as f64;
    values.iter().map(|&value| below(value) + 0.5 * (equal(value) + 1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The series of `fixtures/correlation/make_correlation.py`.
    fn series(count: i64, share: i64, range: i64) -> (Vec<f64>, Vec<f64>) {
        let mut state = 20_240_607_i64;
        let mut next = || {
            state = state * 48271 % 2_147_483_647;
            state % range
        };
        (0..count)
            .map(|_| {
                let (a, b) = (next(), next());
                (a as f64, (share * a + b) as f64)
            })
            .unzip()
    }

    #[test]
    fn coefficients_are_those_of_scipy() {
        let golden = include_str!("../../../../fixtures/correlation/correlation.csv");
        let mut compared = 0;
        for line in golden.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let case: Vec<i64> = cells[0].split('x').map(|cell| cell.parse().unwrap()).collect();
            let (x, y) = series(case[0], case[1], case[2]);
            let (pearson, spearman) = (pearson(&x, &y).unwrap(), spearman(&x, &y).unwrap());
            let found = match cells[1] {
                "pearson" => pearson.value,
                "pearson_low" => pearson.low,
                "pearson_high" => pearson.high,
                "pearson_p" => pearson.p,
                "spearman" => spearman.value,
                _ => spearman.p,
            };
            let expected: f64 = cells[2].parse().unwrap();
            // Of p-values the relative error counts, down to the smallest.
            assert!((found - expected).abs() < 1e-9 * expected.abs(), "{line}: {found}");
            assert!(spearman.low < spearman.value && spearman.value < spearman.high);
            compared += 1;
        }
        assert_eq!(compared, 4 * 6);
    }

    #[test]
    fn what_differs_between_groups_does_not_count_within() {
        // In each group y falls as x rises; the second group is higher in both.
        let (x, y) = ([0.0, 1.0, 2.0, 10.0, 11.0, 12.0], [2.0, 1.0, 0.0, 12.0, 11.0, 10.0]);
        assert!(pearson(&x, &y).unwrap().value > 0.9);
        let within = pearson_within(&x, &y, &[0, 0, 0, 1, 1, 1]).unwrap();
        assert!((within.value + 1.0).abs() < 1e-12 && within.p < 1e-6, "{within:?}");
    }

    #[test]
    fn nothing_is_said_of_constants_and_of_three_pairs() {
        assert_eq!(pearson(&[1.0; 9], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]), None);
        assert_eq!(spearman(&[1.0, 2.0, 3.0], &[1.0, 2.0, 4.0]), None);
    }
}
