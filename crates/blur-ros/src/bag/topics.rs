//! What a bag holds.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::PathBuf;

use super::reader;
use crate::frame::FrameKind;
use crate::{Error, Result};

/// A topic of a bag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// Type of its messages in ROS 2.
    pub type_name: String,
    /// Number of its messages.
    pub messages: u64,
}

/// The topics with messages in the files of a bag, sorted by name. Damage ends the list early: it is told when the messages
/// are read.
///
/// # Errors
/// [`Error::Read`] and [`Error::NotABag`].
pub fn topics(files: &[PathBuf]) -> Result<Vec<Topic>> {
    let mut found: BTreeMap<(String, String), u64> = BTreeMap::new();
    for file in files {
        let read = reader::read(file, |message| {
            let key = (message.topic.to_owned(), message.type_name.to_owned());
            *found.entry(key).or_default() += 1;
            ControlFlow::Continue(())
        });
        match read {
            Ok(()) | Err(Error::Damaged { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(found.into_iter().map(|((name, type_name), messages)| Topic { name, type_name, messages }).collect())
}

/// The topic to be measured: the one asked for or, if none is, the only one with pictures.
///
/// # Errors
/// [`Error::UnknownTopic`], [`Error::NoImageTopic`] and [`Error::ManyImageTopics`], with the topics that there are.
pub fn image_topic(topics: &[Topic], wanted: Option<&str>) -> Result<(String, FrameKind)> {
    let names = |topics: &[(&Topic, FrameKind)]| {
        topics.iter().map(|(topic, _)| topic.name.as_str()).collect::<Vec<_>>().join(", ")
    };
    let pictures: Vec<_> =
        topics.iter().filter_map(|topic| Some((topic, FrameKind::of_type(&topic.type_name)?))).collect();
    let chosen = match wanted {
        Some(wanted) => pictures
            .iter()
            .find(|(topic, _)| topic.name == wanted)
            .ok_or_else(|| Error::UnknownTopic { topic: wanted.to_owned(), topics: names(&pictures) })?,
        None => match pictures.as_slice() {
            [only] => only,
            [] => {
                let topics: Vec<_> =
                    topics.iter().map(|topic| format!("{} ({})", topic.name, topic.type_name)).collect();
                return Err(Error::NoImageTopic { topics: topics.join(", ") });
            }
            many => return Err(Error::ManyImageTopics { count: many.len(), topics: names(many) }),
        },
    };
    Ok((chosen.0.name.clone(), chosen.1))
}
