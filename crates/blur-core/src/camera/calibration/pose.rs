//! Where a board stands before the camera.

use nalgebra::{Matrix3, Rotation3, Vector3};

/// Rotation and translation from the frame of a board to that of the camera.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pose {
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
}

impl Pose {
    /// The board's point in the frame of the camera.
    pub(super) fn place(&self, [x, y]: [f64; 2]) -> Vector3<f64> {
        self.rotation.column(0) * x + self.rotation.column(1) * y + self.translation
    }

    /// The pose turned by the small rotation vector `turn` about the axes of the camera and moved by `shift`.
    pub(super) fn moved(&self, turn: Vector3<f64>, shift: Vector3<f64>) -> Self {
        Self {
            rotation: Rotation3::from_scaled_axis(turn).matrix() * self.rotation,
            translation: self.translation + shift,
        }
    }

    /// Angle in degrees between the normal of the board and the optical axis, 0 to 90.
    pub(super) fn tilt_deg(&self) -> f64 {
        self.rotation[(2, 2)].abs().min(1.0).acos().to_degrees()
    }
}
