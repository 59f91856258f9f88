//! What a picture looks like in six numbers: those that the thesis correlates the error with (section 5.4.3).

use ndarray::ArrayView2;

/// Grey levels of the co-occurrence matrix, as MATLAB's `graycomatrix` has by default.
const LEVELS: usize = 8;

/// Features of a picture of 8 bit. Contrast, correlation, energy and homogeneity are those of the co-occurrence matrix of
/// eight equal grey levels of each pixel and its right neighbour, defined as in MATLAB, which the thesis used.
///
/// *Reference*: Haralick, Shanmugam, Dinstein, *Textural features for image classification*, IEEE Trans. SMC 3 (1973) 610.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Mean grey value, 0 to 255.
    pub brightness: f64,
    /// Mean squared difference of the levels of neighbours, 0 to 49.
    pub contrast: f64,
    /// Correlation of the levels of neighbours, -1 to 1; 0 where all levels are the same.
    pub correlation: f64,
    /// Sum of the squared shares of pairs of levels, above 0 to 1.
    pub energy: f64,
    /// Entropy of the histogram of the 256 grey values in bits, 0 to 8.
    pub entropy: f64,
    /// Mean of `1 / (1 + difference of the levels of neighbours)`, above 0 to 1.
    pub homogeneity: f64,
}

impl Texture {
    /// The names of the features, in the order of [`values`](Self::values).
    pub const NAMES: [&str; 6] = ["brightness", "contrast", "correlation", "energy", "entropy", "homogeneity"];

    /// The features of a picture of at least one row and two columns; those of less are not finite.
    pub fn of(picture: ArrayView2<'_, u8>) -> Self {
        let shares = co_occurrence(picture);
        let pairs =
            || shares.iter().enumerate().flat_map(|(i, row)| row.iter().enumerate().map(move |(j, p)| (i, j, p)));
        let sum = |term: &dyn Fn(f64, f64) -> f64| pairs().map(|(i, j, p)| p * term(i as f64, j as f64)).sum::<f64>();
        let (mean_i, mean_j) = (sum(&|i, _| i), sum(&|_, j| j));
        let covariance = sum(&|i, j| (i - mean_i) * (j - mean_j));
        let variances = sum(&|i, _| (i - mean_i).powi(2)) * sum(&|_, j| (j - mean_j).powi(2));
        Self {
            brightness: picture.iter().map(|&grey| f64::from(grey)).sum::<f64>() / picture.len() as f64,
            contrast: sum(&|i, j| (i - j).powi(2)),
            correlation: if variances > 0.0 { covariance / variances.sqrt() } else { 0.0 },
            energy: pairs().map(|(_, _, p)| p * p).sum(),
            entropy: entropy(picture),
            homogeneity: sum(&|i, j| 1.0 / (1.0 + (i - j).abs())),
        }
    }

    /// All features.
    pub fn values(&self) -> [f64; 6] {
        [self.brightness, self.contrast, self.correlation, self.energy, self.entropy, self.homogeneity]
    }
}

/// Shares of the ordered pairs of levels (left, right).
fn co_occurrence(picture: ArrayView2<'_, u8>) -> [[f64; LEVELS]; LEVELS] {
    let level = |grey: u8| (LEVELS * usize::from(grey) / 255).min(LEVELS - 1);
    let mut counts = [[0_u64; LEVELS]; LEVELS];
    for row in picture.rows() {
        for (&left, &right) in row.iter().zip(row.iter().skip(1)) {
            counts[level(left)][level(right)] += 1;
        }
    }
    let total = counts.iter().flatten().sum::<u64>() as f64;
    counts.map(|row| row.map(|count| count as f64 / total))
}

fn entropy(picture: ArrayView2<'_, u8>) -> f64 {
    let mut histogram = [0_u64; 256];
    picture.iter().for_each(|&grey| histogram[usize::from(grey)] += 1);
    let shares = histogram.iter().filter(|&&count| count > 0).map(|&count| count as f64 / picture.len() as f64);
    shares.map(|share| -share * share.log2()).sum()
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;

    /// The picture of `fixtures/texture/make_texture.py`.
    fn picture([rows, cols, neighbours, range]: [usize; 4]) -> Array2<u8> {
        let mut state = 20_240_607_u64;
        let numbers: Vec<u64> = (0..rows * cols + neighbours)
            .map(|_| {
                state = state * 48271 % 2_147_483_647;
                state % 65536
            })
            .collect();
        let grey = |k: usize| {
            let sum: u64 = numbers[k..k + neighbours].iter().sum();
            (sum * range as u64 / (65536 * neighbours as u64)).min(255) as u8
        };
        Array2::from_shape_fn((rows, cols), |(row, col)| grey(row * cols + col))
    }

    #[test]
    fn features_are_those_of_scikit_image() {
        let golden = include_str!("../../../../fixtures/texture/texture.csv");
        let mut compared = 0;
        for line in golden.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let case: Vec<usize> = cells[0].split('x').map(|cell| cell.parse().unwrap()).collect();
            let found = Texture::of(picture(case.try_into().unwrap()).view());
            let at = Texture::NAMES.iter().position(|&name| name == cells[1]).unwrap();
            let (found, expected) = (found.values()[at], cells[2].parse::<f64>().unwrap());
            assert!((found - expected).abs() < 1e-12 * expected.abs().max(1.0), "{line}: {found}");
            compared += 1;
        }
        assert_eq!(compared, 4 * 6);
    }

    #[test]
    fn an_even_picture_has_no_texture() {
        let found = Texture::of(Array2::from_elem((4, 5), 255).view());
        let none =
            Texture { brightness: 255.0, contrast: 0.0, correlation: 0.0, energy: 1.0, entropy: 0.0, homogeneity: 1.0 };
        assert_eq!(found, none);
    }
}
