//! Programs in C and C++, built against an installed library, print what the meter gives in Rust, bit for bit.

#![allow(clippy::unwrap_used, reason = "a test")]

#[allow(dead_code, reason = "here the records of C are what programs print")]
mod fields;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use blur_core::camera::Scale;
use blur_core::image::{Channels, PixelFormat, Pixels, SampleType};
use blur_core::meter::{Configuration, Geometry, Meter};
use blur_core::motion::Exposure;
use metrology::Measurement;

const PROGRAMS: &str = "BLUR_NATIVE_PROGRAMS";
const WIDTH: usize = 240;
const HEIGHT: usize = 200;
/// X, y, width and height of the region that is measured too.
const REGION: [usize; 4] = [13, 7, 161, 150];

/// The setting of the examples.
fn configuration() -> Configuration {
    let measured = |value, std| Measurement::new(value, std).unwrap();
    let mut configuration = Configuration::default();
    configuration.settings.acceleration = true;
    configuration.exposure = Some(Exposure::new(measured(0.1, 1e-4)).unwrap());
    configuration.geometry = Some(Geometry::Scale(Scale::new(measured(7.789e-4, 2e-6)).unwrap()));
    configuration
}

/// Grey codes of the project's sample.
fn codes() -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/sample.png");
    let luma = blur_picture::read(&path, blur_picture::Linearize::Off).unwrap().luma;
    luma.slice(ndarray::s![..HEIGHT, ..WIDTH]).iter().map(|&value| value as u8).collect()
}

/// A picture: its file, and its samples as this machine has them.
struct Sample {
    file: PathBuf,
    bytes: Vec<u8>,
    format: PixelFormat,
}

fn samples() -> Vec<Sample> {
    let codes = codes();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let mut samples = Vec::new();
    let mut add = |name: &str, header: String, to_file: Vec<u8>, bytes: Vec<u8>, sample, channels| {
        let file = folder.join(name);
        fs::write(&file, [header.as_bytes(), &to_file].concat()).unwrap();
        samples.push(Sample { file, bytes, format: PixelFormat { sample, channels } });
    };
    let size = format!("{WIDTH} {HEIGHT}");
    let colours: Vec<u8> = codes.iter().flat_map(|&code| [code, code / 2, 255 - code]).collect();
    let deep =
        |codes: &[u8]| codes.iter().enumerate().map(|(i, &code)| u16::from(code) * 256 + (i % 256) as u16).collect();
    let (deep_grey, deep_colours): (Vec<u16>, Vec<u16>) = (deep(&codes), deep(&colours));
    let floats: Vec<f32> = codes.iter().map(|&code| f32::from(code) / 3.0).collect();

    add("grey8.pgm", format!("P5\n# a comment\n{size}\n255\n"), codes.clone(), codes, SampleType::U8, Channels::Grey);
    add("colour8.ppm", format!("P6\n{size}\n255\n"), colours.clone(), colours, SampleType::U8, Channels::Rgb);
    for (name, magic, codes, channels) in
        [("grey16.pgm", "P5", deep_grey, Channels::Grey), ("colour16.ppm", "P6", deep_colours, Channels::Rgb)]
    {
        let to_file = codes.iter().flat_map(|code| code.to_be_bytes()).collect();
        let bytes = codes.iter().flat_map(|code| code.to_ne_bytes()).collect();
        add(name, format!("{magic}\n{size}\n65535\n"), to_file, bytes, SampleType::U16, channels);
    }
    // The rows of a PFM come from the bottom to the top; a negative scale says that the lowest byte is the first.
    let upwards: Vec<u8> = floats.chunks_exact(WIDTH).rev().flatten().flat_map(|value| value.to_le_bytes()).collect();
    let bytes = floats.iter().flat_map(|value| value.to_ne_bytes()).collect();
    add("grey.pfm", format!("Pf\n{size}\n-1.0\n"), upwards, bytes, SampleType::F32, Channels::Grey);
    samples
}

impl Sample {
    fn measured(&self, [x, y, width, height]: [usize; 4]) -> String {
        let row_bytes = WIDTH * self.format.bytes();
        let bytes = &self.bytes[y * row_bytes + x * self.format.bytes()..];
        let pixels = Pixels::new(bytes, width, height, row_bytes, self.format).unwrap();
        fields::of_rust(&Meter::new(configuration()).unwrap().measure(&pixels).unwrap())
    }
}

/// A text of fields, with numbers in Rust's form: the shortest that reads back the same.
fn normal(printed: &str) -> String {
    let line = |line: &str| match line.split_once('=') {
        Some((name, value)) => match value.parse::<f64>() {
            Ok(number) => format!("{name}={number:?}\n"),
            Err(_) => format!("{line}\n"),
        },
        None => format!("{line}\n"),
    };
    printed.lines().map(line).collect()
}

fn run(program: &Path, file: &Path, region: &[usize]) -> String {
    let output = Command::new(program).arg(file).args(region.iter().map(ToString::to_string)).output().unwrap();
    assert!(output.status.success(), "{}: {}", program.display(), String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
#[ignore = "needs the programs that 'cargo xtask test' builds"]
fn programs_print_the_record_of_rust() {
    let folder = env::var_os(PROGRAMS).expect("the folder of the programs");
    let mut programs: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    programs.sort();
    assert!(programs.len() >= 5, "{programs:?}");
    let whole = [0, 0, WIDTH, HEIGHT];
    for sample in samples() {
        for (region, arguments) in [(whole, &[][..]), (REGION, &REGION[..])] {
            let expected = normal(&sample.measured(region));
            assert!(expected.contains("\nspeed_m_s="), "{expected}");
            for program in &programs {
                let found = normal(&run(program, &sample.file, arguments));
                assert_eq!(found, expected, "{} of {}", program.display(), sample.file.display());
            }
        }
    }
    for program in &programs {
        println!("{} agrees", program.display());
    }
}

#[test]
#[ignore = "needs the programs that 'cargo xtask test' builds"]
fn damaged_files_are_refused_by_the_examples() {
    let folder = PathBuf::from(env::var_os(PROGRAMS).expect("the folder of the programs"));
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("damaged.pgm");
    for bytes in [&b""[..], b"P5", b"P5\n64 64\n255\nshort", b"P5\n0 64\n255\n", b"P5 99999 64 255\n", b"Pf 64 64 x"] {
        fs::write(&file, bytes).unwrap();
        for program in ["measure-c", "measure-cpp"] {
            let output = Command::new(folder.join(program)).arg(&file).output().unwrap();
            assert_eq!(output.status.code(), Some(1), "{program} of {:?}", String::from_utf8_lossy(bytes));
            assert!(!output.stderr.is_empty());
        }
    }
}
