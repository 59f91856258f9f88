//! Plans for the two sizes that a turned picture can have.

use ndarray::{Array2, ArrayView2};

use crate::estimate::AxialAngle;
use crate::image::{Rotation, Window};

/// A rotation and what a method needs for its results: one plan for motions nearer to the rows and, when the picture is
/// not square, one for motions nearer to the columns.
#[derive(Debug)]
pub(super) struct Oriented<P> {
    rotation: Rotation,
    flat: P,
    steep: Option<P>,
    dim: (usize, usize),
}

impl<P> Oriented<P> {
    /// For pictures of `dim` rows and columns; `make` builds a plan for turned pictures of a size.
    pub(super) fn new(window: Option<Window>, dim: (usize, usize), make: impl Fn((usize, usize)) -> P) -> Self {
        Self {
            rotation: Rotation::new(window, dim.0, dim.1),
            flat: make(dim),
            steep: (dim.0 != dim.1).then(|| make((dim.1, dim.0))),
            dim,
        }
    }

    /// The plan for this angle, with `image` turned into the buffer that `input` names.
    pub(super) fn turn(
        &mut self,
        image: ArrayView2<'_, f32>,
        angle: AxialAngle,
        input: impl FnOnce(&mut P) -> &mut Array2<f32>,
    ) -> &mut P {
        let is_flat = self.rotation.canvas_dim(angle) == self.dim;
        let plan = match &mut self.steep {
            Some(steep) if !is_flat => steep,
            _ => &mut self.flat,
        };
        self.rotation.apply(image, angle, input(plan));
        plan
    }
}
