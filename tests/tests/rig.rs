//! The experiment of the thesis's chapter 6 on the virtual rig: its learning, its null baseline and physics.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

use blur_accel::homomorphic::{HomomorphicPsf, Prototype, Variant};
use blur_accel::reduce::Components;
use blur_accel::regression::{PRESETS, Preset};
use blur_accel::validate::{Comparison, Folds, Recipe, cross_validate, length_alone};
use blur_cli::accel::evaluate::{Kind, Line, Options, evaluate};
use blur_cli::accel::study::Study;
use blur_sim::rig::{Design, POSTERS, Rig, STILLS, Studio};
use blur_sim::sensor::f32_from_u8;
use ndarray::{Array1, Array2};

const SEED: u64 = 1;

/// The PSFs, accelerations and true lengths of all shots of a design.
fn learning_set(design: Design) -> (Array2<f64>, Array1<f64>, Array1<f64>) {
    let rig = Rig::default();
    let mut studio = Studio::new(&rig).unwrap();
    let prototypes: Vec<_> = (0..POSTERS.len())
        .map(|poster| {
            let stills: Vec<_> = (0..STILLS)
                .map(|index| f32_from_u8(studio.background(&rig.still(poster, index, SEED).unwrap()).unwrap().view()))
                .collect();
            let views: Vec<_> = stills.iter().map(Array2::view).collect();
            Prototype::new(Variant::Dft, &views).unwrap()
        })
        .collect();
    let mut extractor = HomomorphicPsf::new(Variant::Dft, rig.side_px, rig.side_px);
    let shots = rig.shots(design, SEED).unwrap();
    let mut inputs = Array2::zeros((shots.len(), HomomorphicPsf::length(rig.side_px)));
    for (mut row, shot) in inputs.rows_mut().into_iter().zip(&shots) {
        let picture = f32_from_u8(studio.picture(shot).unwrap().view());
        let psf = extractor.extract(picture.view(), &prototypes[shot.poster]).unwrap();
        row.iter_mut().zip(psf).for_each(|(to, &from)| *to = from);
    }
    let targets = shots.iter().map(|shot| shot.accel_m_s2).collect();
    (inputs, targets, shots.iter().map(|shot| shot.length_px).collect())
}

#[test]
fn the_protocol_of_the_thesis_does_no_worse_than_the_thesis_and_no_better_than_the_length() {
    let (inputs, targets, lengths_px) = learning_set(Design::FixedRelease);
    let folds = Folds::random(targets.len(), 5, SEED).unwrap();
    let baseline = length_alone(lengths_px.view(), targets.view(), &folds).unwrap();
    let recipe = Recipe { components: Components::default(), preset: Preset::named("gpr-matern52").unwrap() };
    let found = cross_validate(recipe, inputs.view(), targets.view(), &folds, SEED).unwrap();
    // Table 6.2: RMSE 0.2547 m/s2 and R2 0.85.
    assert!(found.metrics.rmse <= 0.2547 && found.metrics.r_squared >= 0.85, "{:?}", found.metrics);
    // v0 = sqrt(2 a d): the length alone knows the acceleration.
    assert!(baseline.metrics.r_squared > 0.99, "{:?}", baseline.metrics);
    assert!(!Comparison::of(&found, &baseline, targets.view(), &folds).unwrap().beats());
    assert_eq!(PRESETS.len(), 19);
}

#[test]
fn the_length_says_nothing_where_the_release_is_random() {
    let rig = Rig::default();
    let shots = rig.shots(Design::RandomRelease, SEED).unwrap();
    let lengths_px: Array1<f64> = shots.iter().map(|shot| shot.length_px).collect();
    let targets: Array1<f64> = shots.iter().map(|shot| shot.accel_m_s2).collect();
    let folds = Folds::random(targets.len(), 5, SEED).unwrap();
    let baseline = length_alone(lengths_px.view(), targets.view(), &folds).unwrap();
    assert!(baseline.metrics.r_squared < 0.1, "{:?}", baseline.metrics);
}

fn line(lines: &[Line], kind: Kind) -> &Line {
    lines.iter().find(|line| line.kind == kind).unwrap()
}

#[test]
fn physics_measures_the_acceleration_where_the_length_says_nothing() {
    let (mut covered, mut total) = (0.0, 0.0);
    for (psnr_db, most_rmse_m_s2) in [(40.0, 0.05), (30.0, 0.10)] {
        let rig = Rig { psnr_db: Some(psnr_db), ..Rig::default() };
        let study = Study::simulate(&rig, Design::RandomRelease, SEED, 5).unwrap();
        let folds = Folds::random(study.len(), 5, SEED).unwrap();
        let options = Options { presets: &[], components: Components::default(), seed: SEED };
        let lines = evaluate(&study, &folds, &options).unwrap();
        let reference = line(&lines, Kind::Reference);
        assert_eq!(reference.n, study.len());
        assert!(reference.metrics.unwrap().rmse <= most_rmse_m_s2, "{psnr_db} dB: {:?}", reference.metrics);
        assert_eq!(reference.right_sign(), Some(1.0), "{psnr_db} dB");
        covered += reference.coverage.unwrap() * reference.n as f64;
        total += reference.n as f64;
    }
    // Of 50 at 95 %, less than 43 happen once in 200 draws.
    assert!(covered >= 43.0, "{covered} of {total}");
}
