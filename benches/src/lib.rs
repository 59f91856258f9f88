//! Time of every method of the registry, in multiples of one 2-D FFT of the same picture in the same run.
//!
//! ```sh
//! cargo bench -p blur-benches                # every method at 256, 512 and 1024 pixels: some minutes
//! cargo bench -p blur-benches -- /512        # one size
//! cargo bench -p blur-benches -- 'fft|angle' # the angle methods and what they are compared with
//! ```
//!
//! `cargo bench -p blur-benches --bench regression` times the regressions of the acceleration instead, in observations a
//! second.
//!
//! # How to read it
//!
//! Criterion first prints each benchmark as `kind/method/side`. The run ends with a table: for every method and size
//! the median time of one picture and, as `x 12.3`, how many transforms fit into it. Compare the multiples, not the
//! milliseconds: they hardly depend on the machine. Without `fft` in the run there are no multiples.
//!
//! - `fft` is one real 2-D FFT as the methods use it (single precision, plan kept), with the copy of the picture into
//!   its input.
//! - `angle` and `length` are single methods; a length method is given the true angle, as in `--known-angle`.
//! - `pair` is the first angle method and then the first length method, each with its own transform of the picture.
//! - `joint` methods find both at once; `whittle-frame` is the default method on a frame of 1920 x 1440 pixels.
//! - `restore` undoes the true blur in one channel, with plans and spectra known.
//!
//! Below the table stands how the default method's time at 512 pixels is spent, stage by stage.
//!
//! The pictures are square dead-leaves scenes exposed with a uniform motion of 24.5 px at 30 degrees and noise of
//! 36 dB. Everything runs on one thread. The first picture of a size, which makes plans and buffers, is not counted.
//! Criterion warms up for 0.5 s and takes 20 samples in at least 1.5 s; other work on the machine raises all times, and
//! the multiples too where it comes and goes.

mod picture;
mod report;

pub use picture::{ANGLE_DEG, LENGTH_PX, blurred_frame, blurred_picture, sharp_picture};
pub use report::{FFT, Id, Timing, median_ns, table};
