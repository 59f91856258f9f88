use proptest::prelude::*;

use super::*;

fn close(found: f64, expected: f64, relative: f64) {
    assert!((found / expected - 1.0).abs() < relative, "{found} {expected}");
}

fn exact(class_percent: f64, accuracy: f64) -> Instruments {
    let mut instruments = Instruments::default();
    instruments.caliper = Instrument { accuracy, class_percent, ..instruments.caliper };
    instruments
}

#[test]
fn a_width_is_evaluated_by_equations_8_2_to_8_6() {
    // Readings 4.9, 4.9, 5.0, 5.2: mean 5, s^2 = 0.06 / 3, u_A^2 = 0.005; class 2 % of 5 mm is 0.1 mm, over 2 sqrt 3;
    // 0.01 mm over 2 sqrt 3.
    let widths = Widths { section: Section::Slit(1), readings_mm: vec![4.9, 4.9, 5.0, 5.2] };
    let found = Direct::width(&widths, &exact(2.0, 0.0)).unwrap();
    close(found.mean, 5.0, 1e-12);
    close(found.type_a, 0.005_f64.sqrt(), 1e-12);
    close(found.type_b1, 0.1 / 12.0_f64.sqrt(), 1e-12);
    close(found.type_b2, 0.01 / 12.0_f64.sqrt(), 1e-12);
    let combined = (0.005_f64 + 0.01 / 12.0 + 0.0001 / 12.0).sqrt();
    close(found.combined, combined, 1e-12);
    close(found.expanded, 1.65 * combined, 1e-12);
    // Welch-Satterthwaite: only the mean has finite degrees of freedom, 3.
    close(found.budget.dof, 3.0 * (combined * combined / 0.005).powi(2), 1e-9);
}

#[test]
fn limits_of_a_data_sheet_are_half_a_rectangle() {
    let widths = Widths { section: Section::Tooth(1), readings_mm: vec![3.1, 3.1] };
    let found = Direct::width(&widths, &exact(0.0, 0.03)).unwrap();
    close(found.type_b1, 0.03 / 3.0_f64.sqrt(), 1e-12);
    assert_eq!(found.type_a, 0.0);
}

#[test]
fn a_speed_is_evaluated_by_equations_8_7_to_8_14() {
    let instruments = exact(0.0, 0.03);
    let tooth = Widths { section: Section::Calibration, readings_mm: vec![25.1, 25.2, 25.3] };
    let tooth = Direct::width(&tooth, &instruments).unwrap();
    let pairs = Pairs { setting: 0.0, system: vec![0.100, 0.102, 0.104], standard: vec![0.100, 0.100, 0.100] };
    let found = Speed::new(&pairs, &tooth, &instruments).unwrap();
    let (x, t) = (25.2e-3, 0.102);
    // Eq. 8.7: 2 per cent; u_A = 0.002 / sqrt 3, u_B1 = 2 % of 0.102 over 2 sqrt 3, u_B2 = 1e-6 over 2 sqrt 3.
    close(found.time.class_percent.unwrap(), 2.0, 1e-9);
    let u_t = (0.002_f64.powi(2) / 3.0 + 0.002_04_f64.powi(2) / 12.0 + 1e-12 / 12.0).sqrt();
    let u_x = 1e-3 * (0.01_f64 / 3.0 + 0.0009 / 3.0 + 0.0001 / 12.0).sqrt();
    close(found.value, x / t, 1e-12);
    close(found.c_t, -x / (t * t), 1e-12);
    close(found.c_x, 1.0 / t, 1e-12);
    close(found.u_1, x / (t * t) * u_t, 1e-9);
    close(found.u_r, u_x / t, 1e-9);
    let combined = (x / (t * t) * u_t).hypot(u_x / t);
    close(found.combined, combined, 1e-9);
    close(found.expanded, 1.65 * combined, 1e-9);
    close(found.corrected.value, x / 0.1, 1e-9);
    // The scatter of the time is the largest contribution, so that no rectangle dominates.
    assert!(!found.dominance.unwrap().rectangular);
}

