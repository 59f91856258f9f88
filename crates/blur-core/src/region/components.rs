//! Connected parts of a labelled grid.

use ndarray::Array2;

/// Turns `from` into `to` in the connected part that `start` (row, column) belongs to, and returns its number of points.
pub(super) fn flood(labels: &mut Array2<u8>, start: (usize, usize), from: u8, to: u8) -> usize {
    if from == to || labels.get(start) != Some(&from) {
        return 0;
    }
    labels[start] = to;
    let mut open = vec![start];
    let mut count = 0;
    while let Some((row, column)) = open.pop() {
        count += 1;
        let neighbours =
            [(row.wrapping_sub(1), column), (row + 1, column), (row, column.wrapping_sub(1)), (row, column + 1)];
        for next in neighbours {
            if labels.get(next) == Some(&from) {
                labels[next] = to;
                open.push(next);
            }
        }
    }
    count
}

/// Gives every part that is not `label` and that only `label` surrounds to it.
pub(super) fn fill_holes(labels: &mut Array2<u8>, label: u8) {
    let (rows, columns) = labels.dim();
    // 0: others not reached from the border, 1: the label, 2: others that are.
    let mut reached = labels.mapv(|other| u8::from(other == label));
    let border = (0..columns)
        .flat_map(|column| [(0, column), (rows - 1, column)])
        .chain((0..rows).flat_map(|row| [(row, 0), (row, columns - 1)]));
    for place in border {
        flood(&mut reached, place, 0, 2);
    }
    labels.zip_mut_with(&reached, |out, &reached| {
        if reached == 0 {
            *out = label;
        }
    });
}

/// Gives `label` to the places within `half_px` along `(cos, sin)` (y down), both ways, of those that have it, unless `keep`
/// says otherwise of the label they have.
pub(super) fn spread(
    labels: &mut Array2<u8>,
    label: u8,
    half_px: f64,
    (cos, sin): (f64, f64),
    keep: impl Fn(u8) -> bool,
) {
    let inside = |labels: &Array2<u8>, (row, column): (usize, usize)| labels.get((row, column)) == Some(&label);
    // Only the border can spread.
    let border: Vec<(usize, usize)> = labels
        .indexed_iter()
        .filter(|((row, column), other)| {
            let (row, column) = (*row, *column);
            **other == label
                && ![(row.wrapping_sub(1), column), (row + 1, column), (row, column.wrapping_sub(1)), (row, column + 1)]
                    .into_iter()
                    .all(|near| inside(labels, near))
        })
        .map(|(place, _)| place)
        .collect();
    let steps = (2.0 * half_px).ceil() as i32;
    for (row, column) in border {
        for step in -steps..=steps {
            // Half a pixel each, so that no pixel of a slanting line is left out.
            let along = (0.5 * f64::from(step)).clamp(-half_px, half_px);
            let (r, c) = ((row as f64 + along * sin).round(), (column as f64 + along * cos).round());
            if r < 0.0 || c < 0.0 {
                continue;
            }
            if let Some(other) = labels.get_mut((r as usize, c as usize)).filter(|other| !keep(**other)) {
                *other = label;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_spreads_along_one_direction_and_not_over_others() {
        let mut labels = Array2::zeros((5, 9));
        labels[(2, 4)] = 1;
        labels[(2, 6)] = 2;
        spread(&mut labels, 1, 2.0, (1.0, 0.0), |other| other == 2);
        assert_eq!(labels.row(2).to_vec(), [0, 0, 1, 1, 1, 1, 2, 0, 0]);
        assert_eq!(labels.iter().filter(|&&label| label == 1).count(), 4);
    }

    #[test]
    fn a_part_is_what_hangs_together_by_its_sides() {
        let mut labels = ndarray::array![[1, 1, 0], [0, 0, 1], [1, 0, 1]];
        assert_eq!(flood(&mut labels, (0, 0), 1, 5), 2);
        assert_eq!(labels, ndarray::array![[5, 5, 0], [0, 0, 1], [1, 0, 1]]);
        assert_eq!(flood(&mut labels, (0, 2), 1, 5), 0);
    }

    #[test]
    fn only_what_is_surrounded_is_a_hole() {
        let mut labels = ndarray::array![[0, 2, 2, 2], [0, 2, 0, 2], [0, 2, 2, 2], [0, 0, 2, 0]];
        fill_holes(&mut labels, 2);
        assert_eq!(labels, ndarray::array![[0, 2, 2, 2], [0, 2, 2, 2], [0, 2, 2, 2], [0, 0, 2, 0]]);
    }
}
