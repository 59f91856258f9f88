//! The page around the sections.

use std::fmt::Write;

use sha2::{Digest, Sha256};

use super::Entry;
use super::html::Text;
use super::raster::base64;
use crate::record::Record;
use crate::text::with_uncertainty;

const STYLE: &str = include_str!("style.css");
/// Adds a slider between the pictures of a pair; the page is complete without it.
const SCRIPT: &str = include_str!("slider.js");

/// Direction and length in a few words.
pub fn summary(record: &Record) -> String {
    if record.status == "no_motion_blur" {
        return String::from("no motion blur");
    }
    let angle = with_uncertainty(record.angle_deg, record.angle_std_deg, 1);
    let length = with_uncertainty(record.length_px, record.length_std_px, 1);
    format!("{angle}\u{b0}, {length} px")
}

/// The whole page.
pub(super) fn html(command: &[String], entries: &[Entry], date: &str) -> String {
    let mut html = head(command, entries.len(), date);
    if entries.len() > 1 {
        html.push_str(&index(entries));
    }
    for (i, Entry { image, section, .. }) in entries.iter().enumerate() {
        // Writing to a String cannot fail, here and below.
        let _ = write!(
            html,
            "<section id=\"picture-{number}\" aria-labelledby=\"title-{number}\">\n<h2 id=\"title-{number}\">{}</h2>\n{section}\
             </section>\n",
            heading(image),
            number = i + 1
        );
    }
    let _ = write!(html, "</main>\n<script>{SCRIPT}</script>\n</body>\n</html>\n");
    html
}

/// The name of a picture, its folder in small print above.
fn heading(image: &str) -> String {
    match image.rfind(['/', '\\']).map(|at| image.split_at(at + 1)) {
        Some((folder, name)) if !name.is_empty() => format!("<small>{}</small>{}", Text(folder), Text(name)),
        _ => Text(image).to_string(),
    }
}

fn head(command: &[String], pictures: usize, date: &str) -> String {
    let count = if pictures == 1 { String::from("1 picture") } else { format!("{pictures} pictures") };
    let command = command.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src '{}'; \
         script-src '{}'\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<meta name=\"generator\" content=\"estimate {version}\">\n\
         <title>Motion blur report, {count}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}</style>\n</head>\n\
         <body>\n<header>\n<h1>Motion blur report</h1>\n\
         <p class=\"run\">{count}, {date}, estimate {version}</p>\n<pre class=\"command\" tabindex=\"0\">{}</pre>\n\
         </header>\n<main>\n",
        hash(STYLE),
        hash(SCRIPT),
        Text(command),
        version = env!("CARGO_PKG_VERSION"),
    )
}

/// A source of the content security policy that allows this very text.
fn hash(text: &str) -> String {
    format!("sha256-{}", base64(&Sha256::digest(text.as_bytes())))
}

fn index(entries: &[Entry]) -> String {
    let mut html = String::from("<nav aria-label=\"Pictures\"><ol>\n");
    for (i, Entry { image, summary, status, .. }) in entries.iter().enumerate() {
        let _ = writeln!(
            html,
            "<li><a href=\"#picture-{}\">{}</a> <span class=\"chip {status}\">{}</span> <span>{}</span></li>",
            i + 1,
            Text(image),
            status.replace('_', " "),
            Text(summary)
        );
    }
    html.push_str("</ol></nav>\n");
    html
}

/// A word of a command line as a shell of the Unix family takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_command_are_quoted_for_a_shell() {
        assert_eq!(quoted("--roi"), "--roi");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("*.png"), "'*.png'");
    }

    #[test]
    fn a_source_of_the_policy_is_the_digest_in_base64() {
        // printf 'abc' | openssl dgst -sha256 -binary | base64
        assert_eq!(hash("abc"), "sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
    }
}
