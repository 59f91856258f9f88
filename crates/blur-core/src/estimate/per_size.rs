//! Plans and buffers that belong to one picture size.

/// What an estimator has made for the size of the last picture.
#[derive(Debug)]
pub(super) struct PerSize<P>(Option<((usize, usize), P)>);

impl<P> PerSize<P> {
    /// Nothing made yet.
    pub(super) fn new() -> Self {
        Self(None)
    }

    /// The plan for pictures of `dim` rows and columns; made anew when the size differs from the last one.
    pub(super) fn get(&mut self, dim: (usize, usize), make: impl FnOnce((usize, usize)) -> P) -> &mut P {
        if self.0.as_ref().is_some_and(|(made_for, _)| *made_for != dim) {
            self.0 = None;
        }
        &mut self.0.get_or_insert_with(|| (dim, make(dim))).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_is_made_once_a_size() {
        let mut made = 0;
        let mut plans = PerSize::new();
        for dim in [(3, 4), (3, 4), (4, 3), (3, 4)] {
            assert_eq!(
                *plans.get(dim, |dim| {
                    made += 1;
                    dim
                }),
                dim
            );
        }
        assert_eq!(made, 3);
    }
}
