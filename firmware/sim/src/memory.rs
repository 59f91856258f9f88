//! The stack's high-water mark.

/// First byte of SRAM.
const SRAM: usize = 0x100;
/// What free SRAM is painted with: neither 0 nor 0xff, nor a common instruction's return address.
const PAINT: u8 = 0xc5;

/// Paints all SRAM; what the program initialises it will overwrite.
pub(crate) fn paint(memory: &mut [u8]) {
    memory[SRAM..].fill(PAINT);
}

/// Bytes from the deepest overwritten one to the end of SRAM. `free_from` is the address behind the program's variables;
/// without it the longest stretch of paint is taken for the free memory.
pub(crate) fn stack_high_water(memory: &[u8], free_from: Option<usize>) -> usize {
    let sram = &memory[SRAM..];
    if let Some(start) = free_from {
        let free = memory.get(start..).unwrap_or_default();
        return free.len() - free.iter().take_while(|byte| **byte == PAINT).count();
    }
    let (mut longest, mut end) = (0, sram.len());
    let mut at = 0;
    for stretch in sram.chunk_by(|a, b| (*a == PAINT) == (*b == PAINT)) {
        at += stretch.len();
        if stretch[0] == PAINT && stretch.len() > longest {
            (longest, end) = (stretch.len(), at);
        }
    }
    sram.len() - end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_is_the_deepest_byte_ever_written() {
        let mut memory = vec![0; 0x900];
        paint(&mut memory);
        memory[0x100..0x120].fill(0);
        memory[0x8f0..0x900].fill(1);
        assert_eq!(stack_high_water(&memory, Some(0x120)), 16);
        assert_eq!(stack_high_water(&memory, None), 16);
        memory[0x8e0] = 7;
        assert_eq!(stack_high_water(&memory, Some(0x120)), 32);
    }

    #[test]
    fn an_untouched_stack_is_empty() {
        let mut memory = vec![0; 0x900];
        paint(&mut memory);
        assert_eq!(stack_high_water(&memory, None), 0);
        assert_eq!(stack_high_water(&memory, Some(0x100)), 0);
    }
}
