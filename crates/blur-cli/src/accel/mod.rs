//! The library of the program `accel`: from folders of pictures to models and back.
//!
//! [`simulate`] (a virtual rig) → [`collection`] (a folder of pictures of known acceleration) → [`features`] (their PSFs) →
//! [`train`] (a model) → [`predict`] (other pictures). [`study`] measures such a folder in every way, [`evaluate`] holds
//! all methods against each other, [`table`] and [`plot`] show it.

pub mod collection;
pub mod evaluate;
pub mod features;
pub mod plot;
pub mod predict;
pub mod simulate;
pub mod study;
pub mod table;
pub mod train;
