//! A live node over Zenoh that ROS 2 with `rmw_zenoh_cpp` sees as one of its own.
//!
//! A [`Node`] subscribes to the pictures of a topic, gives them to one worker by way of a [`Stream`], which drops the oldest
//! when the worker is too slow, and publishes velocities and diagnostics. [`rmw`] holds the conventions.

mod endpoint;
pub mod rmw;
mod worker;

use std::error::Error as StdError;
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use blur_stream::{Limits, Report, Stream};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::{Config, Session, Wait};

use crate::bag::{DIAGNOSTICS_TOPIC, TWIST_TOPIC};
use crate::camera::info_topic;
use crate::frame::FrameKind;
use crate::msg::{
    CameraInfo, CompressedImage, DiagnosticArray, Header, Image, Message, MessageType, Time, TwistWithCovarianceStamped,
};
use crate::observer::{Missing, Observer, Options};
use crate::sequence::{Counts, Event};
use crate::{Error, Result, diagnostics};

use endpoint::{Endpoint, now_ns};
use rmw::{End, Identity};
use worker::{Arrived, Shared, Worker};

/// What a node does and where.
#[derive(Debug, Clone)]
pub struct Settings {
    /// `ROS_DOMAIN_ID`.
    pub domain: u32,
    /// Name of the node.
    pub name: String,
    /// The topic with the pictures.
    pub topic: String,
    /// The type of its messages.
    pub kind: FrameKind,
    /// The topic of the camera; `None`: the one beside the pictures.
    pub info_topic: Option<String>,
    /// Where to connect to, such as `tcp/127.0.0.1:7447`.
    pub connect: Vec<String>,
    /// Where to listen, such as `tcp/127.0.0.1:0`.
    pub listen: Vec<String>,
    /// How many frames may wait, and how long.
    pub limits: Limits,
    /// How to measure.
    pub options: Options,
}

/// What a node tells while it runs.
#[derive(Debug)]
#[non_exhaustive]
pub enum Note {
    /// Something out of the ordinary with a frame.
    Event {
        /// Its stamp.
        stamp: Time,
        /// What.
        event: Event,
    },
    /// A frame that could not be measured.
    Frame {
        /// Its stamp.
        stamp: Time,
        /// Why.
        error: Error,
    },
    /// There are no velocities.
    Missing(Missing),
    /// Something else went wrong.
    Failure(Error),
}

/// A running node. Dropping it ends it.
pub struct Node {
    stream: Arc<Mutex<Option<Stream<Arrived>>>>,
    shared: Arc<Shared>,
    diagnostics: Arc<Endpoint>,
    topic: String,
    /// What ROS sees while it lives.
    _subscribers: Vec<(Subscriber<()>, LivelinessToken)>,
    _token: LivelinessToken,
    session: Session,
}

