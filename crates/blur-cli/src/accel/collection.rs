//! A folder of pictures of known acceleration: `pictures.csv` and the files that it names.
//!
//! `accel simulate` writes such folders; for pictures of a real rig the file is written by hand or exported from a
//! spreadsheet. It is a table with commas between the columns, a point in the numbers, and the names of the columns, in
//! any order, in its first line:
//!
//! ```text
//! image,kind,scene,accel_m_s2,exposure_s,scale_m_per_px
//! wall/still1.png,still,wall,,,
//! wall/still2.png,still,wall,,,
//! wall/run1.png,blurred,wall,2.463,0.1,0.0011008
//! ```
//!
//! | column | meaning |
//! |---|---|
//! | `image` | path of the picture, seen from the folder; each only once |
//! | `kind` | `still`: a sharp background, taken at rest; `blurred`: taken during the motion |
//! | `scene` | what is seen, any name: a blurred picture is compared with the stills of the same scene, at least one |
//! | `accel_m_s2` | acceleration in m/s², positive where the motion speeds up; not read for stills |
//! | `length_px` | length of the blur in pixels, if known |
//! | `accel_ratio` | acceleration ratio `r` of the blur, -1 to 1, if known |
//! | `exposure_s` | exposure in seconds, if known |
//! | `scale_m_per_px` | metres in the scene for each pixel, if known |
//! | `release_m` | distance in metres from the start at rest to the opening of the shutter, if known |
//! | `v0_m_s` | speed in m/s when the shutter opens, if known |
//!
//! The first four columns are needed; of the others each may be missing or empty. Columns of other names are ignored.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::{Error, Result};

/// Name of the table in its folder.
pub const FILE: &str = "pictures.csv";

/// The columns that a table must have.
const NEEDED: [&str; 4] = ["image", "kind", "scene", "accel_m_s2"];

/// The pictures of a folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Collection {
    /// The scenes, in the order in which they first occur.
    pub scenes: Vec<Scene>,
    /// The blurred pictures, in the order of the table.
    pub blurred: Vec<Blurred>,
}

/// What the pictures show, and how it looks at rest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scene {
    /// Its name.
    pub name: String,
    /// Paths of its stills, in the order of the table. A scene with blurred pictures has at least one.
    pub stills: Vec<PathBuf>,
}

/// A blurred picture and what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Blurred {
    /// Its path.
    pub path: PathBuf,
    /// Its scene: a number in [`Collection::scenes`].
    pub scene: usize,
    /// Acceleration in m/s².
    pub accel_m_s2: f64,
    /// Length of the blur in pixels.
    pub length_px: Option<f64>,
    /// Acceleration ratio `r`, -1 to 1.
    pub accel_ratio: Option<f64>,
    /// Exposure in seconds.
    pub exposure_s: Option<f64>,
    /// Metres in the scene for each pixel.
    pub scale_m_per_px: Option<f64>,
    /// Distance in metres from the start at rest to the opening of the shutter.
    pub release_m: Option<f64>,
    /// Speed in m/s when the shutter opens.
    pub v0_m_s: Option<f64>,
}

impl Collection {
    /// Reads the table of a folder and makes sure that the files in it exist. The pictures themselves are not read.
    ///
    /// # Errors
    /// [`Error::InFile`] with the path of the table, in it [`Error::InLine`] with the number of the line, for whatever the
    /// table lacks.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(FILE);
        let table = fs::read(&path).map_err(Error::Read).and_then(|bytes| Self::parse(&bytes, folder));
        table.map_err(|error| error.in_file(&path))
    }

    /// Reads the content of a table whose pictures are in `folder`.
    ///
    /// # Errors
    /// [`Error::InLine`] with the number of the line for whatever the table lacks.
    pub fn parse(table: &[u8], folder: &Path) -> Result<Self> {
        let mut reader = ReaderBuilder::new().flexible(true).trim(Trim::All).from_reader(table);
        let mut byte = reader.position().byte();
        let columns = reader.headers().map_err(Error::Csv).and_then(Columns::find).map_err(in_line(table, byte))?;
        let mut rows = Rows::default();
        let mut record = StringRecord::new();
        loop {
            byte = reader.position().byte();
            match reader.read_record(&mut record) {
                Ok(false) => break,
                Ok(true) => rows.add(&columns, &record, folder, byte).map_err(in_line(table, byte))?,
                Err(error) => return Err(in_line(table, byte)(Error::Csv(error))),
            }
        }
        rows.finish().map_err(|(error, byte)| in_line(table, byte)(error))
    }
}

/// Puts the number of the line before an error: that of the first line with anything in it from `byte` on.
fn in_line(table: &[u8], byte: u64) -> impl Fn(Error) -> Error {
    move |error| {
        let (before, after) = table.split_at_checked(byte as usize).unwrap_or((table, &[]));
        let empty = after.iter().take_while(|&byte| matches!(byte, b'\r' | b'\n'));
        let line = 1 + before.iter().chain(empty).filter(|&&byte| byte == b'\n').count();
        Error::InLine { line, source: Box::new(error) }
    }
}

