//! The HD44780U's registers and memory.

use super::Rule;

/// Characters of a row that are seen.
pub const COLUMNS: usize = 16;
/// Characters of a row in memory.
const ROW: u8 = 40;
/// Where the second row begins.
const SECOND: u8 = 0x40;

/// How long an instruction keeps the controller busy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Busy {
    pub(super) needs_ns: f64,
    pub(super) rule: Rule,
}

const fn execution(needs_ns: f64) -> Busy {
    Busy { needs_ns, rule: Rule::Execution }
}

/// What the controller knows.
// They are the flags of the data sheet.
#[allow(clippy::struct_excessive_bools)]
#[derive(Debug, Clone)]
pub struct Controller {
    /// The upper half of a byte on a four-bit bus.
    upper: Option<u8>,
    four_bits: bool,
    two_rows: bool,
    /// Function sets on the eight-bit bus so far.
    function_sets: u8,
    rows: [[u8; ROW as usize]; 2],
    address: u8,
    to_characters: bool,
    forward: bool,
    shifts: bool,
    shift: i16,
    on: bool,
    cursor: bool,
    blinks: bool,
}

impl Default for Controller {
    fn default() -> Self {
        Self {
            upper: None,
            four_bits: false,
            two_rows: false,
            function_sets: 0,
            rows: [[b' '; ROW as usize]; 2],
            address: 0,
            to_characters: false,
            forward: true,
            shifts: false,
            shift: 0,
            on: false,
            cursor: false,
            blinks: false,
        }
    }
}

impl Controller {
    /// Whether the bus was set to four bits.
    pub fn is_four_bits(&self) -> bool {
        self.four_bits
    }

    /// Whether the display is on.
    pub fn is_on(&self) -> bool {
        self.on
    }

    /// Whether the cursor is shown, as a line or blinking.
    pub fn shows_cursor(&self) -> bool {
        self.cursor || self.blinks
    }

    /// Row and column of the address that the next character goes to, both from 0.
    pub fn position(&self) -> (usize, usize) {
        (usize::from(self.address >= SECOND), usize::from(self.address % SECOND))
    }

    /// Codes of the characters that a row (0 or 1) shows.
    pub fn codes(&self, row: usize) -> [u8; COLUMNS] {
        let Some(memory) = self.rows.get(row).filter(|_| self.on && (row == 0 || self.two_rows)) else {
            return [b' '; COLUMNS];
        };
        let mut codes = [0; COLUMNS];
        for (column, code) in (0..).zip(&mut codes) {
            *code = memory[(column + self.shift).rem_euclid(ROW.into()) as usize];
        }
        codes
    }

    /// The row as text in the characters of ROM A00; those defined by the program and those without a sign here are `�`.
    pub fn text(&self, row: usize) -> String {
        let sign = |code| match code {
            0x5c => '¥',
            0x20..=0x7d => char::from(code),
            0x7e => '→',
            0x7f => '←',
            0xdf => '°',
            0xe4 => 'µ',
            0xe0 => 'α',
            0xe2 => 'β',
            0xf4 => 'Ω',
            0xf7 => 'π',
            0xff => '█',
            _ => char::REPLACEMENT_CHARACTER,
        };
        self.codes(row).into_iter().map(sign).collect()
    }

    /// Takes a pulse of E with four data bits; on the eight-bit bus the lower four lines, open, are read as 0.
    pub(super) fn nibble(&mut self, rs: bool, nibble: u8) -> Busy {
        if !self.four_bits {
            return self.instruction(rs, nibble << 4);
        }
        if let Some(upper) = self.upper.take() {
            return self.instruction(rs, upper << 4 | nibble);
        }
        self.upper = Some(nibble);
        execution(0.0)
    }

    fn instruction(&mut self, rs: bool, byte: u8) -> Busy {
        if rs {
            self.write(byte);
            return execution(41_000.0);
        }
        match byte {
            0 => {}
            1 => {
                self.rows = [[b' '; ROW as usize]; 2];
                self.forward = true;
                self.home();
                return execution(1_520_000.0);
            }
            2..=3 => {
                self.home();
                return execution(1_520_000.0);
            }
            4..=7 => (self.forward, self.shifts) = (byte & 2 != 0, byte & 1 != 0),
            8..=15 => (self.on, self.cursor, self.blinks) = (byte & 4 != 0, byte & 2 != 0, byte & 1 != 0),
            16..=31 if byte & 8 != 0 => self.scroll(byte & 4 == 0),
            16..=31 => self.advance(byte & 4 != 0),
            32..=63 => return self.function_set(byte),
            64..=127 => self.to_characters = true,
            _ => {
                self.to_characters = false;
                self.address = byte & 0x7f;
            }
        }
        execution(37_000.0)
    }

