//! `cargo +nightly fuzz run decoder`, see the documentation of `slider-proto`.

#![no_main]

mod decode;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| decode::decode(bytes));
