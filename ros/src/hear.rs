//! Received messages, responses and requests: each is decoded by its type and forwarded to the parent program.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use futures::StreamExt as _;
use rustdds::no_key::DeserializedCacheChange;
use rustdds::{GUID, SampleIdentity, SequenceNumber};

use crate::cdr::read::{self, Decoded};
use crate::dds::graph::Process;
use crate::dds::participant::{Node, Reader};
use crate::dds::payload::Payload;
use crate::frames::{Frame, Outbox};
use crate::json;
use crate::types::library::Type;

/// Maximum number of requests without a response of the program.
const UNANSWERED_MAX: usize = 10_000;

/// Pending calls by the numbers of their requests.
pub(crate) type Calls = Arc<Mutex<BTreeMap<i64, Call>>>;

/// A call that waits for its response.
pub(crate) struct Call {
    /// Number of the call at the parent program.
    pub(crate) number: u64,
    /// Processes that received the request. A process started later never responds to it.
    pub(crate) servers: Vec<Process>,
}

/// Time for a response to arrive after its server has ended.
const LAST_WORDS: Duration = Duration::from_millis(600);

/// Pending requests, with the recipients of their responses.
pub(crate) type Asked = Arc<Mutex<Requests>>;

/// Unanswered requests by number; the oldest are dropped beyond a limit.
#[derive(Default)]
pub(crate) struct Requests {
    next: u64,
    waiting: BTreeMap<u64, Request>,
}

/// The recipient of a response.
#[derive(Clone, Copy)]
pub(crate) struct Request {
    pub(crate) to: SampleIdentity,
    /// The writer of the request.
    pub(crate) from: GUID,
}

impl Requests {
    /// Removes a request and returns it.
    pub(crate) fn take(&mut self, number: u64) -> Option<Request> {
        self.waiting.remove(&number)
    }

    /// The frame of a request. A request of invalid content gets no response, so it is not kept.
    fn frame(
        &mut self,
        handle: u64,
        request: Request,
        payload: &Payload,
        of: &Type,
    ) -> Result<Frame, String> {
        let number = self.next + 1;
        let head = format!(r#"{{"request":{handle},"number":{number},"message":"#);
        let made = frame(head, payload, of)?;
        self.next = number;
        self.waiting.insert(number, request);
        if self.waiting.len() > UNANSWERED_MAX {
            self.waiting.pop_first();
        }
        Ok(made)
    }
}

/// A frame whose text begins with `head` and ends with the message.
fn frame(head: String, payload: &Payload, of: &Type) -> Result<Frame, String> {
    let mut decoded = Decoded { text: head, arrays: Vec::new() };
    read::read(&payload.bytes, payload.little, of, &mut decoded)?;
    decoded.text.push('}');
    Ok(Frame { text: decoded.text, bytes: decoded.arrays })
}

/// Reports invalid messages, at increasing intervals: the first, second, fourth, eighth …
struct Complaints<'a> {
    about: &'a str,
    outbox: &'a Outbox,
    count: u64,
}

impl Complaints<'_> {
    fn say(&mut self, why: &str) {
        self.count += 1;
        if self.count.is_power_of_two() {
            let (about, count) = (self.about, self.count);
            self.outbox
                .say("warning", &format!("{about}: a message was dropped ({count} so far): {why}"));
        }
    }
}

/// Context of a receiver.
pub(crate) struct Heard {
    pub(crate) of: Arc<Type>,
    /// Name of the topic or service.
    pub(crate) name: String,
    pub(crate) outbox: Outbox,
}

