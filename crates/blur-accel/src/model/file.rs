//! Models as JSON.
//!
//! ```json
//! {"format":"blur-accel model","version":1,"program":"0.1.0","sha256":"…","content":{…}}
//! ```
//!
//! `content` is the model; `sha256` is the checksum of the version, the program's version and the text of the content.
//! A version, once released, is read for ever: what changes the content raises [`VERSION`] and converts the old one here.

use serde::{Deserialize, Serialize};
use serde_json::error::Category;
use serde_json::value::RawValue;
use sha2::{Digest, Sha256};

use super::Model;
use crate::{Error, Result};

/// What a model's file calls itself.
pub const FORMAT: &str = "blur-accel model";
/// Version of the format that is written; all versions from 1 on are read.
pub const VERSION: u64 = 1;

/// What files of every version have, those to come included.
#[derive(Deserialize)]
struct Start {
    format: String,
    version: u64,
    program: Option<String>,
}

#[derive(Serialize, Deserialize)]
struct File<'a> {
    format: String,
    version: u64,
    program: String,
    sha256: String,
    #[serde(borrow)]
    content: &'a RawValue,
}

impl File<'_> {
    fn checksum(&self) -> String {
        sha256(format!("{}\n{}\n{}", self.version, self.program, self.content.get()).as_bytes())
    }
}

impl Model {
    /// The model as the text of a file.
    ///
    /// # Errors
    /// [`Error::ModelContent`] when a number in it is not finite: JSON has no such numbers.
    pub fn to_json(&self) -> Result<String> {
        let content = serde_json::to_string(self).map_err(Error::ModelContent)?;
        // JSON writes what is not finite as null, which does not come back.
        serde_json::from_str::<Self>(&content).map_err(Error::ModelContent)?;
        let content = RawValue::from_string(content).map_err(Error::ModelContent)?;
        let mut file = File {
            format: FORMAT.to_owned(),
            version: VERSION,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            sha256: String::new(),
            content: &content,
        };
        file.sha256 = file.checksum();
        let mut text = serde_json::to_string(&file).map_err(Error::ModelContent)?;
        text.push('\n');
        Ok(text)
    }

    /// The model in the text of a file.
    ///
    /// # Errors
    /// [`Error::NotAModel`], [`Error::ModelCutShort`], [`Error::NewerModel`], [`Error::ModelDamaged`] when the text is not
    /// what was written, [`Error::ModelContent`] and [`Error::Size`] when it is but makes no sense.
    pub fn from_json(text: &[u8]) -> Result<Self> {
        let refuse = |error: serde_json::Error| {
            // An end in the middle of a number or a word is no end to the parser.
            let ends_early = error.classify() == Category::Eof || !text.trim_ascii_end().ends_with(b"}");
            match (begins_as_model(text), ends_early) {
                (true, true) => Error::ModelCutShort { bytes: text.len() },
                (true, false) => Error::ModelDamaged { reason: error.to_string() },
                (false, _) => Error::NotAModel,
            }
        };
        let start: Start = serde_json::from_slice(text).map_err(refuse)?;
        if start.format != FORMAT {
            return Err(Error::NotAModel);
        }
        if start.version > VERSION {
            return Err(Error::NewerModel {
                version: start.version,
                known: VERSION,
                program: start
                    .program
                    .map_or_else(|| "a later program".to_owned(), |program| format!("program {program} or later")),
            });
        }
        let file: File<'_> = serde_json::from_slice(text).map_err(refuse)?;
        if file.checksum() != file.sha256 {
            return Err(Error::ModelDamaged { reason: "its checksum does not fit its content".to_owned() });
        }
        if file.version < 1 {
            return Err(Error::ModelDamaged { reason: "there is no version 0".to_owned() });
        }
        let model: Self = serde_json::from_str(file.content.get()).map_err(Error::ModelContent)?;
        model.check()?;
        Ok(model)
    }
}

/// Whether a text begins as a model's file does, as far as it goes.
fn begins_as_model(text: &[u8]) -> bool {
    let start = format!("{{\"format\":\"{FORMAT}\"");
    let compared = text.len().min(start.len());
    compared > 0 && text[..compared] == start.as_bytes()[..compared]
}

/// The SHA-256 checksum of `bytes`, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    let nibbles = Sha256::digest(bytes).into_iter().flat_map(|byte| [byte >> 4, byte & 0xf]);
    nibbles.filter_map(|nibble| char::from_digit(nibble.into(), 16)).collect()
}

#[cfg(test)]
mod tests {
    use super::sha256;

    /// FIPS 180-2, appendix B.1.
    #[test]
    fn the_checksum_is_that_of_the_standard() {
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
