//! `slider calibrate`.

use std::io;

use slider_host::Error;
use slider_host::calibrate::{self, Options};

pub(crate) fn run(options: &Options) -> Result<bool, Error> {
    calibrate::run(options, &mut io::stdout().lock()).map(|()| true)
}
