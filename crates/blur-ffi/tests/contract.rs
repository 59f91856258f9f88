//! Through C the meter gives what it gives in Rust, bit for bit, whatever the form of the samples.

#![allow(clippy::unwrap_used, clippy::missing_panics_doc, reason = "a test")]

mod fields;

use std::ffi::{CStr, CString};
use std::path::Path;
use std::ptr;

use blur_core::camera::Intrinsics;
use blur_core::estimate::LengthRange;
use blur_core::image::{self, PixelFormat, Pixels, SampleType, Window};
use blur_core::meter;
use metrology::Measurement;
use motion_blur::{
    Camera, Channels, Code, Configuration, Geometry, Meter, Picture, Record, Sample, mb_configuration_default,
    mb_error_message, mb_meter_free, mb_meter_measure, mb_meter_method, mb_meter_new, mb_meter_reason, mb_meter_reset,
};
use ndarray::Array2;

/// Grey codes of the project's sample, cut to a size that is not square.
fn sample() -> Array2<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/sample.png");
    let luma = blur_picture::read(&path, blur_picture::Linearize::Off).unwrap().luma;
    luma.slice(ndarray::s![..200, ..240]).mapv(|value| value as u8)
}

fn configuration() -> Configuration {
    // SAFETY: integers, floats and raw pointers may all be zero.
    let mut configuration = unsafe { std::mem::zeroed() };
    // SAFETY: the size is that of the value.
    let code = unsafe { mb_configuration_default(&raw mut configuration, size_of::<Configuration>()) };
    assert_eq!(code, Code::Ok);
    configuration
}

fn record() -> Record {
    // SAFETY: numbers may all be zero, and so may the status.
    Record { struct_size: size_of::<Record>(), ..unsafe { std::mem::zeroed() } }
}

fn message() -> String {
    // SAFETY: the pointer is to a string that ends in a zero byte, and no call fails before it is copied.
    unsafe { CStr::from_ptr(mb_error_message()) }.to_str().unwrap().to_owned()
}

struct Handle(*mut Meter);

impl Handle {
    fn new(configuration: &Configuration) -> Result<Self, (Code, String)> {
        let mut meter = ptr::dangling_mut();
        // SAFETY: both pointers are to values.
        match unsafe { mb_meter_new(ptr::from_ref(configuration), &raw mut meter) } {
            Code::Ok => Ok(Self(meter)),
            code => {
                assert!(meter.is_null());
                Err((code, message()))
            }
        }
    }

    fn measure(&self, picture: &Picture) -> Result<Record, (Code, String)> {
        let mut record = record();
        // SAFETY: the meter lives, and the tests describe memory that is there.
        match unsafe { mb_meter_measure(self.0, ptr::from_ref(picture), &raw mut record) } {
            Code::Ok => Ok(record),
            code => Err((code, message())),
        }
    }

    fn text(&self, write: unsafe extern "C" fn(*const Meter, *mut std::ffi::c_char, usize) -> usize) -> String {
        let mut buffer = [0_u8; 256];
        // SAFETY: the meter lives, and the buffer has that many bytes.
        let length = unsafe { write(self.0, buffer.as_mut_ptr().cast(), buffer.len()) };
        let text = CStr::from_bytes_until_nul(&buffer).unwrap().to_str().unwrap().to_owned();
        assert_eq!(text.len(), length);
        text
    }

    /// What C programs print of a record.
    fn fields(&self, record: &Record) -> String {
        fields::of_c(record, &self.text(mb_meter_method), &self.text(mb_meter_reason))
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: it was made by the library and is freed once.
        unsafe { mb_meter_free(self.0) };
    }
}

/// One way of storing a picture: its bytes, and the distance between rows.
struct Form {
    name: String,
    bytes: Vec<u8>,
    /// Where the first row begins.
    offset: usize,
    row_bytes: usize,
    sample: (Sample, SampleType),
    channels: (Channels, image::Channels),
}

