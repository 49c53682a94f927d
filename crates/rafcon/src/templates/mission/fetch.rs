//! Fetching one object: drive there, search, grasp, bring it home. Knows the possible failures.

use super::draft::{Draft, Parts};
use super::drive::drive;
use super::scripts;
use rafcon_model::Value;

/// A hierarchy that brings `thing` to the base, or ends by *lost*.
pub(super) fn fetch(thing: &str) -> Draft {
    let parts = Parts::default()
        .child(recall())
        .child(drive("Drive to the thing"))
        .child(search())
        .child(grasp())
        .child(drive("Drive to the base"))
        .child(Draft::script("Put it down", scripts::PUT_DOWN))
        .go("Recall the place", "success", "Drive to the thing")
        .go("Drive to the thing", "arrived", "Search or give up")
        .go("Search or give up", "found", "Grasp")
        .end("Search or give up", "time is up", "lost")
        .go("Grasp", "success", "Drive to the base")
        .end("Grasp", "lost", "lost")
        .go("Drive to the base", "arrived", "Put it down")
        .end("Put it down", "success", "success")
        .give("thing", &["Recall the place", "Grasp"])
        .pass("x_m", "Recall the place", "Drive to the thing")
        .pass("y_m", "Recall the place", "Drive to the thing");
    Draft::hierarchy(format!("Fetch the {thing}"), parts)
        .input("thing", Value::str(thing))
        .outcomes(["success", "lost"])
}

fn recall() -> Draft {
    Draft::script("Recall the place", scripts::RECALL_PLACE)
        .input("thing", Value::str(""))
        .output("x_m", Value::Float(0.0))
        .output("y_m", Value::Float(0.0))
}

fn search() -> Draft {
    let timer = Draft::script("Timer", scripts::SEARCH_TIMER)
        .input("limit_s", Value::Float(60.0))
        .outcomes(["time is up"]);
    let parts = Parts::default()
        .child(spiral())
        .child(timer)
        .end("Search in a spiral", "found", "found")
        .end("Timer", "time is up", "time is up");
    Draft::preemptive("Search or give up", parts)
        .about("The first to end wins: the search or the timer.")
        .outcomes(["found", "time is up"])
}

fn spiral() -> Draft {
    let looks = || Value::Int(0);
    let look = Draft::script("Look closely", scripts::LOOK_CLOSELY)
        .input("looks", looks())
        .output("looks", looks())
        .outcomes(["there it is", "not here"]);
    let parts = Parts::default()
        .variable("looks", looks())
        .child(look)
        .child(Draft::script("Step aside", scripts::STEP_ASIDE))
        .end("Look closely", "there it is", "found")
        .go("Look closely", "not here", "Step aside")
        .go("Step aside", "success", "Look closely")
        .give("looks", &["Look closely"])
        .take("Look closely", "looks");
    Draft::hierarchy("Search in a spiral", parts).outcomes(["found"])
}

fn grasp() -> Draft {
    let attempt = || Value::Int(0);
    let close = Draft::script("Close the gripper", scripts::CLOSE_GRIPPER)
        .input("thing", Value::str(""))
        .input("attempt", attempt())
        .output("attempt", attempt());
    let judge = Draft::script("Once more", scripts::JUDGE_GRASP)
        .input("attempt", attempt())
        .input("attempts", Value::Int(8))
        .outcomes(["again", "enough"]);
    let parts = Parts::default()
        .variable("attempt", attempt())
        .child(Draft::script("Reach for it", scripts::MOVE_ARM))
        .child(close)
        .child(judge)
        .child(Draft::script("Open the gripper", scripts::MOVE_ARM))
        .child(Draft::script("Lift it", scripts::MOVE_ARM))
        .go("Reach for it", "success", "Close the gripper")
        .go("Close the gripper", "success", "Lift it")
        .go("Close the gripper", "aborted", "Once more")
        .go("Once more", "again", "Open the gripper")
        .end("Once more", "enough", "lost")
        .go("Open the gripper", "success", "Reach for it")
        .end("Lift it", "success", "success")
        .give("thing", &["Close the gripper"])
        .give("attempt", &["Close the gripper", "Once more"])
        .take("Close the gripper", "attempt");
    Draft::hierarchy("Grasp", parts)
        .about("A grasp that slips is tried again.")
        .input("thing", Value::str(""))
        .outcomes(["success", "lost"])
}
