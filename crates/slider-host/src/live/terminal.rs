//! The view on a terminal.

use std::io::{IsTerminal, Stdout, stdout};
use std::panic::{self, PanicHookInfo};
use std::sync::mpsc::{Receiver, Sender, TryRecvError};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::crossterm::cursor::Show;
use ratatui::crossterm::terminal::{EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode};
use ratatui::crossterm::{event, execute};

use super::{Event, Request, State, draw};
use crate::Error;

/// How long a picture stays, at least.
const FRAME: Duration = Duration::from_millis(50);
/// Most events between two pictures, so that keys are heard however fast events come.
const MOST_EVENTS: usize = 20_000;

/// Shows what comes through `events` and sends what the user asks for to `commands`, until the user quits; the last
/// request sent is [`Request::Quit`].
///
/// The end of `events` does not end the view: the user may want to read why. The terminal is restored on every way out,
/// also by a panic of this thread, whose message is printed after that. A panic of another thread is shown as an error,
/// and is the error of this function when the user quits. A signal that kills the program leaves the terminal as it is.
///
/// # Errors
///
/// [`Error::View`] if the output is not a terminal, reading or drawing fails, or another thread has panicked.
pub fn run(events: &Receiver<Event>, commands: &Sender<Request>) -> Result<(), Error> {
    let mut screen = Screen::open()?;
    let mut state = State::default();
    let mut is_open = true;
    let mut panicked: Option<String> = None;
    loop {
        for text in screen.take_panics() {
            state.apply(Event::Error(text.clone()));
            panicked.get_or_insert(text);
        }
        screen.terminal.draw(|frame| draw(frame, &state)).map_err(Error::View)?;
        // Every key that waits, so that a key held down does not lag behind.
        let mut patience = FRAME;
        while event::poll(patience).map_err(Error::View)? {
            patience = Duration::ZERO;
            let event::Event::Key(key) = event::read().map_err(Error::View)? else { continue };
            let Some(request) = state.key(key) else { continue };
            let is_heard = commands.send(request).is_ok();
            if request == Request::Quit {
                return panicked.map_or(Ok(()), |text| Err(Error::View(std::io::Error::other(text))));
            }
            if !is_heard {
                state.say("nobody takes commands any more; q quits".to_owned(), true);
            }
        }
        for _ in 0..MOST_EVENTS {
            match events.try_recv() {
                Ok(event) => state.apply(event),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => {
                    if std::mem::take(&mut is_open) {
                        state.say("nothing more will come; q quits".to_owned(), true);
                    }
                    break;
                }
            }
        }
    }
}

/// What the standard library calls when a thread panics.
type Hook = Box<dyn Fn(&PanicHookInfo<'_>) + Sync + Send>;

/// The terminal in raw mode on its alternate screen, until dropped.
///
/// A panic of this thread restores it before its message is printed. One of another thread would print over the
/// picture: its message is kept for the view instead.
struct Screen {
    terminal: Terminal<CrosstermBackend<Stdout>>,
    panics: Arc<Mutex<Vec<String>>>,
    hook: Arc<Hook>,
}

impl Screen {
    fn open() -> Result<Self, Error> {
        if !stdout().is_terminal() {
            return Err(Error::View(std::io::Error::other("the output is not a terminal")));
        }
        match prepare() {
            Ok(terminal) => {
                let panics = Arc::default();
                let hook = install(&panics);
                Ok(Self { terminal, panics, hook })
            }
            Err(error) => {
                // It may have gone half of the way.
                restore();
                Err(Error::View(error))
            }
        }
    }

    /// What other threads said when they panicked, since the last time.
    fn take_panics(&self) -> Vec<String> {
        self.panics.lock().map(|mut panics| std::mem::take(&mut *panics)).unwrap_or_default()
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        restore();
        // Hooks cannot be changed while this thread panics.
        if !std::thread::panicking() {
            let before = Arc::clone(&self.hook);
            panic::set_hook(Box::new(move |info| before(info)));
        }
    }
}

fn prepare() -> std::io::Result<Terminal<CrosstermBackend<Stdout>>> {
    enable_raw_mode()?;
    execute!(stdout(), EnterAlternateScreen)?;
    Terminal::new(CrosstermBackend::new(stdout()))
}

/// Nothing is left to be done about a terminal that is gone, so errors are passed over.
fn restore() {
    let _ = disable_raw_mode();
    let _ = execute!(stdout(), LeaveAlternateScreen, Show);
}

fn install(panics: &Arc<Mutex<Vec<String>>>) -> Arc<Hook> {
    let before = Arc::new(panic::take_hook());
    let (hook, kept, viewer) = (Arc::clone(&before), Arc::clone(panics), std::thread::current().id());
    panic::set_hook(Box::new(move |info| {
        if std::thread::current().id() == viewer {
            restore();
            hook(info);
        } else if let Ok(mut panics) = kept.lock() {
            // On one line, as a message stands.
            panics.push(info.to_string().split_whitespace().collect::<Vec<_>>().join(" "));
        }
    }));
    before
}
