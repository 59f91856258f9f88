//! Labels of the points that are likely and have short borders.

use ndarray::Array2;

use super::borders::{Borders, NEIGHBOURS};
use super::cut::Network;

/// Times that every label is tried.
const SWEEPS: usize = 2;
/// Node of a point that keeps its label.
const FIXED: u32 = u32::MAX;

/// The label of every point, by number: that which together with the borders costs least, as far as changing points to any
/// one label at a time finds it. `log_odds` are logarithms of the odds of each label; minus infinity is never chosen.
///
/// *Reference*: Y. Boykov, O. Veksler and R. Zabih, *Fast approximate energy minimization via graph cuts*, IEEE
/// Transactions on Pattern Analysis and Machine Intelligence 23 (2001) 1222: expansion moves for the Potts model.
pub(super) fn labels(log_odds: &[Array2<f32>], borders: &Borders) -> Array2<u8> {
    let dim = log_odds.first().map_or((0, 0), Array2::dim);
    let mut labels = Array2::zeros(dim);
    for sweep in 0..SWEEPS {
        let before = labels.clone();
        for label in (1..log_odds.len()).chain([0]) {
            expand(&mut labels, log_odds, borders, label as u8);
        }
        if sweep > 0 && labels == before {
            break;
        }
    }
    labels
}

/// Gives `label` to the points that make it cheapest.
fn expand(labels: &mut Array2<u8>, log_odds: &[Array2<f32>], borders: &Borders, label: u8) {
    let odds = &log_odds[usize::from(label)];
    // Only points that may change are nodes.
    let mut nodes = Array2::from_elem(labels.dim(), FIXED);
    let mut count = 0;
    for ((at, node), &now) in nodes.indexed_iter_mut().zip(labels.iter()) {
        if now != label && odds[at].is_finite() {
            *node = count;
            count += 1;
        }
    }
    let mut network = Network::new(count as usize);
    let (rows, columns) = labels.dim();
    for ((row, column), &node) in nodes.indexed_iter() {
        let now = labels[(row, column)];
        if node != FIXED {
            network.prefer_source(node as usize, odds[(row, column)] - log_odds[usize::from(now)][(row, column)]);
        }
        for (direction, (down, across)) in NEIGHBOURS.into_iter().enumerate() {
            let (r, c) = (row + down, column.wrapping_add_signed(across));
            if r >= rows || c >= columns {
                continue;
            }
            let border = borders.cost(direction, (row, column));
            let (other, other_node) = (labels[(r, c)], nodes[(r, c)]);
            // Costs of the border when both keep their labels, when only this point changes and when only that one does.
            let keep = if now == other { 0.0 } else { border };
            let (this, that) = (if other == label { 0.0 } else { border }, if now == label { 0.0 } else { border });
            match (node, other_node) {
                (FIXED, FIXED) => {}
                (node, FIXED) => network.prefer_source(node as usize, keep - this),
                (FIXED, node) => network.prefer_source(node as usize, keep - that),
                // keep + (this - keep) a - this b + (this + that - keep) (1 - a) b, where 1 is a change.
                (a, b) => {
                    network.prefer_source(a as usize, keep - this);
                    network.prefer_source(b as usize, this);
                    network.join(a as usize, b as usize, 0.0, this + that - keep);
                }
            }
        }
    }
    let changes = network.source_side();
    labels.zip_mut_with(&nodes, |now, &node| {
        if node != FIXED && changes[node as usize] {
            *now = label;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cost of labels by the definition.
    fn cost(labels: &Array2<u8>, log_odds: &[Array2<f32>], borders: &Borders) -> f32 {
        let (rows, columns) = labels.dim();
        let mut sum = 0.0;
        for (at, &label) in labels.indexed_iter() {
            sum -= log_odds[usize::from(label)][at];
            for (other, _) in labels.indexed_iter().filter(|(other, l)| *other > at && **l != label) {
                sum += match (other.0 - at.0, other.1 as i32 - at.1 as i32) {
                    (0, 1) => borders.cost(0, at),
                    (1, 0) => borders.cost(1, at),
                    (1, 1) => borders.cost(2, at),
                    (1, -1) => borders.cost(3, at),
                    _ => 0.0,
                };
            }
        }
        assert!(rows * columns > 0 && sum.is_finite());
        sum
    }

    #[test]
    fn two_labels_cost_least_and_more_are_at_a_minimum_of_single_points() {
        let mut state = 3_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f32 / (1_u64 << 31) as f32
        };
        for round in 0..40 {
            let count = 2 + round % 2;
            let dim = (3, 3);
            let odds: Vec<Array2<f32>> =
                (0..count).map(|_| Array2::from_shape_fn(dim, |_| 30.0 * draw() - 15.0)).collect();
            let borders = Borders::of(|_| Array2::from_shape_fn(dim, |_| 6.0 * draw()));
            let found = cost(&labels(&odds, &borders), &odds, &borders);
            let all = (0..(count as u32).pow(9)).map(|code| {
                cost(
                    &Array2::from_shape_fn(dim, |(r, c)| {
                        (code / (count as u32).pow((3 * r + c) as u32) % count as u32) as u8
                    }),
                    &odds,
                    &borders,
                )
            });
            let least = all.fold(f32::INFINITY, f32::min);
            // Expansion moves are exact for two labels, and within a factor of two of the borders for more.
            if count == 2 {
                assert!((found - least).abs() < 1e-2, "{found} {least}");
            } else {
                let best_single = labels(&odds, &borders);
                assert!(found <= least + 20.0 * 6.0 + 1e-2);
                for (at, _) in best_single.indexed_iter() {
                    for other in 0..count as u8 {
                        let mut changed = best_single.clone();
                        changed[at] = other;
                        assert!(cost(&changed, &odds, &borders) >= found - 1e-2, "{at:?} {other}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_point_alone_follows_its_surroundings_and_one_that_cannot_does_not() {
        let mut moves = Array2::from_elem((9, 9), 4.0);
        moves[(4, 4)] = -8.0;
        moves[(2, 2)] = f32::NEG_INFINITY;
        let mut expected = Array2::ones((9, 9));
        expected[(2, 2)] = 0;
        let borders = Borders::of(|direction| Array2::from_elem((9, 9), if direction < 2 { 5.0 } else { 3.5 }));
        assert_eq!(labels(&[Array2::zeros((9, 9)), moves], &borders), expected);
    }
}
