//! Reads an AVR ELF file: the image of the flash and the symbols.

use crate::SimError;
use std::{collections::BTreeMap, path::Path};

/// Flash of the ATmega328P, bytes.
const FLASH: usize = 0x8000;
const MACHINE_AVR: u16 = 83;
const LOADED: u32 = 1;
const SYMBOLS: u32 = 2;
/// Where the linker puts RAM, EEPROM and fuses beside the flash.
const DATA_SPACE: u32 = 0x80_0000;

/// A program as it is in the flash.
#[derive(Debug)]
pub(crate) struct Image {
    pub(crate) flash: Vec<u8>,
    /// End of the program, bytes.
    pub(crate) code_end: u32,
    /// Addresses of symbols; those in RAM without the linker's offset.
    pub(crate) symbols: BTreeMap<String, u32>,
}

/// Integers of a little-endian file; `None` past its end.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn u16(&self, at: usize) -> Option<u16> {
        Some(u16::from_le_bytes(self.0.get(at..at + 2)?.try_into().ok()?))
    }

    fn u32(&self, at: usize) -> Option<u32> {
        Some(u32::from_le_bytes(self.0.get(at..at + 4)?.try_into().ok()?))
    }

    fn index(&self, at: usize) -> Option<usize> {
        self.u32(at).map(|value| value as usize)
    }

    fn text(&self, at: usize) -> Option<String> {
        let text = self.0.get(at..)?.split(|byte| *byte == 0).next()?;
        Some(String::from_utf8_lossy(text).into_owned())
    }
}

impl Image {
    pub(crate) fn read(path: &Path) -> Result<Self, SimError> {
        let file = std::fs::read(path).map_err(|source| SimError::Read { path: path.into(), source })?;
        Self::parse(&file).map_err(|reason| SimError::Elf { path: path.into(), reason: reason.into() })
    }

    fn parse(file: &[u8]) -> Result<Self, &'static str> {
        const SHORT: &str = "the file ends too early";
        let bytes = Bytes(file);
        if !file.starts_with(b"\x7fELF\x01\x01") {
            return Err("not a 32-bit little-endian ELF file");
        }
        if bytes.u16(18).ok_or(SHORT)? != MACHINE_AVR {
            return Err("made for another machine");
        }
        if bytes.u32(24).ok_or(SHORT)? != 0 {
            return Err("it does not start at address 0");
        }
        let mut image = Self { flash: vec![0xff; FLASH], code_end: 0, symbols: BTreeMap::new() };
        image.load(&bytes).ok_or(SHORT)??;
        image.read_symbols(&bytes).ok_or(SHORT)?;
        Ok(image)
    }

    /// Copies the segments to where they are stored: `.data` behind the code, from where the program fetches it.
    fn load(&mut self, bytes: &Bytes<'_>) -> Option<Result<(), &'static str>> {
        let (table, size, count) = (bytes.index(28)?, bytes.u16(42)?, bytes.u16(44)?);
        for segment in 0..usize::from(count) {
            let header = table + segment * usize::from(size);
            let (from, stored, length) = (bytes.index(header + 4)?, bytes.u32(header + 12)?, bytes.index(header + 16)?);
            if bytes.u32(header)? != LOADED || length == 0 || stored >= DATA_SPACE {
                continue;
            }
            let content = bytes.0.get(from..from + length)?;
            let end = stored as usize + length;
            let Some(place) = self.flash.get_mut(stored as usize..end) else {
                return Some(Err("it does not fit into 32 KiB of flash"));
            };
            place.copy_from_slice(content);
            self.code_end = self.code_end.max(end as u32);
        }
        Some(if self.code_end == 0 { Err("it has no code") } else { Ok(()) })
    }

    fn read_symbols(&mut self, bytes: &Bytes<'_>) -> Option<()> {
        let (table, size, count) = (bytes.index(32)?, bytes.u16(46)?, bytes.u16(48)?);
        let section = |number: usize| table + number * usize::from(size);
        for number in 0..usize::from(count) {
            let header = section(number);
            if bytes.u32(header + 4)? != SYMBOLS {
                continue;
            }
            let (from, length, names) =
                (bytes.index(header + 16)?, bytes.index(header + 20)?, bytes.index(header + 24)?);
            let names = bytes.index(section(names) + 16)?;
            for symbol in (from..from + length).step_by(16) {
                let name = bytes.text(names + bytes.index(symbol)?)?;
                let address = bytes.u32(symbol + 4)?;
                let in_ram = (DATA_SPACE..DATA_SPACE + 0x1_0000).contains(&address);
                self.symbols.insert(name, if in_ram { address - DATA_SPACE } else { address });
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_an_avr_program_is_refused() {
        assert!(Image::parse(b"#!/bin/sh").is_err());
        assert!(Image::parse(b"\x7fELF\x01\x01").is_err());
        let host = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert!(Image::parse(&host).is_err());
    }
}
