//! The curves of figures 3.1-3.9 of the thesis against quadrature by mpmath (`fixtures/psf/make_figures.py`).
#![allow(clippy::unwrap_used, clippy::panic, reason = "a golden that cannot be read fails the test")]

use std::collections::BTreeMap;

use blur_core::psf::{AcceleratedBlur, UniformBlur};

/// The value of a figure's curve; see the script for the columns.
fn curve(figure: &str, parameter: f64, length: f64, x: f64) -> f64 {
    let uniform = UniformBlur::new(length).unwrap();
    // R = v0²/a at a = 1000 mm/s².
    let by_ratio = || AcceleratedBlur::from_path((1000.0 * parameter).sqrt(), 1000.0, length).unwrap();
    match figure {
        // The centred box is the gate.
        "3.1" => uniform.gate_transform(2.0 * std::f64::consts::PI * x),
        "3.2" | "3.3" | "3.4" => by_ratio().psf(x),
        "3.5" | "3.6" | "3.7" => by_ratio().mtf(x),
        "3.8" => parameter * length * uniform.cosine_transform(x),
        "3.9" => {
            let duration = ((1.0 + 2.0 * parameter * length).sqrt() - 1.0) / parameter;
            duration * AcceleratedBlur::from_path(1.0, parameter, length).unwrap().cosine_transform(x)
        }
        _ => panic!("no figure {figure}"),
    }
}

#[test]
fn figures_of_chapter_3_are_their_integrals() {
    let mut points = BTreeMap::new();
    for line in include_str!("../../../fixtures/psf/figures.csv").lines().skip(1) {
        let (figure, numbers) = line.split_once(',').unwrap();
        let number: Vec<f64> = numbers.split(',').map(|field| field.parse().unwrap()).collect();
        let [parameter, length, x, truth] = number[..] else { panic!("{line}") };
        let value = curve(figure, parameter, length, x);
        assert!((value - truth).abs() < 1e-13 * truth.abs().max(1.0), "{line}: {value}");
        *points.entry(figure.to_owned()).or_insert(0) += 1;
    }
    // 41 points a curve: three lengths, one density each, five ratios each, one box, three accelerations.
    let counts: Vec<i32> = points.values().map(|n| n / 41).collect();
    assert_eq!(counts, [3, 1, 1, 1, 5, 5, 5, 1, 3]);
}
