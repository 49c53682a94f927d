//! Handling of the frames of the parent program, one after the other.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, PoisonError};
use std::time::Duration;

use rustdds::{GUID, RTPSEntity as _, Timestamp, WriteOptionsBuilder};
use tokio::task::JoinHandle;

use crate::dds::endpoints::{Publisher, arrived};
use crate::dds::graph::{Process, process};
use crate::dds::participant::{self, Node, Part, Writer};
use crate::dds::payload::Payload;
use crate::dds::qos::Qos;
use crate::dds::{liveness, names};
use crate::frames::Outbox;
use crate::hear::{self, Asked, Call, Calls, Heard};
use crate::json::{self, Json};
use crate::requests::{self, AtEnd, AtEndRequests, encoded};
use crate::tell::{self, Counted, Counts};
use crate::types::library::{Library, Type};
use crate::types::{Sort, TypeName, described};
use crate::{describe, settings};

/// Time that a response waits until its client is discovered.
const CLIENT_KNOWN: Duration = Duration::from_secs(1);

/// A publisher, subscription, client or service of the program.
enum Made {
    Publisher { publisher: Publisher, of: Arc<Type>, topic: String },
    Subscription { id: GUID, task: JoinHandle<()> },
    Client { writer: Arc<Writer>, reader: GUID, of: Arc<Type>, calls: Calls, task: JoinHandle<()> },
    Service { writer: Arc<Writer>, reader: GUID, of: Arc<Type>, asked: Asked, task: JoinHandle<()> },
}

/// Timeout for the acknowledgment of the last requests and responses.
const FAREWELL: Duration = Duration::from_millis(500);

/// The name of a service, and types and parts of its requests and responses.
type Halves = (String, [Arc<Type>; 2], [Part; 2]);

/// The state of this program.
pub(crate) struct Session {
    library: Library,
    node: Option<Node>,
    made: BTreeMap<u64, Made>,
    counts: Counts,
    outbox: Outbox,
    ending: Vec<JoinHandle<()>>,
    at_end: AtEndRequests,
}

impl Session {
    /// A session without a node.
    pub(crate) fn new(outbox: Outbox) -> Self {
        let library = settings::library(Vec::new());
        Self {
            library,
            node: None,
            made: BTreeMap::new(),
            counts: Counts::default(),
            outbox,
            ending: Vec::new(),
            at_end: AtEndRequests::default(),
        }
    }