const SAMPLES: [(Sample, SampleType); 3] =
    [(Sample::U8, SampleType::U8), (Sample::U16, SampleType::U16), (Sample::F32, SampleType::F32)];
const CHANNELS: [(Channels, image::Channels); 6] = [
    (Channels::Grey, image::Channels::Grey),
    (Channels::GreyAlpha, image::Channels::GreyAlpha),
    (Channels::Rgb, image::Channels::Rgb),
    (Channels::Rgba, image::Channels::Rgba),
    (Channels::Bgr, image::Channels::Bgr),
    (Channels::Bgra, image::Channels::Bgra),
];

/// Every form of a picture, tight and as a region of a larger buffer, whose other bytes would spoil any result.
fn forms(codes: &Array2<u8>) -> Vec<Form> {
    let mut forms = Vec::new();
    for sample in SAMPLES {
        for channels in CHANNELS {
            let format = PixelFormat { sample: sample.1, channels: channels.1 };
            // The last gap leaves the rows of a float picture at addresses that are not those of floats.
            for (offset, gap) in [(0, 0), (64, 32), (3, 5)] {
                let row_bytes = codes.ncols() * format.bytes() + gap;
                let mut bytes = vec![0xff_u8; offset];
                for row in codes.rows() {
                    row.iter().for_each(|&code| push_pixel(&mut bytes, code, format));
                    bytes.extend(std::iter::repeat_n(0xff, gap));
                }
                // Nothing may be read after the last sample.
                bytes.truncate(bytes.len() - gap);
                let name = format!("{format:?}, offset {offset}, gap {gap}");
                forms.push(Form { name, bytes, offset, row_bytes, sample, channels });
            }
        }
    }
    forms
}

/// A pixel whose colours differ, so that an order that is wrong shows.
fn push_pixel(bytes: &mut Vec<u8>, code: u8, format: PixelFormat) {
    let colours = [code, code / 2, 255 - code, 7];
    for &colour in &colours[..format.channels.count()] {
        match format.sample {
            SampleType::U8 => bytes.push(colour),
            SampleType::U16 => bytes.extend((u16::from(colour) * 256 + u16::from(code)).to_ne_bytes()),
            SampleType::F32 => bytes.extend((f32::from(colour) / 3.0).to_ne_bytes()),
        }
    }
}

impl Form {
    fn picture(&self, codes: &Array2<u8>) -> Picture {
        Picture {
            struct_size: size_of::<Picture>(),
            data: self.bytes[self.offset..].as_ptr().cast(),
            width: codes.ncols(),
            height: codes.nrows(),
            row_bytes: self.row_bytes as isize,
            sample: self.sample.0 as i32,
            channels: self.channels.0 as i32,
        }
    }
}

#[test]
fn every_form_of_a_picture_gives_the_record_of_rust() {
    let codes = sample();
    for linearize in [false, true] {
        let mut rust = meter::Meter::new({
            let mut configuration = meter::Configuration::default();
            configuration.linearize = linearize;
            configuration
        })
        .unwrap();
        let c = Handle::new(&Configuration { linearize: i32::from(linearize), ..configuration() }).unwrap();
        for form in forms(&codes) {
            let format = PixelFormat { sample: form.sample.1, channels: form.channels.1 };
            let bytes = &form.bytes[form.offset..];
            let pixels = Pixels::new(bytes, codes.ncols(), codes.nrows(), form.row_bytes, format).unwrap();
            let expected = fields::of_rust(&rust.measure(&pixels).unwrap());
            let found = c.measure(&form.picture(&codes)).unwrap();
            assert_eq!(c.fields(&found), expected, "{}", form.name);
        }
    }
}

