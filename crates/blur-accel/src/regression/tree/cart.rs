//! One regression tree.

use linfa::traits::{Fit, PredictInplace};
use ndarray::{Array1, ArrayBase, ArrayView1, ArrayView2, Data, Ix2};
use serde::{Deserialize, Serialize};

use crate::regression::samples::{self, Samples};
use crate::{Error, Result};

/// A node of fewer observations is not split, as in MATLAB's `fitrtree`.
const LEAST_PARENT: usize = 10;
/// Two splits whose gains differ by a smaller share are equally good, as where two columns part the observations alike:
/// the first is taken, whatever rounding says.
const TIE: f64 = 1e-10;

/// Settings of a regression tree: every node is split where that takes most from the sum of squares, halfway between
/// two values of one column, until its leaves would have less than `least_leaf` observations. The tree is not pruned.
///
/// *Reference*: Breiman, Friedman, Olshen & Stone, *Classification and Regression Trees*, 1984, section 8.3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cart {
    /// Least number of observations in a leaf, at least 1.
    pub least_leaf: usize,
}

/// A regression tree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tree {
    columns: usize,
    /// The root is the first.
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Node {
    Leaf {
        mean: f64,
    },
    /// Observations whose `column` is at most the `threshold` go to the node `left`.
    Split {
        column: usize,
        threshold: f64,
        left: usize,
        right: usize,
    },
}

impl Cart {
    /// Fails for leaves without observations.
    pub(super) fn check(self) -> Result<()> {
        if self.least_leaf == 0 {
            return Err(Error::Parameter { name: "least observations in a leaf", value: 0.0, expected: "at least 1" });
        }
        Ok(())
    }

    /// The tree over the observations `rows`, which may repeat.
    pub(super) fn grow<'a>(
        self,
        inputs: ArrayView2<'a, f64>,
        targets: ArrayView1<'a, f64>,
        mut rows: Vec<usize>,
    ) -> Tree {
        let mut growth = Growth { settings: self, inputs, targets, nodes: Vec::new() };
        growth.node(&mut rows);
        Tree { columns: inputs.ncols(), nodes: growth.nodes }
    }
}

struct Growth<'a> {
    settings: Cart,
    inputs: ArrayView2<'a, f64>,
    targets: ArrayView1<'a, f64>,
    nodes: Vec<Node>,
}

impl Growth<'_> {
    /// Adds the node of `rows` and all below it, and returns its index.
    fn node(&mut self, rows: &mut [usize]) -> usize {
        let index = self.nodes.len();
        let mean = rows.iter().map(|&row| self.targets[row]).sum::<f64>() / rows.len() as f64;
        self.nodes.push(Node::Leaf { mean });
        if let Some((column, threshold)) = self.best_split(rows, mean) {
            rows.sort_by_key(|&row| self.inputs[[row, column]] > threshold);
            let (low, high) = rows.split_at_mut(rows.partition_point(|&row| self.inputs[[row, column]] <= threshold));
            let left = self.node(low);
            let right = self.node(high);
            self.nodes[index] = Node::Split { column, threshold, left, right };
        }
        index
    }

    /// Column and threshold that take most from the sum of squares.
    fn best_split(&self, rows: &[usize], mean: f64) -> Option<(usize, f64)> {
        let (count, least) = (rows.len(), self.settings.least_leaf);
        let first = self.targets[rows[0]];
        if count < LEAST_PARENT.max(2 * least) || rows.iter().all(|&row| self.targets[row] == first) {
            return None;
        }
        let mut best = None;
        let mut most = 0.0;
        let mut sorted: Vec<(f64, f64)> = Vec::with_capacity(count);
        for column in 0..self.inputs.ncols() {
            sorted.clear();
            sorted.extend(rows.iter().map(|&row| (self.inputs[[row, column]], self.targets[row] - mean)));
            sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut low_sum = 0.0;
            let total: f64 = sorted.iter().map(|(_, target)| target).sum();
            for (at, pair) in sorted.windows(2).enumerate() {
                let (low, high) = (pair[0].0, pair[1].0);
                low_sum += pair[0].1;
                let (low_count, high_count) = (at + 1, count - at - 1);
                if low == high || low_count < least || high_count < least {
                    continue;
                }
                let high_sum = total - low_sum;
                let gain = low_sum * low_sum / low_count as f64 + high_sum * high_sum / high_count as f64;
                if gain > most * (1.0 + TIE) {
                    most = gain;
                    let middle = f64::midpoint(low, high);
                    // Between neighbouring numbers there is no middle.
                    best = Some((column, if middle < high { middle } else { low }));
                }
            }
        }
        best
    }
}

impl Tree {
    /// Whether its parts belong together, which they may not when it was read from a file.
    pub(in crate::regression) fn check(&self) -> Result<()> {
        if self.nodes.is_empty() {
            return Err(Error::TooFew { found: 0, needed: 1, purpose: "as nodes of a tree" });
        }
        for (index, node) in self.nodes.iter().enumerate() {
            let Node::Split { column, left, right, .. } = *node else { continue };
            if column >= self.columns {
                return Err(Error::Size { what: "a column of a tree", found: column, expected: self.columns });
            }
            // Branches stand behind their split, so every way through the tree ends.
            for branch in [left, right] {
                if branch <= index || branch >= self.nodes.len() {
                    return Err(Error::Size { what: "a branch of a tree", found: branch, expected: self.nodes.len() });
                }
            }
        }
        Ok(())
    }

    /// Columns of an observation.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Leaves of the tree.
    pub fn leaves(&self) -> usize {
        self.nodes.iter().filter(|node| matches!(node, Node::Leaf { .. })).count()
    }

    pub(super) fn predict_row(&self, row: ArrayView1<'_, f64>) -> f64 {
        let mut index = 0;
        loop {
            match self.nodes[index] {
                Node::Leaf { mean } => return mean,
                Node::Split { column, threshold, left, right } => {
                    index = if row[column] <= threshold { left } else { right };
                }
            }
        }
    }
}

impl<'a> Fit<ArrayView2<'a, f64>, ArrayView1<'a, f64>, Error> for Cart {
    type Object = Tree;

    fn fit(&self, samples: &Samples<'a>) -> Result<Tree> {
        self.check()?;
        samples::check(samples)?;
        let inputs = samples.records().view();
        Ok(self.grow(inputs, samples.targets().view(), (0..inputs.nrows()).collect()))
    }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<f64>> for Tree {
    fn predict_inplace(&self, inputs: &ArrayBase<D, Ix2>, out: &mut Array1<f64>) {
        inputs.rows().into_iter().zip(out).for_each(|(row, to)| *to = self.predict_row(row));
    }

    fn default_target(&self, inputs: &ArrayBase<D, Ix2>) -> Array1<f64> {
        Array1::zeros(inputs.nrows())
    }
}
