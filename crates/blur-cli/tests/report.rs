//! `--report`: one page that says what the record says, needs nothing but itself and cannot be broken by a name.

#![allow(clippy::unwrap_used, reason = "a page that cannot be made fails the test")]

mod common;

use std::fs;
use std::path::Path;

use common::*;
use image::{GrayImage, ImageBuffer, Luma};
use serde_json::Value;

/// The page that a run wrote, and its records.
fn report(folder: &Path, arguments: &[&str]) -> (i32, Vec<Value>, String) {
    let target = folder.join("report");
    let arguments = ["--report", target.to_str().unwrap()].into_iter().chain(arguments.iter().copied());
    let (status, records) = run_json(arguments);
    (status, records, fs::read_to_string(target.join("report.html")).unwrap())
}

/// The text between two marks, for each time that they occur.
fn between<'a>(text: &'a str, start: &str, end: &str) -> Vec<&'a str> {
    text.split(start).skip(1).map(|rest| rest.split(end).next().unwrap()).collect()
}

fn unescaped(text: &str) -> String {
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&#39;", "'").replace("&amp;", "&")
}

/// Titles of the figures of a page.
fn titles(page: &str) -> Vec<&str> {
    between(page, "<h3>", "</h3>")
}

/// Nothing is fetched: every address is a part of the page or data inside it, and the policy forbids the rest.
fn assert_self_contained(page: &str) {
    for attribute in ["src=\"", "href=\"", "url(", "srcset=\"", "action=\"", "data=\""] {
        for address in between(page, attribute, "\"") {
            assert!(address.starts_with('#') || address.starts_with("data:"), "{attribute}{address:.60}");
        }
    }
    assert!(!page.contains("@import") && !page.contains("<iframe") && !page.contains("<object"));
    assert!(page.contains("Content-Security-Policy\" content=\"default-src 'none'; img-src data:;"));
}

/// Every tag that is opened is closed, in order.
fn assert_well_formed(page: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        let end = rest.find('>').unwrap();
        let tag = &rest[..end];
        rest = &rest[end + 1..];
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "{tag} in {open:?}");
        } else if !tag.ends_with('/') && !["!DOCTYPE", "meta", "link", "img"].contains(&name) {
            open.push(name);
            if ["style", "script"].contains(&name) {
                rest = &rest[rest.find(&format!("</{name}>")).unwrap()..];
            }
        }
    }
    assert_eq!(open, Vec::<&str>::new());
}

/// Nothing shown or drawn is not a number or infinite; the data of pictures may hold any letters.
fn assert_all_numbers(page: &str) {
    let drawn: String = page.split("base64,").map(|part| part.split_once('"').map_or(part, |(_, rest)| rest)).collect();
    for word in ["NaN", "\"inf", ">inf", " inf ", "-inf"] {
        assert!(!drawn.contains(word), "{word}: {:?}", drawn.split(word).next().map(|text| &text[text.len() - 99..]));
    }
}

#[test]
fn every_number_of_the_page_is_that_of_the_record() {
    let folder = folder("report-numbers");
    let path = write(&folder, "a.png", &png(blurred(256, 256, 20, 1)));
    let (status, records, page) = report(
        &folder,
        &["--accel", "--exposure", "100ms", "--exposure-u", "1ms", "--scale", "0.8mm/px", path.to_str().unwrap()],
    );
    assert_eq!(status, 0);
    let json: Value = serde_json::from_str(&unescaped(between(&page, "<pre class=\"record\">", "</pre>")[0])).unwrap();
    assert_eq!(json, records[0]);
    let mut seen = Vec::new();
    for data in between(&page, "<data data-field=\"", "</data>") {
        let (field, rest) = data.split_once("\" value=\"").unwrap();
        let (value, shown) = rest.split_once("\">").unwrap();
        let (value, shown): (f64, f64) = (value.parse().unwrap(), shown.parse().unwrap());
        assert_eq!(value, number(&records[0], field), "{field}");
        // What is shown is the number, rounded.
        let decimals = rest.split_once("\">").unwrap().1.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        assert!((shown - value).abs() <= 0.500_001 * 0.1_f64.powi(decimals as i32), "{field}: {shown} of {value}");
        seen.push(field);
    }
    for field in ["angle_deg", "angle_std_deg", "length_px", "length_std_px", "speed_m_s", "speed_expanded_m_s"] {
        assert!(seen.contains(&field), "{field} is not in {seen:?}");
    }
    assert_self_contained(&page);
    assert_well_formed(&page);
}

