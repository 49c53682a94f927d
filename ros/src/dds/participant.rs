//! The node of this process: one DDS participant, its readers and writers, and their announcement to other nodes.

use std::collections::BTreeMap;
use std::net::{IpAddr, Ipv4Addr};
use std::sync::{Arc, Mutex, PoisonError};

use rustdds::bytes::Bytes;
use rustdds::no_key::{DataWriter, SimpleDataReader};
use rustdds::policy::History;
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, GUID, Publisher, QosPolicyBuilder,
    RTPSEntity as _, Subscriber, Timestamp, Topic, TopicKind,
};

use crate::cdr;
use crate::json::Json;
use crate::types::library::Type;

use super::graph::Graph;
use super::names;
use super::payload::{Payload, Plain};
use super::qos::Qos;

/// Reads messages as bytes.
pub(crate) type Reader = SimpleDataReader<Payload, Plain>;
/// Writes messages as bytes.
pub(crate) type Writer = DataWriter<Payload, Plain>;

/// Name and visibility of the node.
pub(crate) struct Settings {
    pub(crate) name: String,
    pub(crate) namespace: String,
    pub(crate) domain: u16,
    /// True to see only processes of this computer.
    pub(crate) local: bool,
}

/// A reader or writer of this process.
#[derive(Clone)]
pub(crate) struct Part {
    pub(crate) reader: bool,
    pub(crate) topic: String,
    pub(crate) type_name: String,
    pub(crate) qos: Qos,
}

#[derive(Clone)]
pub(crate) struct Node {
    inner: Arc<Inner>,
}

struct Inner {
    settings: Settings,
    participant: DomainParticipant,
    publisher: Publisher,
    subscriber: Subscriber,
    graph: Graph,
    parts: Mutex<BTreeMap<GUID, Part>>,
    about: Arc<Type>,
    announcements: Writer,
}

/// The DDS topic on which processes announce their nodes.
const ANNOUNCEMENTS: &str = "ros_discovery_info";
/// The ROS type of announcements.
pub(crate) const ANNOUNCEMENT: &str = "rmw_dds_common/msg/ParticipantEntitiesInfo";

