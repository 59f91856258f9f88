//! The program `accel simulate`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a program that does not run or answer fails the test")]

mod common;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use blur_cli::accel::collection::Collection;
use blur_sim::rig::{Design, POSTERS, Rig};
use common::{folder, stderr, stdout, write};

fn accel<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_accel")).args(arguments).output().unwrap();
    assert!(output.status.code().is_some(), "ended by a signal: {output:?}");
    assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
    output
}

fn simulate(options: &str, folder: &Path) -> Output {
    accel(["simulate"].into_iter().chain(options.split_whitespace()).chain(["-o", folder.to_str().unwrap()]))
}

/// Every file of a folder by its name.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())).collect()
}

#[test]
fn a_folder_holds_what_the_table_says_and_the_table_the_whole_truth() {
    let folder = folder("simulate-truth").join("new");
    let output = simulate("--design random-release --side 64 --seed 3", &folder);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(
        stdout(&output),
        format!("125 blurred pictures, 25 stills and pictures.csv written to {}\n", folder.display())
    );
    assert_eq!(files(&folder).len(), 151);
    let collection = Collection::read(&folder).unwrap();
    assert_eq!(collection.scenes.len(), 5);
    for (scene, poster) in collection.scenes.iter().zip(POSTERS) {
        assert_eq!((scene.name.as_str(), scene.stills.len()), (poster.name, 5));
    }
    let shots = Rig::default().shots(Design::RandomRelease, 3).unwrap();
    assert_eq!(collection.blurred.len(), shots.len());
    for (blurred, shot) in collection.blurred.iter().zip(shots) {
        // To the last digit.
        assert_eq!(blurred.scene, shot.poster);
        assert_eq!(blurred.accel_m_s2, shot.accel_m_s2);
        assert_eq!(blurred.length_px, Some(shot.length_px));
        assert_eq!(blurred.accel_ratio, Some(shot.accel_ratio));
        assert_eq!(blurred.release_m, Some(shot.release_m));
        assert_eq!(blurred.v0_m_s, Some(shot.v0_m_s));
        assert_eq!(blurred.exposure_s, Some(0.1));
        assert_eq!(blurred.scale_m_per_px, Some(Rig::default().scale_m_per_px));
    }
    let last = collection.blurred.last().unwrap();
    let picture = image::open(&last.path).unwrap();
    assert_eq!((picture.width(), picture.height(), picture.color()), (64, 64, image::ColorType::L8));
    let mut studio = blur_sim::rig::Studio::new(&Rig { side_px: 64, ..Rig::default() }).unwrap();
    let shot = Rig::default().shots(Design::RandomRelease, 3).unwrap()[124];
    assert_eq!(picture.into_luma8().into_raw(), studio.picture(&shot).unwrap().into_raw_vec_and_offset().0);
}

#[test]
fn the_files_do_not_depend_on_the_threads_but_on_every_option() {
    let base = folder("simulate-options");
    let of = |name: &str, options: &str| {
        let folder = base.join(name);
        let output = simulate(&format!("--side 32 {options}"), &folder);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        files(&folder)
    };
    let first = of("first", "--design fixed-release --jobs 1");
    assert!(first == of("threads", "--design fixed-release --jobs 3 --seed 1 --psnr-db 40"));
    for (name, options) in [
        ("seed", "--design fixed-release --seed 2"),
        ("design", "--design random-release"),
        ("noise", "--design fixed-release --psnr-db 25.5"),
        ("none", "--design fixed-release --psnr-db none"),
    ] {
        let other = of(name, options);
        assert!(first.keys().eq(other.keys()), "{name}");
        let same = first.iter().filter(|(file, content)| other[*file] == **content && !file.contains("still")).count();
        // The table need not tell the noise.
        assert!(same <= 1, "{name}: {same} files are the same");
    }
}

#[test]
fn a_folder_that_is_not_empty_stays_as_it_is() {
    let folder = folder("simulate-occupied");
    write(&folder, "notes.txt", b"mine");
    let output = simulate("--design fixed-release --side 32", &folder);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stdout(&output), "");
    let expected = format!(
        "accel: {}: the folder is not empty: name one that is, or one that does not exist yet\n",
        folder.display()
    );
    assert_eq!(stderr(&output), expected);
    assert_eq!(files(&folder).into_keys().collect::<Vec<_>>(), ["notes.txt"]);
    let file = folder.join("notes.txt");
    let output = simulate("--design fixed-release --side 32", &file);
    assert_eq!((output.status.code(), stderr(&output).lines().count()), (Some(1), 1));
    assert!(stderr(&output).contains("notes.txt: cannot be written"), "{}", stderr(&output));
}

#[test]
fn mistakes_end_with_status_2_before_anything_is_written() {
    let folder = folder("simulate-mistakes");
    for options in [
        "",
        "--design nonsense",
        "--design fixed-release --psnr-db loud",
        "--design fixed-release --psnr-db NaN",
        "--design fixed-release --psnr-db 1e9",
        "--design fixed-release --side 31",
        "--design fixed-release --side 5000",
        "--design fixed-release --seed -1",
        "--design fixed-release --jobs 0",
    ] {
        let output = simulate(options, &folder);
        assert_eq!(output.status.code(), Some(2), "{options}: {output:?}");
        assert!(stdout(&output).is_empty() && !stderr(&output).is_empty(), "{options}");
    }
    assert!(files(&folder).is_empty());
    assert_eq!(accel(["simulate", "--design", "fixed-release"]).status.code(), Some(2));
}

#[test]
fn the_help_names_the_designs_and_the_columns_that_are_needed() {
    let output = accel(["simulate", "--help"]);
    assert_eq!(output.status.code(), Some(0));
    for word in ["fixed-release", "random-release", "image kind scene accel_m_s2", "Examples:"] {
        assert!(stdout(&output).contains(word), "{word}");
    }
}
