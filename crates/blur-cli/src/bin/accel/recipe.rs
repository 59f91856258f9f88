//! What a regression is made of, on the command line.

use blur_accel::homomorphic::Variant;
use blur_accel::reduce::Components;
use blur_accel::regression::{PRESETS, Preset};
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// Transform of the pictures.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Transform {
    /// Fourier transform
    Dft,
    /// Cosine transform
    Dct,
}

impl From<Transform> for Variant {
    fn from(transform: Transform) -> Self {
        match transform {
            Transform::Dft => Self::Dft,
            Transform::Dct => Self::Dct,
        }
    }
}

/// The names of the regressions.
pub(crate) fn preset() -> impl TypedValueParser<Value = &'static Preset> {
    PossibleValuesParser::new(PRESETS.iter().map(|preset| preset.name)).try_map(|name| Preset::named(&name))
}

/// A number of principal components, or a share of the variance.
pub(crate) fn components(text: &str) -> std::result::Result<Components, String> {
    if let Ok(count @ 1..) = text.parse() {
        return Ok(Components::Count(count));
    }
    match text.parse() {
        Ok(share) if share > 0.0 && share < 1.0 => Ok(Components::Share(share)),
        _ => Err("write a number such as 76, or a share between 0 and 1 such as 0.99".to_owned()),
    }
}
