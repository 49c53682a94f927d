//! The latest truth about a run, for viewers that want it now and then.

use crate::Scripts;
use crate::driver::Driver;
use rafcon_engine::{Active, Activity, Status};
use rafcon_protocol::{ActiveState, Phase, RunStatus, Snapshot};

/// How things stand; the engine is held only while its active states are listed.
pub(crate) fn take<S: Scripts>(driver: &Driver<S>) -> Option<Snapshot> {
    let look = |core: &mut crate::core::Core<S::Value>| {
        (core.engine.snapshot(), core.engine.status(), core.engine.states_run())
    };
    let (active, status, states_run) = driver.with_core(look)?;
    let elapsed_ms = driver.clock().now_ms();
    let active = active.iter().filter_map(|active| state(driver, active, elapsed_ms)).collect();
    let (disk_safe, problem) = driver.recorder().safety().state();
    Some(Snapshot {
        status: run_status(status),
        active,
        states_run,
        elapsed_ms,
        sequence: driver.recorder().last(),
        disk_safe,
        journal_problem: problem.map(|problem| problem.to_string()),
        breakpoints: driver.points().all(),
        questions: driver.questions().unanswered(),
    })
}

fn state<S: Scripts>(driver: &Driver<S>, active: &Active, now_ms: u64) -> Option<ActiveState> {
    let name = driver.program().node(active.node).name().to_string();
    driver.places().with(active.path, |place| ActiveState {
        path: place.text.to_string(),
        name,
        phase: phase(active),
        since_ms: now_ms.saturating_sub(place.entered_ms()),
        branch: String::new(),
        detail: None,
    })
}

fn phase(active: &Active) -> Phase {
    match active.activity {
        Activity::Waiting(_) => Phase::Waiting,
        Activity::Held => Phase::Held,
        Activity::Script | Activity::Inside if active.preempted => Phase::Preempted,
        Activity::Script | Activity::Inside => Phase::Running,
    }
}

fn run_status(status: Status) -> RunStatus {
    match status {
        Status::Idle | Status::Running => RunStatus::Running,
        Status::Paused => RunStatus::Paused,
        Status::Stopping => RunStatus::Stopping,
        Status::Finished => RunStatus::Finished,
    }
}
