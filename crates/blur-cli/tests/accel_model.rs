//! The programs `accel train` and `accel predict`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a program that does not run or answer fails the test")]

mod common;

use std::ffi::OsStr;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use common::{blurred, folder, number, png, stderr, stdout, write};
use serde_json::Value;

fn accel<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_accel")).args(arguments).output().unwrap();
    assert!(output.status.code().is_some(), "ended by a signal: {output:?}");
    assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
    output
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// What a refused run says: one line, and the status 1.
fn refusal(output: &Output) -> &str {
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(stdout(output).is_empty(), "{output:?}");
    let said = stderr(output).strip_suffix('\n').unwrap();
    assert!(!said.contains('\n') && said.starts_with("accel: "), "{said}");
    said
}

/// A folder from the virtual rig, and the model trained on it; made once for all tests.
fn rig() -> &'static (PathBuf, PathBuf) {
    static RIG: OnceLock<(PathBuf, PathBuf)> = OnceLock::new();
    RIG.get_or_init(|| {
        let base = folder("model-rig");
        let data = base.join("data");
        let made = accel(["simulate", "--design", "fixed-release", "--side", "192", "-o", text(&data)]);
        assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
        let model = base.join("model.json");
        let trained = accel(["train", "--data", text(&data), "-o", text(&model)]);
        assert_eq!(trained.status.code(), Some(0), "{}", stderr(&trained));
        (data, model)
    })
}

/// One of the table: image, kind, scene, acceleration.
struct Row {
    image: PathBuf,
    kind: String,
    scene: String,
    accel_m_s2: Option<f64>,
}

fn table(data: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(data.join("pictures.csv")).unwrap();
    let names = reader.headers().unwrap().clone();
    let column = |name: &str| names.iter().position(|column| column == name).unwrap();
    let (image, kind, scene, accel) = (column("image"), column("kind"), column("scene"), column("accel_m_s2"));
    let rows = reader.records().map(Result::unwrap);
    rows.map(|row| Row {
        image: data.join(&row[image]),
        kind: row[kind].to_owned(),
        scene: row[scene].to_owned(),
        accel_m_s2: row[accel].parse().ok(),
    })
    .collect()
}

/// The stills of a scene and its blurred pictures.
fn of_scene(data: &Path, scene: &str) -> (Vec<PathBuf>, Vec<Row>) {
    let (stills, blurred): (Vec<Row>, Vec<Row>) =
        table(data).into_iter().filter(|row| row.scene == scene).partition(|row| row.kind == "still");
    (stills.into_iter().map(|row| row.image).collect(), blurred)
}

fn predict(model: &Path, stills: &[PathBuf], pictures: &[PathBuf]) -> (Option<i32>, Vec<Value>, String) {
    let mut arguments = vec!["predict", text(model), "--json", "--backgrounds"];
    arguments.extend(stills.iter().map(|path| text(path)));
    arguments.push("--");
    arguments.extend(pictures.iter().map(|path| text(path)));
    let output = accel(arguments);
    let records = stdout(&output).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    (output.status.code(), records, stderr(&output).to_owned())
}

