//! Exploration: the survey and its parallel tasks. Knows the barrier around them.

use super::draft::{Draft, Parts};
use super::size::Size;
use super::{scripts, survey};
use rafcon_model::Value;

/// Survey, map and radio in parallel.
pub(super) fn explore(size: Size) -> Draft {
    let scans = || Value::Int(0);
    let parts = Parts::default()
        .child(survey::survey(size))
        .child(build_map())
        .child(keep_in_touch())
        .child(
            Draft::decider(scripts::DECIDE_EXPLORATION)
                .input("scans", scans())
                .outcomes(["explored", "not enough"]),
        )
        .pass("scans", "Build the map", "Decider")
        .end("Decider", "explored", "explored")
        .end("Decider", "not enough", "not enough");
    Draft::barrier("Explore", parts)
        .about(
            "Drives over the ground while the map grows; the ground station is told all the time.",
        )
        .outcomes(["explored", "not enough"])
}

fn build_map() -> Draft {
    let scans = || Value::Int(0);
    let parts = Parts::default()
        .variable("scans", scans())
        .child(
            Draft::script("Take a scan", scripts::TAKE_SCAN)
                .outcomes(["success", "the survey is over"]),
        )
        .child(
            Draft::script("Merge the scan", scripts::MERGE_SCAN)
                .input("scans", scans())
                .output("scans", scans()),
        )
        .go("Take a scan", "success", "Merge the scan")
        .end("Take a scan", "the survey is over", "success")
        .go("Merge the scan", "success", "Take a scan")
        .give("scans", &["Merge the scan"])
        .take("Merge the scan", "scans")
        .show("scans");
    Draft::hierarchy("Build the map", parts).output("scans", scans())
}

fn keep_in_touch() -> Draft {
    let parts = Parts::default()
        .child(Draft::script("Send the status", scripts::SEND_STATUS).outcomes([
            "sent",
            "no link",
            "the survey is over",
        ]))
        .child(Draft::script("Wait for the link", scripts::WAIT_FOR_LINK))
        .go("Send the status", "sent", "Send the status")
        .go("Send the status", "no link", "Wait for the link")
        .end("Send the status", "the survey is over", "success")
        .go("Wait for the link", "success", "Send the status");
    Draft::hierarchy("Keep in touch", parts)
        .about("A lost link is no reason to stop: the status is sent when it is back.")
}
