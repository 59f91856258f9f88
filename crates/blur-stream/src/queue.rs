//! A bounded queue that drops the oldest frame, with buffers that go round.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// A buffer and when what it holds arrived.
#[derive(Debug)]
pub(crate) struct Frame<T> {
    pub(crate) buffer: T,
    pub(crate) arrived: Instant,
}

/// What became of a frame that was put into the queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Put {
    /// It waits.
    Waits,
    /// It waits, and the oldest frame was dropped for it.
    Displaces,
    /// The queue is closed.
    Closed,
}

#[derive(Debug)]
pub(crate) struct Queue<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
}

#[derive(Debug)]
struct State<T> {
    waiting: VecDeque<Frame<T>>,
    free: Vec<T>,
    capacity: usize,
    is_closed: bool,
}

impl<T> Queue<T> {
    /// A queue of so many waiting frames. Besides these one buffer is with the worker and one with the producer.
    pub(crate) fn new(capacity: usize, mut make: impl FnMut() -> T) -> Self {
        let free: Vec<T> = (0..capacity + 2).map(|_| make()).collect();
        let waiting = VecDeque::with_capacity(capacity + 1);
        Self { state: Mutex::new(State { waiting, free, capacity, is_closed: false }), changed: Condvar::new() }
    }

    /// Fills a buffer, without holding up the worker, and puts it at the end. The oldest frame makes room if it must.
    ///
    /// Only one thread at a time may put.
    pub(crate) fn put(&self, arrived: Instant, fill: impl FnOnce(&mut T)) -> Put {
        let Some(mut buffer) = self.free_buffer() else { return Put::Closed };
        fill(&mut buffer);
        let mut state = self.lock();
        if state.is_closed {
            state.free.push(buffer);
            return Put::Closed;
        }
        state.waiting.push_back(Frame { buffer, arrived });
        let mut put = Put::Waits;
        if state.waiting.len() > state.capacity
            && let Some(oldest) = state.waiting.pop_front()
        {
            state.free.push(oldest.buffer);
            put = Put::Displaces;
        }
        drop(state);
        self.changed.notify_one();
        put
    }

    fn free_buffer(&self) -> Option<T> {
        let mut state = self.lock();
        if state.is_closed { None } else { state.free.pop() }
    }

    /// The oldest frame, waited for; `None` when the queue is closed and empty.
    pub(crate) fn take(&self) -> Option<Frame<T>> {
        let mut state = self.lock();
        loop {
            if let Some(frame) = state.waiting.pop_front() {
                return Some(frame);
            }
            if state.is_closed {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Takes a buffer back.
    pub(crate) fn give_back(&self, buffer: T) {
        self.lock().free.push(buffer);
    }

    /// Lets nothing more in. What waits can still be taken, unless it is to be dropped: then the number is returned.
    pub(crate) fn close(&self, drop_waiting: bool) -> usize {
        let mut state = self.lock();
        state.is_closed = true;
        let dropped = if drop_waiting { state.waiting.drain(..).count() } else { 0 };
        drop(state);
        self.changed.notify_all();
        dropped
    }

    /// A panic of the worker does not hold the lock, and the state is whole between any two statements.
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(queue: &Queue<u32>, number: u32) -> Put {
        queue.put(Instant::now(), |buffer| *buffer = number)
    }

    #[test]
    fn frames_come_out_in_their_order_and_the_oldest_is_dropped() {
        let queue = Queue::new(2, || 0);
        assert_eq!(
            [1, 2, 3, 4].map(|number| put(&queue, number)),
            [Put::Waits, Put::Waits, Put::Displaces, Put::Displaces]
        );
        assert_eq!(queue.take().unwrap().buffer, 3);
        assert_eq!(put(&queue, 5), Put::Waits);
        assert_eq!([4, 5].map(|_| queue.take().unwrap().buffer), [4, 5]);
    }

    #[test]
    fn buffers_go_round_without_a_new_one() {
        let queue = Queue::new(2, || 0);
        let round = allocation_counter::measure(|| {
            for number in 0..100 {
                put(&queue, number);
                put(&queue, number);
                put(&queue, number);
                let frame = queue.take().unwrap();
                queue.give_back(frame.buffer);
            }
        });
        assert_eq!(round.count_total, 0);
    }

    #[test]
    fn a_closed_queue_gives_what_it_holds_and_takes_nothing() {
        let queue = Queue::new(3, || 0);
        put(&queue, 1);
        put(&queue, 2);
        assert_eq!(queue.close(false), 0);
        assert_eq!(put(&queue, 3), Put::Closed);
        assert_eq!(queue.take().unwrap().buffer, 1);
        assert_eq!(queue.close(true), 1);
        assert!(queue.take().is_none());
    }
}
