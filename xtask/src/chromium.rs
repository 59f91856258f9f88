//! The browser that the report is tried in.

use std::env;
use std::path::{Path, PathBuf};

use crate::debian;
use crate::run::{self, Result};

/// Names the browser to be used instead of the first that is found; the test reads it too.
pub(crate) const BROWSER: &str = "BLUR_CHROMIUM";
const PLACES: [&str; 3] = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const PACKAGE: &str = "chromium";

/// Finds the browser, or installs it where that is allowed.
pub(crate) fn provide() -> Result<PathBuf> {
    if let Some(named) = env::var_os(BROWSER) {
        let named = run::root().join(named);
        return if named.exists() {
            Ok(named)
        } else {
            Err(format!("{BROWSER} names {}, which is not there", named.display()))
        };
    }
    let found = || PLACES.map(Path::new).into_iter().find(|place| place.exists()).map(Path::to_owned);
    if let Some(browser) = found() {
        return Ok(browser);
    }
    debian::install(&[PACKAGE], "try the report in a browser")?;
    found().ok_or_else(|| format!("{PACKAGE} is installed, but at none of {}", PLACES.join(", ")))
}
