//! What arrives: messages, responses and requests, each read by its type and told to the program that asked.

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

/// Requests that a program has not answered.
const UNANSWERED_MAX: usize = 10_000;

/// Calls that wait for their responses, by the numbers of their requests.
pub(crate) type Calls = Arc<Mutex<BTreeMap<i64, Call>>>;

/// A call that waits for its response.
pub(crate) struct Call {
    /// What the program calls it.
    pub(crate) number: u64,
    /// The processes that had the request: another one, started since, never answers it.
    pub(crate) servers: Vec<Process>,
}

/// A response that is on its way when its server goes has so long to arrive.
const LAST_WORDS: Duration = Duration::from_millis(600);

/// Requests that wait for their answers: to whom these go.
pub(crate) type Asked = Arc<Mutex<Requests>>;

/// See [`Asked`].
#[derive(Default)]
pub(crate) struct Requests {
    next: u64,
    waiting: BTreeMap<u64, Request>,
}

/// To whom an answer goes.
#[derive(Clone, Copy)]
pub(crate) struct Request {
    pub(crate) to: SampleIdentity,
    /// The writer that the request came from.
    pub(crate) from: GUID,
}

impl Requests {
    /// Takes a request out.
    pub(crate) fn take(&mut self, number: u64) -> Option<Request> {
        self.waiting.remove(&number)
    }

    /// The frame of a request. A request that does not fit its type gets no answer, so it is not kept.
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

/// A frame with the message at the end of its text, which begins as `head` does.
fn frame(head: String, payload: &Payload, of: &Type) -> Result<Frame, String> {
    let mut decoded = Decoded { text: head, arrays: Vec::new() };
    read::read(&payload.bytes, payload.little, of, &mut decoded)?;
    decoded.text.push('}');
    Ok(Frame { text: decoded.text, bytes: decoded.arrays })
}

/// Says what is wrong with messages, not each time: the first, second, fourth, eighth …
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

/// What is heard, and who is told.
pub(crate) struct Heard {
    pub(crate) of: Arc<Type>,
    /// Of the topic or service.
    pub(crate) name: String,
    pub(crate) outbox: Outbox,
}

/// Tells each message of a topic, for ever.
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

/// Tells each response to a call, for ever. `writer` is what sends the requests.
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

/// Tells the calls of a client whose servers have all gone, for ever. `writer` is what sends the requests.
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

/// The frame that says that a call will get no response.
pub(crate) fn failed(call: u64, why: &str) -> String {
    format!(r#"{{"failed":{call},"why":{}}}"#, json::quoted(why))
}

/// Tells each request to a service, for ever.
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

/// How the answer to a request is to be marked: as the client says, or by the request itself.
fn answer_to(heard: &DeserializedCacheChange<Payload>) -> SampleIdentity {
    let own =
        SampleIdentity { writer_guid: heard.writer_guid(), sequence_number: heard.sequence_number };
    match heard.related_sample_identity() {
        None => own,
        // Fast DDS names the reader of the answer, and leaves the number to the request.
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

    /// Takes a request of `std_srvs/srv/SetBool`; its bytes are whole if there is one. Returns the text of the frame.
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
        // An answer has made room.
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
