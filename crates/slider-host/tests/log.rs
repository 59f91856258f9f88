//! A file gives back what was received, as far as it got.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, unreachable_pub, dead_code, reason = "tests")]

mod damage;

use std::fs;
use std::path::{Path, PathBuf};

use damage::Random;
use slider_host::log::{Logged, Recorder, Source, load, parse, read};
use slider_host::reader::{Ended, Event, Missing};
use slider_host::run::{End, Run};
use slider_proto::{Edge, EdgeBatch, EndReason, Level};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("slider-log-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, text: &[u8]) -> PathBuf {
        let path = self.0.join("run.jsonl");
        fs::write(&path, text).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn edge(index: u32) -> Edge {
    let level = if index.is_multiple_of(2) { Level::Low } else { Level::High };
    Edge { tick: (u32::MAX - 20_000).wrapping_add(3000 * index), level, late: index == 9 }
}

fn run(number: u16, count: u32, end: End) -> Run {
    Run { number, tick_hz: 2_000_000, edges: (0..count).map(edge).collect(), end }
}

/// Saves the run as it would be received.
fn save(folder: &Path, run: &Run, missing: Option<Missing>) -> PathBuf {
    let source = Source {
        port: "/dev/ttyUSB0".to_owned(),
        unit: "timer".to_owned(),
        firmware: "0.1.0".to_owned(),
        sheet: Some("a \"sheet\"\n".to_owned()),
    };
    let mut recorder = Recorder::new(folder, source);
    let tick = run.edges.first().map_or(0, |edge| edge.tick);
    recorder.record(&Event::Began { run: run.number, tick, tick_hz: run.tick_hz }).unwrap();
    for (at, edges) in run.edges.chunks(8).enumerate() {
        let mut batch = EdgeBatch::new(run.number, 8 * at as u16);
        for &edge in edges {
            batch.push(edge).unwrap();
        }
        recorder.record(&Event::Edges(batch)).unwrap();
    }
    let ended = Ended { run: run.clone(), missing };
    let mut saved = recorder.record(&Event::Ended(ended)).unwrap().unwrap();
    saved.result(&serde_json::json!({"speed_m_s": 0.5})).unwrap();
    saved.path().to_owned()
}

fn told(edges: u16) -> End {
    End::Told { reason: EndReason::Overrun, edges, lost: 2 }
}

#[test]
fn saved_runs_are_read_back_equal() {
    let folder = Folder::new("equal");
    for count in [0, 1, 8, 26, 60] {
        let whole = run(3, count, told(count as u16));
        assert_eq!(load(save(&folder.0, &whole, None)).unwrap(), [whole]);
        let cut = run(4, count, End::Missing);
        let logged = read(save(&folder.0, &cut, Some(Missing::Frames(2)))).unwrap();
        assert_eq!(logged[0].run, cut);
        assert_eq!(logged[0].incomplete.as_deref(), Some(Missing::Frames(2).to_string().as_str()));
        assert_eq!(logged[0].header.sheet.as_deref(), Some("a \"sheet\"\n"));
        assert_eq!(logged[0].result, Some(serde_json::json!({"speed_m_s": 0.5})));
    }
    // One second made five files of each number, and none was written over.
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 10);
}

#[test]
fn every_edge_is_in_the_file_before_the_run_ends() {
    let folder = Folder::new("early");
    let mut recorder = Recorder::new(&folder.0, Source::default());
    recorder.record(&Event::Began { run: 1, tick: edge(0).tick, tick_hz: 2_000_000 }).unwrap();
    let file = fs::read_dir(&folder.0).unwrap().next().unwrap().unwrap().path();
    for at in 0..10 {
        let mut batch = EdgeBatch::new(1, at);
        batch.push(edge(u32::from(at))).unwrap();
        recorder.record(&Event::Edges(batch)).unwrap();
        assert_eq!(load(&file).unwrap(), [run(1, u32::from(at) + 1, End::Missing)]);
    }
}

#[test]
fn file_torn_anywhere_gives_the_edges_of_its_whole_lines() {
    let folder = Folder::new("torn");
    let whole = run(5, 26, told(26));
    let text = fs::read(save(&folder.0, &whole, None)).unwrap();
    for length in 0..=text.len() {
        let file = folder.file(&text[..length]);
        let lines = text[..length].split(|&byte| byte == b'\n').count() - 1;
        // A line that only lacks its end is whole.
        let lines = lines + usize::from(text.get(length) == Some(&b'\n'));
        let runs = load(&file).unwrap();
        if lines == 0 {
            assert_eq!(runs, []);
            continue;
        }
        let edges = (8 * (lines - 1)).min(26);
        let end = if lines > 5 { whole.end } else { End::Missing };
        assert_eq!(runs, [run(5, edges as u32, end)], "{length}");
        // The system may leave zeros where it did not get to.
        let zeros = [&text[..length], &[0; 100]].concat();
        if text[..length].ends_with(b"\n") {
            assert_eq!(load(folder.file(&zeros)).unwrap(), runs, "{length}");
        }
    }
}

#[test]
fn joined_files_give_all_their_runs() {
    let folder = Folder::new("joined");
    let (one, two) = (run(1, 26, told(26)), run(2, 10, End::Missing));
    let texts =
        [(&one, None), (&two, Some(Missing::Line))].map(|(run, missing)| fs::read(save(&folder.0, run, missing)));
    let text = texts.map(Result::unwrap).concat();
    assert_eq!(load(folder.file(&text)).unwrap(), [one, two]);
}

