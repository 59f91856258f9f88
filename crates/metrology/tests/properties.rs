//! Properties over random inputs.
#![allow(clippy::unwrap_used, reason = "a property that cannot be computed fails the test")]

use metrology::{
    Correlation, Dual, Input, Measurement, concise, propagate, propagate_numeric, sensitivities, sensitivities_numeric,
    student_t_quantile, values_of,
};
use proptest::prelude::*;

/// Every function of `Dual` once, within its domain for positive arguments.
const FUNCTIONS: [fn(&[Dual]) -> Dual; 14] = [
    |q| q[0] + q[1] * q[2],
    |q| 2.0 - q[0] / q[1],
    |q| 3.0 / (q[0] - 10.0 - q[1] * 1.5),
    |q| q[0].powi(-3) * q[1].powi(2),
    |q| q[0].powf(1.7) + 1.0 * q[2].powf(-0.5),
    |q| (q[0] * q[1]).sqrt(),
    |q| (q[0] - q[1]).exp(),
    |q| (q[0] / q[2]).ln(),
    |q| q[0].sin() * q[1].cos(),
    |q| (q[0] * 0.1).tan(),
    |q| q[0].atan2(q[1] - 7.0),
    |q| q[0].atan2(-2.0),
    |q| (-q[0] - 1.0).abs(),
    |q| [q[0], q[1], q[2] * q[0]].into_iter().sum(),
];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn dual_derivatives_are_those_of_differences(x in prop::array::uniform3(0.5..5.0_f64), which in 0..FUNCTIONS.len()) {
        let model = FUNCTIONS[which];
        let exact = sensitivities(model, &x);
        let numeric = sensitivities_numeric(values_of(model), &x, &x.map(|x| 6e-6 * x)).unwrap();
        for (a, b) in exact.iter().zip(&numeric) {
            // Truncation and rounding are both about eps^(2/3) = 4e-11 of the function and its third derivative.
            let size = 1.0 + a.abs() + values_of(model)(&x).abs();
            prop_assert!((a - b).abs() < 1e-6 * size, "{which}: {a} {b}");
        }
    }

    #[test]
    fn derivatives_of_either_kind_give_the_same_uncertainty(
        x in prop::array::uniform3(0.5..5.0_f64),
        u in prop::array::uniform3(0.001..0.1_f64),
        r in -0.99..0.99_f64,
        which in 0..FUNCTIONS.len(),
    ) {
        let inputs: Vec<Input> = (0..3).map(|i| Input::new("x", x[i], u[i]).unwrap().with_dof(5.0).unwrap()).collect();
        let correlation = Correlation::from_pairs(3, &[(0, 1, r)]).unwrap();
        let exact = propagate(&inputs, &correlation, FUNCTIONS[which]).unwrap();
        let numeric = propagate_numeric(&inputs, &correlation, values_of(FUNCTIONS[which])).unwrap();
        prop_assert!((exact.std() - numeric.std()).abs() < 1e-5 * (exact.std() + 0.1 * exact.value().abs() + 0.1));
        let shares: f64 = exact.shares().iter().sum();
        prop_assert!(exact.std() == 0.0 || (shares - 1.0).abs() < 1e-9);
        prop_assert!(exact.dof() >= 5.0 - 1e-9);
    }

    #[test]
    fn concise_notation_comes_back(value in -1e6..1e6_f64, scale in -12..12_i32, relative in 1e-9..1e3_f64, digits in 1..6_usize) {
        let value = value * 10.0_f64.powi(scale);
        let std = relative * value.abs().max(1e-12);
        let text = concise(Measurement::new(value, std).unwrap(), digits);
        let read: Measurement = text.parse().unwrap();
        // Rounded by at most half a unit of the last digit of the uncertainty, which is at most 10^(1 - digits) of it.
        let unit = 10.0_f64.powi(1 - digits as i32) * std;
        prop_assert!((read.value() - value).abs() <= 0.5001 * unit, "{text}");
        prop_assert!((read.std() - std).abs() <= 0.5001 * unit, "{text}");
        // What was read is what was written, digit by digit: rounding once more changes nothing. A carry to 10 leaves
        // one digit less to print.
        let again = concise(read, digits);
        prop_assert_eq!(&again, &text);
    }

    #[test]
    fn an_exact_value_comes_back_as_it_was(value in prop::num::f64::NORMAL) {
        let read: Measurement = concise(Measurement::exact(value).unwrap(), 2).parse().unwrap();
        prop_assert_eq!((read.value(), read.std()), (value, 0.0));
    }

    #[test]
    fn any_text_is_read_or_refused(text in "[-+0-9.()eE ]{0,12}") {
        let _ = text.parse::<Measurement>();
    }

    #[test]
    fn student_t_quantiles_rise_with_probability_and_are_odd(p in 0.0001..0.4999_f64, dof in 0.5..1e6_f64) {
        let (t, next) = (student_t_quantile(p, dof).unwrap(), student_t_quantile(p + 1e-4, dof).unwrap());
        prop_assert!(t < next);
        prop_assert!((t + student_t_quantile(1.0 - p, dof).unwrap()).abs() < 1e-9 * t.abs());
    }
}
