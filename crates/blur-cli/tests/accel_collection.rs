//! Folders of pictures with their table.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a folder that cannot be made fails the test")]

mod common;

use std::path::{Path, PathBuf};

use blur_cli::accel::collection::Collection;
use common::{Random, folder, write};

/// A folder with three empty files, enough for a table that never looks into them.
fn pictures(name: &str) -> PathBuf {
    let folder = folder(name);
    for name in ["a.png", "b.png", "c.png"] {
        write(&folder, name, b"");
    }
    folder
}

const TABLE: &str = "\
image,kind,scene,accel_m_s2
a.png,still,wall,
b.png,blurred,wall,2.463
";

fn parsed(table: &str, folder: &Path) -> Collection {
    Collection::parse(table.as_bytes(), folder).unwrap()
}

#[test]
fn a_table_by_hand_is_read() {
    let folder = pictures("collection-hand");
    // A byte order mark and line ends as Windows writes them, an empty line, spaces, columns in any order, one unknown.
    let table = "\u{feff}kind, scene ,notes,image,accel_m_s2,exposure_s\r\n\
                 blurred,\"the wall, left\",windy,b.png, -1.5 ,0.1\r\n\
                 \r\n\
                 still,\"the wall, left\",,./a.png,,\r\n";
    let collection = parsed(table, &folder);
    assert_eq!(collection.scenes.len(), 1);
    assert_eq!(collection.scenes[0].name, "the wall, left");
    assert_eq!(collection.scenes[0].stills, [folder.join("a.png")]);
    let [blurred] = &collection.blurred[..] else { panic!("{collection:?}") };
    assert_eq!((blurred.path.clone(), blurred.scene, blurred.accel_m_s2), (folder.join("b.png"), 0, -1.5));
    assert_eq!((blurred.exposure_s, blurred.length_px), (Some(0.1), None));
    write(&folder, "pictures.csv", table.as_bytes());
    assert_eq!(Collection::read(&folder).unwrap(), collection);
}

#[test]
fn scenes_keep_their_own_stills_in_the_order_of_the_table() {
    let folder = pictures("collection-order");
    write(&folder, "d.png", b"");
    let table =
        "image,kind,scene,accel_m_s2\nc.png,still,two,\na.png,still,one,\nb.png,still,two,\nd.png,blurred,two,1\n";
    let collection = parsed(table, &folder);
    assert_eq!(collection.scenes[0].stills, [folder.join("c.png"), folder.join("b.png")]);
    assert_eq!(collection.scenes[1].stills, [folder.join("a.png")]);
    assert_eq!(collection.blurred[0].scene, 0);
}

