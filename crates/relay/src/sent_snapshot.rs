//! Snapshots of runs as they are sent. Snapshots that follow one another are alike and short: an active state has the time of its entry
//! in place of its duration, and only the part of its path that differs from the path before it.

use rafcon_link::LENGTH_MAX;
use rafcon_protocol::{ActiveState, Breakpoint, Hold, Phase, Question, RunStatus, Snapshot};
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
struct SentSnapshot {
    status: RunStatus,
    active: Vec<SentState>,
    states_run: u64,
    elapsed_ms: u64,
    sequence: u64,
    disk_safe: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    journal_problem: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    breakpoints: Vec<Breakpoint>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    questions: Vec<Question>,
}

/// An active state: the number of bytes of the path before it that begin its path, the rest of its path, its name, the time of its entry
/// since the start of the run in ms, the number of bytes of its path that are its branch, and further fields.
#[derive(Serialize, Deserialize)]
struct SentState(usize, String, String, u64, usize, Option<Box<Further>>);

/// Fields of an active state that are rarely set.
#[derive(Serialize, Deserialize)]
struct Further {
    phase: Phase,
    /// A branch that does not begin the path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    branch: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    detail: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    held: Vec<Hold>,
}

/// Encodes a snapshot taken `ago_ms` ms ago, and advances its clock.
pub(crate) fn write(snapshot: &Snapshot, ago_ms: u64) -> Option<Vec<u8>> {
    let mut before = "";
    let mut active = Vec::with_capacity(snapshot.active.len());
    for state in &snapshot.active {
        active.push(sent_state(state, before, snapshot.elapsed_ms));
        before = &state.path;
    }
    let Snapshot { status, states_run, sequence, disk_safe, .. } = *snapshot;
    let sent = SentSnapshot {
        status,
        active,
        states_run,
        elapsed_ms: snapshot.elapsed_ms.saturating_add(ago_ms),
        sequence,
        disk_safe,
        journal_problem: snapshot.journal_problem.clone(),
        breakpoints: snapshot.breakpoints.clone(),
        questions: snapshot.questions.clone(),
    };
    serde_json::to_vec(&sent).ok()
}

fn sent_state(state: &ActiveState, before: &str, elapsed_ms: u64) -> SentState {
    let ActiveState { path, name, phase, since_ms, branch, detail, held } = state;
    let same = path.char_indices().zip(before.chars()).find(|((_, one), other)| one != other);
    let same = same.map_or(path.len().min(before.len()), |((place, _), _)| place);
    let begins = path.starts_with(branch.as_str());
    let is_usual = begins && *phase == Phase::Running && detail.is_none() && held.is_empty();
    let further = || Further {
        phase: *phase,
        branch: (!begins).then(|| branch.clone()),
        detail: detail.clone(),
        held: held.clone(),
    };
    SentState(
        same,
        path[same..].to_owned(),
        name.clone(),
        elapsed_ms.saturating_sub(*since_ms),
        if begins { branch.len() } else { 0 },
        (!is_usual).then(|| Box::new(further())),
    )
}

/// Decodes a snapshot. `None` if the bytes contain none, or paths of more than 16 MiB together.
pub(crate) fn read(bytes: &[u8]) -> Option<Snapshot> {
    let sent: SentSnapshot = serde_json::from_slice(bytes).ok()?;
    let mut active: Vec<ActiveState> = Vec::with_capacity(sent.active.len());
    let mut left = LENGTH_MAX as usize;
    for state in sent.active {
        let before = active.last().map_or("", |state| state.path.as_str());
        let state = active_state(state, before, sent.elapsed_ms, left)?;
        left -= state.path.len() + state.branch.len();
        active.push(state);
    }
    Some(Snapshot {
        status: sent.status,
        active,
        states_run: sent.states_run,
        elapsed_ms: sent.elapsed_ms,
        sequence: sent.sequence,
        disk_safe: sent.disk_safe,
        journal_problem: sent.journal_problem,
        breakpoints: sent.breakpoints,
        questions: sent.questions,
    })
}

