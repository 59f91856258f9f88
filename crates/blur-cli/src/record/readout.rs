//! The fields of a rolling shutter.

use blur_core::camera::Scale;
use blur_core::motion::{COVERAGE_K, RolledSpeed, SpeedChange};
use metrology::combined_std;
use serde::{Serialize, Serializer};

use crate::picture::RowsRun;

/// What the time between the rows does to the speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReadoutFields {
    /// Time in seconds from the first row to the last.
    pub readout_s: f64,
    /// Where the rows follow each other in the upright picture.
    #[serde(serialize_with = "name")]
    pub rows_run: RowsRun,
    /// The speed during the exposure.
    #[serde(flatten)]
    pub speeds: RolledSpeedFields,
    /// The change of the speed from the first row to the last, when there is a map.
    #[serde(flatten)]
    pub change: Option<ChangeFields>,
    /// Why the map gives none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub change_reason: Option<String>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "what the serializer calls it with")]
fn name<S: Serializer>(rows_run: &RowsRun, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(rows_run.name())
}

/// Two candidates, since one picture cannot tell a motion from its opposite. Down is along the rows as the sensor reads
/// them, from the first to the last.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RolledSpeedFields {
    /// Speed in metres per second if the content moved down, along with the readout.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_down_m_s: Option<f64>,
    /// Its expanded uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_down_expanded_m_s: Option<f64>,
    /// Speed if it moved up; absent when no speed upwards leaves such a blur.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_up_m_s: Option<f64>,
    /// Its expanded uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_up_expanded_m_s: Option<f64>,
}

impl RolledSpeedFields {
    /// The fields of the speeds downwards and upwards.
    pub fn new(speeds: [RolledSpeed; 2]) -> Self {
        let [down, up] = speeds.map(|speed| Some(speed).filter(|speed| speed.value_m_s.is_finite()));
        Self {
            speed_down_m_s: down.map(|speed| speed.value_m_s),
            speed_down_expanded_m_s: down.and_then(|speed| speed.expanded_m_s()),
            speed_up_m_s: up.map(|speed| speed.value_m_s),
            speed_up_expanded_m_s: up.and_then(|speed| speed.expanded_m_s()),
        }
    }
}

/// How the speed changes while the rows are read, see [`SpeedChange`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChangeFields {
    /// Pixels per second squared; negative when the motion slows down.
    pub change_px_s2: f64,
    /// Its combined standard uncertainty.
    pub change_std_px_s2: f64,
    /// Tiles that it is from.
    pub change_tiles: usize,
    /// In metres per second squared.
    #[serde(flatten)]
    pub metric: Option<MetricChange>,
    /// Its amount in standard uncertainties.
    pub change_significance: f64,
    /// Whether it is more than its expanded uncertainty.
    pub significant: bool,
}

/// The change in the scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MetricChange {
    /// Metres per second squared.
    pub change_m_s2: f64,
    /// Its combined standard uncertainty.
    pub change_std_m_s2: f64,
    /// Its expanded uncertainty.
    pub change_expanded_m_s2: f64,
}

impl ChangeFields {
    /// The fields of `change`, in metres where the scale is known.
    pub fn new(change: SpeedChange, scale: Option<Scale>) -> Self {
        let metric = scale.map(|scale| {
            let k = scale.m_per_px();
            let std = combined_std([(k.value(), change.std_px_s2), (change.value_px_s2, k.std())]);
            MetricChange {
                change_m_s2: k.value() * change.value_px_s2,
                change_std_m_s2: std,
                change_expanded_m_s2: COVERAGE_K * std,
            }
        });
        Self {
            change_px_s2: change.value_px_s2,
            change_std_px_s2: change.std_px_s2,
            change_tiles: change.tiles,
            metric,
            change_significance: change.significance(),
            significant: change.is_significant(),
        }
    }
}