    /// Handles a request of the program. Replies if the request has a number.
    pub(crate) fn handle(&mut self, asked: &Json, bytes: &[u8]) {
        let done =
            asked.text("do").map(ToOwned::to_owned).and_then(|what| self.act(&what, asked, bytes));
        let number = asked.number("ask").ok();
        match (done, number) {
            (Ok(answer), Some(number)) => {
                self.outbox.tell(format!(r#"{{"answer":{number},"value":{answer}}}"#))
            }
            (Err(why), Some(number)) => {
                self.outbox
                    .tell(format!(r#"{{"answer":{number},"error":{}}}"#, json::quoted(&why)));
            }
            (Err(why), None) => self.outbox.say("error", &why),
            (Ok(_), None) => {}
        }
    }

    fn act(&mut self, what: &str, asked: &Json, bytes: &[u8]) -> Result<String, String> {
        match what {
            "start" => self.start(asked)?,
            "describe" => return self.describe(asked.text("type")?),
            "graph" => return Ok(tell::graph(self.node()?)),
            "users" => return Ok(tell::users(self.node()?, &asked.texts("types"))),
            "hashes" => return Ok(describe::hashes(&mut self.library, &asked.texts("types"))),
            "learn" => {
                let told = asked.get("description").ok_or("there is no description")?;
                self.library.learn(described::read(told)?, asked.text("hash")?)?;
            }
            "publisher" => self.publisher(asked)?,
            "subscription" => self.subscription(asked)?,
            "client" => self.client(asked)?,
            "service" => self.service(asked)?,
            "publish" => self.publish(asked, bytes)?,
            "call" => self.call(asked, bytes)?,
            "forget" => self.forget(asked)?,
            "at_end" => self.keep_for_end(asked, bytes)?,
            "not_at_end" => self.at_end.forget(asked.number("call")?),
            "respond" => self.respond(asked, bytes)?,
            "close" => self.close(asked.number("handle")?),
            _ => {
                return Err(format!(
                    "nothing is known of `{what}`: rafcon and rafcon-ros are of different versions"
                ));
            }
        }
        Ok("null".to_owned())
    }

    fn node(&self) -> Result<&Node, String> {
        self.node.as_ref().ok_or_else(|| "there is no node yet".to_owned())
    }

    fn start(&mut self, asked: &Json) -> Result<(), String> {
        if self.node.is_some() {
            return Err("there is a node already".to_owned());
        }
        self.library =
            settings::library(asked.texts("folders").into_iter().map(PathBuf::from).collect());
        let about = self.library.find(participant::ANNOUNCEMENT)?;
        let (node, reader) = Node::new(settings::of(asked)?, Arc::clone(&about))?;
        tokio::spawn(node.graph().clone().follow(node.participant().clone()));
        tokio::spawn(node.graph().clone().follow_nodes(reader, about));
        tokio::spawn(liveness::watch(node.graph().clone(), node.participant().clone()));
        tokio::spawn(tell::changes(node.clone(), Arc::clone(&self.counts), self.outbox.clone()));
        self.node = Some(node);
        Ok(())
    }

    fn describe(&mut self, name: &str) -> Result<String, String> {
        let endings: &[&str] = match TypeName::parse(name)? {
            TypeName { sort: Sort::Service, name, .. } if !name.contains('_') => {
                &["_Request", "_Response"]
            }
            TypeName { sort: Sort::Action, name, .. } if !name.contains('_') => {
                &["_Goal", "_Result", "_Feedback"]
            }
            _ => &[""],
        };
        let found = endings.iter().map(|ending| self.library.find(&format!("{name}{ending}")));
        let found = found.collect::<Result<Vec<_>, _>>()?;
        Ok(describe::all(&found.iter().map(AsRef::as_ref).collect::<Vec<_>>()))
    }

    fn heard(&self, of: Arc<Type>, name: String) -> Heard {
        Heard { of, name, outbox: self.outbox.clone() }
    }

    /// Starts counting the peers of a new object.
    fn count(&mut self, handle: u64, counted: Counted, made: Made) {
        self.counts.lock().unwrap_or_else(PoisonError::into_inner).insert(handle, (counted, 0));
        self.made.insert(handle, made);
        if let Some(node) = &self.node {
            node.graph().touch();
        }
    }

    fn publisher(&mut self, asked: &Json) -> Result<(), String> {
        let (topic, of, part) = self.topic(asked, false)?;
        let writer = self.node()?.writer(part, of.is_large())?;
        let publisher = Publisher::new(self.node()?.clone(), writer);
        let id = publisher.id;
        let made = Made::Publisher { publisher, of, topic };
        self.count(asked.number("handle")?, Counted::One(id), made);
        Ok(())
    }

    fn subscription(&mut self, asked: &Json) -> Result<(), String> {
        let handle = asked.number("handle")?;
        let (topic, of, part) = self.topic(asked, true)?;
        let reader = self.node()?.reader(part, of.is_large())?;
        let id = reader.guid();
        let task = tokio::spawn(hear::messages(reader, self.heard(of, topic), handle));
        self.count(handle, Counted::One(id), Made::Subscription { id, task });
        Ok(())
    }

    /// The name, the type and the part of a requested topic.
    fn topic(&mut self, asked: &Json, reader: bool) -> Result<(String, Arc<Type>, Part), String> {
        let (topic, type_name) = (asked.text("topic")?, asked.text("type")?);
        names::check(topic)?;
        let of = self.library.find(type_name)?;
        let is = |key: &str| asked.get(key) == Some(&Json::Bool(true));
        let depth = u32::try_from(asked.number("depth")?).unwrap_or(u32::MAX);
        let qos = Qos { reliable: is("reliable"), latched: is("latched"), depth };
        let type_name = names::message_type(type_name)?;
        let part = Part { reader, topic: names::topic(topic), type_name, qos };
        Ok((topic.to_owned(), of, part))
    }

    /// The types and parts of a requested service, for its requests and its responses.
    fn halves(&mut self, asked: &Json, client: bool) -> Result<Halves, String> {
        let (service, type_name) = (asked.text("service")?, asked.text("type")?);
        names::check(service)?;
        let (request, response) = (format!("{type_name}_Request"), format!("{type_name}_Response"));
        let types = [self.library.find(&request)?, self.library.find(&response)?];
        let (requests, responses) = names::service(service);
        let part = |reader, topic, name: &str| {
            Ok::<_, String>(Part {
                reader,
                topic,
                type_name: names::message_type(name)?,
                qos: Qos::SERVICE,
            })
        };
        let parts = [part(!client, requests, &request)?, part(client, responses, &response)?];
        Ok((service.to_owned(), types, parts))
    }

    fn client(&mut self, asked: &Json) -> Result<(), String> {
        let (service, [of, answer], [requests, responses]) = self.halves(asked, true)?;
        let reader = self.node()?.reader(responses, false)?;
        let writer = Arc::new(self.node()?.writer(requests, false)?);
        let (id, calls) = (reader.guid(), Calls::default());
        let listen =
            hear::responses(reader, self.heard(answer, service), writer.guid(), Arc::clone(&calls));
        let (node, outbox) = (self.node()?.clone(), self.outbox.clone());
        let look = hear::servers_gone(node, writer.guid(), Arc::clone(&calls), outbox);
        let counted = Counted::Both(writer.guid(), id);
        let task = tokio::spawn(async {
            futures::future::join(listen, look).await;
        });
        let made = Made::Client { writer, reader: id, of, calls, task };
        self.count(asked.number("handle")?, counted, made);
        Ok(())
    }

    fn service(&mut self, asked: &Json) -> Result<(), String> {
        let handle = asked.number("handle")?;
        let (service, [request, of], [requests, responses]) = self.halves(asked, false)?;
        let writer = Arc::new(self.node()?.writer(responses, false)?);
        let reader = self.node()?.reader(requests, false)?;
        let (id, waiting) = (reader.guid(), Asked::default());
        let listen =
            hear::requests(reader, self.heard(request, service), handle, Arc::clone(&waiting));
        let counted = Counted::Both(writer.guid(), id);
        let made =
            Made::Service { writer, reader: id, of, asked: waiting, task: tokio::spawn(listen) };
        self.count(handle, counted, made);
        Ok(())
    }

    fn publish(&mut self, asked: &Json, bytes: &[u8]) -> Result<(), String> {
        let Some(Made::Publisher { publisher, of, topic }) =
            self.made.get(&asked.number("handle")?)
        else {
            return Ok(());
        };
        let message = encoded(asked, bytes, of).map_err(|why| format!("{topic}: {why}"))?;
        let dropped = publisher.send(message);
        if dropped > 0 {
            self.outbox.say(
                "warning",
                &format!("{topic}: {dropped} messages dropped: a subscriber does not keep up"),
            );
        }
        Ok(())
    }

    fn call(&mut self, asked: &Json, bytes: &[u8]) -> Result<(), String> {
        let call = asked.number("call")?;
        let Some(Made::Client { writer, reader, of, calls, .. }) =
            self.made.get(&asked.number("handle")?)
        else {
            return Ok(());
        };
        let sent = encoded(asked, bytes, of).and_then(|bytes| {
            let servers = self.node()?.graph().peers(writer.guid());
            // The response can arrive before `write` returns.
            let mut calls = calls.lock().unwrap_or_else(PoisonError::into_inner);
            let number = requests::send(writer, *reader, bytes)?;
            calls.insert(number, Call { number: call, servers });
            Ok(())
        });
        if let Err(why) = sent {
            self.outbox.tell(hear::failed(call, &why));
        }
        Ok(())
    }

    /// Keeps a request until the parent program ends, or cancels it.
    fn keep_for_end(&mut self, asked: &Json, bytes: &[u8]) -> Result<(), String> {
        let client = asked.number("handle")?;
        if let Some(Made::Client { writer, reader, of, .. }) = self.made.get(&client) {
            let request = encoded(asked, bytes, of)?;
            let writer = Arc::clone(writer);
            let request = AtEnd { writer, reader: *reader, request };
            if self.at_end.keep(asked.number("call")?, request) {
                self.outbox.say(
                    "warning",
                    "too many goals are open: the oldest one is not cancelled if the run is killed",
                );
            }
        }
        Ok(())
    }

    /// Drops a call whose response is no longer needed.
    fn forget(&mut self, asked: &Json) -> Result<(), String> {
        let call = asked.number("call")?;
        if let Some(Made::Client { calls, .. }) = self.made.get(&asked.number("handle")?) {
            calls
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .retain(|_, waiting| waiting.number != call);
        }
        Ok(())
    }

    fn respond(&mut self, asked: &Json, bytes: &[u8]) -> Result<(), String> {
        let node = self.node()?.clone();
        let Some(Made::Service { writer, of, asked: waiting, .. }) =
            self.made.get(&asked.number("handle")?)
        else {
            return Ok(());
        };
        let number = asked.number("number")?;
        let request = waiting.lock().unwrap_or_else(PoisonError::into_inner).take(number);
        let Some(request) = request else { return Ok(()) };
        let payload = Payload { bytes: encoded(asked, bytes, of)?, little: true };
        let writer = Arc::clone(writer);
        let client = process(request.from);
        let send = move |writer: &Writer| {
            let options = WriteOptionsBuilder::new().source_timestamp(Timestamp::now());
            let options = options.related_sample_identity(request.to).build();
            // A missing client needs no response.
            let _ = writer.write_with_options(payload, options);
        };
        if node.graph().peers(writer.guid()).contains(&client) {
            send(&writer);
            return Ok(());
        }
        self.ending.retain(|ending| !ending.is_finished());
        self.ending.push(tokio::spawn(async move {
            let _ = tokio::time::timeout(CLIENT_KNOWN, known(&node, writer.guid(), client)).await;
            send(&writer);
            arrived(&writer, FAREWELL).await;
        }));
        Ok(())
    }

    fn close(&mut self, handle: u64) {
        self.counts.lock().unwrap_or_else(PoisonError::into_inner).remove(&handle);
        let (Some(made), Some(node)) = (self.made.remove(&handle), self.node.clone()) else {
            return;
        };
        match made {
            Made::Publisher { publisher, .. } => self.ending.push(publisher.end()),
            Made::Subscription { id, task } => {
                task.abort();
                node.forget(id);
            }
            Made::Client { writer, reader, task, .. } => {
                task.abort();
                node.forget(reader);
                self.ending.push(farewell(node, writer));
            }
            Made::Service { writer, reader, task, .. } => {
                task.abort();
                node.forget(reader);
                self.ending.push(farewell(node, writer));
            }
        }
        self.ending.retain(|ending| !ending.is_finished());
    }

    /// Closes everything; returns when that is done.
    pub(crate) fn end(mut self, runtime: &tokio::runtime::Handle) {
        self.at_end.send();
        let handles: Vec<u64> = self.made.keys().copied().collect();
        handles.into_iter().for_each(|handle| self.close(handle));
        runtime.block_on(futures::future::join_all(self.ending));
    }
}

/// Waits until a process is matched with a writer.
async fn known(node: &Node, writer: GUID, client: Process) {
    let mut versions = node.graph().watch();
    while !node.graph().peers(writer).contains(&client) && versions.changed().await.is_ok() {}
}

/// Waits for the acknowledgment of a writer's last messages before it is closed.
fn farewell(node: Node, writer: Arc<Writer>) -> JoinHandle<()> {
    tokio::spawn(async move {
        arrived(&writer, FAREWELL).await;
        node.forget(writer.guid());
    })
}
