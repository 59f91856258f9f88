//! The front end that the methods share: from a picture to its levelled spectrum.

use ndarray::ArrayView2;

use crate::image::{Taper, Window};
use crate::spectrum::{Dct2, Dft2, Levelled};

/// The methods' own window: little variance lost, leakage low enough for clean 8-bit pictures.
const DEFAULT_WINDOW: Window = Window::Tukey { taper: 0.25 };

/// Levelled DFT of pictures of one size.
#[derive(Debug)]
pub(super) struct DftFront {
    window: Window,
    taper: Taper,
    dft: Dft2,
    levelled: Levelled,
}

impl DftFront {
    pub(super) fn new(window: Option<Window>, (rows, columns): (usize, usize)) -> Self {
        let window = window.unwrap_or(DEFAULT_WINDOW);
        Self {
            window,
            taper: Taper::new(window, rows, columns),
            dft: Dft2::new(rows, columns),
            levelled: Levelled::for_dft(rows, columns),
        }
    }

    /// Factor by which the window raises the variance of what is estimated from the spectrum.
    pub(super) fn variance_factor(&self) -> f64 {
        let (rows, columns) = self.dft.dim();
        self.window.variance_factor(rows) * self.window.variance_factor(columns)
    }

    pub(super) fn levelled(&self) -> &Levelled {
        &self.levelled
    }

    pub(super) fn set(&mut self, image: ArrayView2<'_, f32>) -> &Levelled {
        self.taper.apply(image, self.dft.input());
        self.levelled.set_from_dft(self.dft.transform());
        &self.levelled
    }
}

/// Levelled DCT of pictures of one size.
#[derive(Debug)]
pub(super) struct DctFront {
    taper: Taper,
    dct: Dct2,
    levelled: Levelled,
}

impl DctFront {
    pub(super) fn new(window: Option<Window>, (rows, columns): (usize, usize)) -> Self {
        Self {
            taper: Taper::new(window.unwrap_or(DEFAULT_WINDOW), rows, columns),
            dct: Dct2::new(rows, columns),
            levelled: Levelled::for_dct(rows, columns),
        }
    }

    pub(super) fn levelled(&self) -> &Levelled {
        &self.levelled
    }

    pub(super) fn set(&mut self, image: ArrayView2<'_, f32>) -> &Levelled {
        self.taper.apply(image, self.dct.input());
        self.levelled.set_from_dct(self.dct.transform());
        &self.levelled
    }
}
