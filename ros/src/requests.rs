//! Encoding of messages, and requests to services: sent at once, or when the parent program ends.

use std::collections::BTreeMap;
use std::sync::Arc;

use rustdds::bytes::Bytes;
use rustdds::{GUID, SampleIdentity, SequenceNumber, Timestamp, WriteOptionsBuilder};

use crate::cdr;
use crate::dds::participant::Writer;
use crate::dds::payload::Payload;
use crate::json::Json;
use crate::types::MESSAGE_MAX;
use crate::types::library::Type;

/// Maximum number of requests for the end; beyond it, the oldest is dropped.
const AT_END_MAX: usize = 10_000;

/// A request to send when the parent program ends.
pub(crate) struct AtEnd {
    pub(crate) writer: Arc<Writer>,
    /// The reader of the response.
    pub(crate) reader: GUID,
    pub(crate) request: Bytes,
}

/// Requests for the end by number.
pub(crate) struct AtEndRequests<R = AtEnd>(BTreeMap<u64, R>);

impl<R> Default for AtEndRequests<R> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<R> AtEndRequests<R> {
    /// Stores a request for the end. Returns true if the oldest one was dropped for it.
    pub(crate) fn keep(&mut self, number: u64, request: R) -> bool {
        self.0.insert(number, request);
        let is_full = self.0.len() > AT_END_MAX;
        if is_full {
            self.0.pop_first();
        }
        is_full
    }

    /// Removes the request with a number.
    pub(crate) fn forget(&mut self, number: u64) {
        self.0.remove(&number);
    }
}

impl AtEndRequests {
    /// Sends all requests, and removes them.
    pub(crate) fn send(&mut self) {
        for AtEnd { writer, reader, request } in std::mem::take(&mut self.0).into_values() {
            // A missing server is ignored.
            let _ = send(&writer, reader, request);
        }
    }
}

/// Sends a request; returns its number, which the response repeats. `reader` receives the response.
pub(crate) fn send(writer: &Writer, reader: GUID, bytes: Bytes) -> Result<i64, String> {
    let to = SampleIdentity { writer_guid: reader, sequence_number: SequenceNumber::UNKNOWN };
    let options =
        WriteOptionsBuilder::new().source_timestamp(Timestamp::now()).related_sample_identity(to);
    let payload = Payload { bytes, little: true };
    let sent =
        writer.write_with_options(payload, options.build()).map_err(|why| why.to_string())?;
    Ok(i64::from(sent.sequence_number))
}

/// The message of a frame, encoded in CDR.
pub(crate) fn encoded(asked: &Json, bytes: &[u8], of: &Type) -> Result<Bytes, String> {
    let sent = cdr::write::write(asked.get("message").ok_or("there is no message")?, bytes, of)?;
    if sent.len() > MESSAGE_MAX {
        let (most, found) = (MESSAGE_MAX >> 20, sent.len() >> 20);
        return Err(format!(
            "a message of {found} MB is not sent, {most} MB is the most that rafcon-ros carries: make it smaller, or use rclpy"
        ));
    }
    Ok(sent.into())
}

#[cfg(test)]
mod tests {
    use super::{AT_END_MAX, AtEndRequests, encoded};
    use crate::json::Json;
    use crate::types::MESSAGE_MAX;
    use crate::types::library::Library;

    #[test]
    fn of_too_many_requests_for_the_end_the_oldest_is_forgotten() {
        let mut kept = AtEndRequests::default();
        let most = AT_END_MAX as u64;
        assert!((1..=most).all(|number| !kept.keep(number, ())));
        assert!(kept.keep(most + 1, ()));
        assert_eq!(kept.0.first_key_value(), Some((&2, &())));
        kept.forget(2);
        assert!(!kept.keep(most + 2, ()));
        assert_eq!(kept.0.len(), AT_END_MAX);
    }

    #[test]
    fn a_message_that_is_too_long_is_refused_and_a_shorter_one_is_not() {
        let of = Library::new(Vec::new(), &[]).find("std_msgs/msg/String").unwrap();
        // The length and the final NUL take five bytes.
        let length = |text: usize| {
            let fields = vec![("data".to_owned(), Json::Text("x".repeat(text)))];
            let asked = Json::Map(vec![("message".to_owned(), Json::Map(fields))]);
            encoded(&asked, &[], &of).map(|bytes| bytes.len())
        };
        assert_eq!(length(MESSAGE_MAX - 5), Ok(MESSAGE_MAX));
        let refused = length(MESSAGE_MAX - 4).unwrap_err();
        assert!(
            refused.starts_with("a message of 33 MB is not sent, 33 MB is the most"),
            "{refused}"
        );
    }
}
