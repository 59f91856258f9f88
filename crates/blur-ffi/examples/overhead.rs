//! What a call through C costs beside the same call in Rust: cargo run --release -p blur-ffi --example overhead
//!
//! Both measure the same picture in turns, each with a meter of its own; which comes first alternates. Printed is the
//! median of the ratios of the pairs with the quartiles, so that what disturbs both does not count.

#![allow(clippy::unwrap_used, reason = "an example")]

use std::hint::black_box;
use std::ptr;
use std::time::{Duration, Instant};

use blur_core::image::{self, PixelFormat, Pixels, SampleType};
use blur_core::meter;
use motion_blur::{
    Channels, Code, Configuration, Meter, Picture, Record, Sample, mb_configuration_default, mb_meter_free,
    mb_meter_measure, mb_meter_new,
};

const SIDE: usize = 512;
const BLUR_PX: usize = 24;
const PAIRS: usize = 101;

/// Grey codes of random blocks that moved to the right.
fn picture() -> Vec<u8> {
    let block = |row: usize, column: usize| {
        let mut hash = (row / 3 * 7919 + column / 3 * 104_729) as u32;
        for factor in [0x2c1b_3c6d, 0x297a_2d39, 1] {
            hash = (hash ^ (hash >> 15)).wrapping_mul(factor);
        }
        hash & 255
    };
    let code = |i: usize| {
        let (row, column) = (i / SIDE, i % SIDE);
        ((0..BLUR_PX).map(|shift| block(row, column + shift)).sum::<u32>() / BLUR_PX as u32) as u8
    };
    (0..SIDE * SIDE).map(code).collect()
}

/// Seconds that `work` takes.
fn time(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().max(Duration::from_nanos(1)).as_secs_f64()
}

/// The value below which a share of sorted values lies.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[(share * (sorted.len() - 1) as f64).round() as usize]
}

fn main() {
    let samples = picture();
    let format = PixelFormat { sample: SampleType::U8, channels: image::Channels::Grey };
    let pixels = Pixels::new(&samples, SIDE, SIDE, SIDE, format).unwrap();
    let mut of_rust = meter::Meter::new(meter::Configuration::default()).unwrap();
    let mut in_rust = || {
        black_box(of_rust.measure(black_box(&pixels)).unwrap());
    };

    // SAFETY: integers, floats and raw pointers may all be zero.
    let mut configuration: Configuration = unsafe { std::mem::zeroed() };
    // SAFETY: the size is that of the value.
    let code = unsafe { mb_configuration_default(&raw mut configuration, size_of::<Configuration>()) };
    assert_eq!(code, Code::Ok);
    let mut of_c: *mut Meter = ptr::null_mut();
    // SAFETY: both pointers are to values.
    assert_eq!(unsafe { mb_meter_new(&raw const configuration, &raw mut of_c) }, Code::Ok);
    let described = Picture {
        struct_size: size_of::<Picture>(),
        data: samples.as_ptr().cast(),
        width: SIDE,
        height: SIDE,
        row_bytes: SIDE as isize,
        sample: Sample::U8 as i32,
        channels: Channels::Grey as i32,
    };
    // SAFETY: as before.
    let mut record = Record { struct_size: size_of::<Record>(), ..unsafe { std::mem::zeroed() } };
    let mut through_c = || {
        // SAFETY: the meter lives, and the picture describes the samples.
        let code = unsafe { mb_meter_measure(of_c, black_box(&raw const described), black_box(&raw mut record)) };
        assert_eq!(code, Code::Ok);
    };

    // The first picture makes the plans.
    in_rust();
    through_c();
    let mut rust_s = Vec::new();
    let mut ratios = Vec::new();
    for pair in 0..PAIRS {
        let (rust, c) = if pair % 2 == 0 {
            let rust = time(&mut in_rust);
            (rust, time(&mut through_c))
        } else {
            let c = time(&mut through_c);
            (time(&mut in_rust), c)
        };
        rust_s.push(rust);
        ratios.push(c / rust);
    }
    // SAFETY: it was made by the library and is freed once.
    unsafe { mb_meter_free(of_c) };
    rust_s.sort_by(f64::total_cmp);
    ratios.sort_by(f64::total_cmp);
    println!("picture                 {SIDE}x{SIDE}, 8 bit, {PAIRS} pairs");
    println!("in Rust, median         {:.3} ms", 1e3 * quantile(&rust_s, 0.5));
    let [low, median, high] = [0.25, 0.5, 0.75].map(|share| quantile(&ratios, share));
    println!("through C over in Rust  {median:.4} (quartiles {low:.4} to {high:.4})");
}
