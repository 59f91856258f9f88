//! A view of the running slider in the terminal.
//!
//! [`State`] is what the view knows: it changes by [`Event`]s and by keys and draws nothing. [`draw`] shows a state and
//! changes nothing. [`run`] connects both to a terminal, and gives the terminal back whatever happens.

mod draw;
mod state;
mod terminal;

pub use draw::draw;
pub use state::{Event, Link, Request, State};
pub use terminal::run;

#[cfg(test)]
mod tests;
