//! The page around the figures.

use std::fmt::Write;

use crate::outcome::{Kind, Outcome, Value};
use crate::sheet::Sheet;
use crate::text::{degrees_of_freedom, plus_minus, significant};

use super::figure::{coverage_k, main_value, position, residuals};
use super::{Context, escape};

const STYLE: &str = include_str!("style.css");

pub(super) fn page(outcomes: &[Outcome], context: &Context) -> String {
    let title = escape(if context.title.is_empty() { "Runs of the slider" } else { &context.title });
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );
    if !context.subtitle.is_empty() {
        let _ = writeln!(page, "<p class=\"soft\">{}</p>", escape(&context.subtitle));
    }
    pooled(&mut page, context);
    overview(&mut page, outcomes);
    for outcome in outcomes {
        run(&mut page, outcome);
    }
    if let Some(sheet) = &context.sheet {
        sheet_section(&mut page, sheet);
    }
    provenance(&mut page, context);
    page.push_str("</body>\n</html>\n");
    page
}

/// A value in large letters, its coverage factor and degrees of freedom in small ones.
fn result(symbol: &str, value: &Value, unit: &str) -> String {
    let freedom = match value.dof {
        dof if dof.is_finite() => format!(", {} degrees of freedom", degrees_of_freedom(dof)),
        _ => String::new(),
    };
    format!(
        "<span class=\"result\">{symbol}{} {}</span> <span class=\"soft\">k = {}{freedom}</span>",
        plus_minus(value.value, value.expanded),
        escape(unit),
        significant(value.coverage_k, 3)
    )
}

fn kind(kind: Kind) -> (&'static str, &'static str) {
    match kind {
        Kind::Uniform => ("uniform", "uniform motion"),
        Kind::Accelerated => ("accelerated", "uniformly accelerated"),
        Kind::Neither => ("neither", "neither uniform nor uniformly accelerated"),
    }
}

fn pooled(page: &mut String, context: &Context) {
    for pooled in &context.pooled {
        let (label, value) = (escape(&pooled.label), result("", &pooled.value, &pooled.unit));
        let _ = writeln!(page, "<p><span class=\"soft\">{label}</span><br>{value}</p>");
    }
}

fn overview(page: &mut String, outcomes: &[Outcome]) {
    if outcomes.is_empty() {
        page.push_str("<p>There is no run.</p>\n");
        return;
    }
    if outcomes.len() == 1 {
        return;
    }
    page.push_str("<div class=\"scroll\"><table>\n<tr><th>run</th><th>result</th><th>motion</th><th>points</th><th>R²</th><th>warnings</th></tr>\n");
    for outcome in outcomes {
        let value = main_value(outcome).map_or_else(
            || "–".to_owned(),
            |(symbol, unit, value)| format!("{symbol} = {} {unit}", plus_minus(value.value, value.expanded)),
        );
        let _ = writeln!(
            page,
            "<tr><td><a href=\"#run-{0}\">{0}</a></td><td>{value}</td><td>{1}</td><td>{2}</td><td>{3}</td><td>{4}</td></tr>",
            outcome.run,
            kind(outcome.kind).0,
            outcome.t_s.len(),
            r_squared(outcome),
            outcome.warnings.len()
        );
    }
    page.push_str("</table></div>\n");
}

/// As many nines as tell it from 1.
fn r_squared(outcome: &Outcome) -> String {
    let missing = 1.0 - outcome.r_squared;
    if missing > 0.0 && missing < 0.01 {
        let decimals = (1.0 - missing.log10().floor()).clamp(2.0, 12.0) as usize;
        return format!("{:.decimals$}", outcome.r_squared);
    }
    significant(outcome.r_squared, 4)
}