#[test]
fn what_is_wrong_is_said_in_one_line_with_its_number() {
    let folder = pictures("collection-wrong");
    let with = |from: &str, to: &str| TABLE.replacen(from, to, 1);
    let cases = [
        (
            String::new(),
            "line 1: there is no column 'image': the first line must name the columns image,kind,scene,accel_m_s2, with commas between them",
        ),
        (with(",kind", ""), "line 1: there is no column 'kind'"),
        (TABLE.replace(',', ";"), "line 1: there is no column 'image'"),
        (with("blurred", "moving"), "line 3: 'moving' in the column 'kind' is neither still nor blurred"),
        (with("b.png", "x.png"), "line 3: there is no file 'x.png'"),
        (with("b.png", "."), "line 3: there is no file '.'"),
        (with("b.png", ""), "line 3: the column 'image' is empty"),
        (with("b.png", "a.png"), "line 3: the picture 'a.png' is already in the table"),
        (with("b.png", "./a.png"), "line 3: the picture './a.png' is already in the table"),
        (with("2.463", "NaN"), "line 3: 'NaN' in the column 'accel_m_s2' is not a number"),
        (with("2.463", "inf"), "line 3: 'inf' in the column 'accel_m_s2' is not a number"),
        (with("2.463", "fast"), "line 3: 'fast' in the column 'accel_m_s2' is not a number"),
        (with("2.463", ""), "line 3: the column 'accel_m_s2' is empty"),
        (
            with("2.463", "2,463"),
            "line 3: 5 fields where the first line names 4 columns; is a decimal comma among them?",
        ),
        (with("still,wall", "still,door"), "line 3: the scene 'wall' has no still"),
        // Line ends of Windows and empty lines count as an editor counts them.
        (with("2.463", "NaN").replace('\n', "\r\n"), "line 3: 'NaN'"),
        (with("b.png", "\n\nx.png"), "line 5: there is no file 'x.png'"),
    ];
    for (table, expected) in cases {
        let error = Collection::parse(table.as_bytes(), &folder).unwrap_err().one_line();
        assert!(error.starts_with(expected), "{table:?} gives: {error}");
    }
    for (column, value, expected) in [
        ("exposure_s", "0", "a number above 0"),
        ("scale_m_per_px", "-1", "a number above 0"),
        ("length_px", "-1", "a number, 0 or more"),
        ("accel_ratio", "1.1", "a number from -1 to 1"),
        ("release_m", "NaN", "a number, 0 or more"),
        ("v0_m_s", "x", "a number, 0 or more"),
    ] {
        let table = format!("image,kind,scene,accel_m_s2,{column}\na.png,still,wall,,\nb.png,blurred,wall,1,{value}\n");
        let error = Collection::parse(table.as_bytes(), &folder).unwrap_err().one_line();
        assert_eq!(error, format!("line 3: '{value}' in the column '{column}' is not {expected}"));
    }
    let bytes = [TABLE.as_bytes(), b"c.png,blurred,\xff,1\n"].concat();
    let error = Collection::parse(&bytes, &folder).unwrap_err().one_line();
    assert!(error.starts_with("line 4: "), "{error}");
}

#[test]
fn errors_of_a_folder_name_the_table() {
    let folder = pictures("collection-folder");
    let table = folder.join("pictures.csv");
    let missing = Collection::read(&folder).unwrap_err().one_line();
    assert!(missing.starts_with(&format!("{}: cannot be read", table.display())), "{missing}");
    write(&folder, "pictures.csv", TABLE.replace("2.463", "NaN").as_bytes());
    let error = Collection::read(&folder).unwrap_err().one_line();
    assert_eq!(error, format!("{}: line 3: 'NaN' in the column 'accel_m_s2' is not a number", table.display()));
}

#[test]
fn damaged_tables_are_read_or_refused() {
    let folder = pictures("collection-damaged");
    let table = "image,kind,scene,accel_m_s2,length_px\na.png,still,wall,,\nb.png,blurred,wall,2.463,30.5\n\
                 c.png,blurred,\"wall\",1.229,60\n";
    let mut random = Random(5);
    let mut read = 0;
    for _ in 0..20_000 {
        let mut bytes = table.as_bytes().to_vec();
        for _ in 0..=random.below(3) {
            let at = random.below(bytes.len());
            match random.below(4) {
                0 => bytes[at] = random.bits() as u8,
                1 => bytes[at] = b"\",\n\r \0.-e"[random.below(9)],
                2 => bytes.truncate(at + 1),
                _ => {
                    bytes.remove(at);
                    bytes.push(b'\n');
                }
            }
        }
        match Collection::parse(&bytes, &folder) {
            Ok(collection) => {
                read += 1;
                assert!(collection.blurred.iter().all(|b| b.accel_m_s2.is_finite()));
                assert!(collection.blurred.iter().all(|b| !collection.scenes[b.scene].stills.is_empty()));
            }
            Err(error) => {
                let (message, lines) = (error.one_line(), bytes.split(|&b| b == b'\n').count());
                let number = message.strip_prefix("line ").and_then(|rest| rest.split(':').next()?.parse().ok());
                assert!(number.is_some_and(|line: usize| (1..=lines).contains(&line)), "{message}");
            }
        }
    }
    // Both must have been tried: a digit more or less still makes a table.
    assert!((1000..19_000).contains(&read), "{read} of 20000 read");
}
