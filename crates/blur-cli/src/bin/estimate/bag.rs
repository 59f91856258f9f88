//! Measures the pictures of a bag.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::Path;

use blur_cli::measure::Options;
use blur_cli::{Error, Result, bag, record};
use blur_ros::bag::{FrameReport, Summary};
use blur_ros::observer::Missing;

use crate::complain;

/// Whether all went well.
///
/// # Errors
/// What keeps the whole bag from being measured.
pub(crate) fn run(path: &Path, options: &Options, bag_options: &bag::BagOptions, json: bool) -> Result<bool> {
    let task = bag::task(path, options, bag_options)?;
    let mut written = Ok(());
    let summary = blur_ros::bag::measure(&task, |frame| {
        let image = bag::name(path, &task.topic, frame.stamp);
        for event in frame.events {
            complain(&format!("{image}: {event}"));
        }
        match report(&image, frame, json) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                written = Err(error);
                ControlFlow::Break(())
            }
        }
    })?;
    match written {
        // The reader has seen enough, as in `estimate ... | head -1`.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => return Err(Error::Write(error)),
        _ => {}
    }
    Ok(tell(path, &task.topic, options, bag_options, summary))
}

fn report(image: &str, frame: &FrameReport<'_>, json: bool) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match frame.outcome {
        None => {}
        Some(Ok(record)) if json => bag::write_json(&mut out, image, record)?,
        Some(Ok(record)) => writeln!(out, "{}", bag::line(image, record))?,
        Some(Err(error)) => {
            let message = blur_ros::diagnostics::one_line(error);
            complain(&format!("{image}: {message}"));
            if json {
                record::write_failed(&mut out, image, &message)?;
            }
        }
    }
    out.flush()
}

/// The summary, once on standard error.
fn tell(path: &Path, topic: &str, options: &Options, bag_options: &bag::BagOptions, summary: Summary) -> bool {
    let Summary { counts, twists, missing, info_error, damage } = summary;
    let name = format!("{}:{topic}", path.display());
    // Without an output, an exposure or a scale nobody has asked for velocities.
    let is_asked = bag_options.output.is_some() || options.exposure_s.is_some() || missing != Some(Missing::Scale);
    if let Some(missing) = missing.filter(|_| is_asked) {
        complain(&format!("{name}: note: {}", missing.advice()));
    }
    if let Some(error) = info_error {
        complain(&format!("{name}: note: {error}"));
    }
    match &bag_options.output {
        Some(output) => complain(&format!("{name}: {counts}; {twists} velocities in {}", output.display())),
        None => complain(&format!("{name}: {counts}")),
    }
    if let Some(damage) = &damage {
        complain(&damage.to_string());
    }
    counts.failed == 0 && damage.is_none()
}