/// A camera of some 60 degrees with a weak lens, as known as a calibration makes it.
fn camera() -> Camera {
    let parameters = [220.0, 221.0, 119.0, 101.0, 0.0, -0.1, 0.02, 0.001, -0.001, 0.0];
    let stds = [0.5, 0.5, 0.8, 0.8, 0.0, 0.002, 0.005, 1e-4, 1e-4, 0.0];
    let mut covariance = [[0.0; 10]; 10];
    for (i, std) in stds.into_iter().enumerate() {
        covariance[i][i] = std * std;
    }
    Camera { struct_size: size_of::<Camera>(), width_px: 240, height_px: 200, parameters, covariance }
}

/// The same setting in Rust.
type Set<'a> = Box<dyn Fn(&mut meter::Configuration) + 'a>;

#[test]
fn every_setting_reaches_the_meter() {
    let codes = sample();
    let camera = camera();
    let intrinsics =
        || Box::new(Intrinsics::new(camera.parameters, camera.covariance, camera.width_px, camera.height_px).unwrap());
    let measured = |value, std| Measurement::new(value, std).unwrap();
    let name = CString::new("dct-radon+dct-pseudo-cepstrum").unwrap();
    let exposed = Configuration { exposure_s: 0.1, exposure_std_s: 1e-4, ..configuration() };
    let scaled = Configuration { scale_m_per_px: 8e-4, scale_std_m_per_px: 2e-6, ..exposed };
    let exposure = blur_core::motion::Exposure::new(measured(0.1, 1e-4)).unwrap();
    let scale = || meter::Geometry::Scale(blur_core::camera::Scale::new(measured(8e-4, 2e-6)).unwrap());
    let cases: Vec<(&str, Configuration, Set<'_>)> = vec![
        (
            "method",
            Configuration { method: name.as_ptr(), ..configuration() },
            Box::new(|rust| rust.method = "dct-radon+dct-pseudo-cepstrum".parse().unwrap()),
        ),
        (
            "window",
            Configuration { window: motion_blur::Window::Hann as i32, ..configuration() },
            Box::new(|rust| rust.settings.window = Some(Window::Hann)),
        ),
        (
            "no window",
            Configuration { window: motion_blur::Window::None as i32, ..configuration() },
            Box::new(|rust| rust.settings.window = Some(Window::None)),
        ),
        (
            "range",
            Configuration { length_min_px: 30.0, length_max_px: 60.0, ..configuration() },
            Box::new(|rust| rust.settings.length_range = Some(LengthRange::new(30.0, 60.0).unwrap())),
        ),
        ("exposure alone", exposed, Box::new(|rust| rust.exposure = Some(exposure))),
        (
            "scale and exposure",
            Configuration { geometry: Geometry::Scale as i32, ..scaled },
            Box::new(|rust| {
                rust.exposure = Some(exposure);
                rust.geometry = Some(scale());
            }),
        ),
        (
            "acceleration in a plane of known scale",
            Configuration { geometry: Geometry::Scale as i32, acceleration: 1, ..scaled },
            Box::new(|rust| {
                rust.settings.acceleration = true;
                rust.exposure = Some(exposure);
                rust.geometry = Some(scale());
            }),
        ),
        (
            "camera and distance",
            Configuration {
                geometry: Geometry::Plane as i32,
                camera: &raw const camera,
                distance_m: 1.2,
                distance_std_m: 0.01,
                ..exposed
            },
            Box::new(|rust| {
                rust.exposure = Some(exposure);
                rust.geometry = Some(meter::Geometry::Plane { camera: intrinsics(), distance_m: measured(1.2, 0.01) });
            }),
        ),
        (
            "turning camera",
            Configuration { geometry: Geometry::Rotation as i32, camera: &raw const camera, ..exposed },
            Box::new(|rust| {
                rust.exposure = Some(exposure);
                rust.geometry = Some(meter::Geometry::Rotation { camera: intrinsics() });
            }),
        ),
        ("tracking", Configuration { tracking: 1, ..configuration() }, Box::new(|rust| rust.tracking = true)),
        ("directed", Configuration { directed: 1, ..configuration() }, Box::new(|rust| rust.directed = true)),
    ];
    let form = &forms(&codes)[0];
    let format = PixelFormat { sample: SampleType::U8, channels: image::Channels::Grey };
    let pixels = Pixels::new(&form.bytes, codes.ncols(), codes.nrows(), form.row_bytes, format).unwrap();
    let plain = fields::of_rust(&meter::Meter::new(meter::Configuration::default()).unwrap().measure(&pixels).unwrap());
    for (what, c, set) in cases {
        let mut rust = meter::Configuration::default();
        set(&mut rust);
        let mut rust = meter::Meter::new(rust).unwrap();
        let c = Handle::new(&c).unwrap();
        // Twice, for what the second frame makes of the first.
        for _ in 0..2 {
            let expected = fields::of_rust(&rust.measure(&pixels).unwrap());
            // One picture twice has no direction, and this one is too doubtful to be tracked.
            assert!(expected != plain || ["tracking", "directed"].contains(&what), "{what} changes nothing");
            assert_eq!(c.fields(&c.measure(&form.picture(&codes)).unwrap()), expected, "{what}");
        }
    }
}

