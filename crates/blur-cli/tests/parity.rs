//! The program and the meter of the core tell the same, bit for bit.
#![allow(clippy::unwrap_used, reason = "a picture that cannot be made or measured fails the test")]

mod common;

use blur_cli::picture::{self, Linearize};
use blur_core::camera::Scale;
use blur_core::image::{Channels, PixelFormat, Pixels, SampleType};
use blur_core::meter::{Configuration, Geometry, Meter};
use blur_core::motion::Exposure;
use blur_core::record::{Record, Value};
use common::*;
use image::{DynamicImage, ImageFormat};
use metrology::Measurement;

fn configuration() -> Configuration {
    let measured = |value: f64, std: f64| Measurement::new(value, std).unwrap();
    let mut configuration = Configuration::default();
    configuration.settings.acceleration = true;
    configuration.exposure = Some(Exposure::new(measured(0.1, 1e-4)).unwrap());
    configuration.geometry = Some(Geometry::Scale(Scale::new(measured(0.7789e-3, 2e-6)).unwrap()));
    configuration
}

const OPTIONS: [&str; 9] =
    ["--accel", "--exposure", "100ms", "--exposure-u", "0.1ms", "--scale", "0.7789mm/px", "--scale-u", "0.002mm/px"];

/// Every field of the record stands in what the program printed, with the same bits. The program has no tracking.
fn assert_same(record: &Record, printed: &serde_json::Value) {
    let mut compared = 0;
    for (name, value) in record.fields().filter(|(name, _)| *name != "tracked") {
        let found = &printed[name];
        match value {
            Value::Count(count) => assert_eq!(found.as_u64(), Some(count as u64), "{name}"),
            Value::Number(number) => {
                assert_eq!(found.as_f64().map(f64::to_bits), Some(number.to_bits()), "{name}: {found} {number}");
            }
            Value::Flag(flag) => assert_eq!(found.as_bool(), Some(flag), "{name}"),
            Value::Text(text) => assert_eq!(found.as_str(), Some(text.as_ref()), "{name}"),
        }
        compared += 1;
    }
    assert!(compared >= 20, "only {compared} fields");
}

#[test]
fn the_sample_measures_the_same_by_program_and_meter() {
    let folder = folder("parity");
    let colour = DynamicImage::from(blurred(200, 160, 14, 3)).into_rgb8();
    let deep = DynamicImage::from(blurred(160, 200, 11, 4)).into_luma16();
    let files = [
        ("sample.png", blur_cli::sample::PNG.to_vec()),
        ("photo.jpg", encode(colour, ImageFormat::Jpeg)),
        ("deep.png", encode(deep, ImageFormat::Png)),
    ];
    let mut meter = Meter::new(configuration()).unwrap();
    for (name, bytes) in files {
        let path = write(&folder, name, &bytes);
        let picture = picture::decode(&bytes, Linearize::Auto).unwrap();
        let mut arguments = OPTIONS.to_vec();
        arguments.push(path.to_str().unwrap());
        let printed = run_json(arguments).1.remove(0);
        let mut record = meter.measure_grey(picture.luma.view()).unwrap();
        record.linearized = picture.linearized;
        assert_same(&record, &printed);
    }
}

#[test]
fn stored_samples_measure_as_the_file_does() {
    let grey = blurred(180, 150, 12, 5);
    let path = write(&folder("parity_stored"), "grey.png", &png(grey.clone()));
    let mut arguments = OPTIONS.to_vec();
    arguments.push(path.to_str().unwrap());
    let printed = run_json(arguments).1.remove(0);
    let format = PixelFormat { sample: SampleType::U8, channels: Channels::Grey };
    let pixels = Pixels::new(grey.as_raw(), 180, 150, 180, format).unwrap();
    assert_same(&Meter::new(configuration()).unwrap().measure(&pixels).unwrap(), &printed);
}
