//! How deep the stack of an AVR program can get, from its disassembly.

use std::collections::BTreeMap;

use crate::run::Result;

/// Bytes that a call pushes on a chip with no more than 128 KiB of flash.
const RETURN_ADDRESS: u32 = 2;

/// What a function does to the stack.
#[derive(Debug, Default, Clone)]
struct Function {
    /// Bytes pushed and reserved.
    frame: u32,
    calls: Vec<String>,
    /// Jumps to other functions, which return in its place.
    jumps: Vec<String>,
    indirect: bool,
}

/// The functions of a program.
#[derive(Debug)]
pub(crate) struct Program {
    functions: BTreeMap<String, Function>,
}

/// The deepest stack of a program in bytes.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Depth {
    /// Of the main program.
    pub(crate) main: u32,
    /// Of the deepest interrupt on top of it; none of them lets another one in.
    pub(crate) interrupt: u32,
    /// The name of that interrupt.
    pub(crate) deepest: String,
}

impl Program {
    /// Reads what `avr-objdump -d` prints.
    pub(crate) fn parse(disassembly: &str) -> Self {
        let mut functions: BTreeMap<String, Function> = BTreeMap::new();
        let mut name = String::new();
        // A frame is reserved by lowering Y, the pair r28 and r29, between loading it from the stack pointer (0x3d) and
        // storing it there. Elsewhere Y only moves along the frame.
        let mut reserving = false;
        let mut low = None;
        for line in disassembly.lines() {
            if let Some((_, label)) = line.strip_suffix(">:").and_then(|line| line.split_once(" <")) {
                label.clone_into(&mut name);
                functions.entry(name.clone()).or_default();
                continue;
            }
            // Address, bytes, then mnemonic and operands, each after a tab.
            let Some(text) = line.splitn(3, '\t').nth(2) else { continue };
            let (mnemonic, operands) = text.split_once('\t').unwrap_or((text.trim_end(), ""));
            let function = functions.entry(name.clone()).or_default();
            let target = || {
                let (_, symbol) = operands.split_once('<')?;
                let symbol = symbol.split('>').next()?;
                // Into the middle of a function is a jump inside it.
                (!symbol.contains("+0x")).then(|| symbol.to_owned())
            };
            match mnemonic {
                "push" => function.frame += 1,
                // `rcall .+0` reserves two bytes: it pushes an address that is never returned to.
                "rcall" if operands.starts_with(".+0 ") => function.frame += RETURN_ADDRESS,
                "call" | "rcall" => function.calls.extend(target()),
                "jmp" | "rjmp" => function.jumps.extend(target().filter(|target| *target != name)),
                "icall" | "ijmp" | "eicall" => function.indirect = true,
                "in" if operands.starts_with("r28, 0x3d") => reserving = true,
                "out" if operands.starts_with("0x3d, r28") => reserving = false,
                "sbiw" if reserving => {
                    function.frame += operands.strip_prefix("r28, ").and_then(number).unwrap_or(0);
                }
                "subi" if reserving => low = operands.strip_prefix("r28, ").and_then(number),
                "sbci" if reserving => {
                    let high = operands.strip_prefix("r29, ").and_then(number);
                    if let (Some(low), Some(high)) = (low.take(), high) {
                        function.frame += high << 8 | low;
                    }
                }
                _ => {}
            }
        }
        Self { functions }
    }

    /// The deepest stack from reset.
    pub(crate) fn depth(&self) -> Result<Depth> {
        let main = self.below("main", &mut Vec::new())? + RETURN_ADDRESS;
        let vectors = self.functions.get("__vectors").ok_or("the program has no vectors")?;
        let (mut interrupt, mut deepest) = (0, String::new());
        for handler in vectors.jumps.iter().filter(|handler| handler.starts_with("__vector_")) {
            let depth = self.below(handler, &mut Vec::new())? + RETURN_ADDRESS;
            if depth > interrupt {
                interrupt = depth;
                deepest.clone_from(handler);
            }
        }
        Ok(Depth { main, interrupt, deepest })
    }

