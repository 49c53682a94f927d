//! Who is there: which readers and writers match those of this process, which nodes they belong to, and who is dead.

use std::collections::{BTreeMap, BTreeSet};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use futures::StreamExt as _;
use rustdds::no_key::SimpleDataReader;
use rustdds::{DomainParticipant, DomainParticipantStatusEvent, GUID, StatusEvented as _};
use tokio::sync::watch;

use crate::cdr;
use crate::json::{self, Json};
use crate::types::library::Type;

use super::payload::{Payload, Plain};

/// What readers and writers of one process have in common: the first 12 bytes of their ids.
pub(crate) type Process = [u8; 12];

/// The process of a reader or writer.
pub(crate) fn process(of: GUID) -> Process {
    let mut prefix = [0; 12];
    prefix.copy_from_slice(of.prefix.as_ref());
    prefix
}

/// A node: its name, and the ids of its readers and writers.
type NamedNode = (String, BTreeSet<[u8; 16]>);

/// What is known, shared by all that needs it.
#[derive(Clone)]
pub(crate) struct Graph {
    known: Arc<Mutex<Known>>,
    version: watch::Sender<u64>,
}

#[derive(Default)]
struct Known {
    /// Of each reader or writer of this process, those elsewhere that it is matched with.
    matched: BTreeMap<GUID, BTreeSet<GUID>>,
    /// Of each process, its nodes.
    nodes: BTreeMap<Process, Vec<NamedNode>>,
    dead: BTreeSet<Process>,
    /// Those that are there, in the order in which they were found.
    arrived: Vec<Process>,
}

impl Known {
    fn note_arrival(&mut self, of: Process) {
        if !self.arrived.contains(&of) {
            self.arrived.push(of);
        }
    }
}

