//! `cargo xtask`: the chores of this workspace.

mod avr;
mod chromium;
mod debian;
mod firmware;
mod goldens;
mod native;
mod package;
mod python;
mod ros;
mod run;
mod stack;
mod tables;
mod test;
mod venv;

use std::process::ExitCode;

const USAGE: &str = "\
The chores of this workspace.

Usage: cargo xtask COMMAND

Commands:
  test [PART]        run every test and check that the fixtures can be remade,
                     or only the steps that have PART in their names
  firmware           build both programs of the slider's boards and check
                     their budget of flash and memory
  install-ffi --prefix DIR
                     build the library for C and C++ and install it with its
                     headers and what pkg-config and CMake need
  goldens            remake the fixtures and the picture of the README
  tables [ARGS]...   measure the accuracy of the methods (release build);
                     ARGS go to the program protocol-p, see 'tables --help'
  help               print this text

Environment:
  BLUR_DATA          folder of real photographs [default: ../shared/data]
  BLUR_REQUIRE_DATA  if set, that folder must be there: no test may skip
  BLUR_CHROMIUM      browser that the report is tried in [default: Debian's chromium]
  BLUR_ARTEFACTS     folder for pictures of the report [default: target/artefacts]
  FIRMWARE_RUSTC     compiler of the firmware, with its sources beside it
                     [default: Debian's rustc-web, else rustup's nightly]";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((command, rest)) = arguments.split_first() else {
        return usage_error("a command is missing");
    };
    let outcome = match (command.as_str(), rest) {
        ("tables", rest) => tables::make(rest),
        ("install-ffi", rest) => native::install(rest),
        ("help" | "-h" | "--help", _) => {
            println!("{USAGE}");
            Ok(())
        }
        ("test", []) => test::all(None),
        ("test", [part]) => test::all(Some(part)),
        ("test", [_, unexpected, ..]) | ("firmware" | "goldens", [unexpected, ..]) => {
            return usage_error(&format!("'{unexpected}' is not expected here"));
        }
        ("firmware", []) => avr::provide(false).and_then(|compiler| firmware::build(&compiler)),
        ("goldens", []) => goldens::make(),
        (unknown, _) => return usage_error(&format!("'{unknown}' is not a command")),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

fn usage_error(message: &str) -> ExitCode {
    eprintln!("xtask: {message}\n\n{USAGE}");
    ExitCode::from(2)
}