fn run(page: &mut String, outcome: &Outcome) {
    let number = outcome.run;
    let (class, words) = kind(outcome.kind);
    let _ = writeln!(
        page,
        "<section id=\"run-{number}\">\n<h2>Run {number}<span class=\"kind {class}\">{words}</span></h2>"
    );
    if let Some((symbol, unit, value)) = main_value(outcome) {
        let _ = writeln!(page, "<p>{}</p>", result(&format!("{symbol} = "), &value, unit));
    }
    if let Some(v0) = &outcome.v0_m_s {
        let _ = writeln!(page, "<p>at the first edge v₀ = {} m/s</p>", plus_minus(v0.value, v0.expanded));
    }
    if !outcome.warnings.is_empty() {
        page.push_str("<ul class=\"warnings\">\n");
        for warning in &outcome.warnings {
            let _ = writeln!(page, "<li>{}</li>", escape(warning));
        }
        page.push_str("</ul>\n");
    }
    let left_out = match outcome.outliers.len() {
        0 => String::new(),
        n => format!(" {n} left out: crosses."),
    };
    let (residuals, caption) = residuals(outcome);
    let _ = writeln!(
        page,
        "<div class=\"figures\">\n<figure>{}<figcaption>Edges of the sheet and the fit.{left_out}</figcaption></figure>\n\
         <figure>{residuals}<figcaption>{}</figcaption></figure>\n</div>",
        position(outcome),
        escape(&caption)
    );
    coefficients(page, outcome);
    page.push_str("</section>\n");
}

fn coefficients(page: &mut String, outcome: &Outcome) {
    const ROWS: [(&str, &str, &str); 3] =
        [("c₀", "m", "position at t = 0"), ("c₁", "m/s", "speed at t = 0"), ("c₂", "m/s²", "half the acceleration")];
    let k = coverage_k(outcome);
    let _ = writeln!(
        page,
        "<div class=\"scroll\"><table>\n<tr><th>x(t)</th><th>value</th><th>u</th><th>U</th><th></th></tr>"
    );
    for (power, (&c, &u)) in outcome.coefficients.iter().zip(&outcome.std_errors).enumerate() {
        let other = format!("c{power}");
        let (name, unit, meaning) = ROWS.get(power).copied().unwrap_or((&other, "", ""));
        let value = plus_minus(c, k * u);
        let value = value.split(" ± ").next().unwrap_or_default();
        let _ = writeln!(
            page,
            "<tr><td>{name} / {unit}</td><td>{value}</td><td>{}</td><td>{}</td><td class=\"text\">{meaning}</td></tr>",
            significant(u, 2),
            significant(k * u, 2)
        );
    }
    let _ = writeln!(
        page,
        "</table></div>\n<p class=\"soft\">{} points, R² = {}, standard deviation of the residuals {} µm</p>",
        outcome.t_s.len(),
        r_squared(outcome),
        significant(outcome.residual_std * 1e6, 3)
    );
}

fn sheet_section(page: &mut String, sheet: &Sheet) {
    let _ = writeln!(page, "<section>\n<h2>The sheet: {}</h2>", escape(&sheet.name));
    if sheet.scale_std > 0.0 {
        let percent = significant(sheet.scale_std * 100.0, 2);
        let _ = writeln!(page, "<p>All widths share a relative standard uncertainty of {percent} %.</p>");
    }
    page.push_str(
        "<div class=\"columns\"><table>\n<thead><tr><th>section</th><th>width / mm</th><th>u / mm</th></tr></thead>\n",
    );
    for (index, width) in sheet.sections.iter().enumerate() {
        let name = if index % 2 == 0 { "tooth" } else { "slit" };
        let _ = writeln!(
            page,
            "<tr><td>{name} {}</td><td>{:.4}</td><td>{:.4}</td></tr>",
            index / 2 + 1,
            width.value_m * 1e3,
            width.std_m * 1e3
        );
    }
    page.push_str("</table></div>\n</section>\n");
}

fn provenance(page: &mut String, context: &Context) {
    if context.command.is_empty() && context.versions.is_empty() {
        return;
    }
    page.push_str("<section>\n<h2>How to make it again</h2>\n");
    if !context.command.is_empty() {
        let _ = writeln!(page, "<pre>{}</pre>", escape(&context.command));
    }
    if !context.versions.is_empty() {
        page.push_str("<div class=\"scroll\"><table>\n");
        for (name, version) in &context.versions {
            let _ = writeln!(page, "<tr><td>{}</td><td class=\"text\">{}</td></tr>", escape(name), escape(version));
        }
        page.push_str("</table></div>\n");
    }
    page.push_str("</section>\n");
}