/// `None` if path and branch are longer than `bytes_max` together.
fn active_state(
    SentState(same, rest, name, entered_ms, branch, further): SentState,
    before: &str,
    elapsed_ms: u64,
    bytes_max: usize,
) -> Option<ActiveState> {
    let same = before.get(..same)?;
    if same.len() + rest.len() + branch > bytes_max {
        return None;
    }
    let path = [same, &rest].concat();
    let branch = path.get(..branch)?.to_owned();
    let since_ms = elapsed_ms.saturating_sub(entered_ms);
    let Some(further) = further else {
        let (phase, detail, held) = (Phase::Running, None, Vec::new());
        return Some(ActiveState { path, name, phase, since_ms, branch, detail, held });
    };
    let Further { phase, branch: other, detail, held } = *further;
    let branch = other.unwrap_or(branch);
    Some(ActiveState { path, name, phase, since_ms, branch, detail, held })
}

#[cfg(test)]
mod tests {
    use super::{read, write};
    use rafcon_link::LENGTH_MAX;
    use rafcon_protocol::Snapshot;
    use serde_json::{Value, json};

    fn snapshot(elapsed_ms: u64, active: &[Value]) -> Snapshot {
        serde_json::from_value(json!({
            "status": "running", "active": active, "states_run": 1, "elapsed_ms": elapsed_ms
        }))
        .expect("a snapshot")
    }

    #[test]
    fn time_goes_on_for_all_that_is_active_until_a_snapshot_is_sent() {
        let active = |since_ms: u64| json!({"path": "A", "name": "a", "phase": "running", "since_ms": since_ms});
        let taken = snapshot(5_000, &[active(1_200)]);
        let sent = [0, 300].map(|ago_ms| write(&taken, ago_ms).expect("bytes"));
        let shown = sent.map(|bytes| read(&bytes).expect("a snapshot"));
        assert_eq!(shown, [taken, snapshot(5_300, &[active(1_500)])]);
    }

    #[test]
    fn a_snapshot_is_read_as_it_was_written() {
        let state = |path: &str, phase: &str, further: Value| {
            let mut state = json!({"path": path, "name": path, "phase": phase, "since_ms": 70});
            state.as_object_mut().expect("an object").extend(further.as_object().cloned().unwrap());
            state
        };
        let taken = snapshot(
            5_000,
            &[
                state("A", "running", json!({})),
                state("A/B", "running", json!({"branch": "A/B"})),
                state("A/B/Ä", "held", json!({"branch": "A/B", "detail": "a step"})),
                state("A/B/Á", "running", json!({"branch": "A/B"})),
                state("A/C", "running", json!({"branch": "elsewhere"})),
            ],
        );
        let bytes = write(&taken, 0).expect("bytes");
        assert_eq!(read(&bytes), Some(taken));
    }

    #[test]
    fn paths_that_name_too_many_bytes_are_refused() {
        let sent = |states: usize, same: usize| {
            let rest = "A".repeat(64 << 10);
            let mut active = vec![json!([0, rest, "", 0, 0, null])];
            active.extend(vec![json!([same, "", "", 0, 0, null]); states - 1]);
            let (states_run, elapsed_ms, sequence, disk_safe) = (0, 0, 0, 0);
            json!({
                "status": "running", "active": active, "states_run": states_run,
                "elapsed_ms": elapsed_ms, "sequence": sequence, "disk_safe": disk_safe
            })
            .to_string()
            .into_bytes()
        };
        let most = (LENGTH_MAX >> 16) as usize;
        let read = |states, same| read(&sent(states, same)).map(|snapshot| snapshot.active.len());
        assert_eq!(read(most, 64 << 10), Some(most));
        assert_eq!(read(most + 1, 64 << 10), None);
        assert_eq!(read(2, (64 << 10) + 1), None);
    }
}
