//! Which edge of the sheet each edge of a run is.

use metrology::least_squares::{Design, generalised, ordinary};
use nalgebra::DMatrix;
use slider_proto::Level;

use super::Timed;
use crate::Error;
use crate::sheet::Sheet;

/// Edges that are needed to tell a gap or a turn from an odd motion.
const ENOUGH: usize = 8;
/// Most gaps that are looked for.
const MOST_GAPS: usize = 3;
/// A gap or turn is believed if with it a cubic leaves less than this share of the squared residuals.
const BELIEVED: f64 = 0.25;
/// A run whose residuals of a cubic are smaller than this share of a section is as it should be.
const SMOOTH: f64 = 0.1;
/// Twice the logarithm of the likelihood ratio that makes us believe that the sheet passed the other way: 1 in 90.
const REVERSED: f64 = 9.0;

/// The outcome: as many indices as edges belong to the pass.
#[derive(Debug)]
pub(super) struct Matched {
    pub(super) sheet: Sheet,
    pub(super) reversed: bool,
    pub(super) indices: Vec<usize>,
}

/// Matches the edges with the sheet under a smooth motion, one that a cubic and a shift between first and last edges of
/// teeth follow.
pub(super) fn matched(edges: &[Timed], sheet: &Sheet, warnings: &mut Vec<String>) -> Result<Matched, Error> {
    let last = sheet.sections.len();
    let positions = sheet.positions_m();
    let mut direct = directly(edges, warnings);
    if direct.len() > 1 && edges[0].edge.level == Level::High {
        return Err(Error::FirstEdge);
    }
    direct.truncate(direct.iter().take_while(|&&index| index <= last).count());
    let mean_section = positions[last] / last as f64;
    let mut indices = direct;
    let smooth = mean_square(&edges[..indices.len()], &indices, &positions)
        .is_none_or(|square| indices.len() == last + 1 && square.sqrt() < SMOOTH * mean_section);
    if !smooth {
        let with_gaps = with_gaps(&edges[..indices.len()], &indices, &positions);
        match turn(edges, &indices, &positions) {
            Some((forth, turned)) if with_gaps.as_ref().is_none_or(|(_, gapped)| turned < *gapped) => {
                warnings.push(format!(
                    "the sheet turned back after edge {}: the {} edges from there on are left out",
                    indices[forth] + 1,
                    edges.len() - forth - 1
                ));
                indices.truncate(forth + 1);
            }
            _ => {
                if let Some((path, _)) = with_gaps {
                    name_gaps(&path, warnings);
                    indices = path;
                }
            }
        }
    }
    if indices.len() < 3 {
        return Err(Error::TooFewEdges { edges: indices.len() });
    }
    if indices.last() == Some(&last) && indices.len() < edges.len() {
        let more = edges.len() - indices.len();
        warnings.push(format!("{more} edges came after the sheet had passed, and are left out"));
    }
    let (sheet, reversed) = direction(&edges[..indices.len()], &indices, sheet);
    if reversed {
        warnings.push("the widths fit the sheet passing with its last tooth first".to_owned());
    }
    Ok(Matched { sheet, reversed, indices })
}

/// One edge after the other; where two lead to the same level, one between them is missing.
fn directly(edges: &[Timed], warnings: &mut Vec<String>) -> Vec<usize> {
    let mut indices = Vec::with_capacity(edges.len());
    let mut next = 0;
    for (number, timed) in edges.iter().enumerate() {
        if number > 0 && timed.edge.level == edges[number - 1].edge.level {
            warnings.push(format!("edge {} is missing: two in a row led to the same level", next + 1));
            next += 1;
        }
        indices.push(next);
        next += 1;
    }
    indices
}

/// Mean square of the residuals, m^2, of a cubic with a shift between first and last edges of teeth; `None` for too few
/// edges.
fn mean_square(edges: &[Timed], indices: &[usize], positions: &[f64]) -> Option<f64> {
    if edges.len() < ENOUGH {
        return None;
    }
    let (design, x) = smooth_motion(edges, indices, positions);
    let fit = ordinary(&design, &x).ok()?;
    Some(fit.chi2 / fit.dof as f64)
}

/// The design matrix of a cubic in time from -1 to 1 with a shift, and the positions.
fn smooth_motion(edges: &[Timed], indices: &[usize], positions: &[f64]) -> (Design, Vec<f64>) {
    let times = edges.iter().map(|timed| timed.t_s);
    let (first, last) = (times.clone().fold(f64::INFINITY, f64::min), times.fold(f64::NEG_INFINITY, f64::max));
    let design = DMatrix::from_fn(edges.len(), 5, |row, column| match column {
        4 => side(indices[row]),
        power => ((2.0 * edges[row].t_s - first - last) / (last - first)).powi(power as i32),
    });
    (design.into(), indices.iter().map(|&index| positions[index]).collect())
}

