//! `estimate --restore`: the files that it writes, and those that it leaves alone.
#![allow(clippy::unwrap_used, reason = "a file that cannot be made or read fails the test")]

mod common;

use std::fs;

use common::{blurred, folder, png, run, run_json, stderr, write};
use image::{DynamicImage, GrayImage, ImageBuffer, Rgba};

/// Mean squared difference of neighbours along the rows, which the blur runs along.
fn contrast(picture: &GrayImage) -> f64 {
    let pairs = picture.as_raw().windows(2).map(|pair| (f64::from(pair[0]) - f64::from(pair[1])).powi(2));
    pairs.sum::<f64>() / picture.len() as f64
}

#[test]
fn the_restored_picture_is_written_and_reported() {
    let folder = folder("restore-one");
    let picture = blurred(200, 160, 12, 1);
    let input = write(&folder, "in.png", &png(picture.clone()));
    for method in ["wiener", "richardson-lucy", "sliding-dct"] {
        let out = folder.join(format!("{method}.png"));
        let (status, records) =
            run_json([&input, &"--restore-method".into(), &method.into(), &"--restore".into(), &out]);
        assert_eq!(status, 0);
        assert_eq!(records[0]["restored"], out.to_str().unwrap());
        assert!(records[0]["sharpness_change"].is_f64());
        let DynamicImage::ImageLuma8(scene) = image::open(&out).unwrap() else { unreachable!("not 8 bit grey") };
        assert_eq!(scene.dimensions(), (200, 160));
        assert!(contrast(&scene) > 2.0 * contrast(&picture), "{method}");
    }
}

#[test]
fn colours_depth_and_alpha_are_kept() {
    let folder = folder("restore-colour");
    let grey = blurred(160, 128, 10, 2);
    let picture = ImageBuffer::from_fn(160, 128, |x, y| {
        let g = u16::from(grey.get_pixel(x, y).0[0]);
        Rgba([257 * g, 65535 - 257 * g, 30_000, (400 * x) as u16])
    });
    let input = write(&folder, "in.png", &png(DynamicImage::ImageRgba16(picture.clone())));
    let out = folder.join("out.tif");
    // The sum of the colours has next to no contrast, their weighted sum has.
    let (status, records) = run_json([&input, &"--restore".into(), &out]);
    assert_eq!((status, records[0]["status"].as_str()), (0, Some("ok")), "{records:?}");
    let DynamicImage::ImageRgba16(scene) = image::open(&out).unwrap() else { unreachable!("not 16 bit with alpha") };
    let mut difference = 0;
    for (new, old) in scene.pixels().zip(picture.pixels()) {
        assert_eq!(new.0[3], old.0[3]);
        // Blue has no contrast, green is the negative of red.
        assert!(new.0[2].abs_diff(30_000) <= 1);
        assert!(new.0[1].abs_diff(65535 - new.0[0]) <= 600, "{new:?}");
        difference = difference.max(new.0[0].abs_diff(old.0[0]));
    }
    assert!(difference > 5000);
}

#[test]
fn a_picture_without_motion_blur_is_not_restored() {
    let folder = folder("restore-sharp");
    let input = write(&folder, "in.png", &png(blurred(200, 160, 1, 3)));
    let out = folder.join("out.png");
    let arguments = [input.as_path(), "--restore".as_ref(), &out];
    let output = run(arguments);
    assert!(output.status.success() && !out.exists());
    assert!(stderr(&output).contains("not restored: there is no motion blur"), "{}", stderr(&output));
    let (_, records) = run_json(arguments);
    assert_eq!((records[0]["status"].as_str(), records[0].get("restored")), (Some("no_motion_blur"), None));
}

#[test]
fn a_doubtful_blur_is_undone_with_a_warning() {
    let folder = folder("restore-doubtful");
    let out = folder.join("out.png");
    let mut seen = Vec::new();
    // White noise along a blur as short as the search goes, and along a longer one: neither has edges to sharpen.
    for (seed, length_px) in [(7, 4), (8, 4), (7, 12)] {
        let input = write(&folder, "in.png", &png(blurred(96, 80, length_px, seed)));
        let arguments = [input.as_path(), "--restore".as_ref(), &out];
        let (_, records) = run_json(arguments);
        let output = run(arguments);
        let notes = stderr(&output);
        let doubtful = records[0]["status"] == "low_confidence";
        let dull = records[0]["sharpness_change"].as_f64().unwrap() <= 0.0;
        assert!(records[0]["restored"].is_string() && fs::remove_file(&out).is_ok(), "{records:?}");
        assert_eq!(notes.contains("restored with a blur of low confidence"), doubtful, "{notes}");
        assert_eq!(notes.contains("does not make the picture sharper"), dull, "{notes}");
        seen.push((doubtful, dull));
    }
    let any = |wanted: fn(&(bool, bool)) -> bool| seen.iter().any(wanted);
    assert!(any(|x| x.0) && any(|x| !x.0) && any(|x| x.1) && any(|x| !x.1), "{seen:?}");
}

#[test]
fn several_pictures_go_into_a_folder_under_their_names() {
    let folder = folder("restore-several");
    for name in ["a", "b"] {
        fs::create_dir(folder.join(name)).unwrap();
        write(&folder.join(name), "x.png", &png(blurred(128, 96, 10, 4)));
    }
    let (a, b) = (folder.join("a/x.png"), folder.join("b/x.png"));
    let one = folder.join("one.png");
    let refused = run([&a, &b, &"--restore".into(), &one]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("name a folder"), "{}", stderr(&refused));

    let out = folder.join("new/");
    let (status, records) = run_json([&a, &b, &"--restore".into(), &out]);
    assert_eq!(status, 0);
    assert_eq!(records.iter().filter(|record| record["restored"].is_string()).count(), 2, "{records:?}");
    // The same picture twice: the same bytes under two names.
    assert_eq!(fs::read(out.join("x.png")).unwrap(), fs::read(out.join("x-2.png")).unwrap());
}

#[test]
fn an_input_is_never_overwritten() {
    let folder = folder("restore-over");
    let content = png(blurred(128, 96, 10, 5));
    let input = write(&folder, "x.png", &content);
    for out in [input.clone(), folder.join("./x.png"), folder.clone()] {
        let refused = run([&input, &"--restore".into(), &out]);
        assert_eq!(refused.status.code(), Some(2), "{}", out.display());
        assert!(stderr(&refused).contains("would overwrite"), "{}", stderr(&refused));
        assert_eq!(fs::read(&input).unwrap(), content);
    }
}

#[test]
fn a_file_that_cannot_be_written_is_an_error_of_its_picture() {
    let folder = folder("restore-unwritable");
    let input = write(&folder, "x.png", &png(blurred(128, 96, 10, 6)));
    let (status, records) = run_json([&input, &"--restore".into(), &folder.join("missing/out.png")]);
    assert_eq!(status, 1);
    let error = records[0]["error"].as_str().unwrap();
    assert!(error.contains("cannot be written") && error.contains("missing"), "{error}");
}
