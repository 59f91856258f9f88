//! How fast a firmware runs: `cargo run --release --example speed -- ELF [SECONDS]`.

use slider_sim::{CYCLES_PER_SECOND, Mcu, Pin};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let elf = arguments.next().ok_or("usage: speed ELF [SECONDS]")?;
    let seconds: u64 = arguments.next().as_deref().unwrap_or("10").parse()?;
    let mut mcu = Mcu::load(elf.as_ref())?;
    mcu.set(Pin::D8, true);
    let begun = Instant::now();
    mcu.run_for(seconds * CYCLES_PER_SECOND)?;
    let took = begun.elapsed().as_secs_f64();
    println!("{:.2} simulated seconds a second", seconds as f64 / took);
    Ok(())
}