#[test]
fn a_model_predicts_other_pictures_of_the_rig() {
    let (data, model) = rig();
    let other = folder("model-other").join("data");
    let made = accel(["simulate", "--design", "fixed-release", "--side", "192", "--seed", "2", "-o", text(&other)]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let mut errors = Vec::new();
    let mut refused = 0;
    let mut scenes: Vec<String> = table(data).into_iter().map(|row| row.scene).collect();
    scenes.dedup();
    for scene in scenes {
        let (stills, blurred) = of_scene(&other, &scene);
        let pictures: Vec<PathBuf> = blurred.iter().map(|row| row.image.clone()).collect();
        let (_, records, _) = predict(model, &stills, &pictures);
        assert_eq!(records.len(), pictures.len());
        for (record, row) in records.iter().zip(&blurred) {
            assert_eq!(record["image"], text(&row.image));
            if record["error"].is_string() {
                refused += 1;
                continue;
            }
            assert_eq!(record["method"], "gpr-matern52");
            assert!(number(record, "accel_std_m_s2") > 0.0 && number(record, "distance") <= 1.0, "{record}");
            errors.push(number(record, "accel_m_s2") - row.accel_m_s2.unwrap());
        }
    }
    // One of 126 is refused on average.
    assert!(refused <= 8, "{refused} refused");
    let rmse = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    // The thesis has 0.2547 m/s² (table 6.2), with pictures of seven times as many pixels.
    assert!(rmse < 0.2547, "{rmse}");
}

#[test]
fn training_says_how_good_the_model_is_and_is_the_same_every_time() {
    let (data, model) = rig();
    let again = folder("model-again").join("model.json");
    let output = accel(["train", "--data", text(data), "-o", text(&again)]);
    assert_eq!(fs::read(model).unwrap(), fs::read(&again).unwrap());
    let said = stdout(&output);
    assert!(said.starts_with(&format!("{}: gpr-matern52 trained on 125 pictures; ", again.display())), "{said}");
    let rmse: f64 = said.split("RMSE ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let stored: Value = serde_json::from_slice(&fs::read(&again).unwrap()).unwrap();
    let provenance = &stored["content"]["provenance"];
    assert!((provenance["validation"]["metrics"]["rmse"].as_f64().unwrap() - rmse).abs() < 1e-4);
    assert_eq!(provenance["data"], "data");
    assert_eq!(stored["content"]["conditions"]["exposure_s"], 0.1);
}

/// The checksum is that of what another program prints.
#[cfg(target_os = "linux")]
#[test]
fn the_checksum_of_the_data_can_be_verified_with_sha256sum() {
    let (data, model) = rig();
    let rows = table(data);
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let mut names = vec!["pictures.csv".to_owned()];
    let mut seen: Vec<&str> = Vec::new();
    for scene in scenes {
        if !seen.contains(&scene) {
            seen.push(scene);
            let stills = rows.iter().filter(|row| row.kind == "still" && row.scene == scene);
            names.extend(stills.map(|row| text(row.image.strip_prefix(data).unwrap()).to_owned()));
        }
    }
    let blurred = rows.iter().filter(|row| row.kind == "blurred");
    names.extend(blurred.map(|row| text(row.image.strip_prefix(data).unwrap()).to_owned()));
    let listing = Command::new("sha256sum").args(&names).current_dir(data).output().unwrap();
    let list = folder("model-checksum").join("list");
    fs::write(&list, listing.stdout).unwrap();
    let of_list = Command::new("sha256sum").arg(&list).output().unwrap();
    let expected = stdout(&of_list).split(' ').next().unwrap();
    let stored: Value = serde_json::from_slice(&fs::read(model).unwrap()).unwrap();
    assert_eq!(stored["content"]["provenance"]["data_sha256"], expected);
}

#[test]
fn a_refused_picture_does_not_keep_the_others_from_being_measured() {
    let (data, model) = rig();
    let scene = table(data)[0].scene.clone();
    let (stills, blurred) = of_scene(data, &scene);
    let alien = write(&folder("model-alien"), "sharp.png", &fs::read(&stills[0]).unwrap());
    let missing = data.join("missing.png");
    let good = blurred[0].image.clone();
    let (status, records, said) = predict(model, &stills, &[alien.clone(), missing.clone(), good.clone()]);
    assert_eq!(status, Some(1));
    assert_eq!(records.len(), 3);
    assert!(records[0]["error"].as_str().unwrap().contains("unlike those the model was trained on"), "{records:?}");
    assert!(records[1]["error"].as_str().unwrap().contains("cannot be read"), "{records:?}");
    assert!((number(&records[2], "accel_m_s2") - blurred[0].accel_m_s2.unwrap()).abs() < 0.5, "{records:?}");
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 2, "{said}");
    assert!(lines[0].starts_with(&format!("accel: {}: ", alien.display())), "{said}");

    // The same for people: only what was measured is on standard output.
    let mut arguments = vec!["predict", text(model), text(&good), text(&missing), "--backgrounds"];
    arguments.extend(stills.iter().map(|path| text(path)));
    let output = accel(arguments);
    assert_eq!(output.status.code(), Some(1));
    assert!(stdout(&output).starts_with(&format!("{}  acceleration ", good.display())), "{}", stdout(&output));
    assert!(stdout(&output).ends_with(" m/s2 (k = 2)\n") && stdout(&output).contains(" ± "), "{}", stdout(&output));
}

#[test]
fn backgrounds_that_cannot_serve_are_refused_in_one_line() {
    let (data, model) = rig();
    let (stills, blurred) = of_scene(data, &table(data)[0].scene);
    let good = text(&blurred[0].image);
    let folder = folder("model-backgrounds");
    let small = write(&folder, "small.png", &png(common::blurred(64, 64, 5, 1)));
    let flat = write(&folder, "flat.png", &png(image::GrayImage::new(192, 192)));
    let run = |still: &Path| accel(["predict", text(model), good, "--backgrounds", text(&stills[0]), text(still)]);
    let said = run(&small);
    let expected = format!("accel: {}: the picture is 64x64 pixels; 192x192 are expected", small.display());
    assert_eq!(refusal(&said), expected);
    assert!(refusal(&run(&flat)).contains("flat.png: all pixels have the value 0"));
    assert!(refusal(&run(&folder.join("none.png"))).contains("none.png: cannot be read"));
    assert_eq!(accel(["predict", text(model), good]).status.code(), Some(2));
    assert_eq!(accel(["predict", text(model), "--backgrounds", good]).status.code(), Some(2));
}

#[test]
fn files_that_are_no_model_are_refused_in_one_line() {
    let (data, model) = rig();
    let (stills, blurred) = of_scene(data, &table(data)[0].scene);
    let folder = folder("model-files");
    let content = fs::read_to_string(model).unwrap();
    for (name, content, expected) in [
        ("cut.json", &content[..5000], "the model is cut short after 5000 bytes"),
        ("empty.json", "", "not a model"),
        ("newer.json", &content.replacen("\"version\":1", "\"version\":2", 1), "the model is of version 2"),
        ("damaged.json", &content.replacen("\"seed\":1", "\"seed\":2", 1), "the model is damaged"),
    ] {
        let path = write(&folder, name, content.as_bytes());
        let output = accel(["predict", text(&path), text(&blurred[0].image), "--backgrounds", text(&stills[0])]);
        let said = refusal(&output);
        assert!(said.starts_with(&format!("accel: {}: {expected}", path.display())), "{said}");
    }
    let none = accel(["predict", text(&folder.join("none.json")), "a.png", "--backgrounds", "b.png"]);
    assert!(refusal(&none).contains("none.json: cannot be read"));
}

/// A folder of its own pictures: one scene, two stills, so many blurred pictures; `change` may spoil it.
fn collection(name: &str, blurred_pictures: usize, change: impl Fn(&Path, &mut String)) -> PathBuf {
    let folder = folder(name);
    let mut table = "image,kind,scene,accel_m_s2\n".to_owned();
    for still in 0..2 {
        write(&folder, &format!("still{still}.png"), &png(blurred(64, 64, 1, still)));
        writeln!(table, "still{still}.png,still,wall,").unwrap();
    }
    for index in 0..blurred_pictures {
        write(&folder, &format!("run{index}.png"), &png(blurred(64, 64, 3 + index % 7, index as u64)));
        writeln!(table, "run{index}.png,blurred,wall,{}", 0.1 * (3 + index % 7) as f64).unwrap();
    }
    change(&folder, &mut table);
    write(&folder, "pictures.csv", table.as_bytes());
    folder
}

#[test]
fn trainings_that_cannot_work_are_refused_in_one_line() {
    let train = |data: &Path| {
        let model = data.join("model.json");
        let output = accel(["train", "--data", text(data), "--components", "3", "-o", text(&model)]);
        assert!(output.status.success() || !model.exists());
        output
    };
    let good = train(&collection("train-good", 14, |_, _| ()));
    assert_eq!(good.status.code(), Some(0), "{}", stderr(&good));
    let few = train(&collection("train-few", 9, |_, _| ()));
    assert_eq!(refusal(&few), "accel: 9 observations are too few: 10 are needed to train a model");
    let none = train(&collection("train-none", 0, |_, _| ()));
    assert!(refusal(&none).contains("no blurred picture"));
    let size = train(&collection("train-size", 14, |folder, _| {
        write(folder, "run5.png", &png(blurred(80, 64, 5, 5)));
    }));
    assert!(refusal(&size).ends_with("run5.png: the picture is 80x64 pixels; 64x64 are expected"), "{size:?}");
    let still = train(&collection("train-still", 14, |folder, _| {
        write(folder, "still1.png", &png(blurred(64, 32, 1, 1)));
    }));
    assert!(refusal(&still).ends_with("still1.png: the picture is 64x32 pixels; 64x64 are expected"), "{still:?}");
    let broken = train(&collection("train-broken", 14, |folder, _| {
        write(folder, "run5.png", b"no picture");
    }));
    assert!(refusal(&broken).contains("run5.png: not a picture"), "{broken:?}");
    let nan = train(&collection("train-nan", 14, |_, table| *table = table.replace(",0.5\n", ",NaN\n")));
    assert!(refusal(&nan).contains("line "), "{nan:?}");
    let alike = train(&collection("train-alike", 14, |_, table| {
        let mut same = String::new();
        for line in table.lines() {
            let row = if line.contains("blurred") { line.rsplit_once(',').unwrap().0 } else { line };
            writeln!(same, "{row}{}", if line.contains("blurred") { ",1.5" } else { "" }).unwrap();
        }
        *table = same;
    }));
    assert!(refusal(&alike).contains("variance of the targets"), "{alike:?}");
    assert!(refusal(&accel(["train", "--data", "no such folder", "-o", "m.json"])).contains("no such folder"));
    let written = collection("train-written", 14, |_, _| ());
    let nowhere = written.join("no/model.json");
    let output = accel(["train", "--data", text(&written), "--components", "3", "-o", text(&nowhere)]);
    assert!(refusal(&output).contains("model.json: cannot be written"), "{output:?}");
}

#[test]
fn wrong_options_are_a_matter_of_usage() {
    for options in [
        &["--model", "oracle"][..],
        &["--components", "0"],
        &["--components", "1.5"],
        &["--components", "many"],
        &["--variant", "dst"],
        &["--seed", "-1"],
    ] {
        let output = accel(["train", "--data", ".", "-o", "m.json"].iter().chain(options));
        assert_eq!(output.status.code(), Some(2), "{options:?}: {}", stderr(&output));
    }
}
