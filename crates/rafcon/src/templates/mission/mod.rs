//! A mission of realistic size, modelled on the machine of DLR's rover at the SpaceBotCamp 2015: explore unknown ground,
//! find a battery and a mug, fetch them, assemble them at the base, and handle failures. The scripts simulate the robot.
//!
//! Knows the plan of the mission. Its size depends on the number of waypoints; all other parts occur once.

mod assemble;
mod build;
mod draft;
mod drive;
mod explore;
mod fetch;
pub(super) mod layout;
mod scripts;
mod size;
mod survey;
mod waypoint;

use super::{Template, TemplateRequest};
use anyhow::Result;
use draft::{Draft, Parts};
use rafcon_model::{State, Value};
use size::Size;

pub(super) const TEMPLATE: Template = Template {
    name: "mission",
    about: "a simulated rover explores, fetches two things and assembles them (750 states, or --states)",
    sized: true,
    libraries: &[],
    build: |wish| root(wish),
};

const STATES: usize = 750;
/// Duration in seconds of a simulated second in a mission of [`STATES`] states: it runs for about half a minute.
const TIME_SCALE: f64 = 0.06;

/// Hidden objects, in the order in which they are fetched.
const THINGS: [&str; 2] = ["battery", "mug"];

fn root(wish: &TemplateRequest) -> Result<State> {
    let states = wish.states.unwrap_or(STATES);
    let fixed = count(&mission(wish, states, Size::SMALLEST));
    let size = Size::fit(states, fixed)?;
    build::root(mission(wish, states, size), &mut build::Ids::default())
}

fn mission(wish: &TemplateRequest, states: usize, size: Size) -> Draft {
    let [battery, mug] = THINGS.map(fetch::fetch);
    let parts = Parts::default()
        .child(prepare(size))
        .child(explore::explore(size))
        .child(battery)
        .child(mug)
        .child(assemble::assemble())
        .child(report())
        .give("time_scale", &["Prepare"])
        .give("seed", &["Prepare"])
        .go("Prepare", "success", "Explore")
        .go("Explore", "explored", "Fetch the battery")
        .go("Explore", "not enough", "Report")
        .go("Explore", "aborted", "Report")
        .go("Fetch the battery", "success", "Fetch the mug")
        .go("Fetch the battery", "lost", "Report")
        .go("Fetch the battery", "aborted", "Report")
        .go("Fetch the mug", "success", "Assemble")
        .go("Fetch the mug", "lost", "Report")
        .go("Fetch the mug", "aborted", "Report")
        .go("Assemble", "assembled", "Report")
        .go("Assemble", "aborted", "Report")
        .pass("assembled", "Assemble", "Report")
        .end("Report", "complete", "success")
        .end("Report", "incomplete", "incomplete")
        .take("Report", "fetched")
        .take("Report", "report");
    Draft::hierarchy(&wish.name, parts)
        .about(
            "Explores, fetches a battery and a mug, and puts them together at the base.\n\nA simulated second takes \
             `time_scale` seconds; with 0 the mission runs as fast as it can. `seed` decides what is hidden where and \
             what goes wrong.",
        )
        .input("time_scale", Value::Float(time_scale(states)))
        .input("seed", Value::Int(1))
        .output("fetched", Value::List([].into()))
        .output("report", Value::str(""))
        .outcomes(["success", "incomplete"])
}

/// A larger mission runs faster, so that the duration stays constant.
#[expect(clippy::cast_precision_loss, reason = "a rough number is enough")]
fn time_scale(states: usize) -> f64 {
    let scale = TIME_SCALE * (STATES as f64 / states as f64).min(1.0);
    (scale * 1e6).round() / 1e6
}

