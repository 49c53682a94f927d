//! The graph: matches between the readers and writers of this process and of others, their nodes, and dead processes.

use std::collections::{BTreeMap, BTreeSet};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use futures::StreamExt as _;
use rustdds::no_key::SimpleDataReader;
use rustdds::{
    DomainParticipant, DomainParticipantStatusEvent, GUID, RTPSEntity, StatusEvented as _,
};
use tokio::sync::watch;

use crate::cdr;
use crate::json::{self, Json};
use crate::types::library::Type;

use super::payload::{Payload, Plain};

/// Maximum number of processes with nodes but without a report of the middleware, which may come later.
const UNREPORTED_MAX: usize = 64;

/// Common prefix of the ids of a process's readers and writers: the first 12 bytes.
pub(crate) type Process = [u8; 12];

/// The process of a reader or writer.
pub(crate) fn process(of: GUID) -> Process {
    let mut prefix = [0; 12];
    prefix.copy_from_slice(of.prefix.as_ref());
    prefix
}

/// A node: its name, and the ids of its readers and writers.
type NamedNode = (String, BTreeSet<[u8; 16]>);

/// The known graph, shared by its users.
#[derive(Clone)]
pub(crate) struct Graph {
    known: Arc<Mutex<Known>>,
    version: watch::Sender<u64>,
}

#[derive(Default)]
struct Known {
    /// Matched peers of each open reader and writer of this process.
    matched: BTreeMap<GUID, BTreeSet<GUID>>,
    /// Nodes of each process.
    nodes: BTreeMap<Process, Vec<NamedNode>>,
    dead: BTreeSet<Process>,
    /// Known processes in the order of their discovery.
    arrived: Vec<Process>,
}

impl Known {
    fn note_arrival(&mut self, of: Process) {
        if !self.arrived.contains(&of) {
            self.arrived.push(of);
        }
    }

    /// Adds a match. Ignores late reports about closed readers and writers.
    fn note_match(&mut self, own: GUID, peer: GUID) {
        self.note_arrival(process(peer));
        if let Some(peers) = self.matched.get_mut(&own) {
            peers.insert(peer);
        }
    }

    /// Sets the nodes of a process. If too many processes are unreported, the one with the lowest id is dropped.
    fn note_nodes(&mut self, of: Process, nodes: Vec<NamedNode>) {
        self.nodes.insert(of, nodes);
        if self.arrived.contains(&of) {
            return;
        }
        let unreported = |known: &&Process| !self.arrived.contains(known) && **known != of;
        let others: Vec<Process> = self.nodes.keys().filter(unreported).copied().collect();
        if let Some(first) = others.first().filter(|_| others.len() >= UNREPORTED_MAX) {
            self.nodes.remove(first);
        }
    }

    fn note_loss(&mut self, gone: Process) {
        self.nodes.remove(&gone);
        self.dead.remove(&gone);
        self.arrived.retain(|it| *it != gone);
        self.matched.values_mut().for_each(|peers| peers.retain(|peer| process(*peer) != gone));
    }
}

impl Graph {
    pub(crate) fn new() -> Self {
        Self { known: Arc::default(), version: watch::Sender::new(0) }
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Creates a reader or writer of this process. All reports of its matches follow later.
    pub(crate) fn make<T: RTPSEntity, E>(
        &self,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let mut known = self.known();
        let made = make()?;
        known.matched.entry(made.guid()).or_default();
        Ok(made)
    }

    /// Removes a closed reader or writer of this process.
    pub(crate) fn forget(&self, own: GUID) {
        self.known().matched.remove(&own);
    }

    /// Announces a possible change.
    pub(crate) fn touch(&self) {
        self.version.send_modify(|version| *version += 1);
    }

    /// A receiver of possible changes.
    pub(crate) fn watch(&self) -> watch::Receiver<u64> {
        self.version.subscribe()
    }

    /// Live processes matched with a reader or writer of this process, one entry per match.
    pub(crate) fn peers(&self, of: GUID) -> Vec<Process> {
        let known = self.known();
        let matched = known.matched.get(&of).into_iter().flatten().map(|peer| process(*peer));
        matched.filter(|process| !known.dead.contains(process)).collect()
    }

    /// True if a process was found dead before the end of its lease.
    pub(crate) fn is_dead(&self, one: Process) -> bool {
        self.known().dead.contains(&one)
    }

    /// Processes with at least one match.
    pub(crate) fn processes(&self) -> BTreeSet<Process> {
        self.known().matched.values().flatten().map(|peer| process(*peer)).collect()
    }

    /// Marks a process as dead or alive.
    pub(crate) fn set_dead(&self, one: Process, dead: bool) {
        let mut known = self.known();
        // A process lost in the meantime is unknown.
        let is_dead = dead && known.arrived.contains(&one);
        let changed = if is_dead { known.dead.insert(one) } else { known.dead.remove(&one) };
        drop(known);
        if changed {
            self.touch();
        }
    }

    /// True if a process was discovered before another one.
    pub(crate) fn came_before(&self, one: Process, other: Process) -> bool {
        let known = self.known();
        let place = |of| known.arrived.iter().position(|it| *it == of);
        place(one).is_some_and(|one| place(other).is_some_and(|other| one < other))
    }

    /// The node of a remote reader or writer; empty if unknown.
    pub(crate) fn node_of(&self, of: GUID) -> String {
        let known = self.known();
        let nodes = known.nodes.get(&process(of)).into_iter().flatten();
        let found = nodes.into_iter().find(|(_, parts)| parts.contains(&of.to_bytes()));
        found.map(|(name, _)| name.clone()).unwrap_or_default()
    }

    /// Names of all remote nodes.
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
                known.note_match(own, peer);
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
                known.note_loss(gone);
            }
            _ => {}
        }
        drop(known);
        self.touch();
    }

    /// Follows the reports of the middleware about other processes, forever.
    pub(crate) async fn follow(self, participant: DomainParticipant) {
        let listener = participant.status_listener();
        let mut events = listener.as_async_status_stream();
        while let Some(event) = events.next().await {
            self.note(event);
        }
    }

    /// Follows the announcements of nodes by other processes, forever.
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
                self.known().note_nodes(from, nodes);
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

