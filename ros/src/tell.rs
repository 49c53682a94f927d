//! Reports of the network's graph to the parent program: complete on request, and changes as they happen.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rustdds::GUID;

use crate::dds::graph::{Process, process};
use crate::dds::names;
use crate::dds::participant::Node;
use crate::dds::qos::Qos;
use crate::frames::Outbox;
use crate::json;

/// Time for which changes are collected before a report.
const COLLECT: Duration = Duration::from_millis(10);

/// The kind of a count of peers.
#[derive(Clone, Copy)]
pub(crate) enum Counted {
    /// All that match a reader or writer.
    One(GUID),
    /// Processes that match both of them.
    Both(GUID, GUID),
}

/// Requested counts, with the last reported value.
pub(crate) type Counts = Arc<Mutex<BTreeMap<u64, (Counted, usize)>>>;

/// Reports each changed count, and the fact of a change, forever.
pub(crate) async fn changes(node: Node, counts: Counts, outbox: Outbox) {
    let mut versions = node.graph().watch();
    loop {
        tell_counts(&node, &counts, &outbox);
        outbox.tell(r#"{"changed":true}"#.to_owned());
        if versions.changed().await.is_err() {
            return;
        }
        tokio::time::sleep(COLLECT).await;
        versions.mark_unchanged();
    }
}

/// Reports the counts that have changed.
pub(crate) fn tell_counts(node: &Node, counts: &Counts, outbox: &Outbox) {
    let mut counts = counts.lock().unwrap_or_else(PoisonError::into_inner);
    for (handle, (counted, told)) in counts.iter_mut() {
        let now = count(node, *counted);
        if now != *told {
            *told = now;
            outbox.tell(format!(r#"{{"matched":{handle},"count":{now}}}"#));
        }
    }
}

fn count(node: &Node, counted: Counted) -> usize {
    let graph = node.graph();
    match counted {
        Counted::One(id) => graph.peers(id).len(),
        Counted::Both(one, other) => {
            let mut both: Vec<Process> = graph.peers(one);
            let others = graph.peers(other);
            both.retain(|process| others.contains(process));
            both.sort_unstable();
            both.dedup();
            both.len()
        }
    }
}

/// The complete graph:
/// `{"ends": [[topic, reader, node, type, reliable, latched]], "services": {name: [type]}, "nodes": [name]}`.
pub(crate) fn graph(node: &Node) -> String {
    let mut ends = Vec::new();
    let mut services: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut end = |topic: &str, reader: bool, name: &str, type_name: &str, qos: Qos| {
        if let (Some(topic), Some(type_name)) =
            (names::plain_topic(topic), names::plain_type(type_name))
        {
            let (topic, name, type_name) =
                (json::quoted(topic), json::quoted(name), json::quoted(&type_name));
            ends.push(format!(
                "[{topic},{reader},{name},{type_name},{},{}]",
                qos.reliable, qos.latched
            ));
        } else if reader && let Some((service, type_name)) = names::plain_service(topic, type_name)
        {
            let types = services.entry(service).or_default();
            if !types.contains(&type_name) {
                types.push(type_name);
            }
        }
    };
    let own = node.name();
    for part in node.parts() {
        end(&part.topic, part.reader, &own, &part.type_name, part.qos);
    }
    let own_process = process(rustdds::RTPSEntity::guid(node.participant()));
    let elsewhere = |id: GUID| process(id) != own_process && !node.graph().is_dead(process(id));
    for reader in node.participant().discovered_readers() {
        let (id, about) = (reader.reader_proxy.remote_reader_guid, &reader.subscription_topic_data);
        if elsewhere(id) {
            let policies = about.qos();
            let qos = Qos::of(policies.reliability(), policies.durability(), true);
            end(about.topic_name(), true, &node.graph().node_of(id), about.type_name(), qos);
        }
    }
    for writer in node.participant().discovered_writers() {
        let (id, about) = (writer.writer_proxy.remote_writer_guid, &writer.publication_topic_data);
        if elsewhere(id) {
            let qos = Qos::of(about.reliability, about.durability, false);
            end(&about.topic_name, false, &node.graph().node_of(id), &about.type_name, qos);
        }
    }
    let mut nodes = node.graph().nodes();
    nodes.push(own);
    nodes.sort_unstable();
    nodes.dedup();
    let quoted = |texts: &[String]| {
        texts.iter().map(|text| json::quoted(text)).collect::<Vec<_>>().join(",")
    };
    let service = |(name, types): (&String, &Vec<String>)| {
        format!("{}:[{}]", json::quoted(name), quoted(types))
    };
    let services: Vec<String> = services.iter().map(service).collect();
    let (ends, services, nodes) = (ends.join(","), services.join(","), quoted(&nodes));
    format!(r#"{{"ends":[{ends}],"services":{{{services}}},"nodes":[{nodes}]}}"#)
}

/// Remote users of messages: `[[type, hash, node]]`. Messages of services are requests and responses.
pub(crate) fn users(node: &Node, types: &[String]) -> String {
    let mut found = Vec::new();
    let mut user = |id: GUID, type_name: &str, user_data: &[u8]| {
        let name_of_node = node.graph().node_of(id);
        if let (Some(name), Some(hash)) = (names::plain_type(type_name), type_hash(user_data))
            && types.contains(&name)
            && !name_of_node.is_empty()
            && !node.graph().is_dead(process(id))
        {
            let texts = [&name, &hash, &name_of_node].map(|text| json::quoted(text));
            found.push(format!("[{}]", texts.join(",")));
        }
    };
    for reader in node.participant().discovered_readers() {
        let about = &reader.subscription_topic_data;
        let id = reader.reader_proxy.remote_reader_guid;
        user(id, about.type_name(), &reader.user_data);
    }
    for writer in node.participant().discovered_writers() {
        let about = &writer.publication_topic_data;
        let id = writer.writer_proxy.remote_writer_guid;
        user(id, &about.type_name, &writer.user_data);
    }
    found.sort_unstable();
    found.dedup();
    format!("[{}]", found.join(","))
}

/// The type hash in the user data of a remote reader or writer: `typehash=RIHS01_…;`, after its length.
fn type_hash(user_data: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(user_data.get(4..)?).ok()?;
    let found = text.split(';').find_map(|entry| entry.strip_prefix("typehash="));
    found.filter(|hash| hash.starts_with("RIHS01_")).map(ToOwned::to_owned)
}

#[cfg(test)]
mod tests {
    use super::type_hash;

    #[test]
    fn a_hash_is_found_in_user_data() {
        assert_eq!(type_hash(b"\x13\0\0\0typehash=RIHS01_ab;\0"), Some("RIHS01_ab".to_owned()));
        assert_eq!(
            type_hash(b"\x13\0\0\0other=1;typehash=RIHS01_ab;"),
            Some("RIHS01_ab".to_owned())
        );
        for other in [&b""[..], b"\0\0", b"\x05\0\0\0hello", b"\x02\0\0\0\xff\xff"] {
            assert_eq!(type_hash(other), None);
        }
    }
}
