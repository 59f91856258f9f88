//! The conventions by which `rmw_zenoh_cpp` speaks over Zenoh.
//!
//! After the document `docs/design.md` of the repository <https://github.com/ros2/rmw_zenoh> (sections *Topic and Service name
//! mapping to Zenoh key expressions* and *Graph Cache*) and, for what it leaves open, `liveliness_utils.cpp` (order of the
//! qualities of service, identifier of a publisher) and `attachment_helpers.cpp` (attachment) beside it.

use twox_hash::XxHash3_128;

use crate::msg::MessageType;

/// Bytes of the identifier of a publisher.
const GID_BYTES: usize = 16;

/// A node in a domain, by the identifier of its Zenoh session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    /// `ROS_DOMAIN_ID`.
    pub domain: u32,
    /// Identifier of the session in hexadecimal digits.
    pub session: String,
    /// Name of the node, without a namespace.
    pub node: String,
}

/// What a node has on a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Reliable and volatile, the last ten messages.
    Publisher,
    /// Best effort and volatile, the last messages up to a number: as the drivers of cameras publish.
    Subscription {
        /// The number.
        depth: usize,
    },
}

/// The key expression of a topic: `<domain>/<topic>/<type>/<hash>`.
pub fn topic_key(domain: u32, topic: &str, kind: &MessageType) -> String {
    format!("{domain}/{}/{}/{}", topic.trim_matches('/'), kind.dds(), kind.hash)
}

impl Identity {
    /// The liveliness token of the node itself.
    pub fn node_token(&self) -> String {
        let Self { domain, session, node } = self;
        format!("@ros2_lv/{domain}/{session}/0/0/NN/%/%/{node}")
    }

    /// The liveliness token of one of its ends; `id` is another for each.
    pub fn end_token(&self, id: usize, end: End, topic: &str, kind: &MessageType) -> String {
        let Self { domain, session, node } = self;
        // Reliability, durability, history and depth, deadline, lifespan, liveliness and its lease; empty where usual.
        let (letters, qos) = match end {
            End::Publisher => ("MP", "::,10:,:,:,,".to_owned()),
            End::Subscription { depth } => ("MS", format!("2::,{depth}:,:,:,,")),
        };
        let mangled = topic.replace('/', "%");
        format!("@ros2_lv/{domain}/{session}/0/{id}/{letters}/%/%/{node}/{mangled}/{}/{}/{qos}", kind.dds(), kind.hash)
    }
}

/// The identifier of a publisher, which goes with each of its messages: the hash of its token.
pub fn gid(token: &str) -> [u8; GID_BYTES] {
    // The low half first, as the machines that this runs on have it in memory.
    XxHash3_128::oneshot(token.as_bytes()).to_le_bytes()
}

/// What goes with a message: its number, counted from 1, when it was sent in nanoseconds, and who sent it. Numbers have the
/// lowest byte first, and the identifier is preceded by its length.
pub fn attachment(number: i64, sent_ns: i64, gid: [u8; GID_BYTES]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(2 * size_of::<i64>() + 1 + GID_BYTES);
    bytes.extend(number.to_le_bytes());
    bytes.extend(sent_ns.to_le_bytes());
    bytes.push(GID_BYTES as u8);
    bytes.extend(gid);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `std_msgs/msg/String`, of which the document has examples.
    const STRING: MessageType = MessageType {
        package: "std_msgs",
        name: "String",
        hash: "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
        definition: "",
    };

    #[test]
    fn keys_and_tokens_are_those_of_the_document() {
        assert_eq!(
            topic_key(0, "/robot1/chatter", &STRING),
            "0/robot1/chatter/std_msgs::msg::dds_::String_/RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
        );
        let session = "aac3178e146ba6f1fc6e6a4085e77f21".to_owned();
        let listener = Identity { domain: 2, session, node: "listener".to_owned() };
        assert_eq!(listener.node_token(), "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener");
        // The listener of the document is reliable, which is usual and left out.
        assert_eq!(
            listener.end_token(10, End::Subscription { depth: 10 }, "/chatter", &STRING),
            "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/10/MS/%/%/listener/%chatter/std_msgs::msg::dds_::String_/\
             RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/2::,10:,:,:,,"
        );
        let talker =
            Identity { session: "8b20917502ee955ac4476e0266340d5c".to_owned(), node: "talker".to_owned(), ..listener };
        assert_eq!(
            talker.end_token(10, End::Publisher, "/chatter", &STRING),
            "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/\
             RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/::,10:,:,:,,"
        );
    }

    #[test]
    fn the_identifier_is_the_hash_of_the_token() {
        // XXH3-128 of nothing, from the specification of xxHash: low half 6001c324468d497f, high half 99aa06d3014798d8.
        let low = 0x6001_c324_468d_497f_u64.to_le_bytes();
        let high = 0x99aa_06d3_0147_98d8_u64.to_le_bytes();
        assert_eq!(gid(""), [low, high].concat()[..]);
    }

    #[test]
    fn the_attachment_has_thirty_three_bytes() {
        let bytes = attachment(1, 2, [7; 16]);
        assert_eq!(bytes.len(), 33);
        assert_eq!((bytes[0], bytes[8], bytes[16], bytes[32]), (1, 2, 16, 7));
    }
}
