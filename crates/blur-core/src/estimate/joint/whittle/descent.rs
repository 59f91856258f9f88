//! The way to the maximum of the likelihood: which step to take next.

use nalgebra::Cholesky;

use super::likelihood::{Matrix, Vector};
use super::point::PARAMETERS;

/// Damping at first, and at least: a share of the diagonal. It grows and falls by these factors.
const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-6;
const MORE_DAMPING: f64 = 10.0;
const LESS_DAMPING: f64 = 0.2;
/// Shares of a step refused that are tried next, and steps refused one after the other that end a fit.
const LEAST_SHARE: f64 = 0.1;
const MOST_SHARE: f64 = 0.5;
const MOST_REFUSED: usize = 6;
/// Least curvature that is learnt, relative to that expected.
const LEAST_CURVATURE: f64 = 0.2;

/// What is known of the negative log-likelihood about the point that a fit has come to.
#[derive(Debug)]
pub(super) struct Descent<'a> {
    /// At first that expected, then what the gradients tell.
    curvature: Matrix,
    /// Whether what was last expected was so at the point itself.
    pub(super) is_fresh: bool,
    damping: f64,
    /// Share of a step that is taken.
    pub(super) share: f64,
    /// Steps refused since the last one that was taken.
    refused: usize,
    held: &'a [usize],
}

impl<'a> Descent<'a> {
    /// From a point of the `expected` curvature, where the parameters `held` stay what they are.
    pub(super) fn new(expected: &Matrix, held: &'a [usize]) -> Self {
        let mut descent =
            Self { curvature: *expected, is_fresh: true, damping: FIRST_DAMPING, share: 1.0, refused: 0, held };
        descent.renew(expected);
        descent
    }

    /// Forgets what was learnt for what is `expected` at the point.
    pub(super) fn renew(&mut self, expected: &Matrix) {
        self.curvature = *expected;
        self.is_fresh = true;
        for &i in self.held {
            self.curvature.row_mut(i).fill(0.0);
            self.curvature.column_mut(i).fill(0.0);
            self.curvature[(i, i)] = 1.0;
        }
    }

    /// `vector` without the parameters that are held.
    pub(super) fn free(&self, mut vector: Vector) -> Vector {
        for &i in self.held {
            vector[i] = 0.0;
        }
        vector
    }

    /// The step to take back from here.
    pub(super) fn step(&self, gradient: &Vector) -> Option<Vector> {
        let mut damped = self.curvature;
        for i in 0..PARAMETERS {
            damped[(i, i)] *= 1.0 + self.damping;
        }
        Some(Cholesky::new(damped)?.solve(gradient))
    }

    /// Makes the curvature along `moved` that by which the gradient has changed on the way.
    ///
    /// *Reference*: J. Nocedal and S. J. Wright, *Numerical Optimization*, 2006, procedure 18.2: the formula of Broyden,
    /// Fletcher, Goldfarb and Shanno, damped as by Powell, so that the curvature stays positive.
    pub(super) fn learn(&mut self, moved: &Vector, change: &Vector) {
        let expected = self.curvature * moved;
        let (along, mut told) = (moved.dot(&expected), moved.dot(change));
        if !(along > 0.0 && told.is_finite()) {
            return;
        }
        let mut change = *change;
        if told < LEAST_CURVATURE * along {
            let share = (1.0 - LEAST_CURVATURE) * along / (along - told);
            change = change * share + expected * (1.0 - share);
            told = moved.dot(&change);
        }
        self.curvature += change * change.transpose() / told - expected * expected.transpose() / along;
    }

    /// A step was taken.
    pub(super) fn accept(&mut self) {
        (self.refused, self.share, self.is_fresh) = (0, 1.0, false);
        self.damping = (self.damping * LESS_DAMPING).max(LEAST_DAMPING);
    }

    /// A step that has `gained` less than nothing, where its slope promised `slope`, was not taken: less of the next one will be,
    /// as much as is best along a parabola.
    pub(super) fn shorten(&mut self, gained: f64, slope: f64) {
        self.refused += 1;
        let promised = slope * self.share;
        self.share *= (0.5 * promised / (promised - gained)).clamp(LEAST_SHARE, MOST_SHARE);
    }

    /// A long step was not taken: the next one is to go where it is steep rather than far.
    pub(super) fn damp(&mut self) {
        self.refused += 1;
        self.damping *= MORE_DAMPING;
    }

    /// Whether no step was taken for long.
    pub(super) fn is_lost(&self) -> bool {
        self.refused == MOST_REFUSED
    }
}

#[cfg(test)]
mod tests {
    use super::super::point::{LENGTH, NOISE};
    use super::*;

    #[test]
    fn a_likelihood_that_curves_more_than_expected_is_followed_to_its_maximum() {
        // Along the noise nine times as much: steps by what is expected would lead further and further away.
        let expected = Matrix::from_diagonal(&Vector::from_fn(|i, _| 1.0 + i as f64));
        let mut true_curvature = expected;
        true_curvature[(NOISE, NOISE)] *= 9.0;
        true_curvature[(NOISE, NOISE + 2)] = 2.0;
        true_curvature[(NOISE + 2, NOISE)] = 2.0;
        let loss = |x: &Vector| 0.5 * x.dot(&(true_curvature * x));
        let mut at = Vector::from_element(1.0);
        let mut descent = Descent::new(&expected, &[LENGTH]);
        let mut steps = 0;
        while loss(&at) - 0.5 * expected[(LENGTH, LENGTH)] > 1e-9 {
            steps += 1;
            assert!(steps < 25 && !descent.is_lost(), "{at}");
            let gradient = descent.free(true_curvature * at);
            let step = descent.step(&gradient).unwrap();
            let next = at - step * descent.share;
            descent.learn(&(next - at), &(descent.free(true_curvature * next) - gradient));
            let gained = loss(&at) - loss(&next);
            if gained > 0.0 {
                at = next;
                descent.accept();
            } else {
                descent.shorten(gained, step.dot(&gradient));
            }
        }
        assert_eq!(at[LENGTH], 1.0);
    }

    #[test]
    fn a_step_refused_is_taken_in_part() {
        let mut descent = Descent::new(&Matrix::identity(), &[]);
        // Promised 2 and lost 2 along a parabola: its vertex is at a quarter of the step.
        descent.shorten(-2.0, 2.0);
        assert_eq!(descent.share, 0.25);
        descent.shorten(-1e9, 2.0);
        assert_eq!(descent.share, 0.25 * LEAST_SHARE);
        descent.accept();
        assert_eq!((descent.share, descent.is_fresh), (1.0, false));
        for _ in 0..MOST_REFUSED {
            assert!(!descent.is_lost());
            descent.shorten(-1.0, 1.0);
        }
        assert!(descent.is_lost());
    }
}