#[test]
fn simulated_calibrations_give_the_figures_of_the_thesis() {
    let instruments = Instruments::default();
    for seed in 1..=20 {
        let found = readings(seed, &instruments).unwrap();
        let mut tooth = None;
        for widths in &found.widths {
            let direct = Direct::width(widths, &instruments).unwrap();
            if let Some((value, expanded)) = figures::width(widths.section) {
                // Twenty readings give u_A to some 16 %, and it is less than half of the variance; a mean strays by
                // u_A, some 0.012 mm.
                close(direct.expanded, expanded, 0.25);
                assert!((direct.mean - value).abs() < 0.07, "{}: {} {value}", direct.label, direct.mean);
                let suspected = widths.section == Section::Tooth(5);
                assert!(!suspected || !direct.suspicions.is_empty());
            } else {
                tooth = Some(direct);
            }
        }
        for pairs in &found.times {
            let speed = Speed::new(pairs, tooth.as_ref().unwrap(), &instruments).unwrap();
            let (value, expanded) = figures::speed(pairs.setting).unwrap();
            // 2 % over sqrt 20, five times; the deviation is drawn as it must be, but for the photogate's 0.1 ms.
            close(speed.value, value, 0.023);
            close(speed.expanded, expanded, 0.06);
            assert!(speed.u_r / speed.u_1 < 0.3, "the time dominates, as in the thesis");
        }
        for pairs in &found.accelerations {
            let direct = Direct::acceleration(pairs, &instruments).unwrap();
            let (value, expanded) = figures::acceleration(pairs.setting).unwrap();
            close(direct.mean, value, 0.025);
            close(direct.expanded, expanded, 0.35);
        }
    }
}

#[test]
fn misreadings_are_suspected_and_others_hardly_ever() {
    let instruments = Instruments::default();
    let mut alarms = 0;
    let mut sets = 0;
    for seed in 0..100 {
        for widths in readings(seed, &instruments).unwrap().widths {
            if widths.section != Section::Tooth(5) {
                sets += 1;
                alarms += Direct::width(&widths, &instruments).unwrap().suspicions.len();
            }
        }
    }
    // 1 % of 1000 sets: 10, with a standard deviation of 3.
    assert_eq!(sets, 1000);
    assert!((1..=22).contains(&alarms), "{alarms}");
}

#[test]
fn simulated_files_are_read_back_as_they_are() {
    let found = readings(7, &Instruments::default()).unwrap();
    let [(_, a), (_, b), (_, c)] = files(&found);
    let again = Readings {
        widths: widths("a", &a).unwrap(),
        times: times("b", &b).unwrap(),
        accelerations: accelerations("c", &c).unwrap(),
    };
    assert_eq!(again, found);
    assert!(a.contains("tooth 1,3.") && a.lines().all(|line| line.len() < 28), "rounded as displays show");
}

/// `REGENERATE=1 cargo test -p slider-host calibrate` remakes the examples.
#[test]
fn the_examples_are_the_simulated_calibration_of_seed_1() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/calibration/");
    let found = files(&readings(1, &Instruments::default()).unwrap());
    let instruments = toml::to_string_pretty(&Instruments::default()).unwrap();
    for (name, content) in found.into_iter().chain([("instruments.toml", instruments)]) {
        let path = folder.to_owned() + name;
        if std::env::var_os("REGENERATE").is_some() {
            std::fs::write(&path, &content).unwrap();
        }
        assert!(std::fs::read_to_string(&path).unwrap() == content, "{name}");
    }
}

#[test]
fn a_sheet_of_calibrated_widths_is_the_sheet_that_is_read() {
    let instruments = exact(0.1, 0.03);
    let found = readings(3, &instruments).unwrap();
    let sheet = sheet("five teeth", &found.widths, &instruments).unwrap();
    assert_eq!(sheet.sections.len(), 9);
    // Eq. 8.3 of a relative class: 0.1 % over 2 sqrt 3, shared by all.
    close(sheet.scale_std, 1e-3 / 12.0_f64.sqrt(), 1e-12);
    // The class is not in the widths a second time: three parts are left.
    let tooth = Direct::width(&found.widths[0], &instruments).unwrap();
    let own_mm = (tooth.type_a.powi(2) + 0.03_f64.powi(2) / 3.0 + 0.01_f64.powi(2) / 12.0).sqrt();
    close(sheet.sections[0].std_m, own_mm / 1e3, 1e-12);
    let read = Sheet::from_toml(&sheet.to_toml(1.65).unwrap()).unwrap();
    for (a, b) in read.sections.iter().zip(&sheet.sections) {
        close(a.value_m, b.value_m, 1e-12);
        close(a.std_m, b.std_m, 1e-12);
    }
    let missing: Vec<_> = found.widths.iter().filter(|w| w.section != Section::Slit(3)).cloned().collect();
    let error = super::sheet("x", &missing, &instruments).unwrap_err().to_string();
    assert_eq!(error, "a sheet of 5 teeth needs readings of slit 3");
}