#[test]
fn the_budget_adds_up_to_the_speed_of_the_record() {
    let folder = folder("report-budget");
    let path = write(&folder, "a.png", &png(blurred(256, 256, 20, 2)));
    let (_, records, page) =
        report(&folder, &["--exposure", "100ms", "--exposure-u", "2ms", "--scale", "0.8mm/px", path.to_str().unwrap()]);
    let table = between(&page, "<tbody>", "</tbody>")[0];
    let shares: Vec<f64> = between(table, "value=\"", "\"").iter().map(|share| share.parse().unwrap()).collect();
    assert_eq!(shares.len(), 3);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 2e-4, "{shares:?}");
    // v = k L / T: relative uncertainties add in squares, and that of the exposure is 2 %.
    let relative = number(&records[0], "speed_std_m_s") / number(&records[0], "speed_m_s");
    assert!((shares[2] - (0.02 / relative).powi(2)).abs() < 1e-3, "{shares:?}");
    assert_eq!(shares[1], 0.0);
}

/// The budget of a page: shares, and the total with its standard and its expanded uncertainty.
fn budget(page: &str) -> (Vec<f64>, [f64; 3]) {
    let rest = page.split("Uncertainty budget").nth(1).unwrap();
    let shares = between(between(rest, "<tbody>", "</tbody>")[0], "value=\"", "\"");
    let total = between(rest, "<tfoot>", "</tfoot>")[0].replace("&nbsp;", " ");
    let cells = between(&total, "<td", "</td>").into_iter().map(|cell| cell.split_once('>').unwrap().1);
    let numbers: Vec<f64> =
        cells.map(|cell| cell.rsplit(": ").next().unwrap().split(' ').next().unwrap().parse().unwrap()).collect();
    (shares.iter().map(|share| share.parse().unwrap()).collect(), numbers.try_into().unwrap())
}

/// A camera without distortion for pictures of 256 x 256 pixels: a focal length of 500 px, known to 1 %.
const CAMERA: &str = r#"{"format": "blur camera", "version": 1, "program": "hand", "camera": {"model": "", "width_px": 256,
    "height_px": 256, "views": 0, "points": 0, "rms_px": 0, "parameters": [{"name": "fx_px", "value": 500, "std": 5},
    {"name": "fy_px", "value": 500, "std": 5}, {"name": "cx_px", "value": 127.5, "std": 0},
    {"name": "cy_px", "value": 127.5, "std": 0}],
    "covariance": [[25, 25, 0, 0], [25, 25, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]}}"#;

#[test]
fn with_a_camera_the_budget_tells_focal_length_from_distance() {
    let folder = folder("report-camera");
    let path = write(&folder, "a.png", &png(blurred(256, 256, 20, 14)));
    let camera = write(&folder, "camera.json", CAMERA.as_bytes());
    let given = ["--exposure", "100ms", "--camera", camera.to_str().unwrap(), path.to_str().unwrap()];
    let (_, records, page) = report(&folder, &[&["--distance", "2m", "--distance-u", "0.04m"], &given[..]].concat());
    let (shares, [speed, std, expanded]) = budget(&page);
    let relative = number(&records[0], "speed_std_m_s") / number(&records[0], "speed_m_s");
    assert!((speed / number(&records[0], "speed_m_s") - 1.0).abs() < relative, "{speed}");
    assert!(
        (std / number(&records[0], "speed_std_m_s") - 1.0).abs() < 0.06 && expanded > 1.9 * std,
        "{std} {expanded}"
    );
    // Length, focal length 1 %, distance 2 %, exposure.
    assert_eq!(shares.len(), 4);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 2e-4, "{shares:?}");
    assert!((shares[1] - (0.01 / relative).powi(2)).abs() < 0.02 * shares[1] + 1e-4, "{shares:?}");
    assert!((shares[2] - (0.02 / relative).powi(2)).abs() < 1e-3, "{shares:?}");

    let (_, records, page) = report(&folder, &[&["--rotating", "--exposure-u", "3ms"], &given[..]].concat());
    let (shares, [rate, ..]) = budget(&page);
    let relative = number(&records[0], "angular_rate_std_rad_s") / number(&records[0], "angular_rate_rad_s");
    assert!((rate / number(&records[0], "angular_rate_rad_s") - 1.0).abs() < relative, "{rate}");
    assert_eq!(shares.len(), 3);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 2e-4, "{shares:?}");
    assert!((shares[2] - (0.03 / relative).powi(2)).abs() < 1e-3, "{shares:?}");
    assert!(page.contains("<dt>Angular rate</dt>") && page.contains("the scene stood still"));
}

