//! The files of a bag.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::{Error, Result};

const METADATA: &str = "metadata.yaml";
/// The most that is read of it.
const MAX_METADATA_BYTES: u64 = 1 << 24;

/// Whether a path is a bag: an MCAP file by its content, or a folder with `metadata.yaml`.
pub fn is_bag(path: &Path) -> bool {
    if path.is_dir() {
        return path.join(METADATA).is_file();
    }
    let mut magic = [0; mcap::MAGIC.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && magic == mcap::MAGIC
}

/// The MCAP files of a bag in their order.
///
/// # Errors
/// [`Error::Read`] and, for a folder whose storage is not MCAP or compressed as a whole, [`Error::BagFolder`].
pub fn files(path: &Path) -> Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let metadata = path.join(METADATA);
    let read = |source| Error::Read { path: metadata.clone(), source };
    let mut text = String::new();
    File::open(&metadata).map_err(read)?.take(MAX_METADATA_BYTES).read_to_string(&mut text).map_err(read)?;
    let refused = |reason: String| Error::BagFolder { path: metadata.clone(), reason };
    for (key, accepted, advice) in [
        ("storage_identifier", "mcap", "convert the bag with 'ros2 bag convert' to the storage mcap"),
        ("compression_mode", "", "let MCAP compress its chunks instead of rosbag2 files or messages"),
    ] {
        let value = scalar(&text, key).unwrap_or_default();
        if !value.eq_ignore_ascii_case(accepted) && !value.eq_ignore_ascii_case("none") {
            return Err(refused(format!("{key} '{value}' cannot be read: {advice}")));
        }
    }
    // Only the last part of a path counts, as for rosbag2: bags are moved, and nothing outside is to be read.
    let names: Vec<_> = list(&text, "relative_file_paths")
        .into_iter()
        .filter_map(|name| Some(Path::new(name).file_name()?.to_owned()))
        .collect();
    if names.is_empty() {
        return Err(refused("relative_file_paths names no file".to_owned()));
    }
    let files: Vec<_> = names.into_iter().map(|name| path.join(name)).collect();
    match files.iter().find(|file| fs::metadata(file).is_err()) {
        Some(missing) => Err(refused(format!("the file {} that it names is missing", missing.display()))),
        None => Ok(files),
    }
}

/// The value of the first line `key: value` of a YAML document, without quotes.
fn scalar<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    text.lines().find_map(|line| Some(unquoted(value_of(line, key)?)))
}

/// The items below the first line `key:` of a YAML document, or behind it in brackets.
fn list<'a>(text: &'a str, key: &str) -> Vec<&'a str> {
    let mut lines = text.lines().skip_while(|line| value_of(line, key).is_none());
    let inline = lines.next().and_then(|line| value_of(line, key)).unwrap_or_default();
    if let Some(items) = inline.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        return items.split(',').map(unquoted).filter(|item| !item.is_empty()).collect();
    }
    lines.map_while(|line| line.trim_start().strip_prefix("- ")).map(unquoted).collect()
}

fn value_of<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    line.trim().strip_prefix(key)?.strip_prefix(':').map(str::trim)
}

fn unquoted(text: &str) -> &str {
    let text = text.trim();
    ['"', '\''].into_iter().find_map(|quote| text.strip_prefix(quote)?.strip_suffix(quote)).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: &str = "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  duration:\n    nanoseconds: 1\n  \
                         relative_file_paths:\n    - run_0.mcap\n    - 'run_1.mcap'\n  compression_mode: \"\"\n";

    #[test]
    fn files_are_listed_in_either_style() {
        assert_eq!(list(BLOCK, "relative_file_paths"), ["run_0.mcap", "run_1.mcap"]);
        assert_eq!(
            list("relative_file_paths: [a.mcap, \"b.mcap\"]\nx: 1", "relative_file_paths"),
            ["a.mcap", "b.mcap"]
        );
        assert_eq!(scalar(BLOCK, "storage_identifier"), Some("mcap"));
        assert_eq!(scalar(BLOCK, "compression_mode"), Some(""));
        assert!(list(BLOCK, "files").is_empty());
    }
}
