//! `slider listen --live`: the listener in a thread, the view in front of it.

use std::cell::RefCell;
use std::sync::mpsc::{Receiver, Sender};

use slider_host::live::{Event as Shown, Request};
use slider_host::reader::Event;
use slider_host::sheet::Sheet;
use slider_proto::{TimerState, Unwrapper};

/// What the view is told, and what its user asks for.
pub(crate) struct View {
    shown: Sender<Shown>,
    requests: Receiver<Request>,
    positions_m: Vec<f64>,
    run: RefCell<Open>,
}

/// The run that is going on.
#[derive(Default)]
struct Open {
    number: u16,
    tick_hz: u32,
    first: u64,
    edges: usize,
    unwrapper: Unwrapper,
}

impl View {
    pub(crate) fn new(shown: Sender<Shown>, requests: Receiver<Request>, sheet: &Sheet) -> Self {
        Self { shown, requests, positions_m: sheet.positions_m(), run: RefCell::default() }
    }

    /// A view that has been closed is told nothing; its last request ends the listener.
    pub(crate) fn show(&self, event: Shown) {
        let _ = self.shown.send(event);
    }

    /// What the user has asked for; a view that is gone asks to quit.
    pub(crate) fn request(&self) -> Option<Request> {
        match self.requests.try_recv() {
            Ok(request) => Some(request),
            Err(std::sync::mpsc::TryRecvError::Empty) => None,
            Err(std::sync::mpsc::TryRecvError::Disconnected) => Some(Request::Quit),
        }
    }

    /// Shows what the reader has found; what is said in words comes from the listener.
    pub(crate) fn follow(&self, event: &Event) {
        let mut open = self.run.borrow_mut();
        match event {
            Event::Began { run, tick, tick_hz } => {
                let mut unwrapper = Unwrapper::default();
                *open = Open { number: *run, tick_hz: *tick_hz, first: unwrapper.unwrap(*tick), edges: 0, unwrapper };
                self.show(Shown::Timer(TimerState::Running));
            }
            Event::Edges(batch) => {
                for edge in batch.edges() {
                    let ticks = open.unwrapper.unwrap(edge.tick).saturating_sub(open.first);
                    let t_s = ticks as f64 / f64::from(open.tick_hz.max(1));
                    let x_m = self.positions_m.get(open.edges).copied();
                    open.edges += 1;
                    self.show(Shown::Edge { run: open.number, t_s, x_m });
                }
            }
            Event::Ended(_) => self.show(Shown::Timer(TimerState::Idle)),
            _ => {}
        }
    }
}
