//! What to measure and how, from keyword arguments.

use blur_core::camera::{Intrinsics, Scale};
use blur_core::estimate::{LengthRange, registry};
use blur_core::image::Window;
use blur_core::meter::{Configuration, Geometry};
use blur_core::motion::Exposure;
use metrology::Measurement;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::camera::Camera;
use crate::error::refuse;
use crate::image::shown;

/// The keyword arguments that every measurement takes.
#[derive(Default)]
struct Options {
    configuration: Configuration,
    exposure_s: Option<f64>,
    exposure_std_s: f64,
    scale_m_per_px: Option<f64>,
    scale_std_m_per_px: f64,
    camera: Option<Intrinsics>,
    distance_m: Option<f64>,
    distance_std_m: f64,
    rotating: bool,
}

/// The configuration that keyword arguments describe. Those for frames that follow each other are known only if `of_frames`.
pub(crate) fn configuration(arguments: Option<&Bound<'_, PyDict>>, of_frames: bool) -> PyResult<Configuration> {
    let mut options = Options::default();
    for (name, value) in arguments.into_iter().flatten() {
        options.set(name.extract()?, &value, of_frames)?;
    }
    options.into_configuration()
}

impl Options {
    fn set(&mut self, name: &str, value: &Bound<'_, PyAny>, of_frames: bool) -> PyResult<()> {
        let settings = &mut self.configuration.settings;
        match name {
            "method" => self.configuration.method = value.extract::<&str>()?.parse().map_err(refuse)?,
            "linearize" => self.configuration.linearize = value.extract()?,
            "length_range_px" => settings.length_range = length_range(value)?,
            "window" => settings.window = window(value)?,
            "acceleration" => settings.acceleration = value.extract()?,
            "exposure_s" => self.exposure_s = value.extract()?,
            "exposure_std_s" => self.exposure_std_s = value.extract()?,
            "scale_m_per_px" => self.scale_m_per_px = value.extract()?,
            "scale_std_m_per_px" => self.scale_std_m_per_px = value.extract()?,
            "camera" => self.camera = value.extract::<Option<PyRef<'_, Camera>>>()?.map(|camera| camera.0.clone()),
            "distance_m" => self.distance_m = value.extract()?,
            "distance_std_m" => self.distance_std_m = value.extract()?,
            "rotating" => self.rotating = value.extract()?,
            "tracking" if of_frames => self.configuration.tracking = value.extract()?,
            "directed" if of_frames => self.configuration.directed = value.extract()?,
            unknown => return Err(PyTypeError::new_err(format!("unexpected keyword argument '{unknown}'"))),
        }
        Ok(())
    }

    fn into_configuration(self) -> PyResult<Configuration> {
        let method = self.configuration.method.to_string();
        if self.configuration.settings.acceleration && !registry::ACCELERATION.contains(&method.as_str()) {
            let known = registry::ACCELERATION.join(", ");
            return Err(refuse(format!("the method {method} cannot look for an acceleration; {known} can")));
        }
        let exposure = self.exposure_s.map(|value| measured(value, self.exposure_std_s)).transpose()?;
        let geometry = self.geometry()?;
        let mut configuration = self.configuration;
        configuration.exposure = exposure.map(Exposure::new).transpose().map_err(refuse)?;
        configuration.geometry = geometry;
        Ok(configuration)
    }

    fn geometry(&self) -> PyResult<Option<Geometry>> {
        let camera = || self.camera.clone().map(Box::new);
        match (self.scale_m_per_px, camera(), self.distance_m, self.rotating) {
            (None, None, None, false) => Ok(None),
            (Some(value), None, None, false) => {
                let scale = Scale::new(measured(value, self.scale_std_m_per_px)?).map_err(refuse)?;
                Ok(Some(Geometry::Scale(scale)))
            }
            (None, Some(camera), Some(value), false) => {
                Ok(Some(Geometry::Plane { camera, distance_m: measured(value, self.distance_std_m)? }))
            }
            (None, Some(camera), None, true) => Ok(Some(Geometry::Rotation { camera })),
            _ => Err(refuse(
                "give scale_m_per_px, or camera with distance_m, or camera with rotating=True: other combinations \
                 contradict each other or leave the speed open",
            )),
        }
    }
}

fn measured(value: f64, std: f64) -> PyResult<Measurement> {
    Measurement::new(value, std).map_err(refuse)
}

fn length_range(value: &Bound<'_, PyAny>) -> PyResult<Option<LengthRange>> {
    let Some((min_px, max_px)) = value.extract::<Option<(f64, f64)>>()? else { return Ok(None) };
    LengthRange::new(min_px, max_px).map(Some).map_err(refuse)
}

fn window(value: &Bound<'_, PyAny>) -> PyResult<Option<Window>> {
    match value.extract::<Option<&str>>()? {
        None => Ok(None),
        Some("none") => Ok(Some(Window::None)),
        Some("hann") => Ok(Some(Window::Hann)),
        Some(_) => Err(refuse(format!("there is no window {}: give 'none' or 'hann'", shown(value)))),
    }
}
