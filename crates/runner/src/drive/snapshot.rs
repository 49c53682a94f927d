//! Snapshots of a run's current state, for viewers that request them now and then.

use crate::Scripts;
use crate::drive::driver::Driver;
use crate::record::tell;
use rafcon_engine::{Activity, PathId, Status, WaitReason};
use rafcon_protocol::{ActiveState, Hold, Phase, RunStatus, Snapshot};
use std::collections::BTreeMap;

/// Takes a snapshot. The engine is locked only while its active states are listed.
pub(crate) fn take<S: Scripts>(driver: &Driver<S>) -> Option<Snapshot> {
    let look = |core: &mut crate::drive::core::Core<S::Value>| {
        let active = core.engine.snapshot();
        let nexts = active.iter().flat_map(|active| &active.holds).filter_map(|hold| hold.next);
        let nexts = nexts.map(|next| (next, core.engine.path_text(next).to_string())).collect();
        let waits = active.iter().filter_map(|active| match &active.activity {
            Activity::Waiting(reason) => Some((active.path, tell::awaited(reason, &core.engine))),
            _ => None,
        });
        let texts = Texts { nexts, waits: waits.collect() };
        // The engine is locked, so no event is added meanwhile.
        let sequence = driver.recorder().last();
        (active, texts, core.engine.status(), core.engine.states_run(), sequence)
    };
    let (active, texts, status, states_run, sequence) = driver.with_core(look)?;
    let elapsed_ms = driver.clock().now_ms();
    let active =
        active.iter().filter_map(|active| state(driver, active, &texts, elapsed_ms)).collect();
    let (disk_safe, problem) = driver.recorder().safety().state();
    Some(Snapshot {
        status: run_status(status),
        active,
        states_run,
        elapsed_ms,
        sequence,
        disk_safe,
        journal_problem: problem.map(|problem| problem.to_string()),
        breakpoints: driver.points().all(),
        questions: driver.questions().unanswered(),
    })
}

/// Texts that only the engine can supply.
struct Texts {
    /// The paths of states that may never have been entered.
    nexts: BTreeMap<PathId, String>,
    /// The missing conditions of waiting states.
    waits: BTreeMap<PathId, String>,
}

fn state<S: Scripts>(
    driver: &Driver<S>,
    active: &rafcon_engine::ActiveState,
    texts: &Texts,
    now_ms: u64,
) -> Option<ActiveState> {
    let name = driver.program().node(active.node).name().to_string();
    let place = driver.places().get(active.path)?;
    let top = active.top.and_then(|top| driver.places().get(top));
    Some(ActiveState {
        path: place.text.to_string(),
        name,
        phase: phase(active),
        since_ms: now_ms.saturating_sub(place.entered_ms()),
        branch: top.map(|top| top.text.to_string()).unwrap_or_default(),
        detail: detail(active, texts),
        held: held(active, texts),
    })
}

/// The condition that a state waits for.
fn detail(active: &rafcon_engine::ActiveState, texts: &Texts) -> Option<String> {
    match &active.activity {
        Activity::Waiting(_) => texts.waits.get(&active.path).cloned(),
        Activity::Checking => Some("the condition of a breakpoint".to_owned()),
        Activity::Script | Activity::Inside | Activity::Held => None,
    }
}

fn held(active: &rafcon_engine::ActiveState, texts: &Texts) -> Vec<Hold> {
    let hold = |hold: &rafcon_engine::Hold| Hold {
        next: hold.next.and_then(|next| texts.nexts.get(&next).cloned()),
        by: tell::held_by(hold.by),
    };
    active.holds.iter().map(hold).collect()
}

fn phase(active: &rafcon_engine::ActiveState) -> Phase {
    match active.activity {
        Activity::Waiting(WaitReason::Interrupted) => Phase::Interrupted,
        Activity::Waiting(_) => Phase::Waiting,
        Activity::Held => Phase::Held,
        Activity::Script | Activity::Inside | Activity::Checking if active.preempted => {
            Phase::Preempted
        }
        Activity::Script | Activity::Inside | Activity::Checking => Phase::Running,
    }
}

fn run_status(status: Status) -> RunStatus {
    match status {
        Status::Idle | Status::Running => RunStatus::Running,
        Status::Paused => RunStatus::Paused,
        Status::Stepping => RunStatus::Stepping,
        Status::Stopping => RunStatus::Stopping,
        Status::Finished => RunStatus::Finished,
    }
}