#[test]
fn a_readout_gives_a_speed_for_each_way() {
    let folder = folder("report-readout");
    let turned = image::imageops::rotate90(&blurred(256, 256, 20, 15));
    let path = write(&folder, "a.png", &png(turned));
    let given = ["--exposure", "100ms", "--scale", "1mm/px", "--readout", "50ms", path.to_str().unwrap()];
    let (_, records, page) = report(&folder, &given);
    for (field, way) in [("speed_down_m_s", "down"), ("speed_up_m_s", "up")] {
        let value = between(&page, &format!("<data data-field=\"{field}\" value=\""), "\"")[0];
        assert_eq!(value.parse::<f64>().unwrap(), number(&records[0]["readout"], field));
        assert!(page.contains(&format!("if it moved {way}")));
    }
    assert!(page.contains("0.05 s (--readout)"));
    assert_well_formed(&page);
}

#[test]
fn a_map_is_drawn_with_its_tiles_and_regions() {
    let folder = folder("report-map");
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/sample.png");
    let given = ["--map", "128", "--exposure", "100ms", "--scale", "1mm/px", sample];
    let (_, records, page) = report(&folder, &given);
    let map = &records[0]["map"];
    let (tiles, regions) = (map["tiles"].as_array().unwrap(), map["regions"].as_array().unwrap());
    assert!(!regions.is_empty(), "{map}");
    let figure = between(&page, "<h3>What moves, and what stands still</h3>", "</figure>")[0];
    for status in ["ok", "low_confidence"] {
        let drawn = figure.matches(&format!("<path class=\"tile {status}\" d=\"M")).count();
        // One more is in the legend.
        assert_eq!(drawn, 1 + tiles.iter().filter(|tile| tile["status"] == status).count(), "{status}");
    }
    let rows = between(between(figure, "<tbody>", "</tbody>")[0], "<tr>", "</tr>");
    assert_eq!(rows.len(), regions.len());
    for (row, region) in rows.iter().zip(regions) {
        let cells: Vec<&str> = between(row, "<td>", "</td>");
        for (cell, field) in [(0, "angle_deg"), (1, "length_px"), (2, "speed_m_s"), (3, "area_px")] {
            let shown: f64 = cells[cell].split([' ', '\u{b0}']).next().unwrap().parse().unwrap();
            assert!((shown - number(region, field)).abs() < 0.051, "{field}: {shown} in {region}");
        }
    }
    assert_all_numbers(figure);
    assert_well_formed(&page);
    assert_self_contained(&page);
}

#[test]
fn under_a_mask_the_figures_are_those_of_the_part_measured() {
    let folder = folder("report-mask");
    let path = write(&folder, "a.png", &png(blurred(300, 256, 20, 17)));
    let mask = GrayImage::from_fn(300, 256, |x, y| {
        Luma([if (f64::from(x) - 160.0).hypot(f64::from(y) - 120.0) < 100.0 { 255 } else { 0 }])
    });
    let mask = write(&folder, "mask.png", &png(mask));
    let (_, records, page) = report(&folder, &["--mask", mask.to_str().unwrap(), path.to_str().unwrap()]);
    assert_eq!(records[0]["status"], "ok", "{}", records[0]);
    assert_eq!(between(&page, "<p class=\"absent\">", "</p>").len(), 2, "the map and the budget");
    // The disk reaches from 61 to 259 and from 21 to 219.
    assert!(page.contains("199 \u{d7} 199 pixels from column 61, row 21"));
    assert!(page.contains("the mask, hard edges tapered over") && page.contains("mask.png (--mask)"));
    assert_all_numbers(&page);
    assert_well_formed(&page);
}

