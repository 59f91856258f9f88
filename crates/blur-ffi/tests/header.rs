//! The header in the tree is what the sources say.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::path::Path;
use std::{env, fs};

const HEAD: &str = "\
/* Motion blur measured from C and C++: direction, length, speed and acceleration with their uncertainties, of one picture.
 *
 * Made from crates/blur-ffi/src by: REGENERATE=1 cargo test -p blur-ffi --test header
 *
 *     mb_configuration configuration = {sizeof configuration};
 *     mb_meter *meter;
 *     if (mb_meter_new(&configuration, &meter) != MB_CODE_OK) puts(mb_error_message());
 *     mb_picture picture = {sizeof picture, samples, width, height, row_bytes, MB_SAMPLE_U8, MB_CHANNELS_GREY};
 *     mb_record record = {sizeof record};
 *     if (mb_meter_measure(meter, &picture, &record) != MB_CODE_OK) puts(mb_error_message());
 *     mb_meter_free(meter);
 *
 * Structures begin with their size, so that they may grow: fields are only ever added at the end, and zero bytes stand for
 * defaults. All functions may be called from any thread, but one meter by one thread at a time. Nothing is thrown. When there
 * is no memory left the process ends.
 *
 * Licence: MIT or Apache-2.0. */";

fn generated() -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    config.header = Some(HEAD.to_owned());
    config.after_includes = Some(format!(
        "\n/* Version of this header; that of the library that runs is mb_version(). */\n\
         #define MB_VERSION \"{}\"\n#define MB_VERSION_MAJOR {}\n#define MB_VERSION_MINOR {}\n#define MB_VERSION_PATCH {}",
        env!("CARGO_PKG_VERSION"),
        env!("CARGO_PKG_VERSION_MAJOR"),
        env!("CARGO_PKG_VERSION_MINOR"),
        env!("CARGO_PKG_VERSION_PATCH"),
    ));
    let mut text = Vec::new();
    cbindgen::generate_with_config(folder, config).unwrap().write(&mut text);
    String::from_utf8(text).unwrap().replace("// # Safety\n", "// What the caller promises:\n")
}

#[test]
fn the_header_is_what_the_sources_say() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/motion_blur.h");
    let generated = generated();
    if env::var_os("REGENERATE").is_some() {
        fs::write(&path, &generated).unwrap();
    }
    let stored = fs::read_to_string(&path).unwrap_or_default();
    assert!(stored == generated, "{} has drifted: REGENERATE=1 cargo test -p blur-ffi --test header", path.display());
}