/// Where the columns are.
struct Columns {
    names: StringRecord,
}

impl Columns {
    fn find(names: &StringRecord) -> Result<Self> {
        for column in NEEDED {
            if !names.iter().any(|name| name == column) {
                return Err(Error::NoColumn { column, needed: NEEDED.join(",") });
            }
        }
        Ok(Self { names: names.clone() })
    }

    /// The text in a column; empty when there is no such column.
    fn text<'r>(&self, record: &'r StringRecord, column: &str) -> &'r str {
        let at = self.names.iter().position(|name| name == column);
        at.and_then(|at| record.get(at)).unwrap_or_default()
    }

    /// The text in a column that must not be empty.
    fn needed<'r>(&self, record: &'r StringRecord, column: &'static str) -> Result<&'r str> {
        let text = self.text(record, column);
        if text.is_empty() { Err(Error::EmptyColumn { column }) } else { Ok(text) }
    }

    /// The number in a column, if there is one.
    fn number(&self, record: &StringRecord, column: &'static str, range: &Range) -> Result<Option<f64>> {
        let text = self.text(record, column);
        if text.is_empty() {
            return Ok(None);
        }
        let number = text.parse().ok().filter(|number| (range.allows)(*number));
        number.map_or_else(
            || Err(Error::ColumnNumber { column, text: text.to_owned(), expected: range.expected }),
            |number| Ok(Some(number)),
        )
    }
}

/// Which numbers a column may hold.
struct Range {
    allows: fn(f64) -> bool,
    expected: &'static str,
}

const ANY: Range = Range { allows: f64::is_finite, expected: "a number" };
const ABOVE_0: Range = Range { allows: |x| x.is_finite() && x > 0.0, expected: "a number above 0" };
const FROM_0: Range = Range { allows: |x| x.is_finite() && x >= 0.0, expected: "a number, 0 or more" };
const RATIO: Range = Range { allows: |x| (-1.0..=1.0).contains(&x), expected: "a number from -1 to 1" };

/// What has been read so far.
#[derive(Default)]
struct Rows {
    scenes: Vec<Scene>,
    numbers: HashMap<String, usize>,
    images: HashSet<PathBuf>,
    blurred: Vec<Blurred>,
    /// Where in the table each of the blurred is.
    bytes: Vec<u64>,
}

impl Rows {
    fn add(&mut self, columns: &Columns, record: &StringRecord, folder: &Path, byte: u64) -> Result<()> {
        let (fields, expected) = (record.len(), columns.names.len());
        if fields != expected {
            return Err(Error::FieldCount { fields, expected });
        }
        let path = self.picture(columns.needed(record, "image")?, folder)?;
        let kind = columns.needed(record, "kind")?;
        let scene = self.scene(columns.needed(record, "scene")?);
        match kind {
            "still" => self.scenes[scene].stills.push(path),
            "blurred" => {
                let number = |column, range: &Range| columns.number(record, column, range);
                self.blurred.push(Blurred {
                    path,
                    scene,
                    accel_m_s2: number("accel_m_s2", &ANY)?.ok_or(Error::EmptyColumn { column: "accel_m_s2" })?,
                    length_px: number("length_px", &FROM_0)?,
                    accel_ratio: number("accel_ratio", &RATIO)?,
                    exposure_s: number("exposure_s", &ABOVE_0)?,
                    scale_m_per_px: number("scale_m_per_px", &ABOVE_0)?,
                    release_m: number("release_m", &FROM_0)?,
                    v0_m_s: number("v0_m_s", &FROM_0)?,
                });
                self.bytes.push(byte);
            }
            other => return Err(Error::PictureKind { kind: other.to_owned() }),
        }
        Ok(())
    }

    /// The path of an image that exists and has not occurred yet.
    fn picture(&mut self, image: &str, folder: &Path) -> Result<PathBuf> {
        // ./a.png is a.png.
        let name: PathBuf = Path::new(image).components().filter(|part| *part != Component::CurDir).collect();
        let path = folder.join(&name);
        if !self.images.insert(name) {
            return Err(Error::RepeatedPicture { image: image.to_owned() });
        }
        if !path.is_file() {
            return Err(Error::NoPicture { image: image.to_owned() });
        }
        Ok(path)
    }

    fn scene(&mut self, name: &str) -> usize {
        if let Some(&number) = self.numbers.get(name) {
            return number;
        }
        self.scenes.push(Scene { name: name.to_owned(), stills: Vec::new() });
        self.numbers.insert(name.to_owned(), self.scenes.len() - 1);
        self.scenes.len() - 1
    }

    /// The collection, or what is wrong with it as a whole and where.
    fn finish(self) -> std::result::Result<Collection, (Error, u64)> {
        for (blurred, &byte) in self.blurred.iter().zip(&self.bytes) {
            let Scene { name, stills } = &self.scenes[blurred.scene];
            if stills.is_empty() {
                return Err((Error::NoStills { scene: name.clone() }, byte));
            }
        }
        Ok(Collection { scenes: self.scenes, blurred: self.blurred })
    }
}
