//! Measures the picture in a file of raw 8-bit grey samples once for each line on the standard input, and prints how many
//! nanoseconds that took: the measure for whoever calls the library from another language.
//!
//! `cargo run --release -p blur-core --example timed_meter -- FILE WIDTH HEIGHT`

use std::error::Error;
use std::io::{BufRead, Write};
use std::time::Instant;

use blur_core::image::{Channels, PixelFormat, Pixels, SampleType};
use blur_core::meter::{Configuration, Meter};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, width, height] = arguments.as_slice() else { return Err("give FILE WIDTH HEIGHT".into()) };
    let (width, height) = (width.parse()?, height.parse()?);
    let samples = std::fs::read(file)?;
    let format = PixelFormat { sample: SampleType::U8, channels: Channels::Grey };
    let mut meter = Meter::new(Configuration::default())?;
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        line?;
        let start = Instant::now();
        let record = meter.measure(&Pixels::new(&samples, width, height, width, format)?)?;
        let took = start.elapsed();
        writeln!(out, "{} {:?}", took.as_nanos(), record.length_px)?;
        out.flush()?;
    }
    Ok(())
}
