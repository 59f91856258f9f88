//! Cameras as JSON.
//!
//! ```json
//! {"format":"blur camera","version":1,"program":"0.1.0","sha256":"…","camera":{…}}
//! ```
//!
//! `camera` holds the parameters with their standard uncertainties and covariance. `sha256`, the checksum of its text without
//! spaces, may be left out of a file that is written by hand. A version, once released, is read for ever.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use blur_accel::model::sha256;
use blur_core::camera::{Calibration, Intrinsics, PARAMETER_NAMES, PARAMETERS};
use serde::ser::{Error as _, SerializeSeq};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::value::RawValue;

use crate::{Error, Result};

/// What a camera's file calls itself.
pub const FORMAT: &str = "blur camera";
/// Version of the format that is written; all versions from 1 on are read.
pub const VERSION: u64 = 1;

/// The meaning of the parameters, for whoever opens the file.
const MODEL: &str = "u = fx x' + skew y' + cx, v = fy y' + cy in pixels from the centre of the first, as stored; \
     x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2), \
     y' = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y";

/// Most bytes of a file.
const MAX_BYTES: u64 = 1 << 20;
/// A standard uncertainty may differ so much, relatively, from the root of its variance.
const ROUNDING: f64 = 1e-6;

/// What files of every version have, those to come included.
#[derive(Deserialize)]
struct Start {
    format: String,
    version: u64,
    program: Option<String>,
}

#[derive(Serialize, Deserialize)]
struct Document {
    format: String,
    version: u64,
    program: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<String>,
    camera: Camera,
}

/// A calibrated camera as it stands in a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Camera {
    model: String,
    width_px: usize,
    height_px: usize,
    /// Pictures of the board.
    views: usize,
    /// Points in all of them.
    points: usize,
    /// Root mean square distance of the points from where the camera would see them.
    rms_px: f64,
    parameters: Vec<Parameter>,
    /// In the order of the parameters.
    #[serde(serialize_with = "one_row_a_line")]
    covariance: Vec<Vec<f64>>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Parameter {
    name: String,
    value: f64,
    std: f64,
}

/// The camera of a calibration as the text of a file.
pub fn to_json(calibration: &Calibration) -> Result<String> {
    let intrinsics = &calibration.intrinsics;
    let numbers = intrinsics.parameters().iter().zip(intrinsics.stds());
    let camera = Camera {
        model: MODEL.to_owned(),
        width_px: intrinsics.width_px(),
        height_px: intrinsics.height_px(),
        views: calibration.view_rms_px.len(),
        points: calibration.points,
        rms_px: calibration.rms_px,
        parameters: PARAMETER_NAMES
            .iter()
            .zip(numbers)
            .map(|(&name, (&value, std))| Parameter { name: name.to_owned(), value, std })
            .collect(),
        covariance: intrinsics.covariance().iter().map(|row| row.to_vec()).collect(),
    };
    let document = Document {
        format: FORMAT.to_owned(),
        version: VERSION,
        program: env!("CARGO_PKG_VERSION").to_owned(),
        sha256: Some(checksum(&camera)?),
        camera,
    };
    let mut text = serde_json::to_string_pretty(&document)?;
    text.push('\n');
    Ok(text)
}

/// The camera in the text of a file.
///
/// # Errors
/// [`Error::NotACamera`], [`Error::NewerCamera`], [`Error::CameraDamaged`] when the text is not what was written, and those of
/// [`Intrinsics::new`] when it is but describes no camera.
pub fn from_json(text: &[u8]) -> Result<Intrinsics> {
    let damaged = |reason: String| Error::CameraDamaged { reason };
    let start: Start = serde_json::from_slice(text).map_err(|error| {
        let names_itself = text.windows(FORMAT.len()).any(|part| part == FORMAT.as_bytes());
        if names_itself { damaged(error.to_string()) } else { Error::NotACamera }
    })?;
    if start.format != FORMAT {
        return Err(Error::NotACamera);
    }
    if start.version > VERSION {
        let program =
            start.program.map_or_else(|| "a later program".to_owned(), |program| format!("program {program} or later"));
        return Err(Error::NewerCamera { version: start.version, known: VERSION, program });
    }
    let document: Document = serde_json::from_slice(text).map_err(|error| damaged(error.to_string()))?;
    if document.version < 1 {
        return Err(damaged("there is no version 0".to_owned()));
    }
    if let Some(sum) = &document.sha256
        && *sum != checksum(&document.camera)?
    {
        return Err(damaged("its checksum does not fit its content".to_owned()));
    }
    intrinsics(&document.camera)
}

/// Reads the camera in a file.
///
/// # Errors
/// Those of [`from_json`] and [`Error::Read`], with the name of the file.
pub fn read(path: &Path) -> Result<Intrinsics> {
    let content = || -> Result<Intrinsics> {
        let mut text = Vec::new();
        File::open(path).map_err(Error::Read)?.take(MAX_BYTES).read_to_end(&mut text).map_err(Error::Read)?;
        from_json(&text)
    };
    content().map_err(|error| error.in_file(path))
}

fn intrinsics(camera: &Camera) -> Result<Intrinsics> {
    let damaged = |reason: String| Error::CameraDamaged { reason };
    let mut values = [0.0; PARAMETERS];
    let mut covariance = [[0.0; PARAMETERS]; PARAMETERS];
    // Parameters that are not named are 0 and exact.
    let mut places = Vec::with_capacity(PARAMETERS);
    for parameter in &camera.parameters {
        let place = PARAMETER_NAMES.iter().position(|&name| name == parameter.name);
        let place = place.ok_or_else(|| {
            damaged(format!("there is no parameter '{}'; known: {}", parameter.name, PARAMETER_NAMES.join(" ")))
        })?;
        if places.contains(&place) {
            return Err(damaged(format!("the parameter '{}' stands there twice", parameter.name)));
        }
        values[place] = parameter.value;
        places.push(place);
    }
    let (rows, expected) = (camera.covariance.len(), places.len());
    if let Some(found) = camera.covariance.iter().map(Vec::len).chain([rows]).find(|&found| found != expected) {
        return Err(damaged(format!("the covariance of {expected} parameters has a side of {found}")));
    }
    for (row, &i) in camera.covariance.iter().zip(&places) {
        for (&value, &j) in row.iter().zip(&places) {
            covariance[i][j] = value;
        }
    }
    let intrinsics = Intrinsics::new(values, covariance, camera.width_px, camera.height_px)?;
    for (parameter, &place) in camera.parameters.iter().zip(&places) {
        let std = intrinsics.stds()[place];
        let is_root = (parameter.std - std).abs() <= ROUNDING * std;
        if !is_root {
            return Err(damaged(format!(
                "the standard uncertainty {} of {} is not the root of its variance, {std}",
                parameter.std, parameter.name
            )));
        }
    }
    Ok(intrinsics)
}

fn checksum(camera: &Camera) -> Result<String> {
    Ok(sha256(serde_json::to_string(camera)?.as_bytes()))
}

/// A matrix of which each row stays on one line, however the rest is laid out.
fn one_row_a_line<S: Serializer>(rows: &[Vec<f64>], serializer: S) -> std::result::Result<S::Ok, S::Error> {
    let mut sequence = serializer.serialize_seq(Some(rows.len()))?;
    for row in rows {
        let text = serde_json::to_string(row).map_err(S::Error::custom)?;
        sequence.serialize_element(&RawValue::from_string(text).map_err(S::Error::custom)?)?;
    }
    sequence.end()
}