impl Node {
    /// Opens a session and begins to measure; notes come out of the receiver.
    ///
    /// # Errors
    /// [`Error::Zenoh`], [`Error::Stream`] and those of [`Observer::new`].
    pub fn start(settings: &Settings) -> Result<(Self, Receiver<Note>)> {
        let Settings { domain, name, kind, info_topic: wanted, limits, .. } = settings.clone();
        let topic = absolute(&settings.topic);
        let observer = Observer::new(settings.options.clone(), &topic)?;
        let wants_info = observer.wants_info();
        let session = zenoh::open(config(settings)?).wait().map_err(zenoh_error("open a session"))?;
        let identity = Identity { domain, session: session.zid().to_string(), node: name };
        let token = session.liveliness().declare_token(identity.node_token()).wait();
        let token = token.map_err(zenoh_error("declare a token"))?;
        let twist = Endpoint::declare::<TwistWithCovarianceStamped<'_>>(&session, &identity, 1, TWIST_TOPIC)?;
        let diagnostics = Endpoint::declare::<DiagnosticArray<'_>>(&session, &identity, 2, DIAGNOSTICS_TOPIC)?;
        let (twist, diagnostics) = (Arc::new(twist), Arc::new(diagnostics));
        let shared = Arc::new(Shared::default());
        let (sender, notes) = mpsc::channel();
        let mut worker = Worker {
            kind,
            observer,
            twist,
            diagnostics: Arc::clone(&diagnostics),
            shared: Arc::clone(&shared),
            notes: sender,
            missing: None,
            has_told_info: false,
        };
        let stream = Stream::start(limits, Arrived::default, move |arrived: &mut Arrived| {
            worker.work(arrived);
            // The memory of the transport is given back at once.
            arrived.payload = zenoh::bytes::ZBytes::default();
        })?;
        let stream = Arc::new(Mutex::new(Some(stream)));
        let depth = limits.capacity;
        let subscribe = |id, topic: &str, kind: &MessageType, take: Box<dyn Fn(zenoh::bytes::ZBytes) + Send + Sync>| {
            let key = rmw::topic_key(domain, topic, kind);
            let subscriber = session
                .declare_subscriber(key)
                .callback(move |sample| take(sample.payload().clone()))
                .wait()
                .map_err(zenoh_error("subscribe"))?;
            let token = identity.end_token(id, End::Subscription { depth }, topic, kind);
            let token = session.liveliness().declare_token(token).wait().map_err(zenoh_error("declare a token"))?;
            Ok::<_, Error>((subscriber, token))
        };
        let mut subscribers = Vec::new();
        if wants_info {
            let shared = Arc::clone(&shared);
            let take = move |payload| *lock(&shared.info) = Some(payload);
            let topic = wanted.map_or_else(|| info_topic(&topic), |wanted| absolute(&wanted));
            subscribers.push(subscribe(3, &topic, &CameraInfo::TYPE, Box::new(take))?);
        }
        let to_stream = Arc::clone(&stream);
        let take = move |payload| {
            if let Some(stream) = lock(&to_stream).as_mut() {
                stream.push(|arrived| *arrived = Arrived { payload, received_ns: now_ns() });
            }
        };
        let kind = match kind {
            FrameKind::Raw => Image::TYPE,
            FrameKind::Compressed => CompressedImage::TYPE,
        };
        subscribers.push(subscribe(4, &topic, &kind, Box::new(take))?);
        Ok((Self { stream, shared, diagnostics, topic, _subscribers: subscribers, _token: token, session }, notes))
    }

    /// What became of the frames so far.
    pub fn report(&self) -> Report {
        lock(&self.stream).as_ref().map(Stream::report).unwrap_or_default()
    }

    /// Numbers of the frames that were begun.
    pub fn counts(&self) -> Counts {
        *lock(&self.shared.counts)
    }

    /// Publishes the report as diagnostics.
    ///
    /// # Errors
    /// [`Error::Zenoh`].
    pub fn publish_report(&self) -> Result<()> {
        let header = Header { stamp: Time::from_nanoseconds(now_ns()), frame_id: "" };
        self.diagnostics.send(&diagnostics::of_stream(header, &self.topic, &self.report()))
    }

    /// Ends the worker after the frame that it is at, leaves the network and reports.
    ///
    /// # Errors
    /// [`Error::Stream`] and [`Error::Zenoh`].
    pub fn stop(self) -> Result<(Report, Counts)> {
        let stream = lock(&self.stream).take();
        let report = stream.map(Stream::stop).transpose()?.unwrap_or_default();
        let counts = self.counts();
        self.session.close().wait().map_err(zenoh_error("close the session"))?;
        Ok((report, counts))
    }
}

/// A peer that is found by others through those it connects to, never by multicast.
fn config(settings: &Settings) -> Result<Config> {
    let mut config = Config::default();
    // A list of strings in quotes is JSON.
    let (connect, listen) = (format!("{:?}", settings.connect), format!("{:?}", settings.listen));
    for (key, value) in [
        ("mode", "\"peer\""),
        ("connect/endpoints", &connect),
        ("listen/endpoints", &listen),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "true"),
    ] {
        config.insert_json5(key, value).map_err(zenoh_error("configure the session"))?;
    }
    Ok(config)
}

/// A topic as seen from the root: the node stands in no namespace.
fn absolute(topic: &str) -> String {
    format!("/{}", topic.trim_matches('/'))
}

fn zenoh_error(task: &'static str) -> impl Fn(Box<dyn StdError + Send + Sync>) -> Error {
    move |source| Error::Zenoh { task, reason: source.to_string() }
}

/// What is behind the locks is whole between any two statements.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