/// Addresses of the readers and writers of each remote process.
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

#[cfg(test)]
mod tests {
    use rustdds::{DomainParticipantStatusEvent as Event, GUID};

    use super::{Graph, Process, UNREPORTED_MAX, process};

    /// The reader or writer with this number in the process with this number.
    fn id(process: u16, number: u8) -> GUID {
        let mut bytes = [0; 16];
        bytes[..2].copy_from_slice(&process.to_be_bytes());
        bytes[15] = number;
        GUID::from_bytes(bytes)
    }

    struct Made(GUID);

    impl rustdds::RTPSEntity for Made {
        fn guid(&self) -> GUID {
            self.0
        }
    }

    const OWN: u16 = 0;

    fn graph_with(own: GUID) -> Graph {
        let graph = Graph::new();
        graph.make(|| Ok::<_, ()>(Made(own))).unwrap();
        graph
    }

    fn matched(graph: &Graph, own: GUID, peer: GUID) {
        graph.note(Event::RemoteReaderMatched { local_writer: own, remote_reader: peer });
    }

    fn lost(graph: &Graph, one: GUID) {
        let elapsed = rustdds::Duration::from_secs(20);
        let reason = rustdds::LostReason::Timeout { lease: elapsed, elapsed };
        graph.note(Event::ParticipantLost { id: one.prefix, reason });
    }

    /// Numbers of entries: own readers and writers, processes with nodes, dead processes, discovered processes.
    fn kept(graph: &Graph) -> [usize; 4] {
        let known = graph.known();
        [known.matched.len(), known.nodes.len(), known.dead.len(), known.arrived.len()]
    }

    #[test]
    fn a_writer_is_known_until_it_is_given_back_and_late_reports_are_ignored() {
        let (own, peer) = (id(OWN, 1), id(7, 1));
        let graph = graph_with(own);
        matched(&graph, own, peer);
        assert_eq!(graph.peers(own), [process(peer)]);
        graph.forget(own);
        matched(&graph, own, peer);
        assert_eq!((graph.peers(own), graph.processes().len()), (Vec::new(), 0));
        assert_eq!(kept(&graph), [0, 0, 0, 1]);
    }

    #[test]
    fn nothing_is_kept_of_a_process_that_is_lost() {
        let (own, peer) = (id(OWN, 1), id(7, 1));
        let graph = graph_with(own);
        matched(&graph, own, peer);
        graph
            .known()
            .note_nodes(process(peer), vec![("/peer".to_owned(), [peer.to_bytes()].into())]);
        graph.set_dead(process(peer), true);
        assert_eq!((kept(&graph), graph.node_of(peer)), ([1, 1, 1, 1], "/peer".to_owned()));
        lost(&graph, peer);
        // The liveness check had probed it before.
        graph.set_dead(process(peer), true);
        assert_eq!((kept(&graph), graph.peers(own)), ([1, 0, 0, 0], Vec::new()));
    }

    #[test]
    fn of_too_many_processes_that_are_not_reported_the_first_is_forgotten() {
        let own = id(OWN, 1);
        let graph = graph_with(own);
        let nodes = |number: u16| {
            let one: Process = process(id(number, 1));
            graph.known().note_nodes(one, vec![(format!("/{number}"), [].into())]);
        };
        matched(&graph, own, id(1, 1));
        let most = u16::try_from(UNREPORTED_MAX).unwrap();
        (1..=most + 1).for_each(nodes);
        assert_eq!(kept(&graph), [1, UNREPORTED_MAX + 1, 0, 1]);
        nodes(most + 2);
        assert_eq!(kept(&graph), [1, UNREPORTED_MAX + 1, 0, 1]);
        let names = graph.nodes();
        assert_eq!(names[..2], ["/1", "/3"]);
        assert_eq!(names.last(), Some(&format!("/{}", most + 2)));
        // A process that is reported later no longer counts.
        matched(&graph, own, id(3, 1));
        nodes(most + 3);
        assert_eq!(kept(&graph)[1], UNREPORTED_MAX + 2);
    }
}
