//! What to measure and how.

use std::ffi::{CStr, c_char};
use std::mem::{offset_of, zeroed};

use blur_core::camera::Scale;
use blur_core::estimate::LengthRange;
use blur_core::estimate::registry::Choice;
use blur_core::image;
use blur_core::meter;
use blur_core::motion::Exposure;
use metrology::Measurement;

use crate::border::guarded;
use crate::versioned::{self, Room, Versioned};
use crate::{Camera, Code, Error, Result};

/// Window laid over a picture before its transform.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Window {
    /// The method's own choice.
    Method = 0,
    /// No taper: the picture as it is.
    None = 1,
    /// Raised cosine over the whole length.
    Hann = 2,
}

/// What turns the pixels of a blur into metres or radians.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Geometry {
    /// Nothing: there is no speed.
    None = 0,
    /// The motion is in a plane of scale_m_per_px.
    Scale = 1,
    /// A calibrated camera sees a motion in a plane at distance_m, parallel to its sensor.
    Plane = 2,
    /// A calibrated camera turns in front of a scene at rest.
    Rotation = 3,
}

/// What to measure and how. Zeros are the defaults, so mb_configuration configuration = {sizeof configuration}; measures
/// direction and length with the recommended method. What is not of the chosen geometry is not looked at.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Configuration {
    /// Its size in bytes: sizeof(mb_configuration).
    pub struct_size: usize,
    /// Name of the method, such as "whittle" or "dct-radon+dct-pseudo-cepstrum"; null for the recommended one.
    pub method: *const c_char,
    /// One of mb_window.
    pub window: i32,
    /// Not 0: look for an acceleration too. Only the method "whittle" can.
    pub acceleration: i32,
    /// Not 0: integer samples follow the sRGB tone curve, which is undone, since motion mixes light.
    pub linearize: i32,
    /// Not 0: pictures are frames that follow each other; a fit may start from the result of the frame before.
    pub tracking: i32,
    /// Not 0: pictures are frames that follow each other; the displacement since the frame before tells a motion from its
    /// opposite.
    pub directed: i32,
    /// One of mb_geometry.
    pub geometry: i32,
    /// Shortest length to search in pixels, at least 2; 0 and 0: from 4 px to what the size of the picture allows.
    pub length_min_px: f64,
    /// Longest length to search in pixels.
    pub length_max_px: f64,
    /// Exposure of every picture in seconds; 0: unknown, so there is no speed.
    pub exposure_s: f64,
    /// Its standard uncertainty.
    pub exposure_std_s: f64,
    /// For MB_GEOMETRY_SCALE: metres in the scene for each pixel.
    pub scale_m_per_px: f64,
    /// Its standard uncertainty.
    pub scale_std_m_per_px: f64,
    /// For MB_GEOMETRY_PLANE: distance from the camera to the plane in metres.
    pub distance_m: f64,
    /// Its standard uncertainty.
    pub distance_std_m: f64,
    /// For MB_GEOMETRY_PLANE and MB_GEOMETRY_ROTATION: the camera. It is copied.
    pub camera: *const Camera,
}

// SAFETY: `repr(C)`, the size first, and numbers and raw pointers only.
unsafe impl Versioned for Configuration {
    const NAME: &'static str = "mb_configuration";
    const LEAST_BYTES: usize = offset_of!(Self, camera) + size_of::<*const Camera>();
}

/// Sets all fields of a configuration to their defaults. struct_size is sizeof(mb_configuration).
///
/// # Safety
/// `configuration` is null or points to `struct_size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mb_configuration_default(configuration: *mut Configuration, struct_size: usize) -> Code {
    guarded(|| {
        let bytes = configuration.cast::<u8>();
        if bytes.is_null() {
            return Err(Error::NullPointer { name: Configuration::NAME });
        }
        if struct_size >= size_of::<usize>() {
            // SAFETY: the caller promises that many writable bytes.
            unsafe { bytes.write_bytes(0, struct_size) };
            // SAFETY: the size is the first field, and there is room for it.
            unsafe { configuration.cast::<usize>().write_unaligned(struct_size) };
        }
        // SAFETY: the caller promises as many bytes as the first field now says.
        let room = unsafe { Room::at(configuration) }?;
        // SAFETY: any bytes make a valid value of this type.
        room.fill(&unsafe { zeroed() });
        Ok(())
    })
}