#[test]
fn the_picture_can_be_found_again_by_its_digest() {
    let folder = folder("report-digest");
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/sample.png");
    let (_, _, page) = report(&folder, &[sample]);
    let bytes = fs::read(sample).unwrap();
    assert!(page.contains(&format!("{} bytes, SHA-256 {SAMPLE_SHA256}", bytes.len())));
    assert!(page.contains(&format!("estimate {}", env!("CARGO_PKG_VERSION"))));
    assert!(between(&page, "<pre class=\"command\" tabindex=\"0\">", "</pre>")[0].contains("--report"));
}

#[test]
fn names_and_options_cannot_break_out_of_the_page() {
    let folder = folder("report-escape");
    let name = "<img src=x onerror=alert(1)>&\"'<b>.png";
    // A slash cannot be in a name, so no closing tag either; the command line may hold one.
    let path = write(&folder, name, &png(blurred(128, 128, 10, 3)));
    let broken = write(&folder, "<svg onload=alert(2)>.png", b"no picture");
    let (status, records, page) = report(&folder, &[path.to_str().unwrap(), broken.to_str().unwrap()]);
    assert_eq!((status, records.len()), (1, 2));
    assert!(!page.contains("<img src=x") && !page.contains("<b>") && !page.contains("<svg onload"));
    assert!(page.contains("&lt;img src=x onerror=alert(1)&gt;&amp;&quot;&#39;&lt;b&gt;.png</h2>"));
    assert_well_formed(&page);
    assert_self_contained(&page);
}

#[test]
fn several_pictures_have_an_index_and_sections_in_their_order() {
    let folder = folder("report-several");
    let files = [
        write(&folder, "c.png", &png(blurred(600, 600, 12, 1))),
        write(&folder, "a.png", b"not a picture"),
        write(&folder, "b.png", &png(blurred(64, 64, 8, 2))),
        folder.join("missing.png"),
    ];
    let names: Vec<&str> = files.iter().map(|path| path.to_str().unwrap()).collect();
    let (status, _, page) = report(&folder, &[&["--jobs", "2"], &names[..]].concat());
    assert_eq!(status, 1);
    let headings: Vec<String> = between(&page, "<h2 id=\"title-", "</h2>")
        .into_iter()
        .map(|heading| heading.split_once("\">").unwrap().1.replace("<small>", "").replace("</small>", ""))
        .collect();
    assert_eq!(headings, names);
    assert_eq!(between(&page, "<a href=\"#picture-", "\"").join(""), "1234");
    let failures = between(&page, "<p class=\"verdict failed\">", "</p>");
    assert_eq!(failures.len(), 2);
    assert!(failures[0].contains("not a picture") && failures[1].contains("No such file"), "{failures:?}");
    assert_well_formed(&page);
}

#[test]
fn every_status_has_its_words_and_every_figure_is_there_or_says_why_not() {
    let folder = folder("report-status");
    // White noise has no pattern; a square of 32 pixels is too small for certainty; the third is clear.
    let noise = blurred(256, 256, 1, 4);
    let files = [
        write(&folder, "none.png", &png(noise)),
        write(&folder, "small.png", &png(blurred(32, 32, 6, 5))),
        write(&folder, "clear.png", &png(blurred(256, 256, 20, 6))),
    ];
    let names: Vec<&str> = files.iter().map(|path| path.to_str().unwrap()).collect();
    let (_, records, page) = report(&folder, &names);
    let sections: Vec<&str> = page.split("<section ").skip(1).collect();
    for (record, section) in records.iter().zip(sections) {
        let word = match record["status"].as_str().unwrap() {
            "ok" => "Trusted",
            "low_confidence" => "Doubtful",
            _ => "No motion blur",
        };
        assert!(section.contains(&format!("<strong>{word}</strong>")), "{record}");
        if let Some(reason) = record["reason"].as_str() {
            assert_eq!(unescaped(section).matches(reason).count(), 2, "in the verdict and in the record: {reason}");
        }
        assert_eq!(titles(section).len(), 13, "{record}: {:?}", titles(section));
        assert_all_numbers(section);
    }
    assert_eq!(records[0]["status"], "no_motion_blur");
    assert_eq!(records[2]["status"], "ok");
}