fn prepare(size: Size) -> Draft {
    let start = Draft::script("Start the simulation", scripts::START_SIMULATION)
        .input("time_scale", Value::Float(0.0))
        .input("seed", Value::Int(1))
        .input("waypoints", int(size.waypoints));
    let checks = (0..size.checks).map(|number| {
        let device = device(number);
        Draft::script(format!("Check the {device}"), scripts::CHECK_DEVICE)
            .input("device", Value::str(&device))
    });
    let parts = checks.fold(Parts::default().child(start), Parts::child).chain();
    let last = parts.children.last().map_or_else(String::new, |child| child.name.clone());
    let parts = parts
        .end(&last, "success", "success")
        .give("time_scale", &["Start the simulation"])
        .give("seed", &["Start the simulation"]);
    Draft::hierarchy("Prepare", parts)
        .about("Puts the world in place, then checks all devices.")
        .input("time_scale", Value::Float(0.0))
        .input("seed", Value::Int(1))
}

fn device(number: usize) -> String {
    const DEVICES: [&str; 8] =
        ["stereo camera", "laser", "radio", "gripper", "wheels", "lamp", "compass", "computer"];
    match DEVICES.get(number) {
        Some(device) => (*device).to_owned(),
        None => format!("joint {}", number - DEVICES.len() + 1),
    }
}

fn report() -> Draft {
    Draft::script("Report", scripts::REPORT)
        .about("Every way through the mission ends here.")
        .input("assembled", Value::Bool(false))
        .output("fetched", Value::List([].into()))
        .output("report", Value::str(""))
        .outcomes(["complete", "incomplete"])
}

fn int(number: usize) -> Value {
    Value::Int(i64::try_from(number).unwrap_or(i64::MAX))
}

/// Number of states in a draft.
fn count(draft: &Draft) -> usize {
    1 + draft.children().iter().map(count).sum::<usize>()
}

#[cfg(test)]
mod tests {
    use super::super::{Template, TemplateRequest};
    use super::TEMPLATE;
    use expect_test::{Expect, expect};
    use rafcon_model::{BuiltinTypes, Header, Machine, State, problems};

    fn build(states: Option<usize>) -> anyhow::Result<State> {
        let Template { build, .. } = TEMPLATE;
        build(&TemplateRequest { name: "mission".to_owned(), states })
    }

    fn check(states: Option<usize>, expect: &Expect) {
        let figures = match build(states) {
            Ok(root) => format!(
                "{} states, {} transitions, depth {}",
                sum(&root, &|_| 1),
                sum(&root, &|state| state.container().map_or(0, |c| c.transitions.len())),
                depth(&root)
            ),
            Err(error) => error.to_string(),
        };
        expect.assert_eq(&figures);
    }

    fn sum(state: &State, figure: &dyn Fn(&State) -> usize) -> usize {
        let children = state.container().into_iter().flat_map(|inside| inside.states.values());
        figure(state) + children.map(|child| sum(child, figure)).sum::<usize>()
    }

    fn depth(state: &State) -> usize {
        let children = state.container().into_iter().flat_map(|inside| inside.states.values());
        1 + children.map(|child| depth(child)).max().unwrap_or_default()
    }

    #[test]
    fn a_mission_has_as_many_states_as_wanted() {
        check(None, &expect!["750 states, 1219 transitions, depth 8"]);
        check(Some(10_000), &expect!["10000 states, 16053 transitions, depth 8"]);
        check(
            Some(20),
            &expect!["a mission has at least 120 states: give a larger number with `--states`"],
        );
    }

    #[test]
    fn every_size_from_the_smallest_on_can_be_had() {
        for states in 150..400 {
            let root = build(Some(states)).unwrap();
            assert_eq!(sum(&root, &|_| 1), states);
        }
    }

    #[test]
    fn nothing_is_wrong_with_it() {
        let machine = Machine { header: Header::default(), root: build(None).unwrap().into() };
        let found = problems(&machine, &BuiltinTypes);
        assert!(found.is_empty(), "{found:?}");
    }

    #[test]
    fn the_same_wish_makes_the_same_machine() {
        assert_eq!(build(Some(200)).unwrap(), build(Some(200)).unwrap());
    }
}
