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

#[cfg(test)]
mod tests {
    use super::*;

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
