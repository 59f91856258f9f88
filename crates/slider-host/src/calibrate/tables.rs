//! Tables 8.1 to 8.3 of the thesis from one's own readings.

use metrology::{Budget, Measurement, concise};

use super::direct::Direct;
use super::figures;
use super::readings::{Pairs, Widths};
use super::speed::Speed;
use crate::text::{Table, degrees_of_freedom, significant};

/// `3.174(35)`, the uncertainty in units of the last digit.
fn short(value: f64, expanded: f64) -> String {
    Measurement::new(value, expanded).map_or_else(|_| "-".to_owned(), |measurement| concise(measurement, 2))
}

/// The same by a budget.
fn whole(budget: &Budget) -> String {
    short(budget.value, budget.expanded)
}

/// A figure of the thesis, to the three decimals that it prints.
fn printed(figure: Option<(f64, f64)>) -> String {
    figure.map_or_else(|| "-".to_owned(), |(value, expanded)| format!("{value:.3}({:.0})", expanded * 1e3))
}

fn explain(table: &mut Table, coverage_k: f64) {
    let k = significant(coverage_k, 3);
    table
        .notes
        .push(format!("U = {k} u_c as in the thesis (eq. 8.6); U95 = t u_c of 95 % with the effective degrees of"));
    table
        .notes
        .push("freedom (GUM G.4). Parentheses hold expanded uncertainties in units of the last digit.".to_owned());
}

/// Table 8.1: widths, mm.
pub(super) fn widths(rows: &[(&Widths, Direct)], coverage_k: f64, thesis: bool) -> Table {
    let mut header = vec!["section", "N", "s", "u_A", "u_B1", "u_B2", "u_c", "x(U)", "dof", "t", "x(U95)"];
    header.extend(thesis.then_some("thesis"));
    let mut table = Table::new("Table 8.1: widths of teeth and slits, mm", &header);
    for (widths, direct) in rows {
        let mut cells = vec![direct.label.clone(), widths.readings_mm.len().to_string()];
        let parts = [direct.sample_std, direct.type_a, direct.type_b1, direct.type_b2, direct.combined];
        cells.extend(parts.map(|part| format!("{part:.4}")));
        cells.push(short(direct.mean, direct.expanded));
        cells.extend(modern(&direct.budget));
        cells.extend(thesis.then(|| printed(figures::width(widths.section))));
        table.push(cells);
    }
    explain(&mut table, coverage_k);
    table.notes.extend(rows.iter().flat_map(|(_, direct)| direct.suspicions.clone()));
    table
}

fn modern(budget: &Budget) -> [String; 3] {
    [degrees_of_freedom(budget.dof), format!("{:.2}", budget.coverage_k), whole(budget)]
}

/// Table 8.2: speeds, m/s.
pub(super) fn speeds(rows: &[Speed], coverage_k: f64, thesis: bool) -> Table {
    let mut header = vec![
        "speed",
        "t/ms",
        "class/%",
        "u_A(t)/ms",
        "u_B1/ms",
        "u_B2/ms",
        "C_t",
        "C_x",
        "U_R/U_1",
        "v(U)",
        "dof",
        "t",
        "v(U95)",
        "corrected",
    ];
    header.extend(thesis.then_some("thesis"));
    let mut table = Table::new("Table 8.2: speeds, m/s", &header);
    for speed in rows {
        let time = &speed.time;
        let mut cells = vec![speed.index.to_string(), format!("{:.3}", time.mean * 1e3)];
        cells.push(time.class_percent.map_or_else(|| "-".to_owned(), |class| format!("{class:.2}")));
        cells.extend([time.type_a, time.type_b1, time.type_b2].map(|part| significant(part * 1e3, 3)));
        cells.extend([speed.c_t, speed.c_x].map(|c| significant(c, 4)));
        let ratio = if speed.u_1 > 0.0 { speed.u_r / speed.u_1 } else { f64::INFINITY };
        cells.push(significant(ratio, 2));
        cells.push(short(speed.value, speed.expanded));
        cells.extend(modern(&speed.budget));
        cells.push(whole(&speed.corrected));
        cells.extend(thesis.then(|| printed(figures::speed(speed.index))));
        table.push(cells);
    }
    explain(&mut table, coverage_k);
    table.notes.push(
        "C_t in m/s^2 (eq. 8.9), C_x in 1/s (eq. 8.10), U_R/U_1 (eq. 8.14) below 0.3: the time dominates.".to_owned(),
    );
    let rectangles = rows.iter().filter(|speed| speed.dominance.is_some_and(|found| found.rectangular)).count();
    table.notes.push(format!(
        "One rectangular contribution dominates all others, as k = 1.65 for 95 % supposes, at {rectangles} of {} speeds.",
        rows.len()
    ));
    corrected(&mut table);
    table.notes.extend(rows.iter().flat_map(|speed| speed.time.suspicions.clone()));
    table
}

fn corrected(table: &mut Table) {
    table.notes.push(
        "The deviation from the standard (class, eq. 8.7) is known, so GUM 3.2.4 corrects it: 'corrected' is"
            .to_owned(),
    );
    table
        .notes
        .push("the value by the standard with U95, in which the standard's own calibration is missing.".to_owned());
}

/// Table 8.3: accelerations, m/s^2.
pub(super) fn accelerations(rows: &[(&Pairs, Direct, Budget)], coverage_k: f64, thesis: bool) -> Table {
    let mut header =
        vec!["angle", "N", "class/%", "s", "u_A", "u_B1", "u_B2", "u_c", "a(U)", "dof", "t", "a(U95)", "corrected"];
    header.extend(thesis.then_some("thesis"));
    let mut table = Table::new("Table 8.3: accelerations, m/s2", &header);
    for (pairs, direct, by_standard) in rows {
        let mut cells = vec![direct.label.clone(), pairs.system.len().to_string()];
        cells.push(direct.class_percent.map_or_else(|| "-".to_owned(), |class| format!("{class:.2}")));
        let parts = [direct.sample_std, direct.type_a, direct.type_b1, direct.type_b2, direct.combined];
        cells.extend(parts.map(|part| format!("{part:.5}")));
        cells.push(short(direct.mean, direct.expanded));
        cells.extend(modern(&direct.budget));
        cells.push(whole(by_standard));
        cells.extend(thesis.then(|| printed(figures::acceleration(pairs.setting))));
        table.push(cells);
    }
    explain(&mut table, coverage_k);
    corrected(&mut table);
    table.notes.extend(rows.iter().flat_map(|(_, direct, _)| direct.suspicions.clone()));
    table
}