const V1: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/slider/run_v1.jsonl");

/// The file was written by hand after the documentation of the format and stays as it is.
#[test]
fn file_of_version_1_is_read() {
    let logged = read(V1).unwrap();
    let [one, two] = logged.as_slice() else { panic!("{logged:?}") };
    assert_eq!((one.header.run, one.header.port.as_str(), one.header.tick), (3, "/dev/ttyUSB0", 4_294_960_000));
    assert_eq!((one.header.started_s, one.header.sheet.as_deref()), (1_795_345_383.25, Some("encoder 5")));
    assert_eq!((one.header.program.as_str(), one.header.firmware.as_str()), ("0.1.0", "0.1.0"));
    let edge = |tick, level, late| Edge { tick, level, late };
    let edges = vec![
        edge(4_294_960_000, Level::Low, false),
        edge(4_294_965_000, Level::High, false),
        edge(5544, Level::Low, true),
        edge(10_544, Level::High, false),
    ];
    let end = End::Told { reason: EndReason::Limit, edges: 4, lost: 0 };
    assert_eq!(one.run, Run { number: 3, tick_hz: 2_000_000, edges, end });
    assert!(one.run.is_complete() && one.incomplete.is_none() && one.result.is_some());
    assert_eq!((two.run.number, two.run.edges.len(), two.run.end), (4, 1, End::Missing));
    assert_eq!(two.incomplete.as_deref(), Some("the line went away"));
}

/// The first error of the text of `V1` in which `old` is `new`.
fn error(folder: &Folder, old: &str, new: &str) -> String {
    let text = fs::read_to_string(V1).unwrap();
    assert!(text.contains(old), "{old}");
    load(folder.file(text.replacen(old, new, 1).as_bytes())).unwrap_err().to_string()
}

#[test]
fn errors_name_their_line_and_what_is_wrong() {
    let folder = Folder::new("errors");
    for (old, new, line, what) in [
        ("{\"header\"", "{\"heads\"", 1, "does not begin with the header"),
        ("slider-run", "slider-walk", 1, "not a file of the format 'slider-run'"),
        ("\"version\":1", "\"version\":2", 1, "version 2 of the format, this program knows up to 1"),
        ("\"version\":1,", "", 1, "no version"),
        ("2000000", "0", 1, "tick_hz is 0"),
        ("\"first\":0", "\"first\":1", 2, "edge 1 came where edge 0 was due"),
        ("[0,1]", "[0,0]", 2, "an edge is missing"),
        ("[0,1]", "[0,2]", 2, "level 2 is neither 0 nor 1"),
        ("[0,1]", "[0]", 2, "2 ticks, 1 levels"),
        ("4294965000", "4294950000", 2, "is not after the one before it"),
        ("4294965000", "42949650000", 2, "no line of a run"),
        ("4294965000", "429496x", 2, "no JSON"),
        ("\"edges\":4", "\"edges\":5", 4, "its end tells 5 edges and 4 were received"),
        ("\"late\":1", "\"late\":0", 4, "its end tells 0 late edges and 1 were received"),
        ("\"limit\"", "\"tired\"", 4, "unknown reason 'tired'"),
        ("{\"result\"", "{\"results\"", 5, "unknown variant"),
        ("\"edges\":1}", "\"edges\":2}", 8, "2 edges are told and 1 are there"),
    ] {
        let error = error(&folder, old, new);
        assert!(error.contains(&format!("run.jsonl, line {line}: ")) && error.contains(what), "{new}: {error}");
    }
}

#[test]
fn mutated_files_are_refused_or_read_but_never_panic() {
    let text = fs::read(V1).unwrap();
    let mut random = Random(3);
    let mut refused = 0;
    for _ in 0..50_000 {
        let mut mutated = text.clone();
        for _ in 0..=random.below(3) {
            let at = random.below(mutated.len());
            let end = (at + 1 + random.below(40)).min(mutated.len());
            match random.below(6) {
                0 => drop(mutated.remove(at)),
                1 => drop(mutated.drain(at..end)),
                2 => mutated[at] ^= 1 << random.below(8),
                3 => mutated[at] = b"0123456789{}[],:\"\n"[random.below(18)],
                4 => mutated.extend_from_slice(&text[at.min(text.len() - 1)..]),
                _ => {
                    let part = mutated[at..end].to_vec();
                    mutated.splice(at..at, part);
                }
            }
            if mutated.is_empty() {
                break;
            }
        }
        match parse(Path::new("run.jsonl"), &mutated) {
            Ok(runs) => {
                for Logged { run, .. } in runs {
                    let levels = run.edges.windows(2).all(|pair| pair[0].level != pair[1].level);
                    assert!(levels && run.tick_hz > 0);
                }
            }
            Err(error) => {
                refused += 1;
                assert!(error.to_string().contains("line "), "{error}");
            }
        }
    }
    assert!(refused > 10_000, "{refused}");
}

#[test]
fn missing_file_is_told_by_name() {
    assert!(load("/no/such/run.jsonl").unwrap_err().to_string().starts_with("/no/such/run.jsonl: "));
}
