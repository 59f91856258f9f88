//! Many pictures on several threads, with the results in the order of the inputs.

use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use crate::input::Input;
use crate::measure::{Finding, Measurer, Options};
use crate::restore::{self, target};
use crate::{Error, Result, picture, report, sample};

/// Measures all `inputs` on `jobs` threads and calls `report` for each, in their order and as early as that order
/// allows. When `report` breaks, no further picture is started.
pub fn run(
    inputs: &[Input],
    options: &Options,
    jobs: NonZeroUsize,
    mut report: impl FnMut(&Input, std::result::Result<&Finding, &Error>) -> ControlFlow<()> + Send,
) -> Result<()> {
    // Threads without a picture of their own help with the tiles of others' maps.
    let threads = if options.map_tile_px.is_some() { jobs.get() } else { jobs.get().min(inputs.len().max(1)) };
    let targets = match &options.restore {
        Some(to) => target::prepare(inputs, &to.path)?,
        None => Vec::new(),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    pool.in_place_scope(|scope| {
        // One task on every thread, each with its own estimator, takes pictures until none is left.
        let (next, targets) = (&next, &targets);
        scope.spawn_broadcast(move |_, _| {
            let mut measurer = Measurer::new(options);
            while let Some((index, input)) = take(inputs, next) {
                if sender.send((index, measure(&mut measurer, input, targets.get(index)))).is_err() {
                    break;
                }
            }
        });
        if in_order(inputs, receiver, &mut report).is_break() {
            next.store(inputs.len(), Ordering::Relaxed);
        }
    });
    Ok(())
}

fn take<'a>(inputs: &'a [Input], next: &AtomicUsize) -> Option<(usize, &'a Input)> {
    let index =
        next.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |i| (i < inputs.len()).then_some(i + 1)).ok()?;
    inputs.get(index).map(|input| (index, input))
}

/// `None` for an input that has failed already.
fn measure(measurer: &mut Measurer<'_>, input: &Input, target: Option<&Option<PathBuf>>) -> Option<Result<Finding>> {
    let bytes = match input {
        Input::Failed { .. } => return None,
        Input::File(path) => picture::load(path).map(Cow::Owned),
        Input::Sample => Ok(Cow::Borrowed(sample::PNG)),
    };
    Some(bytes.map_err(Error::from).and_then(|bytes| {
        let options = measurer.options();
        let picture = picture::decode(&bytes, options.linearize)?;
        let mut finding = measurer.measure(input.name(), &picture)?;
        if let (Some(to), Some(Some(path))) = (&options.restore, target) {
            restore::write(&mut finding, &picture, to.method, path)?;
        }
        if options.report.is_some() {
            finding.section = Some(report::section::of(&bytes, &picture, &finding, options, measurer.mask()));
        }
        Ok(finding)
    }))
}

fn in_order(
    inputs: &[Input],
    results: mpsc::Receiver<(usize, Option<Result<Finding>>)>,
    report: &mut impl FnMut(&Input, std::result::Result<&Finding, &Error>) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut waiting: Vec<Option<Option<Result<Finding>>>> = Vec::new();
    waiting.resize_with(inputs.len(), || None);
    let mut reported = 0;
    for (index, result) in results {
        waiting[index] = Some(result);
        while let Some(result) = waiting.get_mut(reported).and_then(Option::take) {
            let input = &inputs[reported];
            match (&result, input) {
                (Some(Ok(record)), _) => report(input, Ok(record))?,
                (Some(Err(error)), _) | (None, Input::Failed { error, .. }) => report(input, Err(error))?,
                (None, _) => {}
            }
            reported += 1;
        }
    }
    ControlFlow::Continue(())
}
