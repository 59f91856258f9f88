//! Quantiles of the distributions that coverage factors come from, and the tail that tests need.

mod beta;
mod chi_squared;
mod f;
mod normal;
mod student_t;

pub use chi_squared::chi_squared_quantile;
pub use f::f_tail;
pub use normal::normal_quantile;
pub use student_t::student_t_quantile;

/// Relative change at which an iteration ends.
const CONVERGED: f64 = 1e-15;
/// Quadratic convergence needs fewer than ten steps; bisection of any bracket of finite numbers fewer than these.
const MAX_STEPS: usize = 200;

/// Solves `f(x) = target` for a positive `x`, with `f` positive and monotonic: `f` gives its value and the derivative
/// of its logarithm by the logarithm of `x`. Newton's method in these logarithms, where tails are nearly straight,
/// kept inside a bracket. `None` if the numbers of the machine do not reach far enough.
fn solve_positive(f: impl Fn(f64) -> (f64, f64), target: f64, guess: f64, increasing: bool) -> Option<f64> {
    let (mut low, mut high) = (0.0_f64, f64::INFINITY);
    let mut x = guess;
    for _ in 0..MAX_STEPS {
        let (value, log_slope) = f(x);
        if (value > target) == increasing {
            high = x;
        } else {
            low = x;
        }
        let newton = x * ((target / value).ln() / log_slope).exp();
        let next = if newton > low && newton < high {
            newton
        } else if high.is_infinite() {
            2.0 * x
        } else {
            f64::midpoint(low, high)
        };
        if (next - x).abs() <= CONVERGED * x {
            return next.is_finite().then_some(next);
        }
        x = next;
    }
    None
}
