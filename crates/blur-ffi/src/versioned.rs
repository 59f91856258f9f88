//! Structures that may grow: a program and the library need not know the same version of them.
//!
//! Fields are only ever added at the end, and zero bytes stand for their defaults. A structure says by its first field how
//! many bytes its program knows, as in `clone3` and `openat2` of Linux: what the library knows beyond counts as zero, and
//! what the program knows beyond must be zero.

use std::mem::{MaybeUninit, size_of};

use crate::{Error, Result};

/// Larger sizes are taken for a field that was never set.
const MOST_BYTES: usize = 4096;

/// A structure whose first field, `struct_size: usize`, tells its size in bytes.
///
/// # Safety
/// The type is `repr(C)`, begins with that field, and any bytes make a valid value of it: integers, floats and raw pointers.
pub(crate) unsafe trait Versioned: Copy {
    /// Name in C.
    const NAME: &'static str;
    /// Bytes of its first version.
    const LEAST_BYTES: usize;
}

/// The bytes that the program knows of a structure.
///
/// # Safety
/// `at` is null or points to a `usize`.
unsafe fn known_bytes<T: Versioned>(at: *const T) -> Result<usize> {
    if at.is_null() {
        return Err(Error::NullPointer { name: T::NAME });
    }
    // SAFETY: the pointer is not null, so it points to a `usize`; C promises nothing of its alignment.
    let bytes = unsafe { at.cast::<usize>().read_unaligned() };
    if (T::LEAST_BYTES..=MOST_BYTES).contains(&bytes) {
        Ok(bytes)
    } else {
        Err(Error::StructSize { structure: T::NAME, bytes, least: T::LEAST_BYTES, most: MOST_BYTES })
    }
}

/// Copies a structure that a program filled.
///
/// # Safety
/// `from` is null or points to as many readable bytes as its first field says, or to that field if this is out of range.
pub(crate) unsafe fn read<T: Versioned>(from: *const T) -> Result<T> {
    // SAFETY: as promised by the caller.
    let bytes = unsafe { known_bytes(from) }?;
    let known = size_of::<T>();
    if let Some(beyond) = bytes.checked_sub(known) {
        // SAFETY: the bytes of the structure reach this far.
        let start = unsafe { from.cast::<u8>().add(known) };
        // SAFETY: these are the remaining bytes of the structure, and nothing changes them meanwhile.
        let tail = unsafe { std::slice::from_raw_parts(start, beyond) };
        if let Some(offset) = tail.iter().position(|&byte| byte != 0) {
            return Err(Error::NewerField { structure: T::NAME, offset: known + offset, known });
        }
    }
    let mut value = MaybeUninit::<T>::zeroed();
    // SAFETY: both sides hold that many bytes, and one of them is ours alone.
    unsafe { std::ptr::copy_nonoverlapping(from.cast::<u8>(), value.as_mut_ptr().cast::<u8>(), bytes.min(known)) };
    // SAFETY: any bytes make a valid value of this type, and those that were not copied are zero.
    Ok(unsafe { value.assume_init() })
}

/// Room for a structure in a program's memory.
pub(crate) struct Room<T> {
    to: *mut T,
    bytes: usize,
}

impl<T: Versioned> Room<T> {
    /// The room at `to`, as large as its first field says.
    ///
    /// # Safety
    /// `to` is null or points to as many writable bytes, or to that field if this is out of range; they stay so until
    /// [`fill`](Self::fill).
    pub(crate) unsafe fn at(to: *mut T) -> Result<Self> {
        // SAFETY: as promised by the caller.
        let bytes = unsafe { known_bytes(to) }?;
        Ok(Self { to, bytes })
    }

