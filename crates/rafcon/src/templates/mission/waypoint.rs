//! One waypoint: drive there, search the surroundings, store the objects found. Knows the positions of the waypoints.

use super::draft::{Draft, Parts};
use super::drive::{drive, goal};
use super::{int, scripts};
use rafcon_model::Value;

/// Distance of neighbouring waypoints, in metres.
const GRID_M: f64 = 3.0;
/// Waypoints in a row of the grid.
const ROW: usize = 8;

/// The waypoint with this number, from 1.
pub(super) fn waypoint(number: usize) -> Draft {
    let (x_m, y_m) = place(number);
    let parts = Parts::default()
        .child(
            Draft::script("Is it visited", scripts::ALREADY_VISITED)
                .input("waypoint", Value::Int(0))
                .outcomes(["new", "visited"]),
        )
        .child(drive("Drive there"))
        .child(look_around())
        .child(remember())
        .child(note("Mark as seen", scripts::MARK_WAYPOINT))
        .child(note("Leave it out", scripts::GIVE_UP_WAYPOINT))
        .go("Is it visited", "new", "Drive there")
        .end("Is it visited", "visited", "done")
        .go("Drive there", "arrived", "Look around")
        .go("Drive there", "aborted", "Leave it out")
        .end("Leave it out", "success", "done")
        .go("Look around", "nothing", "Mark as seen")
        .go("Look around", "found", "Remember")
        .go("Remember", "success", "Mark as seen")
        .end("Mark as seen", "success", "done")
        .give("x_m", &["Drive there", "Remember"])
        .give("y_m", &["Drive there", "Remember"])
        .give(
            "waypoint",
            &[
                "Is it visited",
                "Drive there",
                "Look around",
                "Remember",
                "Mark as seen",
                "Leave it out",
            ],
        )
        .pass("things", "Look around", "Remember");
    Draft::hierarchy(name(number), parts)
        .input("x_m", Value::Float(x_m))
        .input("y_m", Value::Float(y_m))
        .input("waypoint", int(number))
        .outcomes(["done"])
}

/// Name of a waypoint.
pub(super) fn name(number: usize) -> String {
    format!("Waypoint {number}")
}

/// Alternating rows, so that the next waypoint is always near.
#[expect(clippy::cast_precision_loss, reason = "there are not that many places")]
fn place(number: usize) -> (f64, f64) {
    let (row, column) = ((number - 1) / ROW, (number - 1) % ROW);
    let column = if row % 2 == 0 { column } else { ROW - 1 - column };
    ((column + 1) as f64 * GRID_M, row as f64 * GRID_M)
}

fn look_around() -> Draft {
    let things = || Value::List([].into());
    let parts = Parts::default()
        .child(
            Draft::script("Take pictures", scripts::TAKE_PICTURES)
                .input("waypoint", Value::Int(0))
                .output("things", things()),
        )
        .child(Draft::script("Scan the ground", scripts::SCAN_GROUND))
        .child(
            Draft::decider(scripts::DECIDE_LOOK)
                .input("things", things())
                .output("things", things())
                .outcomes(["nothing", "found"]),
        )
        .end("Decider", "nothing", "nothing")
        .end("Decider", "found", "found")
        .give("waypoint", &["Take pictures"])
        .pass("things", "Take pictures", "Decider")
        .take("Decider", "things");
    Draft::barrier("Look around", parts)
        .about("Camera and laser at the same time.")
        .input("waypoint", Value::Int(0))
        .output("things", things())
        .outcomes(["nothing", "found"])
}

fn remember() -> Draft {
    goal(Draft::script("Remember", scripts::REMEMBER_THINGS))
        .input("things", Value::List([].into()))
}

fn note(name: &str, script: &'static str) -> Draft {
    Draft::script(name, script).input("waypoint", Value::Int(0))
}

#[cfg(test)]
mod tests {
    use super::place;

    #[test]
    fn the_way_through_the_grid_has_no_jumps() {
        for number in 1..40 {
            let ((x, y), (to_x, to_y)) = (place(number), place(number + 1));
            assert!((to_x - x).abs() + (to_y - y).abs() <= 3.0);
        }
    }
}
