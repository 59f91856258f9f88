//! The border between C and Rust: errors become codes and messages, and no panic passes it.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::{Code, Error, Result};

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Why the last call that failed on this thread did, as one line of text; empty when none has failed. It stays valid until
/// the next call on this thread fails, and is never null.
#[unsafe(no_mangle)]
pub extern "C" fn mb_error_message() -> *const c_char {
    // At the end of a thread its message may be gone already.
    MESSAGE.try_with(|message| message.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

/// Does `work` and tells what became of it.
pub(crate) fn guarded(work: impl FnOnce() -> Result<()>) -> Code {
    // Nobody sees what a panic left half done: handles that were in use are poisoned.
    let outcome = catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|panic| Err(Error::Internal { message: text_of(panic.as_ref()) }));
    match outcome {
        Ok(()) => Code::Ok,
        Err(error) => {
            remember(&error);
            error.code()
        }
    }
}

fn text_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic without text").to_owned()
}

fn remember(error: &Error) {
    // A name that came from outside may hold anything but a zero byte in the end of the text.
    let text = CString::new(error.to_string().replace('\0', " ")).unwrap_or_default();
    // At the end of a thread there is nobody left to read it.
    let _ = MESSAGE.try_with(|message| message.replace(text));
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use super::*;

    fn message() -> String {
        // SAFETY: the pointer is to a string that ends in a zero byte, and no call fails before it is copied.
        unsafe { CStr::from_ptr(mb_error_message()) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn a_panic_becomes_a_code_and_its_message() {
        assert_eq!(guarded(|| panic!("row {} is missing", 7)), Code::Internal);
        assert_eq!(message(), "defect of the library: row 7 is missing");
        assert_eq!(guarded(|| std::panic::panic_any(5_u8)), Code::Internal);
        assert_eq!(message(), "defect of the library: a panic without text");
    }

    #[test]
    fn the_message_is_that_of_the_last_failure_of_this_thread() {
        assert_eq!(message(), "");
        assert_eq!(guarded(|| Err(Error::NullPointer { name: "meter" })), Code::NullPointer);
        assert_eq!(guarded(|| Ok(())), Code::Ok);
        assert_eq!(message(), "meter is null; it must point to something");
        assert_eq!(std::thread::spawn(message).join().unwrap(), "");
    }

    #[test]
    fn a_zero_byte_does_not_cut_the_message() {
        let error = Error::Internal { message: "a\0b".to_owned() };
        assert_eq!(guarded(|| Err(error.clone())), Code::Internal);
        assert_eq!(message(), "defect of the library: a b");
    }
}
