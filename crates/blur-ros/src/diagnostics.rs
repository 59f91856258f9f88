//! From a record to diagnostics that hold all of it.

use std::borrow::Cow;
use std::error::Error as _;

use blur_core::estimate::Status;
use blur_core::record::{Record, Value};

use crate::Error;
use crate::msg::{DiagnosticArray, DiagnosticStatus, Header, KeyValue, Level};
use crate::sequence::Event;

/// What is said of a direction that is known but for its sign.
const AMBIGUOUS: &str = "direction ambiguous";

/// The diagnostics of one frame of `topic`: every field of its record by its name, as text from which the same bits come back.
///
/// `Ok` stands for a status `ok` with a direction, `Warn` for one with low confidence or without the sign of its direction,
/// `Error` for no motion blur and for a frame that could not be measured.
pub fn diagnostics<'a>(
    header: Header<'a>,
    topic: &str,
    outcome: Result<&Record, &Error>,
    events: &[Event],
) -> DiagnosticArray<'a> {
    let (level, message) = match outcome {
        Ok(record) => verdict(record),
        Err(error) => (Level::Error, one_line(error)),
    };
    let mut values: Vec<KeyValue<'a>> = match outcome {
        Ok(record) => record
            .fields()
            .map(|(name, value)| KeyValue { key: Cow::Borrowed(name), value: Cow::Owned(text(&value)) })
            .collect(),
        Err(error) => vec![KeyValue { key: Cow::Borrowed("error"), value: Cow::Owned(one_line(error)) }],
    };
    values.extend(
        events.iter().map(|event| KeyValue { key: Cow::Borrowed("sequence"), value: Cow::Owned(event.to_string()) }),
    );
    let status = DiagnosticStatus {
        level,
        name: Cow::Owned(format!("blur: {topic}")),
        message: Cow::Owned(message),
        hardware_id: Cow::Borrowed(header.frame_id),
        values,
    };
    DiagnosticArray { header, status: vec![status] }
}

/// The diagnostics of the frames of `topic` as a stream: how many there were, and how long they took.
///
/// `Warn` stands for frames that were dropped or came too late to be measured.
#[cfg(feature = "node")]
pub fn of_stream<'a>(header: Header<'a>, topic: &str, report: &blur_stream::Report) -> DiagnosticArray<'a> {
    let seconds = |time: std::time::Duration| format!("{:?}", time.as_secs_f64());
    let values = [
        ("received", report.received.to_string()),
        ("done", report.done.to_string()),
        ("dropped", report.dropped.to_string()),
        ("late", report.late.to_string()),
        ("latency_p50_s", seconds(report.p50)),
        ("latency_p99_s", seconds(report.p99)),
        ("latency_longest_s", seconds(report.longest)),
    ];
    let status = DiagnosticStatus {
        level: if report.dropped + report.late > 0 { Level::Warn } else { Level::Ok },
        name: Cow::Owned(format!("blur: stream of {topic}")),
        message: Cow::Owned(report.to_string()),
        hardware_id: Cow::Borrowed(""),
        values: values.map(|(key, value)| KeyValue { key: Cow::Borrowed(key), value: Cow::Owned(value) }).to_vec(),
    };
    DiagnosticArray { header, status: vec![status] }
}

fn verdict(record: &Record) -> (Level, String) {
    let name = record.status.name();
    let mut message = match record.status.doubt() {
        Some(doubt) => format!("{name}: {doubt}"),
        None => name.to_owned(),
    };
    if matches!(record.status, Status::NoMotionBlur(_)) {
        return (Level::Error, message);
    }
    if record.direction_deg.is_none() {
        message = format!("{message}, {AMBIGUOUS}");
        return (Level::Warn, message);
    }
    (if record.status == Status::Ok { Level::Ok } else { Level::Warn }, message)
}

/// Numbers in the shortest way that gives the same number back.
fn text(value: &Value) -> String {
    match value {
        Value::Count(count) => count.to_string(),
        Value::Number(number) => format!("{number:?}"),
        Value::Flag(flag) => flag.to_string(),
        Value::Text(text) => text.clone().into_owned(),
    }
}

/// An error on one line, with its causes where it does not tell them itself.
pub fn one_line(error: &Error) -> String {
    let mut message = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let text = error.to_string();
        if !message.contains(&text) {
            message = format!("{message}: {text}");
        }
        cause = error.source();
    }
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}
