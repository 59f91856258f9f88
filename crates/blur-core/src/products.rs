//! Sums of the products of all pairs of columns, as the information of a fit is made of.

/// Values that lie in one register.
pub(crate) const LANES: usize = 4;
/// Registers of each column that are worked on at once.
pub(crate) const GROUP: usize = 8;
/// Values of each column that are worked on at once.
pub(crate) const WIDTH: usize = GROUP * LANES;
/// Columns are filled up to a multiple of this.
pub(crate) const TILE: usize = 4;
/// Groups that are summed in single precision, at most.
const GROUPS: usize = 32;

/// A group of values of each column.
pub(crate) type Columns<const N: usize> = [[f32; WIDTH]; N];
/// Products of some columns with others by row, column and lane.
type Tile = [[[f32; LANES]; TILE]; TILE];

/// Sums of the products of `N` columns, a multiple of [`TILE`], with as many others; of a matrix that is symmetric, so that its
/// upper triangle is enough. The order of the sums is always the same.
#[derive(Debug)]
pub(crate) struct Products<const N: usize> {
    /// The tiles of the upper triangle, row by row.
    tiles: Vec<Tile>,
    groups: usize,
    totals: [[f64; N]; N],
}

impl<const N: usize> Products<N> {
    pub(crate) fn new() -> Self {
        const { assert!(N.is_multiple_of(TILE)) };
        let across = N / TILE;
        Self { tiles: vec![Tile::default(); across * (across + 1) / 2], groups: 0, totals: [[0.0; N]; N] }
    }

    /// Forgets all sums.
    pub(crate) fn clear(&mut self) {
        self.tiles.fill(Tile::default());
        self.groups = 0;
        self.totals = [[0.0; N]; N];
    }

    /// Adds the products of a group.
    pub(crate) fn add(&mut self, left: &Columns<N>, right: &Columns<N>) {
        let mut tiles = self.tiles.iter_mut();
        let (left, right) = (left.as_chunks().0, right.as_chunks().0);
        for (i, left) in left.iter().enumerate() {
            for (right, tile) in right[i..].iter().zip(&mut tiles) {
                add_tile(left, right, tile);
            }
        }
        self.groups += 1;
        if self.groups == GROUPS {
            self.add_up();
        }
    }

    /// The sums, of which those below the diagonal mean nothing.
    pub(crate) fn totals(&mut self) -> &[[f64; N]; N] {
        self.add_up();
        &self.totals
    }

    fn add_up(&mut self) {
        let mut tiles = self.tiles.iter_mut();
        for i in (0..N).step_by(TILE) {
            for (j, tile) in (i..N).step_by(TILE).zip(&mut tiles) {
                for (totals, sums) in self.totals[i..].iter_mut().zip(tile) {
                    for (total, sum) in totals[j..].iter_mut().zip(sums) {
                        *total += f64::from((sum[0] + sum[2]) + (sum[1] + sum[3]));
                        *sum = [0.0; LANES];
                    }
                }
            }
        }
        self.groups = 0;
    }
}

/// Adds the products of some columns with others. Kept apart from its callers: there the compiler would rather vectorise across
/// products than along them.
#[inline(never)]
fn add_tile(left: &Columns<TILE>, right: &Columns<TILE>, tile: &mut Tile) {
    // Two rows at a time, for which there are registers.
    for (left, sums) in left.as_chunks::<2>().0.iter().zip(tile.as_chunks_mut::<2>().0) {
        let mut all = *sums;
        for block in 0..GROUP {
            for (left, sums) in left.iter().zip(&mut all) {
                let left = &left.as_chunks::<LANES>().0[block];
                for (right, sum) in right.iter().zip(sums) {
                    let right = &right.as_chunks::<LANES>().0[block];
                    for ((sum, left), right) in sum.iter_mut().zip(left).zip(right) {
                        *sum += left * right;
                    }
                }
            }
        }
        *sums = all;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_products_whatever_their_number() {
        const N: usize = 12;
        let value = |group: usize, column: usize, lane: usize| ((7 * group + 5 * column + 3 * lane) % 11) as f32 - 5.0;
        let columns =
            |group: usize, from: usize| std::array::from_fn(|i| std::array::from_fn(|k| value(group, from + i, k)));
        for groups in [0, 1, GROUPS, 2 * GROUPS + 3] {
            let mut products = Products::<N>::new();
            // Nothing is left of what was there before.
            products.add(&columns(50, 0), &columns(51, 0));
            products.clear();
            for group in 0..groups {
                products.add(&columns(group, 0), &columns(group, 20));
            }
            for (i, totals) in products.totals().iter().enumerate() {
                for (j, &total) in totals.iter().enumerate().skip(i) {
                    let expected: f32 = (0..groups)
                        .flat_map(|group| (0..WIDTH).map(move |k| value(group, i, k) * value(group, 20 + j, k)))
                        .sum();
                    assert_eq!(total, f64::from(expected), "{groups} groups, {i} {j}");
                }
            }
        }
    }
}