#[test]
fn methods_without_a_likelihood_say_why_figures_are_absent() {
    let folder = folder("report-methods");
    let path = write(&folder, "a.png", &png(blurred(256, 256, 20, 7)));
    for method in ["phase-autocorrelation", "dct-radon+dct-pseudo-cepstrum"] {
        let (status, _, page) = report(&folder, &["--method", method, path.to_str().unwrap()]);
        assert_eq!(status, 0);
        let absent = between(&page, "<p class=\"absent\">", "</p>");
        // Likelihood, two of residuals, the evidence; the map, the budget.
        assert_eq!(absent.len(), 6, "{method}: {absent:?}");
        assert!(absent[..4].iter().all(|why| why.contains(method) && why.contains("whittle")), "{absent:?}");
        assert_well_formed(&page);
    }
}

#[test]
fn deep_tiny_float_and_large_pictures_are_drawn() {
    let folder = folder("report-sizes");
    let deep =
        ImageBuffer::from_fn(96, 80, |x, y| Luma([u16::from(blurred(96, 80, 9, 8).get_pixel(x, y).0[0]) * 7 + 20_000]));
    let small = blurred(40, 50, 7, 9);
    let samples: Vec<f32> = small.pixels().map(|pixel| f32::from(pixel.0[0]) * 1e-4).collect();
    let files = [
        write(&folder, "deep.png", &png(deep)),
        write(&folder, "tiny.png", &png(blurred(32, 32, 6, 10))),
        write(&folder, "float.tif", &float_tiff(40, 50, &samples)),
        write(&folder, "large.png", &png(blurred(4096, 4096, 40, 11))),
        write(&folder, "wide.png", &png(blurred(2000, 33, 8, 12))),
    ];
    let names: Vec<&str> = files.iter().map(|path| path.to_str().unwrap()).collect();
    let (status, records, page) = report(&folder, &names);
    assert_eq!((status, records.len()), (0, 5));
    assert!(!page.contains("could not be drawn"));
    assert_all_numbers(&page);
    // The picture, its detail, before and after.
    assert_eq!(between(&page, "data:image/jpeg;base64,", "\"").len(), 20);
    // Five pictures, the largest of 16 million pixels, in a page that a telephone can hold.
    assert!(page.len() < 6_000_000, "{}", page.len());
    assert_well_formed(&page);
    assert_self_contained(&page);
}

#[test]
fn a_report_replaces_an_older_one_and_leaves_nothing_else() {
    let folder = folder("report-again");
    let path = write(&folder, "a.png", &png(blurred(64, 64, 8, 13)));
    let target = folder.join("deep").join("report");
    for method in ["phase-autocorrelation", "whittle"] {
        let output = run(["--report", target.to_str().unwrap(), "--method", method, path.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(fs::read_to_string(target.join("report.html")).unwrap().contains(method));
    }
    let files: Vec<_> = fs::read_dir(&target).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(files, ["report.html"]);
}

#[test]
fn a_file_is_no_folder_for_a_report() {
    let folder = folder("report-file");
    let file = write(&folder, "file", b"precious");
    let output = run(["--report", file.to_str().unwrap()]);
    assert_eq!((output.status.code(), stdout(&output)), (Some(2), ""));
    assert!(stderr(&output).contains("name a folder"), "{}", stderr(&output));
    assert_eq!(fs::read(&file).unwrap(), b"precious");
}

/// `sha256sum fixtures/sample.png`.
const SAMPLE_SHA256: &str = "d80563f0dc9a819e86eb720bf6b4f4e2df902d7943c7a81b6bb94776bd6403c4";