/// Forwards the messages of a topic, forever.
pub(crate) async fn messages(reader: Reader, heard: Heard, handle: u64) {
    let Heard { of, name: topic, outbox } = heard;
    let mut complaints = Complaints { about: &topic, outbox: &outbox, count: 0 };
    let stream = reader.as_async_stream();
    tokio::pin!(stream);
    while let Some(heard) = stream.next().await {
        let frame = heard.map_err(|why| why.to_string()).and_then(|heard| {
            let payload: Payload = heard.into_value();
            frame(format!(r#"{{"heard":{handle},"message":"#), &payload, &of)
        });
        match frame {
            Ok(frame) => outbox.message(frame).await,
            Err(why) => complaints.say(&why),
        }
    }
}

/// Forwards the responses to calls, forever. `writer` sends the requests.
pub(crate) async fn responses(reader: Reader, heard: Heard, writer: GUID, calls: Calls) {
    let Heard { of, name: service, outbox } = heard;
    let own = reader.guid();
    let mut complaints = Complaints { about: &service, outbox: &outbox, count: 0 };
    let stream = reader.as_async_stream();
    tokio::pin!(stream);
    while let Some(heard) = stream.next().await {
        let heard = match heard {
            Ok(heard) => heard,
            Err(why) => {
                complaints.say(&why.to_string());
                continue;
            }
        };
        let Some(to) = heard.related_sample_identity() else { continue };
        if to.writer_guid != own && to.writer_guid != writer {
            continue;
        }
        let number = i64::from(to.sequence_number);
        let call = calls.lock().unwrap_or_else(PoisonError::into_inner).remove(&number);
        let Some(call) = call else { continue };
        let payload: Payload = heard.into_value();
        let Call { number, .. } = call;
        match frame(format!(r#"{{"response":{number},"message":"#), &payload, &of) {
            Ok(frame) => outbox.message(frame).await,
            Err(why) => outbox.tell(failed(number, &why)),
        }
    }
}

/// Reports the calls of a client whose servers have all ended, forever. `writer` sends the requests.
pub(crate) async fn servers_gone(node: Node, writer: GUID, calls: Calls, outbox: Outbox) {
    let mut versions = node.graph().watch();
    while versions.changed().await.is_ok() {
        tokio::time::sleep(LAST_WORDS).await;
        let there = node.graph().peers(writer);
        let mut calls = calls.lock().unwrap_or_else(PoisonError::into_inner);
        calls.retain(|_, Call { number, servers }| {
            let is_waiting = servers.is_empty() || servers.iter().any(|it| there.contains(it));
            if !is_waiting {
                outbox.tell(failed(*number, "its server has ended"));
            }
            is_waiting
        });
    }
}

/// The frame for a call without a response.
pub(crate) fn failed(call: u64, why: &str) -> String {
    format!(r#"{{"failed":{call},"why":{}}}"#, json::quoted(why))
}

/// Forwards the requests to a service, forever.
pub(crate) async fn requests(reader: Reader, heard: Heard, handle: u64, asked: Asked) {
    let Heard { of, name: service, outbox } = heard;
    let mut complaints = Complaints { about: &service, outbox: &outbox, count: 0 };
    let stream = reader.as_async_stream();
    tokio::pin!(stream);
    while let Some(heard) = stream.next().await {
        let frame = heard.map_err(|why| why.to_string()).and_then(|heard| {
            let request = Request { to: answer_to(&heard), from: heard.writer_guid() };
            let payload: Payload = heard.into_value();
            asked
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .frame(handle, request, &payload, &of)
        });
        match frame {
            Ok(frame) => outbox.message(frame).await,
            Err(why) => complaints.say(&why),
        }
    }
}

/// The identity for the response to a request: from the client, or from the request itself.
fn answer_to(heard: &DeserializedCacheChange<Payload>) -> SampleIdentity {
    let own =
        SampleIdentity { writer_guid: heard.writer_guid(), sequence_number: heard.sequence_number };
    match heard.related_sample_identity() {
        None => own,
        // Fast DDS sets the reader of the response, and takes the number from the request.
        Some(said) if said.writer_guid == GUID::GUID_UNKNOWN => own,
        Some(said)
            if i64::from(said.sequence_number) <= 0
                || said.sequence_number == SequenceNumber::UNKNOWN =>
        {
            SampleIdentity { writer_guid: said.writer_guid, ..own }
        }
        Some(said) => said,
    }
}

#[cfg(test)]
mod tests {
    use rustdds::bytes::Bytes;
    use rustdds::{GUID, SampleIdentity, SequenceNumber};

    use super::{Payload, Request, Requests, UNANSWERED_MAX};
    use crate::types::library::Library;

    /// Adds a request of `std_srvs/srv/SetBool`, which is valid if it has a byte. Returns the text of the frame.
    fn request(requests: &mut Requests, bytes: &'static [u8]) -> Result<String, String> {
        let of = Library::new(Vec::new(), &[]).find("std_srvs/srv/SetBool_Request")?;
        let to = SampleIdentity {
            writer_guid: GUID::GUID_UNKNOWN,
            sequence_number: SequenceNumber::UNKNOWN,
        };
        let payload = Payload { bytes: Bytes::from_static(bytes), little: true };
        let request = Request { to, from: GUID::GUID_UNKNOWN };
        requests.frame(3, request, &payload, &of).map(|frame| frame.text)
    }

    #[test]
    fn of_too_many_unanswered_requests_the_oldest_is_forgotten() {
        let mut requests = Requests::default();
        let first = request(&mut requests, &[1]).unwrap();
        assert_eq!(first, r#"{"request":3,"number":1,"message":{"data":true}}"#);
        let (to, from) = requests.waiting.get(&1).map(|one| (one.to, one.from)).unwrap();
        requests.waiting.extend((2..=UNANSWERED_MAX as u64).map(|it| (it, Request { to, from })));
        requests.next = UNANSWERED_MAX as u64;
        request(&mut requests, &[0]).unwrap();
        assert!(requests.take(1).is_none() && requests.take(2).is_some());
        // A response has freed capacity.
        request(&mut requests, &[0]).unwrap();
        assert!(requests.take(3).is_some());
    }

    #[test]
    fn a_request_that_does_not_fit_its_type_is_not_kept() {
        let mut requests = Requests::default();
        request(&mut requests, &[]).unwrap_err();
        assert_eq!((requests.waiting.len(), requests.next), (0, 0));
    }
}