    /// Bytes that `name` and what it calls take, without its own return address.
    fn below(&self, name: &str, path: &mut Vec<String>) -> Result<u32> {
        if path.iter().any(|above| above == name) {
            return Err(format!("'{name}' calls itself: {}; the stack has no bound", path.join(" > ")));
        }
        let function = self.functions.get(name).ok_or_else(|| format!("'{name}' is called and not there"))?;
        if function.indirect {
            return Err(format!("'{name}' calls through a pointer, so the stack has no bound that can be read"));
        }
        path.push(name.to_owned());
        let mut deepest = 0;
        for callee in &function.calls {
            deepest = deepest.max(self.below(callee, path)? + RETURN_ADDRESS);
        }
        for callee in &function.jumps {
            deepest = deepest.max(self.below(callee, path)?);
        }
        path.pop();
        Ok(function.frame + deepest)
    }
}

/// A number as the disassembler writes it: `0x3d`, with its decimal value in a comment behind it.
fn number(text: &str) -> Option<u32> {
    let digits = text.split(['\t', ' ', ';']).next()?;
    match digits.strip_prefix("0x") {
        Some(hex) => u32::from_str_radix(hex, 16).ok(),
        None => digits.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VECTORS: &str = "\
00000000 <__vectors>:
       0:\t0c 94 34 00 \tjmp\t0x68\t; 0x68 <__ctors_end>
       4:\t0c 94 51 00 \tjmp\t0xa2\t; 0xa2 <__vector_1>

000000a2 <__vector_1>:
      a2:\t0f 92       \tpush\tr0
      a4:\t0c 94 45 11 \tjmp\t0xb0\t; 0xb0 <handler>

000000b0 <handler>:
      b0:\t1f 92       \tpush\tr1
      b2:\t0e 94 f9 11 \tcall\t0xd0\t; 0xd0 <leaf>
      b6:\t18 95       \treti
";

    fn program(main: &str, leaf: &str) -> Program {
        Program::parse(&format!("{VECTORS}\n000000c0 <main>:\n{main}\n000000d0 <leaf>:\n{leaf}"))
    }

    #[test]
    fn pushes_frames_and_return_addresses_add_up() {
        let main = "\
      c0:\tcf 93       \tpush\tr28
      c2:\tdf 93       \tpush\tr29
      c4:\tcd b7       \tin\tr28, 0x3d\t; 61
      c6:\tde b7       \tin\tr29, 0x3e\t; 62
      c8:\tc8 52       \tsubi\tr28, 0x28\t; 40
      ca:\td1 40       \tsbci\tr29, 0x01\t; 1
      cb:\tcd bf       \tout\t0x3d, r28\t; 61
      cb:\tc4 5a       \tsubi\tr28, 0xA4\t; 164
      cb:\tdf 4f       \tsbci\tr29, 0xFF\t; 255
      cc:\t0e 94 f9 11 \tcall\t0xd0\t; 0xd0 <leaf>
      ce:\tfe cf       \trjmp\t.-4      \t; 0xcc <main+0xc>
";
        let leaf = "\
      d0:\tcf 93       \tpush\tr28
      d1:\tcd b7       \tin\tr28, 0x3d\t; 61
      d2:\t2a 97       \tsbiw\tr28, 0x0a\t; 10
      d3:\tcd bf       \tout\t0x3d, r28\t; 61
      d4:\t08 95       \tret
";
        let depth = program(main, leaf).depth();
        // main: its return address, two registers, 0x128 bytes, the call, and the leaf's 11 bytes.
        let main = 2 + 2 + 0x128 + 2 + 11;
        // The interrupt: return address, two registers, the call, the leaf.
        assert_eq!(depth, Ok(Depth { main, interrupt: 2 + 2 + 2 + 11, deepest: "__vector_1".to_owned() }));
    }

    #[test]
    fn a_stack_without_a_bound_is_an_error() {
        let itself = "      d0:\t0e 94 f9 11 \tcall\t0xd0\t; 0xd0 <leaf>\n";
        assert!(program("", itself).depth().is_err_and(|error| error.contains("calls itself")));
        let pointer = "      d0:\t09 95       \ticall\n";
        assert!(program("", pointer).depth().is_err_and(|error| error.contains("pointer")));
    }
}
