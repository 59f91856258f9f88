//! The handle.

use std::ffi::c_char;
use std::sync::{Mutex, TryLockError};

use blur_core::estimate;
use blur_core::meter;

use crate::border::guarded;
use crate::picture::{self, Samples};
use crate::versioned::Room;
use crate::{Code, Configuration, Error, Picture, Record, Result, configuration};

/// Measures pictures one after the other. Plans and buffers are made with the first picture of a size. One thread at a time
/// may use a meter, not always the same one; different meters are independent of each other.
#[derive(Debug)]
pub struct Meter {
    // Never waited for: it tells use by two threads at a time, and that a panic left the state half changed.
    state: Mutex<State>,
}

struct State {
    meter: meter::Meter,
    /// Of the last picture that was measured.
    status: Option<estimate::Status>,
}

impl std::fmt::Debug for State {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("State").field("status", &self.status).finish_non_exhaustive()
    }
}

/// Makes a meter and writes it to *meter; free it with mb_meter_free. On failure *meter becomes null.
///
/// # Safety
/// `configuration` is null or points to a configuration as its documentation says; `meter` is null or points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mb_meter_new(configuration: *const Configuration, meter: *mut *mut Meter) -> Code {
    guarded(|| {
        if meter.is_null() {
            return Err(Error::NullPointer { name: "meter" });
        }
        // SAFETY: the pointer is not null, so it points to a pointer.
        unsafe { meter.write(std::ptr::null_mut()) };
        // SAFETY: as promised by the caller.
        let configuration = unsafe { configuration::read(configuration) }?;
        let state = State { meter: meter::Meter::new(configuration).map_err(Error::Configuration)?, status: None };
        let made = Box::into_raw(Box::new(Meter { state: Mutex::new(state) }));
        // SAFETY: as before.
        unsafe { meter.write(made) };
        Ok(())
    })
}

/// Frees a meter; null is allowed, and nothing is done.
///
/// # Safety
/// `meter` is null or came from `mb_meter_new`, was not freed before, and is in use by no thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mb_meter_free(meter: *mut Meter) {
    guarded(|| {
        if !meter.is_null() {
            // SAFETY: it was made from a box, and nobody uses it any more.
            drop(unsafe { Box::from_raw(meter) });
        }
        Ok(())
    });
}

/// Measures a picture and fills *record. On failure *record stays as it is. That a picture shows no blur, or that the result
/// is in doubt, is no failure but a status.
///
/// # Safety
/// `meter` is null or came from `mb_meter_new`; `picture` and `record` are null or point to what their documentation says; the
/// samples are readable and nobody writes to them during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mb_meter_measure(meter: *mut Meter, picture: *const Picture, record: *mut Record) -> Code {
    let work = |state: &mut State| {
        // SAFETY: as promised by the caller.
        let samples = unsafe { picture::samples(picture) }?;
        // SAFETY: as promised by the caller.
        let room = unsafe { Room::at(record) }?;
        let measured = match samples {
            Samples::Grey(view) => state.meter.measure_grey(view),
            Samples::Stored(pixels) => state.meter.measure(&pixels),
        };
        let measured = measured.map_err(Error::Picture)?;
        state.status = Some(measured.status);
        room.fill(&Record::from(&measured));
        Ok(())
    };
    // SAFETY: as promised by the caller.
    unsafe { with(meter, work) }
}

/// Forgets the frame before: the next picture does not follow it.
///
/// # Safety
/// `meter` is null or came from `mb_meter_new`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mb_meter_reset(meter: *mut Meter) -> Code {
    let work = |state: &mut State| {
        state.meter.reset();
        state.status = None;
        Ok(())
    };
    // SAFETY: as promised by the caller.
    unsafe { with(meter, work) }
}

