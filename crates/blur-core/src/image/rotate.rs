//! Rotation of a picture.

/// Placeholder until the rotation lands in the next commit of this module.
#[derive(Debug)]
pub struct Rotation;
