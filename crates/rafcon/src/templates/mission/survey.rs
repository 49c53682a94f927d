//! Visits every waypoint, sector by sector, and charges the battery in between. Knows sectors.

use super::draft::{Draft, Parts};
use super::drive::drive;
use super::size::Size;
use super::{scripts, waypoint};
use rafcon_model::Value;

/// The survey of all sectors.
pub(super) fn survey(size: Size) -> Draft {
    let mut parts = Parts::default().child(choose(size));
    let mut first = 1;
    for (number, waypoints) in (1..).zip(size.sectors()) {
        let name = format!("Sector {number}");
        parts = parts
            .child(sector(&name, first, waypoints))
            .go("Choose the sector", &outcome(number), &name)
            .go(&name, "surveyed", "Choose the sector")
            .go(&name, "battery low", "Charge")
            .go(&name, "aborted", "End the survey");
        first += waypoints;
    }
    let parts = parts
        .child(charge())
        .child(Draft::script("End the survey", scripts::END_SURVEY).output("seen", Value::Int(0)))
        .go("Choose the sector", "all surveyed", "End the survey")
        .go("Choose the sector", "aborted", "End the survey")
        .go("Charge", "success", "Choose the sector")
        .go("Charge", "aborted", "End the survey")
        .end("End the survey", "success", "success")
        .take("End the survey", "seen");
    Draft::hierarchy("Survey", parts)
        .about("Sector by sector; a sector that was left with a low battery is entered again.")
        .output("seen", Value::Int(0))
}

fn choose(size: Size) -> Draft {
    let sectors = (1..=size.sectors).map(outcome);
    Draft::script("Choose the sector", scripts::CHOOSE_SECTOR)
        .input("sizes", size.sectors_value())
        .outcomes(sectors.chain(["all surveyed".to_owned()]))
}

fn outcome(sector: usize) -> String {
    format!("sector {sector}")
}

fn sector(name: &str, first: usize, waypoints: usize) -> Draft {
    let watch = Draft::script("Watch the battery", scripts::WATCH_BATTERY).outcomes(["low"]);
    let parts = Parts::default()
        .child(visit(first, waypoints))
        .child(watch)
        .end("Visit the waypoints", "all visited", "surveyed")
        .end("Watch the battery", "low", "battery low");
    Draft::preemptive(name, parts)
        .about("The visit, unless the battery runs low before.")
        .outcomes(["surveyed", "battery low"])
}

fn visit(first: usize, waypoints: usize) -> Draft {
    let mut parts = Parts::default();
    let last = first + waypoints - 1;
    for number in first..=last {
        let name = waypoint::name(number);
        parts = parts.child(waypoint::waypoint(number));
        parts = if number == last {
            parts.end(&name, "done", "all visited")
        } else {
            parts.go(&name, "done", &waypoint::name(number + 1))
        };
    }
    Draft::hierarchy("Visit the waypoints", parts).outcomes(["all visited"])
}

fn charge() -> Draft {
    let parts = Parts::default()
        .child(drive("Drive to the base"))
        .child(Draft::script("Dock", scripts::DOCK))
        .child(Draft::script("Load the battery", scripts::LOAD_BATTERY))
        .go("Drive to the base", "arrived", "Dock")
        .go("Dock", "success", "Load the battery")
        .end("Load the battery", "success", "success");
    Draft::hierarchy("Charge", parts).about("The charger stands at the base.")
}