/// Writes the name of the method to buffer, cut to capacity with the zero byte at its end, and returns its whole length
/// without that; 0 on failure.
///
/// # Safety
/// `meter` is null or came from `mb_meter_new`; `buffer` is null or points to `capacity` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mb_meter_method(meter: *const Meter, buffer: *mut c_char, capacity: usize) -> usize {
    // SAFETY: as promised by the caller.
    unsafe { write_text(meter, buffer, capacity, |state| state.meter.configuration().method.to_string()) }
}

/// Writes why the status of the last picture that was measured is not MB_STATUS_OK to buffer, as one line of text, cut to
/// capacity with the zero byte at its end, and returns its whole length without that. 0 and an empty text if the status was
/// MB_STATUS_OK, none was measured, or on failure. 256 bytes are enough for every reason.
///
/// # Safety
/// As `mb_meter_method`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn mb_meter_reason(meter: *const Meter, buffer: *mut c_char, capacity: usize) -> usize {
    let reason = |state: &State| {
        let doubt = state.status.and_then(estimate::Status::doubt);
        doubt.map(|doubt| doubt.to_string()).unwrap_or_default()
    };
    // SAFETY: as promised by the caller.
    unsafe { write_text(meter, buffer, capacity, reason) }
}

/// # Safety
/// As `mb_meter_method`.
unsafe fn write_text(
    meter: *const Meter,
    buffer: *mut c_char,
    capacity: usize,
    text: impl FnOnce(&State) -> String,
) -> usize {
    let has_room = !buffer.is_null() && capacity > 0;
    if has_room {
        // SAFETY: there is room for one byte at least.
        unsafe { buffer.write(0) };
    }
    let mut length = 0;
    let work = |state: &mut State| {
        let text = text(state);
        length = text.len();
        if has_room {
            let copied = length.min(capacity - 1);
            // SAFETY: both sides hold that many bytes, and the text is ours alone.
            unsafe { std::ptr::copy_nonoverlapping(text.as_ptr(), buffer.cast::<u8>(), copied) };
            // SAFETY: one byte more fits into the capacity.
            let end = unsafe { buffer.add(copied) };
            // SAFETY: as before.
            unsafe { end.write(0) };
        }
        Ok(())
    };
    // SAFETY: as promised by the caller.
    match unsafe { with(meter, work) } {
        Code::Ok => length,
        _ => 0,
    }
}

/// Does `work` with the state of a meter that nobody else is using.
///
/// # Safety
/// `meter` is null or came from `mb_meter_new` and was not freed.
unsafe fn with(meter: *const Meter, work: impl FnOnce(&mut State) -> Result<()>) -> Code {
    guarded(|| {
        // SAFETY: it is null or points to a meter that lives.
        let meter = unsafe { meter.as_ref() }.ok_or(Error::NullPointer { name: "meter" })?;
        let mut state = meter.state.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => Error::Busy,
            TryLockError::Poisoned(_) => Error::Poisoned,
        })?;
        work(&mut state)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meter() -> Meter {
        let state = State { meter: meter::Meter::new(meter::Configuration::default()).unwrap(), status: None };
        Meter { state: Mutex::new(state) }
    }

    #[test]
    fn a_panic_stays_inside_and_poisons_its_handle_only() {
        let (broken, whole) = (meter(), meter());
        // SAFETY: both meters live to the end of the test.
        let panicked = unsafe { with(&raw const broken, |_| panic!("provoked")) };
        assert_eq!(panicked, Code::Internal);
        for (meter, expected) in [(&broken, Code::Poisoned), (&whole, Code::Ok)] {
            // SAFETY: as before.
            assert_eq!(unsafe { mb_meter_reset(std::ptr::from_ref(meter).cast_mut()) }, expected);
        }
    }

    #[test]
    fn use_by_two_threads_at_a_time_is_refused() {
        let shared = meter();
        let held = shared.state.lock().unwrap();
        // SAFETY: the meter lives to the end of the test.
        let other = || unsafe { mb_meter_reset((&raw const shared).cast_mut()) };
        assert_eq!(std::thread::scope(|scope| scope.spawn(other).join().unwrap()), Code::Busy);
        drop(held);
        assert_eq!(other(), Code::Ok);
    }
}
