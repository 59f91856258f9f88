//! Least squares against the certified values of the NIST Statistical Reference Datasets.
//!
//! The files are those of <https://www.itl.nist.gov/div898/strd/lls/lls.shtml>, in `nist_strd` of the data folder. The log
//! relative error of q against the certified c is `-log10(|q - c| / |c|)`; certified values have 15 digits, so more than 15
//! is not counted.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use e2e_tests::data;
use metrology::least_squares::{Design, Fit, ordinary};
use nalgebra::DMatrix;

/// The digits of the certified values.
const MOST_DIGITS: f64 = 15.0;

/// The digits that are promised. Wampler2 and Pontius come nearest: their decimals are not doubles, and what is fitted is not
/// quite what was certified.
const DIGITS: f64 = 13.0;

struct Set {
    name: &'static str,
    /// Highest power of the only x, or `None` for as many x as the file has.
    degree: Option<usize>,
    constant: bool,
}

const SETS: [Set; 11] = [
    Set { name: "Norris", degree: Some(1), constant: true },
    Set { name: "Pontius", degree: Some(2), constant: true },
    Set { name: "NoInt1", degree: None, constant: false },
    Set { name: "NoInt2", degree: None, constant: false },
    Set { name: "Filip", degree: Some(10), constant: true },
    Set { name: "Longley", degree: None, constant: true },
    Set { name: "Wampler1", degree: Some(5), constant: true },
    Set { name: "Wampler2", degree: Some(5), constant: true },
    Set { name: "Wampler3", degree: Some(5), constant: true },
    Set { name: "Wampler4", degree: Some(5), constant: true },
    Set { name: "Wampler5", degree: Some(5), constant: true },
];

/// Certified values and data of a file.
#[derive(Default)]
struct Certified {
    coefficients: Vec<f64>,
    std_errors: Vec<f64>,
    residual_std: f64,
    r_squared: f64,
    y: Vec<f64>,
    x: Vec<Vec<f64>>,
}

fn read(path: &Path) -> Certified {
    let text = std::fs::read_to_string(path).unwrap();
    let mut certified = Certified::default();
    for (index, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let numbers: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
        // Every file has its data from line 61 on; above, it says so itself.
        match words.as_slice() {
            _ if index >= 60 && !numbers.is_empty() => {
                certified.y.push(numbers[0]);
                certified.x.push(numbers[1..].to_vec());
            }
            [name, _, _] if index >= 30 && name.starts_with('B') && numbers.len() == 2 => {
                certified.coefficients.push(numbers[0]);
                certified.std_errors.push(numbers[1]);
            }
            ["Standard", "Deviation", _] => certified.residual_std = numbers[0],
            ["R-Squared", _] => certified.r_squared = numbers[0],
            _ => {}
        }
    }
    certified
}

fn fit(set: &Set, certified: &Certified) -> Fit {
    let design = if let Some(degree) = set.degree {
        let x: Vec<f64> = certified.x.iter().map(|row| row[0]).collect();
        Design::polynomial(&x, degree)
    } else {
        let first = usize::from(set.constant);
        let columns = certified.x[0].len() + first;
        let element = |i: usize, j: usize| if j < first { 1.0 } else { certified.x[i][j - first] };
        DMatrix::from_fn(certified.y.len(), columns, element).into()
    };
    ordinary(&design, &certified.y).unwrap()
}

fn digits(found: f64, certified: f64) -> f64 {
    (-((found - certified) / certified).abs().log10()).min(MOST_DIGITS)
}

#[test]
fn certified_values_are_reproduced() {
    let Some(folder) = data::folder() else { return };
    println!("set        coefficients  standard errors  residual std  R^2   (digits)");
    for set in &SETS {
        let certified = read(&folder.join("nist_strd").join(format!("{}.dat", set.name)));
        let fit = fit(set, &certified);
        assert_eq!(fit.coefficients.len(), certified.coefficients.len(), "{}", set.name);
        let least = |pairs: &mut dyn Iterator<Item = (&f64, &f64)>| {
            pairs.map(|(&found, &certified)| digits(found, certified)).fold(MOST_DIGITS, f64::min)
        };
        let coefficients = least(&mut fit.coefficients.iter().zip(&certified.coefficients));
        let r_squared = if set.constant { fit.r_squared } else { fit.r_squared_about_zero };
        let r_squared = digits(r_squared, certified.r_squared);
        let std_errors = fit.std_errors_posterior();
        let (std_digits, residual_digits) = if certified.residual_std == 0.0 {
            // An exact fit: nothing to be relative to. The decimals of y are not doubles, so what is fitted is off by up to
            // half a unit in the last place of each y; of that at most all is left as residuals.
            let bound = certified.y.iter().map(|y| (y * f64::EPSILON / 2.0).powi(2)).sum::<f64>().sqrt();
            assert!(fit.chi2.sqrt() <= bound, "{}: residuals {:e}, bound {bound:e}", set.name, fit.chi2.sqrt());
            for (found, unit) in std_errors.iter().zip(&fit.std_errors_prior()) {
                assert!(*found <= bound / (fit.dof as f64).sqrt() * unit, "{}: {found:e}", set.name);
            }
            (f64::NAN, f64::NAN)
        } else {
            (
                least(&mut std_errors.iter().zip(&certified.std_errors)),
                digits(fit.residual_std(), certified.residual_std),
            )
        };
        println!("{:10} {coefficients:12.1}  {std_digits:15.1}  {residual_digits:12.1}  {r_squared:4.1}", set.name);
        for found in [coefficients, std_digits, residual_digits, r_squared] {
            assert!(found.is_nan() || found >= DIGITS, "{}: {found} digits", set.name);
        }
    }
}
