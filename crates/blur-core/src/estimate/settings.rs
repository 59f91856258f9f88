//! What a caller may set for every method.

use crate::image::Window;
use crate::{Error, Result};

/// Shortest and longest blur length that a method looks for, in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthRange {
    min_px: f64,
    max_px: f64,
}

impl LengthRange {
    /// A range with `2 <= min_px < max_px`.
    pub fn new(min_px: f64, max_px: f64) -> Result<Self> {
        if !(min_px.is_finite() && min_px >= 2.0) {
            return Err(Error::Parameter { name: "shortest length (px)", value: min_px, expected: "at least 2" });
        }
        if !(max_px.is_finite() && max_px > min_px) {
            return Err(Error::Parameter {
                name: "longest length (px)",
                value: max_px,
                expected: "greater than the shortest length",
            });
        }
        Ok(Self { min_px, max_px })
    }

    /// Shortest length in pixels.
    pub fn min_px(self) -> f64 {
        self.min_px
    }

    /// Longest length in pixels.
    pub fn max_px(self) -> f64 {
        self.max_px
    }
}

/// Settings that all methods share. The default leaves every choice to the method.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Window laid over the picture before its transform; `None`: the method's own choice.
    pub window: Option<Window>,
    /// Lengths to search; `None`: from 4 px to what the picture's size allows.
    pub length_range: Option<LengthRange>,
}
