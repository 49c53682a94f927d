//! Messages as bytes, and requests to services: sent at once, or when the program that asks ends.

use std::collections::BTreeMap;
use std::sync::Arc;

use rustdds::bytes::Bytes;
use rustdds::{GUID, SampleIdentity, SequenceNumber, Timestamp, WriteOptionsBuilder};

use crate::cdr;
use crate::dds::participant::Writer;
use crate::dds::payload::Payload;
use crate::json::Json;
use crate::types::library::Type;

/// Requests that are kept for the end; the oldest of more is forgotten.
const AT_END_MAX: usize = 10_000;

/// The largest message that is sure to arrive.
const MESSAGE_MAX: usize = 33 << 20;

/// A request that is sent when the program that asks ends.
pub(crate) struct AtEnd {
    pub(crate) writer: Arc<Writer>,
    /// The reader that receives the response.
    pub(crate) reader: GUID,
    pub(crate) request: Bytes,
}

/// Requests that are kept for the end, by number.
#[derive(Default)]
pub(crate) struct AtEndRequests(BTreeMap<u64, AtEnd>);

impl AtEndRequests {
    /// Keeps a request until the end.
    pub(crate) fn keep(&mut self, number: u64, request: AtEnd) {
        self.0.insert(number, request);
        if self.0.len() > AT_END_MAX {
            self.0.pop_first();
        }
    }

    /// Forgets the request with a number.
    pub(crate) fn forget(&mut self, number: u64) {
        self.0.remove(&number);
    }

    /// Sends all requests, and forgets them.
    pub(crate) fn send(&mut self) {
        for AtEnd { writer, reader, request } in std::mem::take(&mut self.0).into_values() {
            // Without a server there is nothing to ask for.
            let _ = send(&writer, reader, request);
        }
    }
}

/// Sends a request; returns the number that its response names. `reader` receives the response.
pub(crate) fn send(writer: &Writer, reader: GUID, bytes: Bytes) -> Result<i64, String> {
    let to = SampleIdentity { writer_guid: reader, sequence_number: SequenceNumber::UNKNOWN };
    let options =
        WriteOptionsBuilder::new().source_timestamp(Timestamp::now()).related_sample_identity(to);
    let payload = Payload { bytes, little: true };
    let sent =
        writer.write_with_options(payload, options.build()).map_err(|why| why.to_string())?;
    Ok(i64::from(sent.sequence_number))
}

/// The message of a frame in CDR.
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
