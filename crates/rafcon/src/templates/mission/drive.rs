//! The basic skill of the mission: to drive to a position. Knows nothing of its purpose.

use super::draft::{Draft, Parts};
use super::scripts;
use rafcon_model::Value;

/// Drives to (`x_m`, `y_m`). Slipping wheels and doubtful positions are recovered; without a path it ends by aborted.
pub(super) fn drive(name: impl Into<String>) -> Draft {
    let parts = Parts::default()
        .child(plan())
        .child(follow())
        .child(
            Draft::script("Check the position", scripts::CHECK_POSITION)
                .outcomes(["there", "lost"]),
        )
        .child(Draft::script("Relocalise", scripts::RELOCALISE))
        .child(Draft::script("Stop the wheels", scripts::STOP_WHEELS))
        .go("Plan the path", "success", "Follow the path")
        .go("Follow the path", "success", "Check the position")
        .go("Follow the path", "aborted", "Relocalise")
        .go("Follow the path", "preempted", "Stop the wheels")
        .end("Check the position", "there", "arrived")
        .go("Check the position", "lost", "Relocalise")
        .go("Relocalise", "success", "Plan the path")
        .end("Stop the wheels", "success", "preempted")
        .give("x_m", &["Plan the path", "Follow the path"])
        .give("y_m", &["Plan the path", "Follow the path"])
        .give("waypoint", &["Plan the path"])
        .pass("length_m", "Plan the path", "Follow the path");
    goal(Draft::hierarchy(name, parts))
        .about("Drives to (x_m, y_m). `waypoint` is 0 where no waypoint is.")
        .outcomes(["arrived"])
}

fn plan() -> Draft {
    goal(Draft::script("Plan the path", scripts::PLAN_PATH)).output("length_m", Value::Float(0.0))
}

fn follow() -> Draft {
    Draft::script("Follow the path", scripts::FOLLOW_PATH)
        .input("x_m", Value::Float(0.0))
        .input("y_m", Value::Float(0.0))
        .input("length_m", Value::Float(0.0))
}

/// Inputs for the target of a drive; the default is the base.
pub(super) fn goal(draft: Draft) -> Draft {
    draft
        .input("x_m", Value::Float(0.0))
        .input("y_m", Value::Float(0.0))
        .input("waypoint", Value::Int(0))
}
