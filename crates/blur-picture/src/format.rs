//! File formats, recognised by their content and not by the name of the file.

use image::ImageFormat;

use crate::{Error, Result};

/// Bytes at the start of a file that tell its format.
pub(super) const SIGNATURE_BYTES: usize = 16;

/// A format that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Portable Network Graphics.
    Png,
    /// JPEG, with or without EXIF.
    Jpeg,
    /// TIFF, with integer or float samples.
    Tiff,
}

impl Format {
    /// The format of a file that starts with `bytes`.
    pub fn of(bytes: &[u8]) -> Result<Self> {
        match image::guess_format(bytes) {
            Ok(ImageFormat::Png) => Ok(Self::Png),
            Ok(ImageFormat::Jpeg) => Ok(Self::Jpeg),
            Ok(ImageFormat::Tiff) => Ok(Self::Tiff),
            Ok(ImageFormat::Gif) => Err(Error::OtherFormat { format: "GIF" }),
            Ok(ImageFormat::WebP) => Err(Error::OtherFormat { format: "WebP" }),
            Ok(ImageFormat::OpenExr) => Err(Error::OtherFormat { format: "OpenEXR" }),
            _ if bytes.get(4..8) == Some(b"ftyp") => Err(Error::OtherFormat { format: "HEIF, AVIF or video" }),
            _ if bytes.is_empty() => Err(Error::EmptyFile),
            // Other signatures are two letters long, as likely to begin a text as a picture.
            _ => {
                let start = &bytes[..bytes.len().min(SIGNATURE_BYTES)];
                Err(Error::NotAPicture { start: start.escape_ascii().to_string() })
            }
        }
    }
}

/// Whether JPEG data reach their end-of-image marker. Decoders fill the missing part of a truncated file with grey,
/// and a half-grey picture would be measured as if it were one.
pub(super) fn jpeg_is_complete(bytes: &[u8]) -> bool {
    const MARKER: u8 = 0xFF;
    const START_OF_SCAN: u8 = 0xDA;
    const END_OF_IMAGE: [u8; 2] = [MARKER, 0xD9];
    // Step over the segments first: an EXIF segment holds a whole thumbnail with an end marker of its own.
    let mut at = 2;
    while let Some(&[a, kind, high, low]) = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>()) {
        if a != MARKER {
            at += 1;
        } else if kind == START_OF_SCAN {
            return bytes[at..].windows(2).any(|pair| pair == END_OF_IMAGE);
        } else if kind == MARKER {
            at += 1;
        } else {
            at += 2 + usize::from(u16::from_be_bytes([high, low]));
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_known_by_their_first_bytes() {
        assert_eq!(Format::of(b"\x89PNG\r\n\x1a\n....").unwrap(), Format::Png);
        assert_eq!(Format::of(b"\xff\xd8\xff\xe0").unwrap(), Format::Jpeg);
        assert_eq!(Format::of(b"II*\0").unwrap(), Format::Tiff);
        assert_eq!(Format::of(b"MM\0*").unwrap(), Format::Tiff);
    }

    #[test]
    fn what_is_no_picture_is_quoted() {
        let message = Format::of(b"Dear all,\nhello").unwrap_err().to_string();
        assert!(message.contains(r"Dear all,\nhello"), "{message}");
        assert!(matches!(Format::of(b""), Err(Error::EmptyFile)));
        assert!(matches!(Format::of(b"GIF89a"), Err(Error::OtherFormat { format: "GIF" })));
        assert!(matches!(Format::of(b"\0\0\0\x18ftypheic"), Err(Error::OtherFormat { .. })));
    }

    #[test]
    fn the_end_of_a_thumbnail_is_not_the_end_of_the_picture() {
        let app1 = [0xFF, 0xE1, 0, 6, 0xFF, 0xD8, 0xFF, 0xD9];
        let scan = [0xFF, 0xDA, 0, 2, 1, 2, 0xFF, 0x00, 3];
        let truncated = [&[0xFF, 0xD8][..], &app1, &scan].concat();
        assert!(!jpeg_is_complete(&truncated));
        assert!(jpeg_is_complete(&[&truncated[..], &[0xFF, 0xD9]].concat()));
        assert!(!jpeg_is_complete(&[0xFF, 0xD8, 0xFF]));
    }
}
