//! The worker and its queue.

use std::any::Any;
use std::panic::resume_unwind;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::queue::{Frame, Put, Queue};
use crate::report::{Report, Tally};
use crate::{Error, Result};

/// How much may wait, and how long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most frames that wait for the worker, at least 1. Two more buffers are with the worker and with whoever fills them.
    pub capacity: usize,
    /// Longest time that a frame may have waited when its turn comes; `None`: any.
    pub deadline: Option<Duration>,
}

impl Default for Limits {
    fn default() -> Self {
        Self { capacity: 4, deadline: None }
    }
}

/// A worker thread and the frames that wait for it. Dropping it stops the worker and waits for its end: no thread is left.
#[derive(Debug)]
pub struct Stream<T> {
    queue: Arc<Queue<T>>,
    tally: Arc<Mutex<Tally>>,
    worker: Option<JoinHandle<()>>,
}

impl<T: Send + 'static> Stream<T> {
    /// Starts a worker that calls `work` for each frame. `make` makes the buffers, all at once.
    ///
    /// # Errors
    /// When the capacity is 0 or the thread cannot be started.
    pub fn start(
        limits: Limits,
        make: impl FnMut() -> T,
        mut work: impl FnMut(&mut T) + Send + 'static,
    ) -> Result<Self> {
        let Limits { capacity, deadline } = limits;
        let tally = Tally::new().filter(|_| capacity > 0).ok_or(Error::Capacity { capacity })?;
        let queue = Arc::new(Queue::new(capacity, make));
        let tally = Arc::new(Mutex::new(tally));
        let (of_worker, counts) = (Arc::clone(&queue), Arc::clone(&tally));
        let worker = thread::Builder::new()
            .name("blur-stream".to_owned())
            .spawn(move || {
                // Whatever ends the worker, nobody may wait for it in vain.
                let _closer = Closer(&of_worker);
                while let Some(Frame { mut buffer, arrived }) = of_worker.take() {
                    if deadline.is_some_and(|most| arrived.elapsed() > most) {
                        lock(&counts).late += 1;
                    } else {
                        work(&mut buffer);
                        lock(&counts).count_done(arrived.elapsed());
                    }
                    of_worker.give_back(buffer);
                }
            })
            .map_err(Error::Thread)?;
        Ok(Self { queue, tally, worker: Some(worker) })
    }

    /// Gives the worker a frame that arrives now: `fill` writes it into a buffer, which still holds an older one. Returns at
    /// once; `false` when the worker has ended.
    pub fn push(&mut self, fill: impl FnOnce(&mut T)) -> bool {
        let put = self.queue.put(Instant::now(), fill);
        let mut tally = lock(&self.tally);
        match put {
            Put::Closed => return false,
            Put::Waits => {}
            Put::Displaces => tally.dropped += 1,
        }
        tally.received += 1;
        true
    }

    /// What has become of the frames so far.
    pub fn report(&self) -> Report {
        lock(&self.tally).report()
    }

    /// Lets the worker finish what waits, ends it and reports.
    ///
    /// # Errors
    /// [`Error::Worker`] when it panicked.
    pub fn finish(mut self) -> Result<Report> {
        self.end(false)
    }

    /// Ends the worker after the frame that it is at, drops what waits and reports.
    ///
    /// # Errors
    /// [`Error::Worker`] when it panicked.
    pub fn stop(mut self) -> Result<Report> {
        self.end(true)
    }
}

impl<T> Stream<T> {
    fn end(&mut self, drop_waiting: bool) -> Result<Report> {
        lock(&self.tally).dropped += self.queue.close(drop_waiting) as u64;
        let ended = self.worker.take().map_or(Ok(()), JoinHandle::join);
        let report = lock(&self.tally).report();
        match ended {
            Ok(()) => Ok(report),
            Err(panic) => Err(Error::Worker { done: report.done, message: message(panic.as_ref()) }),
        }
    }
}

/// Without a way to report it, a panic of the worker goes on in the thread that drops the stream, unless that panics itself.
impl<T> Drop for Stream<T> {
    fn drop(&mut self) {
        self.queue.close(true);
        if let Some(Err(panic)) = self.worker.take().map(JoinHandle::join)
            && !thread::panicking()
        {
            resume_unwind(panic);
        }
    }
}

/// Closes a queue when the worker ends.
struct Closer<'a, T>(&'a Queue<T>);

impl<T> Drop for Closer<'_, T> {
    fn drop(&mut self) {
        self.0.close(false);
    }
}

/// What a panic said.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message").to_owned()
}

/// The counters are plain numbers: a panic leaves them whole.
fn lock(tally: &Mutex<Tally>) -> MutexGuard<'_, Tally> {
    tally.lock().unwrap_or_else(PoisonError::into_inner)
}
