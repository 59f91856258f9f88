//! `slider simulate`.

use std::io;

use slider_host::Error;
use slider_host::simulate::{self, Options};

pub(crate) fn run(options: &Options) -> Result<bool, Error> {
    simulate::run(options, &mut io::stdout().lock()).map(|()| true)
}