#[test]
fn errors_tell_line_and_column() {
    let cases = [
        ("", "w.csv:1:1: nothing but empty lines; the first one must be section,reading_mm"),
        ("section;reading_mm\n", "w.csv:1:1: 'section;reading_mm' must be the header section,reading_mm"),
        ("# c\n\nsection,reading_mm\n", "w.csv:3:1: no readings under the header"),
        ("section,reading_mm\ntooth 1,3.1\nslit 1, x\n", "w.csv:3:9: 'x' is not a number"),
        (
            "section,reading_mm\ntooth 1,3,1\n",
            "w.csv:2:11: 3 fields where section,reading_mm are expected: is a decimal comma among them? Write a point",
        ),
        (
            "section,reading_mm\ntooth 1;3.1\n",
            "w.csv:2:12: 1 fields where section,reading_mm are expected: separate them by commas, not semicolons",
        ),
        (
            "section,reading_mm\n  gap 1,3.1\n",
            "w.csv:2:3: 'gap 1' is not a section: write tooth 1, slit 1 or calibration tooth",
        ),
        ("section,reading_mm\ntooth 1,-3.1\n", "w.csv:2:9: '-3.1' must be above 0 and below 1e12"),
        ("section,reading_mm\ntooth 1,inf\n", "w.csv:2:9: 'inf' is not a number"),
        (
            "section,reading_mm\ntooth 1,3.1\ntooth 2,3.1\ntooth 2,3.1\n",
            "w.csv:2:1: tooth 1 has one reading; its scatter needs at least two",
        ),
    ];
    for (text, message) in cases {
        assert_eq!(widths("w.csv", text).unwrap_err().to_string(), message);
    }
    let read = widths("w.csv", "\u{feff}section,reading_mm\r\n TOOTH  1 , 3.1\r\ntooth 1,3.2\r\n# end").unwrap();
    assert_eq!(read, [Widths { section: Section::Tooth(1), readings_mm: vec![3.1, 3.2] }]);
}

#[test]
fn instruments_are_read_and_checked() {
    let read = Instruments::from_toml("coverage_k = 2\n[caliper]\nname = \"mine\"\nresolution = 0.02\n").unwrap();
    assert_eq!((read.coverage_k, read.caliper.resolution, read.timer.resolution), (2.0, 0.02, 1e-6));
    for text in [
        "coverage_k = 0",
        "[caliper]\nname = 'x'\nresolution = -1",
        "[calliper]\n",
        "[timer]\nname = 'x'",
        "coverage_k = nan",
    ] {
        assert!(Instruments::from_toml(text).is_err(), "{text}");
    }
    let text = toml::to_string_pretty(&Instruments::default()).unwrap();
    assert_eq!(Instruments::from_toml(&text).unwrap(), Instruments::default());
}

#[test]
fn tables_stand_beside_the_thesis() {
    let tables = thesis(1).unwrap();
    let rows: Vec<usize> = tables.iter().map(|table| table.rows().len()).collect();
    assert_eq!(rows, [11, 10, 8]);
    let text: String = tables.iter().map(ToString::to_string).collect();
    for figure in ["3.164(107)", "0.173(12)", "0.351(4)"] {
        assert!(text.contains(figure), "{figure}");
    }
}

