//! Multiplication of small integers without the chip's multiplier.
//!
//! LLVM's code for AVR keeps a product in register r0, and uses r0 as a scratch register when it stores to a far place of
//! the stack: between `mul` and the use of its result it may do so, and the product is lost (seen with LLVM 22 in an index
//! into a table). So the multiplier is switched off in `.cargo/config.toml`, and these are what the compiler calls
//! instead; `cargo xtask firmware` checks that nothing else multiplies. The 32-bit product comes from libgcc, whose
//! assembly is right.

/// The low 8 bits of a product.
#[unsafe(no_mangle)]
pub extern "C" fn __mulqi3(mut a: u8, mut b: u8) -> u8 {
    let mut product = 0u8;
    while b != 0 {
        if b & 1 != 0 {
            product = product.wrapping_add(a);
        }
        a <<= 1;
        b >>= 1;
    }
    product
}

/// The low 16 bits of a product.
#[unsafe(no_mangle)]
pub extern "C" fn __mulhi3(mut a: u16, mut b: u16) -> u16 {
    let mut product = 0u16;
    while b != 0 {
        if b & 1 != 0 {
            product = product.wrapping_add(a);
        }
        a <<= 1;
        b >>= 1;
    }
    product
}