#[test]
fn what_is_not_allowed_is_refused_with_its_numbers() {
    let bad_name = CString::new("wiener").unwrap();
    let untracked = CString::new("phase-autocorrelation").unwrap();
    let no_text = CString::new([b'a', 0xff]).unwrap();
    let camera = Camera { width_px: 0, ..camera() };
    let plain = configuration();
    let cases = [
        (Configuration { method: bad_name.as_ptr(), ..plain }, Code::Configuration, "'wiener'"),
        (Configuration { method: no_text.as_ptr(), ..plain }, Code::Configuration, "from byte 1 on"),
        (Configuration { method: untracked.as_ptr(), tracking: 1, ..plain }, Code::Configuration, "cannot follow"),
        (Configuration { window: -4, ..plain }, Code::UnknownValue, "mb_configuration.window = -4"),
        (Configuration { geometry: 4, ..plain }, Code::UnknownValue, "mb_configuration.geometry = 4"),
        (Configuration { length_min_px: 9.0, ..plain }, Code::Configuration, "longest length (px) = 0"),
        (Configuration { exposure_s: -0.1, ..plain }, Code::Configuration, "exposure (s) = -0.1"),
        (Configuration { exposure_s: f64::NAN, ..plain }, Code::Configuration, "NaN is not a finite number"),
        (Configuration { exposure_s: 0.1, exposure_std_s: -1.0, ..plain }, Code::Configuration, "uncertainty -1"),
        (Configuration { geometry: Geometry::Scale as i32, ..plain }, Code::Configuration, "scale (m/px) = 0"),
        (Configuration { geometry: Geometry::Plane as i32, ..plain }, Code::NullPointer, "mb_camera is null"),
        (
            Configuration { geometry: Geometry::Rotation as i32, camera: &raw const camera, ..plain },
            Code::Configuration,
            "width (px) = 0",
        ),
        (Configuration { struct_size: 8, ..plain }, Code::StructSize, "mb_configuration.struct_size is 8"),
    ];
    for (configuration, code, part) in cases {
        let (found, message) = Handle::new(&configuration).map(|_| ()).unwrap_err();
        assert_eq!(found, code, "{message}");
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn pictures_that_cannot_be_measured_are_refused_and_the_meter_lives_on() {
    let codes = sample();
    let forms = forms(&codes);
    let picture = forms[0].picture(&codes);
    let grey = [0.5_f32; 64 * 64];
    let mut holed = grey;
    holed[64 * 9 + 5] = f32::NAN;
    let floats = |data: &[f32]| Picture {
        data: data.as_ptr().cast(),
        width: 64,
        height: 64,
        row_bytes: 256,
        sample: Sample::F32 as i32,
        ..picture
    };
    let c = Handle::new(&configuration()).unwrap();
    let cases = [
        (Picture { width: 31, ..picture }, Code::Picture, "31x200"),
        (Picture { width: 0, ..picture }, Code::Picture, "0x200"),
        (Picture { height: 0, ..picture }, Code::Picture, "240x0"),
        (Picture { row_bytes: 239, ..picture }, Code::Layout, "row_bytes = 239"),
        (Picture { row_bytes: -240, ..picture }, Code::Layout, "row_bytes = -240"),
        (Picture { height: usize::MAX, ..picture }, Code::Layout, "larger than any memory"),
        (Picture { width: usize::MAX, sample: 1, ..picture }, Code::Layout, "larger than any memory"),
        (Picture { sample: 3, ..picture }, Code::UnknownValue, "mb_picture.sample = 3"),
        (Picture { channels: 6, ..picture }, Code::UnknownValue, "mb_picture.channels = 6"),
        (Picture { data: ptr::null(), ..picture }, Code::NullPointer, "mb_picture.data"),
        (Picture { struct_size: 0, ..picture }, Code::StructSize, "mb_picture.struct_size is 0"),
        (floats(&grey), Code::Picture, "all pixels have the value 0.5"),
        (floats(&holed), Code::Picture, "row 9, column 5 is NaN"),
    ];
    let whole = c.fields(&c.measure(&picture).unwrap());
    for (bad, code, part) in cases {
        let (found, message) = c.measure(&bad).unwrap_err();
        assert_eq!(found, code, "{message}");
        assert!(message.contains(part), "{message}");
    }
    assert_eq!(c.fields(&c.measure(&picture).unwrap()), whole);
}

#[test]
fn a_record_that_has_no_room_is_not_touched() {
    let codes = sample();
    let forms = forms(&codes);
    let picture = forms[0].picture(&codes);
    let c = Handle::new(&configuration()).unwrap();
    let mut small = Record { struct_size: size_of::<Record>() - 1, angle_deg: -7.0, ..record() };
    // SAFETY: the meter and the picture live; what is beyond the size given is not written.
    assert_eq!(unsafe { mb_meter_measure(c.0, &raw const picture, &raw mut small) }, Code::StructSize);
    assert_eq!((small.struct_size, small.angle_deg), (size_of::<Record>() - 1, -7.0));
    // SAFETY: null is allowed.
    assert_eq!(unsafe { mb_meter_measure(c.0, &raw const picture, ptr::null_mut()) }, Code::NullPointer);
}

#[test]
fn reasons_are_cut_to_their_room_and_forgotten_on_reset() {
    let noise: Vec<u8> = (0..128_u32 * 128).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let picture = Picture {
        struct_size: size_of::<Picture>(),
        data: noise.as_ptr().cast(),
        width: 128,
        height: 128,
        row_bytes: 128,
        sample: Sample::U8 as i32,
        channels: Channels::Grey as i32,
    };
    let c = Handle::new(&configuration()).unwrap();
    assert_eq!(c.text(mb_meter_reason), "");
    assert_ne!(c.measure(&picture).unwrap().status, motion_blur::Status::Ok);
    let reason = c.text(mb_meter_reason);
    assert!(reason.len() > 10, "{reason}");
    let mut buffer = [0x55_u8; 8];
    // SAFETY: the meter lives, and the buffer is larger than what is said of it.
    let length = unsafe { mb_meter_reason(c.0, buffer.as_mut_ptr().cast(), 6) };
    assert_eq!(length, reason.len());
    assert_eq!((&buffer[..5], &buffer[5..]), (&reason.as_bytes()[..5], &[0, 0x55, 0x55][..]));
    // SAFETY: as before; null and no room only ask for the length.
    assert_eq!(unsafe { mb_meter_reason(c.0, ptr::null_mut(), 6) }, length);
    // SAFETY: as before.
    assert_eq!(unsafe { mb_meter_reason(c.0, buffer.as_mut_ptr().cast(), 0) }, length);
    assert_eq!(buffer[5..], [0, 0x55, 0x55]);
    // SAFETY: the meter lives.
    assert_eq!(unsafe { mb_meter_reset(c.0) }, Code::Ok);
    assert_eq!(c.text(mb_meter_reason), "");
}