impl Graph {
    pub(crate) fn new() -> Self {
        Self { known: Arc::default(), version: watch::Sender::new(0) }
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Says that something may have changed.
    pub(crate) fn touch(&self) {
        self.version.send_modify(|version| *version += 1);
    }

    /// Hears when something may have changed.
    pub(crate) fn watch(&self) -> watch::Receiver<u64> {
        self.version.subscribe()
    }

    /// The processes alive that a reader or writer of this process is matched with, one for each match.
    pub(crate) fn peers(&self, of: GUID) -> Vec<Process> {
        let known = self.known();
        let matched = known.matched.get(&of).into_iter().flatten().map(|peer| process(*peer));
        matched.filter(|process| !known.dead.contains(process)).collect()
    }

    /// Whether a process was found to be dead, although its lease has not ended.
    pub(crate) fn is_dead(&self, one: Process) -> bool {
        self.known().dead.contains(&one)
    }

    /// Processes that matter here: something of theirs is matched.
    pub(crate) fn processes(&self) -> BTreeSet<Process> {
        self.known().matched.values().flatten().map(|peer| process(*peer)).collect()
    }

    /// Says whether a process is dead.
    pub(crate) fn set_dead(&self, one: Process, dead: bool) {
        let mut known = self.known();
        let changed = if dead { known.dead.insert(one) } else { known.dead.remove(&one) };
        drop(known);
        if changed {
            self.touch();
        }
    }

    /// Whether a process was found before another one.
    pub(crate) fn came_before(&self, one: Process, other: Process) -> bool {
        let known = self.known();
        let place = |of| known.arrived.iter().position(|it| *it == of);
        place(one).is_some_and(|one| place(other).is_some_and(|other| one < other))
    }

    /// The node of a reader or writer elsewhere, empty if it is not known yet.
    pub(crate) fn node_of(&self, of: GUID) -> String {
        let known = self.known();
        let nodes = known.nodes.get(&process(of)).into_iter().flatten();
        let found = nodes.into_iter().find(|(_, parts)| parts.contains(&of.to_bytes()));
        found.map(|(name, _)| name.clone()).unwrap_or_default()
    }

    /// The names of all nodes elsewhere.
    pub(crate) fn nodes(&self) -> Vec<String> {
        let known = self.known();
        let alive = known.nodes.iter().filter(|(process, _)| !known.dead.contains(*process));
        alive.flat_map(|(_, nodes)| nodes.iter().map(|(name, _)| name.clone())).collect()
    }

    fn note(&self, event: DomainParticipantStatusEvent) {
        use DomainParticipantStatusEvent as Event;
        let mut known = self.known();
        match event {
            Event::ParticipantDiscovered { dpd } => {
                known.note_arrival(process(dpd.guid));
            }
            Event::RemoteReaderMatched { local_writer: own, remote_reader: peer }
            | Event::RemoteWriterMatched { local_reader: own, remote_writer: peer } => {
                known.note_arrival(process(peer));
                known.matched.entry(own).or_default().insert(peer);
            }
            Event::ReaderLost { guid, .. } | Event::WriterLost { guid, .. } => {
                known.matched.remove(&guid);
                known.matched.values_mut().for_each(|peers| {
                    peers.remove(&guid);
                });
            }
            Event::ParticipantLost { id, .. } => {
                let mut gone = [0; 12];
                gone.copy_from_slice(id.as_ref());
                known.nodes.remove(&gone);
                known.dead.remove(&gone);
                known.arrived.retain(|it| *it != gone);
                known
                    .matched
                    .values_mut()
                    .for_each(|peers| peers.retain(|peer| process(*peer) != gone));
            }
            _ => {}
        }
        drop(known);
        self.touch();
    }

    /// Takes what the middleware says about others, for ever.
    pub(crate) async fn follow(self, participant: DomainParticipant) {
        let listener = participant.status_listener();
        let mut events = listener.as_async_status_stream();
        while let Some(event) = events.next().await {
            self.note(event);
        }
    }

    /// Takes what other processes say about their nodes, for ever.
    pub(crate) async fn follow_nodes(
        self,
        reader: SimpleDataReader<Payload, Plain>,
        about: Arc<Type>,
    ) {
        let stream = reader.as_async_stream();
        tokio::pin!(stream);
        while let Some(told) = stream.next().await {
            let Ok(told) = told else { continue };
            let from = process(told.writer_guid());
            let payload = told.into_value();
            let mut decoded = cdr::read::Decoded::default();
            if cdr::read::read(&payload.bytes, payload.little, &about, &mut decoded).is_ok()
                && let Ok(told) = json::parse(decoded.text.as_bytes())
            {
                let nodes = nodes(&told, &decoded.arrays);
                self.known().nodes.insert(from, nodes);
                self.touch();
            }
        }
    }
}

/// The nodes in a message of `rmw_dds_common/msg/ParticipantEntitiesInfo`.
fn nodes(told: &Json, arrays: &[u8]) -> Vec<NamedNode> {
    let Some(Json::List(nodes)) = told.get("node_entities_info_seq") else { return Vec::new() };
    let id = |gid: &Json| match gid.get("data") {
        Some(Json::Array { start, bytes, .. }) => {
            arrays.get(*start..start + bytes)?.try_into().ok()
        }
        _ => None,
    };
    let ids = |node: &Json, key: &str| match node.get(key) {
        Some(Json::List(gids)) => gids.iter().filter_map(id).collect::<Vec<[u8; 16]>>(),
        _ => Vec::new(),
    };
    let node = |node: &Json| {
        let namespace = node.text("node_namespace").ok()?.trim_end_matches('/');
        let name = format!("{namespace}/{}", node.text("node_name").ok()?);
        let parts =
            ids(node, "reader_gid_seq").into_iter().chain(ids(node, "writer_gid_seq")).collect();
        Some((name, parts))
    };
    nodes.iter().filter_map(node).collect()
}

/// Where the readers and writers of each process elsewhere listen.
pub(crate) fn addresses(
    participant: &DomainParticipant,
) -> BTreeMap<Process, BTreeSet<SocketAddr>> {
    let mut found: BTreeMap<Process, BTreeSet<SocketAddr>> = BTreeMap::new();
    for reader in participant.discovered_readers() {
        let proxy = reader.reader_proxy;
        let known = found.entry(process(proxy.remote_reader_guid)).or_default();
        known.extend(
            proxy.unicast_locator_list.into_iter().filter(|at| at.is_udp()).map(SocketAddr::from),
        );
    }
    for writer in participant.discovered_writers() {
        let proxy = writer.writer_proxy;
        let known = found.entry(process(proxy.remote_writer_guid)).or_default();
        known.extend(
            proxy.unicast_locator_list.into_iter().filter(|at| at.is_udp()).map(SocketAddr::from),
        );
    }
    found
}