impl Node {
    /// Creates the node; `about` is the type of [`ANNOUNCEMENT`].
    pub(crate) fn new(settings: Settings, about: Arc<Type>) -> Result<(Self, Reader), String> {
        let no = |what: &str, why: &dyn std::fmt::Display| {
            format!("cannot {what} in domain {}: {why}", settings.domain)
        };
        let mut builder = DomainParticipantBuilder::new(settings.domain);
        if settings.local {
            builder = builder.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]);
        }
        let participant = builder.build().map_err(|why| no("take part", &why))?;
        let plain = QosPolicyBuilder::new().build();
        let publisher = participant.create_publisher(&plain).map_err(|why| no("publish", &why))?;
        let subscriber =
            participant.create_subscriber(&plain).map_err(|why| no("subscribe", &why))?;
        let qos = Qos { reliable: true, latched: true, depth: 1 }.policies(false);
        let type_name = names::message_type(ANNOUNCEMENT)?;
        let topic = topic(&participant, ANNOUNCEMENTS, &type_name)?;
        let graph = Graph::new();
        let announcements: Writer = graph
            .make(|| publisher.create_datawriter_no_key(&topic, Some(qos.clone())))
            .map_err(|why| no("publish", &why))?;
        let reader: Reader = graph
            .make(|| {
                subscriber.create_simple_datareader_no_key(&topic, Some(qos.modify_by(&every())))
            })
            .map_err(|why| no("subscribe", &why))?;
        let parts = Mutex::default();
        let inner = Inner {
            settings,
            participant,
            publisher,
            subscriber,
            graph,
            parts,
            about,
            announcements,
        };
        let node = Self { inner: Arc::new(inner) };
        node.announce();
        Ok((node, reader))
    }

    pub(crate) fn graph(&self) -> &Graph {
        &self.inner.graph
    }

    pub(crate) fn participant(&self) -> &DomainParticipant {
        &self.inner.participant
    }

    /// Namespace and name, joined by `/`.
    pub(crate) fn name(&self) -> String {
        format!(
            "{}/{}",
            self.inner.settings.namespace.trim_end_matches('/'),
            self.inner.settings.name
        )
    }

    /// The readers and writers of the node.
    pub(crate) fn parts(&self) -> Vec<Part> {
        self.inner.parts.lock().unwrap_or_else(PoisonError::into_inner).values().cloned().collect()
    }

    /// Creates a reader of a DDS topic. `large`: see [`Qos::policies`].
    pub(crate) fn reader(&self, part: Part, large: bool) -> Result<Reader, String> {
        self.check(&part)?;
        let topic = topic(&self.inner.participant, &part.topic, &part.type_name)?;
        let qos = part.qos.policies(large);
        let subscriber = &self.inner.subscriber;
        let make = || subscriber.create_simple_datareader_no_key(&topic, Some(qos));
        let reader: Reader =
            self.graph().make(make).map_err(|why| format!("cannot read {}: {why}", part.topic))?;
        self.add(reader.guid(), part);
        Ok(reader)
    }

    /// Creates a writer of a DDS topic.
    pub(crate) fn writer(&self, part: Part, large: bool) -> Result<Writer, String> {
        self.check(&part)?;
        let topic = topic(&self.inner.participant, &part.topic, &part.type_name)?;
        let (publisher, qos) = (&self.inner.publisher, part.qos.policies(large));
        let make = || publisher.create_datawriter_no_key(&topic, Some(qos));
        let writer: Writer =
            self.graph().make(make).map_err(|why| format!("cannot write {}: {why}", part.topic))?;
        self.add(writer.guid(), part);
        Ok(writer)
    }

    /// Checks that a topic has only one type in this process.
    fn check(&self, part: &Part) -> Result<(), String> {
        let other = self
            .parts()
            .into_iter()
            .find(|other| other.topic == part.topic && other.type_name != part.type_name);
        let plain = |name: &str| names::plain_type(name).unwrap_or_else(|| name.to_owned());
        let Some(other) = other else { return Ok(()) };
        let (what, wanted) = (if part.reader { "hear" } else { "publish" }, plain(&part.type_name));
        let topic = names::plain_topic(&part.topic).unwrap_or(&part.topic);
        let other = plain(&other.type_name);
        Err(format!("cannot {what} {wanted} on {topic}: this run uses it as {other} already"))
    }

    fn add(&self, id: GUID, part: Part) {
        self.inner.parts.lock().unwrap_or_else(PoisonError::into_inner).insert(id, part);
        self.announce();
    }

    /// Removes a reader or writer.
    pub(crate) fn forget(&self, id: GUID) {
        self.inner.parts.lock().unwrap_or_else(PoisonError::into_inner).remove(&id);
        self.inner.graph.forget(id);
        self.announce();
    }

    /// Announces the readers and writers of this node to other processes.
    fn announce(&self) {
        let parts = self.inner.parts.lock().unwrap_or_else(PoisonError::into_inner);
        let mut bytes = Vec::new();
        let mut gid = |id: GUID| {
            let start = bytes.len();
            bytes.extend_from_slice(&id.to_bytes());
            Json::Map(vec![("data".to_owned(), Json::Array { code: 'B', start, bytes: 16 })])
        };
        let own = gid(self.inner.participant.guid());
        let mut gids = |reader: bool| {
            Json::List(
                parts
                    .iter()
                    .filter(|(_, part)| part.reader == reader)
                    .map(|(id, _)| gid(*id))
                    .collect(),
            )
        };
        let node = Json::Map(vec![
            ("node_namespace".to_owned(), Json::Text(self.inner.settings.namespace.clone())),
            ("node_name".to_owned(), Json::Text(self.inner.settings.name.clone())),
            ("reader_gid_seq".to_owned(), gids(true)),
            ("writer_gid_seq".to_owned(), gids(false)),
        ]);
        let nodes = Json::List(vec![node]);
        let told =
            Json::Map(vec![("gid".to_owned(), own), ("node_entities_info_seq".to_owned(), nodes)]);
        if let Ok(told) = cdr::write::write(&told, &bytes, &self.inner.about) {
            let payload = Payload { bytes: Bytes::from(told), little: true };
            // On failure, others know the node's topics but not its name.
            let _ = self.inner.announcements.write(payload, Some(Timestamp::now()));
        }
    }
}

/// Keeps simultaneous announcements of many processes.
fn every() -> rustdds::QosPolicies {
    QosPolicyBuilder::new().history(History::KeepAll).build()
}

fn topic(participant: &DomainParticipant, name: &str, type_name: &str) -> Result<Topic, String> {
    let plain = QosPolicyBuilder::new().build();
    let made =
        participant.create_topic(name.to_owned(), type_name.to_owned(), &plain, TopicKind::NoKey);
    made.map_err(|why| format!("cannot make the topic {name}: {why}"))
}