/// Reads a configuration that a program filled.
///
/// # Safety
/// `from` is null or points to as many readable bytes as its first field says; its method is null or text that ends in a zero
/// byte, and its camera is as [`versioned::read`] demands.
pub(crate) unsafe fn read(from: *const Configuration) -> Result<meter::Configuration> {
    // SAFETY: as promised by the caller.
    let given = unsafe { versioned::read(from) }?;
    let mut configuration = meter::Configuration::default();
    if !given.method.is_null() {
        // SAFETY: the caller promises text that ends in a zero byte.
        configuration.method = method(unsafe { CStr::from_ptr(given.method) })?;
    }
    configuration.settings.window = window(given.window)?;
    configuration.settings.length_range = length_range(given.length_min_px, given.length_max_px)?;
    configuration.settings.acceleration = given.acceleration != 0;
    configuration.linearize = given.linearize != 0;
    configuration.tracking = given.tracking != 0;
    configuration.directed = given.directed != 0;
    configuration.exposure = exposure(given.exposure_s, given.exposure_std_s)?;
    // SAFETY: as promised by the caller.
    configuration.geometry = unsafe { geometry(&given) }?;
    Ok(configuration)
}

fn method(name: &CStr) -> Result<Choice> {
    let name = name.to_str().map_err(|error| Error::MethodText { valid_bytes: error.valid_up_to() })?;
    name.parse().map_err(Error::Configuration)
}

fn window(value: i32) -> Result<Option<image::Window>> {
    const METHOD: i32 = Window::Method as i32;
    const NONE: i32 = Window::None as i32;
    const HANN: i32 = Window::Hann as i32;
    match value {
        METHOD => Ok(None),
        NONE => Ok(Some(image::Window::None)),
        HANN => Ok(Some(image::Window::Hann)),
        _ => Err(Error::UnknownValue { field: "mb_configuration.window", value, most: HANN, enumeration: "mb_window" }),
    }
}

fn length_range(min_px: f64, max_px: f64) -> Result<Option<LengthRange>> {
    if min_px == 0.0 && max_px == 0.0 {
        return Ok(None);
    }
    LengthRange::new(min_px, max_px).map(Some).map_err(Error::Configuration)
}

fn exposure(seconds: f64, std_s: f64) -> Result<Option<Exposure>> {
    if seconds == 0.0 {
        return Ok(None);
    }
    Exposure::new(measurement(seconds, std_s)?).map(Some).map_err(Error::Configuration)
}

/// # Safety
/// The camera is as [`versioned::read`] demands.
unsafe fn geometry(given: &Configuration) -> Result<Option<meter::Geometry>> {
    const NONE: i32 = Geometry::None as i32;
    const SCALE: i32 = Geometry::Scale as i32;
    const PLANE: i32 = Geometry::Plane as i32;
    const ROTATION: i32 = Geometry::Rotation as i32;
    // SAFETY: as promised by the caller.
    let camera = || unsafe { versioned::read(given.camera) }?.intrinsics().map(Box::new);
    Ok(Some(match given.geometry {
        NONE => return Ok(None),
        SCALE => {
            let m_per_px = measurement(given.scale_m_per_px, given.scale_std_m_per_px)?;
            meter::Geometry::Scale(Scale::new(m_per_px).map_err(Error::Configuration)?)
        }
        PLANE => meter::Geometry::Plane {
            camera: camera()?,
            distance_m: measurement(given.distance_m, given.distance_std_m)?,
        },
        ROTATION => meter::Geometry::Rotation { camera: camera()? },
        value => {
            return Err(Error::UnknownValue {
                field: "mb_configuration.geometry",
                value,
                most: ROTATION,
                enumeration: "mb_geometry",
            });
        }
    }))
}

fn measurement(value: f64, std: f64) -> Result<Measurement> {
    Measurement::new(value, std).map_err(|error| Error::Configuration(error.into()))
}