    /// Writes what both sides know; the first field then says how much that is.
    pub(crate) fn fill(self, value: &T) {
        let shared = self.bytes.min(size_of::<T>());
        let from = std::ptr::from_ref(value).cast::<u8>();
        // SAFETY: both sides hold that many bytes, and a value of ours is not part of a program's memory.
        unsafe { std::ptr::copy_nonoverlapping(from, self.to.cast::<u8>(), shared) };
        // SAFETY: the room begins with this field.
        unsafe { self.to.cast::<usize>().write_unaligned(shared) };
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;

    /// A structure in its second version: `late` was added.
    #[repr(C)]
    #[derive(Debug, Clone, Copy, PartialEq)]
    struct Grown {
        struct_size: usize,
        early: f64,
        late: f64,
    }

    // SAFETY: `repr(C)`, the size first, and numbers only.
    unsafe impl Versioned for Grown {
        const NAME: &'static str = "mb_grown";
        const LEAST_BYTES: usize = offset_of!(Grown, late);
    }

    #[repr(C)]
    struct Newer {
        known: Grown,
        newest: u64,
    }

    const BYTES: usize = size_of::<Grown>();

    fn read_one(value: &Grown) -> Result<Grown> {
        // SAFETY: every size that the tests give is at most that of the value, or refused.
        unsafe { read(value) }
    }

    #[test]
    fn what_an_older_program_does_not_know_counts_as_zero() {
        let old = Grown { struct_size: Grown::LEAST_BYTES, early: 1.5, late: 9.0 };
        assert_eq!(read_one(&old), Ok(Grown { late: 0.0, ..old }));
    }

    #[test]
    fn a_newer_program_may_leave_its_new_fields_zero_and_no_more() {
        let known = Grown { struct_size: size_of::<Newer>(), early: 1.5, late: 2.5 };
        let mut newer = Newer { known, newest: 0 };
        // SAFETY: the size given is that of the whole value.
        assert_eq!(unsafe { read((&raw const newer).cast::<Grown>()) }, Ok(known));
        newer.newest = u64::from_ne_bytes([0, 0, 0, 7, 0, 0, 0, 0]);
        // SAFETY: as before.
        let refused = unsafe { read((&raw const newer).cast::<Grown>()) };
        assert_eq!(refused, Err(Error::NewerField { structure: "mb_grown", offset: BYTES + 3, known: BYTES }));
    }

    #[test]
    fn sizes_that_cannot_be_are_refused() {
        for bytes in [0, 1, Grown::LEAST_BYTES - 1, MOST_BYTES + 1, usize::MAX] {
            let error = read_one(&Grown { struct_size: bytes, early: 0.0, late: 0.0 }).unwrap_err();
            assert_eq!(
                error,
                Error::StructSize { structure: "mb_grown", bytes, least: Grown::LEAST_BYTES, most: MOST_BYTES }
            );
        }
        // SAFETY: null is allowed.
        assert_eq!(unsafe { read::<Grown>(std::ptr::null()) }, Err(Error::NullPointer { name: "mb_grown" }));
    }

    #[test]
    fn only_what_a_program_knows_is_written() {
        let value = Grown { struct_size: 0, early: 1.0, late: 2.0 };
        let mut old = Grown { struct_size: Grown::LEAST_BYTES, early: 0.0, late: 7.0 };
        // SAFETY: the room is at most that of the value.
        unsafe { Room::at(&raw mut old) }.ok().unwrap().fill(&value);
        assert_eq!(old, Grown { struct_size: Grown::LEAST_BYTES, early: 1.0, late: 7.0 });
        let mut newer = Newer { known: Grown { struct_size: size_of::<Newer>(), ..old }, newest: 5 };
        // SAFETY: the room is that of the whole value.
        unsafe { Room::at((&raw mut newer).cast::<Grown>()) }.ok().unwrap().fill(&value);
        assert_eq!((newer.known, newer.newest), (Grown { struct_size: BYTES, ..value }, 5));
    }

    #[test]
    fn structures_may_lie_anywhere() {
        let value = Grown { struct_size: BYTES, early: 1.5, late: -2.5 };
        let mut memory = [value; 2];
        // SAFETY: one byte and the structure fit into the memory.
        let odd = unsafe { memory.as_mut_ptr().byte_add(1) };
        // SAFETY: as before.
        unsafe { odd.write_unaligned(value) };
        // SAFETY: as before.
        assert_eq!(unsafe { read(odd) }, Ok(value));
    }
}
