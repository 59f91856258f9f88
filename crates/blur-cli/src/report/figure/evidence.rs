//! What speaks for and against the result.

use std::fmt::Write;

use crate::Result;
use crate::report::html::{Data, Figure};
use crate::report::section::Subject;
use crate::text::significant;

const TITLE: &str = "For and against";

/// The numbers of the evidence, each with what it means.
pub fn draw(subject: &Subject<'_>) -> Result<Figure> {
    let Some(found) = subject.record.evidence else {
        return Ok(subject
            .likelihood(TITLE)
            .err()
            .unwrap_or_else(|| Figure::absent(TITLE, "The method weighs no evidence.")));
    };
    let rows = [
        (
            "gain_per_bin",
            found.gain_per_bin,
            "Gain over no blur",
            "in log-likelihood for each bin of signal; more is better",
        ),
        (
            "rival_share",
            found.rival_share,
            "Best other blur",
            "its evidence relative to this one; 0 is unrivalled, 1 a tie",
        ),
        (
            "incoherent_share",
            found.incoherent_share,
            "Incoherent light",
            "share of the light that does not follow the motion",
        ),
        ("misfit", found.misfit, "Misfit", "mean squared residual; about 1 or less for a model that is right"),
        (
            "band_cycles_per_px",
            found.band_cycles_per_px,
            "Band",
            "highest frequency used, cycles/px; 0.5 is all there is",
        ),
    ];
    let mut list = String::new();
    for (field, value, name, meaning) in rows {
        let shown = significant(value, 3);
        // Writing to a String cannot fail.
        let _ = write!(
            list,
            "<div><dt>{name}<small>{meaning}</small></dt><dd>{}</dd></div>",
            Data { field, value, shown: &shown }
        );
    }
    Ok(Figure {
        title: TITLE,
        content: format!("<dl class=\"evidence\">{list}</dl>"),
        caption: String::from(
            "The verdict at the head of the section is drawn from these numbers and the uncertainties: each has a limit, and \
             the first that is broken is the reason given.",
        ),
        is_wide: false,
    })
}
