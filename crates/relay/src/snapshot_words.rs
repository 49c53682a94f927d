//! Snapshots of runs as they travel. Of active states the time of their entry is sent, which stays as it is, in the place of the time
//! since: so snapshots that follow one another are alike, and need few bytes.

use rafcon_protocol::Snapshot;

/// Parses a snapshot taken `ago_ms` ms ago, and advances its clock.
pub(crate) fn write(snapshot: &Snapshot, ago_ms: u64) -> Option<Vec<u8>> {
    let turned = turn(snapshot.clone());
    let elapsed_ms = snapshot.elapsed_ms.saturating_add(ago_ms);
    serde_json::to_vec(&Snapshot { elapsed_ms, ..turned }).ok()
}

/// Parses the snapshot in these bytes. `None` if they contain none.
pub(crate) fn read(bytes: &[u8]) -> Option<Snapshot> {
    serde_json::from_slice(bytes).ok().map(turn)
}

/// From times since the entry to times of the entry, or back.
fn turn(mut snapshot: Snapshot) -> Snapshot {
    for active in &mut snapshot.active {
        active.since_ms = snapshot.elapsed_ms.saturating_sub(active.since_ms);
    }
    snapshot
}

#[cfg(test)]
mod tests {
    use super::{read, write};
    use rafcon_protocol::Snapshot;
    use serde_json::json;

    #[test]
    fn time_goes_on_for_all_that_is_active_until_a_snapshot_is_sent() {
        let active = |since_ms: u64| json!([{"path": "A", "name": "a", "phase": "running", "since_ms": since_ms}]);
        let snapshot = |elapsed_ms: u64, active: serde_json::Value| -> Snapshot {
            serde_json::from_value(json!({
                "status": "running", "active": active, "states_run": 1, "elapsed_ms": elapsed_ms
            }))
            .expect("a snapshot")
        };
        let told = snapshot(5_000, active(1_200));
        let sent = [0, 300].map(|ago_ms| write(&told, ago_ms).expect("bytes"));
        let shown = sent.map(|bytes| read(&bytes).expect("a snapshot"));
        assert_eq!(shown, [told, snapshot(5_300, active(1_500))]);
    }
}
