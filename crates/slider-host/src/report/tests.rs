use super::*;
use crate::outcome::Kind;
use crate::sheet::Width;

const SPEED: f64 = 0.5;

/// Passes the sheet at constant speed, with these residuals.
fn uniform(run: u16, sheet: &Sheet, residuals_m: &[f64]) -> Outcome {
    let x_m = sheet.positions_m();
    let t_s: Vec<f64> =
        x_m.iter().zip(residuals_m.iter().chain(std::iter::repeat(&0.0))).map(|(x, r)| (x - r) / SPEED).collect();
    let residuals_m: Vec<f64> = x_m.iter().zip(&t_s).map(|(x, t)| x - SPEED * t).collect();
    let value = Value { value: SPEED, std: 0.0012, dof: 24.0, expanded: 0.0025, coverage_k: 2.06 };
    Outcome {
        run,
        degree: 1,
        coefficients: vec![0.0, SPEED],
        std_errors: vec![1e-5, 0.0012],
        t_s,
        x_m,
        residuals_m,
        residual_stds_m: vec![20e-6; 26],
        residual_std: 12e-6,
        r_squared: 0.999_987,
        speed_m_s: Some(value),
        v0_m_s: None,
        accel_m_s2: None,
        kind: Kind::Uniform,
        outliers: vec![],
        warnings: vec![],
    }
}

fn sheet(stds_m: impl Fn(usize) -> f64, scale_std: f64) -> Sheet {
    let mut sheet = Sheet::nominal();
    for (index, section) in sheet.sections.iter_mut().enumerate() {
        *section = Width { std_m: stds_m(index), ..*section };
    }
    sheet.scale_std = scale_std;
    sheet
}

/// Runs, a sheet and texts as they come, for the eye and for the tests below.
fn example() -> (Vec<Outcome>, Context) {
    let sheet = sheet(|index| if index == 8 { 65e-6 } else { 21e-6 }, 2e-4);
    let wobble: Vec<f64> =
        (0..26).map(|i| 30e-6 * (f64::from(i) * 1.7).sin() + 10e-6 * (f64::from(i) * 5.1).cos()).collect();
    let mut first = uniform(1, &sheet, &wobble);
    first
        .warnings
        .push("3 of 26 edges are missing behind the first: the run is fitted to where it is whole".to_owned());
    first.outliers.push(9);
    let mut second = uniform(2, &sheet, &wobble);
    let (v0, a) = (0.412, 1.229);
    second.degree = 2;
    second.kind = Kind::Accelerated;
    second.coefficients = vec![0.0, v0, a / 2.0];
    second.std_errors = vec![1e-5, 0.0009, 0.0031];
    second.t_s = second.x_m.iter().map(|x| (-v0 + (v0 * v0 + 2.0 * a * x).sqrt()) / a).collect();
    second.t_s.iter_mut().zip(&wobble).for_each(|(t, r)| *t -= r / 0.5);
    second.residuals_m = wobble.clone();
    second.speed_m_s = None;
    second.v0_m_s = Some(Value { value: v0, std: 0.0009, dof: 23.0, expanded: 0.0019, coverage_k: 2.07 });
    second.accel_m_s2 = Some(Value { value: a, std: 0.0062, dof: 23.0, expanded: 0.0128, coverage_k: 2.07 });
    let mut third = uniform(3, &sheet, &wobble);
    third.kind = Kind::Neither;
    third.warnings.push("the timer lost its line after edge 26; the end of the run is not known".to_owned());
    let value = Value { value: 0.500_31, std: 0.0009, dof: 31.0, expanded: 0.0018, coverage_k: 2.04 };
    let context = Context {
        title: "Preset 5, encoder 5".to_owned(),
        subtitle: "simulated, seed 1".to_owned(),
        sheet: Some(sheet),
        pooled: vec![Pooled { label: "speed of runs 1 and 3".to_owned(), unit: "m/s".to_owned(), value }],
        versions: vec![
            ("slider".to_owned(), "0.1.0".to_owned()),
            ("timer".to_owned(), "firmware 1.0, 16 MHz".to_owned()),
        ],
        command: "slider report --sheet encoder5.toml --output report.html logs/2026-11-22T10-00-00-preset-5.log"
            .to_owned(),
    };
    (vec![first, second, third], context)
}

#[test]
fn a_page_tells_every_run_and_needs_nothing_but_itself() {
    let (outcomes, context) = example();
    let page = html(&outcomes, &context);
    for text in [
        "0.5000 ± 0.0025 m/s",
        "1.229 ± 0.013 m/s²",
        "Run 3",
        "0.999987",
        "of 26 edges are missing",
        "0.5003 ± 0.0018",
        "--output report.html",
        "firmware 1.0",
        "viewport",
    ] {
        assert!(page.contains(text), "{text}");
    }
    for outside in ["http:", "https:", "src=", "@import", "url(", "<script", "<link"] {
        assert!(!page.contains(outside), "{outside}");
    }
    // Each fitted point is there: 26 of each run in each of its two figures.
    assert_eq!(page.matches("class=\"dot\"").count(), 3 * 2 * 26 - 2);
    assert_eq!(page.matches("class=\"cross\"").count(), 2);
    if let Ok(path) = std::env::var("SLIDER_REPORT") {
        std::fs::write(path, &page).unwrap();
    }
}

#[test]
fn every_element_that_opens_closes() {
    let (outcomes, context) = example();
    let page = html(&outcomes, &context);
    let mut open: Vec<&str> = Vec::new();
    for tag in page.split('<').skip(1) {
        let inside = tag.split('>').next().unwrap();
        let name = inside.split([' ', '/']).find(|name| !name.is_empty()).unwrap();
        if inside.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !inside.ends_with('/') && !["!DOCTYPE", "meta", "br"].contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn text_from_outside_cannot_become_markup() {
    let (mut outcomes, mut context) = example();
    let bad = "</title><script>alert(1)</script>\" onload='x' & \u{1b}[2J";
    context.title = bad.to_owned();
    context.subtitle = bad.to_owned();
    context.command = bad.to_owned();
    context.versions.push((bad.to_owned(), bad.to_owned()));
    context.pooled[0].label = bad.to_owned();
    context.pooled[0].unit = bad.to_owned();
    context.sheet.as_mut().unwrap().name = bad.to_owned();
    outcomes[0].warnings.push(bad.to_owned());
    let page = html(&outcomes, &context);
    assert_eq!(page.matches("&lt;script&gt;").count(), 9 + 1, "the title stands twice");
    for raw in ["<script", "onload='", "\u{1b}"] {
        assert!(!page.contains(raw), "{raw}");
    }
}

#[test]
fn numbers_that_are_none_draw_nothing_and_break_nothing() {
    let (mut outcomes, context) = example();
    outcomes[0].t_s[3] = f64::NAN;
    outcomes[0].x_m[4] = f64::INFINITY;
    outcomes[0].residuals_m.truncate(5);
    outcomes[0].coefficients = vec![f64::NAN, f64::INFINITY];
    outcomes[0].outliers.push(9000);
    outcomes[1].t_s.clear();
    outcomes[1].x_m.clear();
    outcomes[1].residuals_m.clear();
    outcomes[1].coefficients.clear();
    outcomes[2].t_s = vec![0.1; 26];
    let page = html(&outcomes, &context);
    for figure in page.split("<svg").skip(1) {
        let figure = figure.split("</svg>").next().unwrap();
        assert!(!figure.contains("NaN") && !figure.contains("inf\"") && !figure.contains("inf,"), "{figure}");
    }
    assert!(html(&[], &Context::default()).contains("There is no run."));
}
