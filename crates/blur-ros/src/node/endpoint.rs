//! A publisher of one topic.

use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::{Session, Wait};

use super::rmw::{self, End, Identity};
use super::zenoh_error;
use crate::Result;
use crate::cdr::ByteOrder;
use crate::msg::Message;

/// Publishes messages of one type; ROS sees it while it lives.
pub(super) struct Endpoint {
    publisher: Publisher<'static>,
    gid: [u8; 16],
    sent: AtomicI64,
    _token: LivelinessToken,
}

impl Endpoint {
    /// A publisher of messages of the type `M` on `topic`.
    pub(super) fn declare<'m, M: Message<'m>>(
        session: &Session,
        identity: &Identity,
        id: usize,
        topic: &str,
    ) -> Result<Self> {
        let key = rmw::topic_key(identity.domain, topic, &M::TYPE);
        let publisher = session.declare_publisher(key).wait().map_err(zenoh_error("declare a publisher"))?;
        let token = identity.end_token(id, End::Publisher, topic, &M::TYPE);
        let gid = rmw::gid(&token);
        let token = session.liveliness().declare_token(token).wait().map_err(zenoh_error("declare a token"))?;
        Ok(Self { publisher, gid, sent: AtomicI64::new(0), _token: token })
    }

    /// Sends a message to whoever listens.
    pub(super) fn send<'m>(&self, message: &impl Message<'m>) -> Result<()> {
        let number = self.sent.fetch_add(1, Ordering::Relaxed) + 1;
        let attachment = rmw::attachment(number, now_ns(), self.gid);
        let put = self.publisher.put(message.to_cdr(ByteOrder::Little)).attachment(attachment);
        put.wait().map_err(zenoh_error("publish"))
    }
}

/// Nanoseconds since 1970.
pub(super) fn now_ns() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    since.as_nanos().try_into().unwrap_or(i64::MAX)
}