#[test]
fn a_run_writes_what_it_was_asked_for() {
    let folder = std::env::temp_dir().join(format!("slider-calibrate-{}", std::process::id()));
    let simulated = Options {
        simulate: Some(5),
        readings: Some(folder.clone()),
        sheet: Some(folder.join("sheet.toml")),
        thesis: true,
        budgets: true,
        ..Options::default()
    };
    let mut first = Vec::new();
    run(&simulated, &mut first).unwrap();
    let from_files = Options {
        widths: Some(folder.join("widths.csv")),
        times: Some(folder.join("times.csv")),
        accelerations: Some(folder.join("accelerations.csv")),
        thesis: true,
        budgets: true,
        ..Options::default()
    };
    let mut second = Vec::new();
    run(&from_files, &mut second).unwrap();
    let sheet = Sheet::from_toml(&std::fs::read_to_string(folder.join("sheet.toml")).unwrap()).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let (first, second) = (String::from_utf8(first).unwrap(), String::from_utf8(second).unwrap());
    assert_eq!(sheet.sections.len(), 9);
    assert!(first.starts_with(&second), "the same numbers from the files");
    assert!(first.contains("Student's t") && first.contains("simulated"));
    assert!(run(&Options::default(), &mut Vec::new()).is_err());
    let mut json = Vec::new();
    run(&Options { simulate: Some(5), json: true, ..Options::default() }, &mut json).unwrap();
    let lines: Vec<serde_json::Value> =
        String::from_utf8(json).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 11 + 10 + 8);
    assert_eq!(lines[0]["measurand"], "tooth 1");
}

#[derive(clap::Parser)]
struct Cli {
    #[command(flatten)]
    options: Options,
}

#[test]
fn options_that_need_or_exclude_each_other_say_so() {
    <Cli as clap::CommandFactory>::command().debug_assert();
    let parse = |line: &str| <Cli as clap::Parser>::try_parse_from(line.split(' ')).map(|cli| cli.options);
    assert_eq!(parse("x --simulate 3 --thesis").unwrap().simulate, Some(3));
    assert_eq!(parse("x --widths w.csv").unwrap().name, "calibrated");
    for line in ["x --times t.csv", "x --simulate 3 --widths w.csv", "x --readings folder"] {
        assert!(parse(line).is_err(), "{line}");
    }
}

/// A file with some bytes replaced, removed or repeated.
fn mutated(text: &str, edits: &[(usize, u8, u8)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for &(place, kind, byte) in edits {
        let place = place % bytes.len().max(1);
        match kind % 4 {
            0 if !bytes.is_empty() => bytes[place] = byte,
            1 if !bytes.is_empty() => drop(bytes.remove(place)),
            2 => bytes.insert(place.min(bytes.len()), byte),
            _ => {
                let tail = bytes[place.min(bytes.len())..].iter().copied().take(30).collect::<Vec<u8>>();
                bytes.extend(tail);
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn check(text: &str, result: Result<Vec<Vec<f64>>, Error>) {
    match result {
        Ok(groups) => {
            for readings in groups {
                assert!(readings.len() >= 2 && readings.iter().all(|r| r.is_finite() && *r > 0.0));
            }
        }
        Err(Error::Readings { line, column, .. }) => {
            let content = text.trim_start_matches('\u{feff}').lines().nth(line - 1).unwrap_or_default();
            assert!((1..=content.chars().count() + 1).contains(&column), "{line}:{column} {content:?}");
        }
        Err(other) => panic!("{other}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn damaged_files_give_readings_or_an_error_at_a_place(
        edits in proptest::collection::vec((any::<usize>(), any::<u8>(), any::<u8>()), 1..6),
    ) {
        let small = "section,reading_mm\ntooth 1,3.17\ntooth 1,3.18\nslit 1,4.89\nslit 1,4.90\n";
        let text = mutated(small, &edits);
        let found = widths("x", &text);
        if let Ok(found) = &found {
            for widths in found {
                // Whatever was read can be evaluated.
                Direct::width(widths, &Instruments::default()).unwrap();
            }
        }
        check(&text, found.map(|all| all.into_iter().map(|w| w.readings_mm).collect()));
        let small = "speed,t_system_s,t_standard_s\n0,0.146,0.127\n0,0.145,0.126\n1,0.11,0.09\n1,0.12,0.1\n";
        let text = mutated(small, &edits);
        let found = times("x", &text);
        if let Ok(found) = &found {
            let tooth = Widths { section: Section::Calibration, readings_mm: vec![25.1, 25.2] };
            let tooth = Direct::width(&tooth, &Instruments::default()).unwrap();
            for pairs in found {
                Speed::new(pairs, &tooth, &Instruments::default()).unwrap();
            }
        }
        check(&text, found.map(|all| all.into_iter().flat_map(|p| [p.system, p.standard]).collect()));
    }
}