/// +1 for first edges of teeth, -1 for last ones.
fn side(index: usize) -> f64 {
    if index.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// The last edge before the sheet turned back, if it did, and the mean square then: the same edges come again in the other
/// order, and all that came are among them.
fn turn(edges: &[Timed], direct: &[usize], positions: &[f64]) -> Option<(usize, f64)> {
    let mut best = None;
    let mut least = BELIEVED * mean_square(&edges[..direct.len()], direct, positions)?;
    // At least two edges come again: one alone is more likely a carriage that stops.
    for forth in (edges.len() / 2).max(2) - 1..direct.len().min(edges.len() - 2) {
        let back = direct[..=forth].iter().rev().copied();
        let there_and_back: Vec<usize> = direct[..=forth].iter().copied().chain(back).take(edges.len()).collect();
        if there_and_back.len() == edges.len()
            && let Some(square) = mean_square(edges, &there_and_back, positions)
            && square < least
        {
            least = square;
            best = Some((forth, square));
        }
    }
    best
}

/// Puts gaps of two edges where they make the motion smoother, as many as there is room for: the indices, if any gap is
/// worth it, and the mean square.
fn with_gaps(edges: &[Timed], direct: &[usize], positions: &[f64]) -> Option<(Vec<usize>, f64)> {
    let room = (positions.len() - 1).saturating_sub(*direct.last()?) / 2;
    let plain = mean_square(edges, direct, positions)?;
    let mut path = direct.to_vec();
    let mut best = None;
    let (mut least, mut worth) = (plain, 1.0);
    for _ in 0..room.min(MOST_GAPS) {
        worth *= BELIEVED;
        let candidates = (1..path.len()).filter_map(|from| {
            let shifted: Vec<usize> =
                path.iter().enumerate().map(|(number, &index)| index + if number >= from { 2 } else { 0 }).collect();
            mean_square(edges, &shifted, positions).map(|square| (square, shifted))
        });
        let (square, shifted) = candidates.min_by(|a, b| a.0.total_cmp(&b.0))?;
        path = shifted;
        // Each gap must be worth it, but two may have to come together.
        if square < plain * worth && square < least * BELIEVED {
            least = square;
            best = Some((path.clone(), square));
        }
    }
    best
}

fn name_gaps(indices: &[usize], warnings: &mut Vec<String>) {
    for pair in indices.windows(2).filter(|pair| pair[1] - pair[0] > 2) {
        for edge in (pair[0] + 1..pair[1] - 1).step_by(2) {
            let what = if edge.is_multiple_of(2) { "tooth" } else { "slit" };
            warnings.push(format!("{what} {} was not seen: its two edges are missing", edge / 2 + 1));
        }
    }
}

/// The sheet as it passed. A sheet that looks the same from both ends passed forward.
fn direction(edges: &[Timed], indices: &[usize], sheet: &Sheet) -> (Sheet, bool) {
    let mut reversed = sheet.clone();
    reversed.sections.reverse();
    let same = sheet.sections.iter().zip(&reversed.sections).all(|(a, b)| a.value_m == b.value_m);
    if same || edges.len() < ENOUGH {
        return (sheet.clone(), false);
    }
    let (Some(forward), Some(backward)) = (misfit(edges, indices, sheet), misfit(edges, indices, &reversed)) else {
        return (sheet.clone(), false);
    };
    // The scale of the uncertainties is not trusted: of their likelihood only the ratio of the sums counts.
    if edges.len() as f64 * (forward / backward).ln() > REVERSED { (reversed, true) } else { (sheet.clone(), false) }
}

/// Sum of the squared residuals in units of the sheet's uncertainties and of one micrometre for each edge.
fn misfit(edges: &[Timed], indices: &[usize], sheet: &Sheet) -> Option<f64> {
    let (design, x) = smooth_motion(edges, indices, &sheet.positions_m());
    let full = Sheet { scale_std: 0.0, ..sheet.clone() }.covariance_m2();
    let covariance = full.select_rows(indices).select_columns(indices)
        + DMatrix::from_diagonal_element(edges.len(), edges.len(), 1e-12);
    generalised(&design, &x, &covariance).ok().map(|fit| fit.chi2)
}
