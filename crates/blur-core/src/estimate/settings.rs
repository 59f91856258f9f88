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

    /// The part of the range up to `most_px`, at least twice the shortest length that methods look for by themselves.
    pub(crate) fn within(self, most_px: f64) -> Self {
        let max_px = self.max_px.min(most_px.max(2.0 * LEAST_LENGTH_PX));
        Self { min_px: self.min_px.min(0.5 * max_px), max_px }
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
    /// Whether to look for an acceleration too; only methods that fit the likelihood can.
    pub acceleration: bool,
}

/// Shortest length that the methods look for by themselves, in pixels: below it the first dark line leaves the band.
const LEAST_LENGTH_PX: f64 = 4.0;
/// Longest length that the methods look for by themselves, as a share of the picture's extent along the motion.
const MOST_OF_EXTENT: f64 = 0.6;

impl Settings {
    /// The lengths to search in a picture that measures `extent_px` along the motion.
    pub(crate) fn lengths_in(&self, extent_px: f64) -> LengthRange {
        self.length_range.unwrap_or(LengthRange {
            min_px: LEAST_LENGTH_PX,
            // The smallest pictures allowed are 32 pixels wide, so this stays above the shortest length.
            max_px: (MOST_OF_EXTENT * extent_px).max(2.0 * LEAST_LENGTH_PX),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_refused_with_its_offending_end() {
        assert!(LengthRange::new(1.0, 20.0).unwrap_err().to_string().contains("shortest length (px) = 1"));
        assert!(LengthRange::new(10.0, 10.0).unwrap_err().to_string().contains("longest length (px) = 10"));
        assert!(LengthRange::new(f64::NAN, 10.0).is_err());
    }

    #[test]
    fn a_range_is_cut_to_what_a_picture_can_hold() {
        let cut = LengthRange::new(4.0, 1e300).unwrap().within(200.0);
        assert_eq!((cut.min_px(), cut.max_px()), (4.0, 200.0));
        let beyond = LengthRange::new(500.0, 900.0).unwrap().within(200.0);
        assert_eq!((beyond.min_px(), beyond.max_px()), (100.0, 200.0));
        let inside = LengthRange::new(5.0, 50.0).unwrap();
        assert_eq!(inside.within(200.0), inside);
    }

    #[test]
    fn the_search_reaches_to_a_share_of_the_picture() {
        let range = Settings::default().lengths_in(512.0);
        assert!((range.max_px() - 307.2).abs() < 1e-9);
        let own = LengthRange::new(5.0, 50.0).unwrap();
        let settings = Settings { length_range: Some(own), ..Settings::default() };
        assert_eq!(settings.lengths_in(512.0), own);
    }
}
