//! Regression trees, one or many.

mod bagged;
mod boosted;
mod cart;

pub use bagged::{Bagged, Bagging};
pub use boosted::{Boosted, Boosting};
pub use cart::{Cart, Tree};