    fn function_set(&mut self, byte: u8) -> Busy {
        let was_eight_bits = !self.four_bits;
        self.four_bits = byte & 0x10 == 0;
        self.two_rows = byte & 8 != 0;
        self.upper = None;
        if was_eight_bits && self.four_bits {
            return execution(37_000.0);
        }
        if was_eight_bits {
            self.function_sets = self.function_sets.saturating_add(1);
            match self.function_sets {
                1 => return Busy { needs_ns: 4_100_000.0, rule: Rule::Initialisation },
                2 => return Busy { needs_ns: 100_000.0, rule: Rule::Initialisation },
                _ => {}
            }
        }
        execution(37_000.0)
    }

    fn home(&mut self) {
        self.address = 0;
        self.shift = 0;
        self.to_characters = false;
    }

    fn write(&mut self, code: u8) {
        if self.to_characters {
            return;
        }
        let (row, column) = self.position();
        if let Some(place) = self.rows[row].get_mut(column) {
            *place = code;
        }
        self.advance(self.forward);
        if self.shifts {
            self.scroll(self.forward);
        }
    }

    fn scroll(&mut self, to_the_left: bool) {
        self.shift += if to_the_left { 1 } else { -1 };
    }

    /// Moves the address; the rows follow each other in a ring.
    fn advance(&mut self, forward: bool) {
        let last = ROW - 1;
        self.address = match (self.address, forward) {
            (address, true) if address == last => SECOND,
            (address, true) if address >= SECOND + last => 0,
            (address, true) => address + 1,
            (0, false) => SECOND + last,
            (SECOND, false) => last,
            (address, false) => address - 1,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ready() -> Controller {
        let mut lcd = Controller::default();
        for nibble in [3, 3, 3, 2] {
            lcd.nibble(false, nibble);
        }
        for command in [0x28, 0x0f, 0x06] {
            byte(&mut lcd, false, command);
        }
        lcd
    }

    fn byte(lcd: &mut Controller, rs: bool, byte: u8) {
        lcd.nibble(rs, byte >> 4);
        lcd.nibble(rs, byte & 0xf);
    }

    #[test]
    fn the_bus_begins_with_eight_bits_and_can_be_set_up_again_from_any_state() {
        let mut lcd = ready();
        assert!(lcd.is_four_bits() && lcd.shows_cursor());
        // A controller that starts again sends 3, 3, 3, 2 even when the display has four bits and half a byte.
        for half in [false, true] {
            if half {
                lcd.nibble(false, 0);
            }
            for nibble in [3, 3, 3, 2] {
                lcd.nibble(false, nibble);
            }
            byte(&mut lcd, false, 0x28);
            byte(&mut lcd, false, 0x80);
            byte(&mut lcd, true, b'!');
            assert_eq!(lcd.codes(0)[0], b'!', "half a byte: {half}");
            byte(&mut lcd, false, 0x01);
        }
    }

    #[test]
    fn the_address_runs_from_row_to_row_and_either_way() {
        let mut lcd = ready();
        byte(&mut lcd, false, 0x80 + 39);
        byte(&mut lcd, true, b'a');
        assert_eq!(lcd.position(), (1, 0));
        byte(&mut lcd, false, 0x04);
        byte(&mut lcd, true, b'b');
        assert_eq!(lcd.position(), (0, 39));
        assert_eq!(lcd.codes(1)[0], b'b');
        byte(&mut lcd, false, 0x10);
        assert_eq!(lcd.position(), (0, 38));
    }

    #[test]
    fn shifting_moves_the_view_and_home_brings_it_back() {
        let mut lcd = ready();
        byte(&mut lcd, true, b'a');
        byte(&mut lcd, true, b'b');
        byte(&mut lcd, false, 0x18);
        assert_eq!(lcd.codes(0)[0], b'b');
        byte(&mut lcd, false, 0x02);
        assert_eq!(lcd.text(0).trim_end(), "ab");
        byte(&mut lcd, false, 0x08);
        assert_eq!(lcd.text(0).trim_end(), "", "off");
    }
}
