//! Many pictures on several threads.

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use blur_core::image::Pixels;
use blur_core::meter::{Configuration, Meter};
use blur_core::record::Record;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error::refuse;
use crate::image::Image;
use crate::meter::as_read;
use crate::{data, options};

/// How often the interpreter is asked whether Ctrl-C was pressed.
const ASK_EVERY: Duration = Duration::from_millis(100);

type Found = (usize, blur_core::Result<Record>);

/// Measures many pictures on `threads` threads, by default one for each processor, and returns their Records in order.
///
/// A picture that cannot be measured gives a MotionBlurError in its place. Images and keyword arguments are those of
/// `estimate`. All images are kept in memory until the end.
#[pyfunction]
#[pyo3(signature = (images, *, threads = None, order = "rgb", **options))]
pub(crate) fn estimate_batch<'py>(
    py: Python<'py>,
    images: &Bound<'py, PyAny>,
    threads: Option<NonZeroUsize>,
    order: &str,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyList>> {
    let configuration = options::configuration(options, false)?;
    let images = images.try_iter()?.map(|image| Ok(Image::new(&image?, order)));
    let images = images.collect::<PyResult<Vec<PyResult<Image<'py>>>>>()?;
    let pixels: Vec<Option<blur_core::Result<Pixels<'_>>>> =
        images.iter().map(|image| image.as_ref().ok().map(Image::pixels)).collect();
    let threads = threads.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);

    let mut results: Vec<Option<blur_core::Result<Record>>> = pixels.iter().map(|_| None).collect();
    py.detach(|| measure_all(&pixels, &configuration, threads.min(pixels.len()), &mut results))?;

    let list = PyList::empty(py);
    for (image, result) in images.into_iter().zip(results) {
        let outcome = match (image, result) {
            (Ok(image), Some(found)) => found.map(|found| as_read(&found, image.linearized)).map_err(refuse),
            (Err(error), _) => Err(error),
            (Ok(_), None) => Err(refuse("the picture was not measured")),
        };
        match outcome {
            Ok(found) => list.append(data::record(py, &found)?)?,
            Err(error) => list.append(error.into_value(py))?,
        }
    }
    Ok(list)
}

/// Measures on threads, each with its own meter, while this one listens for Ctrl-C.
fn measure_all(
    pictures: &[Option<blur_core::Result<Pixels<'_>>>],
    configuration: &Configuration,
    threads: usize,
    results: &mut [Option<blur_core::Result<Record>>],
) -> PyResult<()> {
    let meters: Vec<Meter> =
        (0..threads).map(|_| Meter::new(configuration.clone())).collect::<blur_core::Result<_>>().map_err(refuse)?;
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for meter in meters {
            let (sender, next) = (sender.clone(), &next);
            scope.spawn(move || work(pictures, meter, next, &sender));
        }
        drop(sender);
        loop {
            match receiver.recv_timeout(ASK_EVERY) {
                Ok((index, result)) => results[index] = Some(result),
                Err(RecvTimeoutError::Timeout) =>
                {
                    #[expect(
                        clippy::redundant_closure_for_method_calls,
                        reason = "the method's name alone has one lifetime"
                    )]
                    if let Err(interrupt) = Python::attach(|py| py.check_signals()) {
                        next.store(pictures.len(), Ordering::Relaxed);
                        return Err(interrupt);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
        }
    })
}

/// Takes pictures until none is left.
fn work(
    pictures: &[Option<blur_core::Result<Pixels<'_>>>],
    mut meter: Meter,
    next: &AtomicUsize,
    sender: &Sender<Found>,
) {
    let mut take = || {
        let index = next.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |i| (i < pictures.len()).then_some(i + 1));
        let Ok(index) = index else { return ControlFlow::Break(()) };
        let result = match &pictures[index] {
            Some(Ok(pixels)) => meter.measure(pixels),
            Some(Err(error)) => Err(error.clone()),
            None => return ControlFlow::Continue(()),
        };
        if sender.send((index, result)).is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    while take().is_continue() {}
}
