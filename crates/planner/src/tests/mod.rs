//! Shared helpers: pools and tasks from text. A skill is a line `library: port port = type`, followed by its action.

mod linearisations;
mod machines;
mod merging;
mod renaming;
mod validating;

use crate::pddl::{Name, read_problem};
use crate::{Finding, Plan, Pool, Skill, Task, read_skill};
use rafcon_model::{
    Json, Kind, Outcome, OutcomeId, Port, PortId, Script, State, StateId, Value, json,
};
use std::fmt::Write as _;
use std::sync::Arc;

/// The root of a skill with string inputs and an annotation.
pub(super) fn root(name: &str, ports: &str, notes: &Json) -> Arc<State> {
    let mut state =
        State::new(StateId::new("SKILLX"), name, Kind::Execution(Script { text: Some("".into()) }));
    state.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
    for (id, port) in (0..).zip(ports.split_whitespace()) {
        let (name, data_type) = port.split_once('=').unwrap_or((port, "str"));
        let data_type = rafcon_model::DataType::from_file(data_type);
        state.inputs.insert(Port::new(PortId(id), name, data_type, Value::None));
    }
    state.semantic_data = Some(Arc::new(notes.clone()));
    Arc::new(state)
}

/// An annotation in the format of the reference's plugin.
pub(super) fn notes(action: &str, predicates: &str, types: &str, planning: &str) -> Json {
    let text = |text: &str| Json::Str(text.into());
    let annotation = Json::Object(vec![
        ("pddl_action".into(), text(action)),
        ("pddl_predicates".into(), text(predicates)),
        ("pddl_types".into(), text(types)),
        ("requirements".into(), Json::List(vec![text(":typing"), text(":strips")])),
        ("description".into(), text("")),
    ]);
    let mut notes = Json::Object(vec![(
        "RAFCONTPP".into(),
        Json::Object(vec![("PDDL_ACTION".into(), annotation)]),
    )]);
    if !planning.is_empty() {
        notes.set("planning", json::parse(planning).unwrap());
    }
    notes
}

/// Parses skills from blocks: `name ports…` in the first line, then the action. `predicates`, `types` and `planning`
/// begin a line of their own.
pub(super) fn skills(text: &str) -> Vec<Result<Skill, Finding>> {
    let blocks = text.split("skill ").map(str::trim).filter(|block| !block.is_empty());
    blocks
        .map(|block| {
            let (head, rest) = block.split_once('\n').unwrap_or((block, ""));
            let (name, ports) = head.split_once(' ').unwrap_or((head, ""));
            let mut parts = [String::new(), String::new(), String::new(), String::new()];
            for line in rest.lines() {
                let line = line.trim();
                let words = ["predicates ", "types ", "planning "];
                let found = words.iter().position(|word| line.starts_with(word));
                let slot = found.map_or(0, |at| at + 1);
                let text = found.map_or(line, |at| &line[words[at].len()..]);
                writeln!(parts[slot], "{text}").unwrap();
            }
            let [action, predicates, types, planning] = parts;
            let notes = notes(&action, &predicates, &types, &planning);
            read_skill(&format!("pool/{name}"), &root(name, ports, &notes))
                .map(|skill| skill.expect("an action"))
        })
        .collect()
}

pub(super) fn pool(text: &str, types: &str) -> Pool {
    let skills = skills(text).into_iter().map(|skill| skill.unwrap()).collect();
    Pool::new("test", skills, &hierarchy(types))
}

/// `waiter person, chef person`
fn hierarchy(text: &str) -> Vec<(Name, Name)> {
    let pairs = text.split(',').filter_map(|pair| pair.trim().split_once(' '));
    pairs.map(|(child, parent)| (child.into(), parent.trim().into())).collect()
}

pub(super) fn task(pool: &Pool, problem: &str) -> (Task, Vec<Finding>) {
    Task::new(pool.domain.clone(), read_problem(problem).unwrap())
}

/// Parses a plan from lines `(cook bob pizza)`, with time `0: (cook bob pizza) [5]`.
pub(super) fn plan(text: &str) -> Plan {
    let temporal = text.contains('[');
    let steps = text.lines().map(str::trim).filter(|line| !line.is_empty()).map(|line| {
        let (time, rest) = line.split_once(": ").unwrap_or(("0", line));
        let (action, duration) = rest.split_once(" [").unwrap_or((rest, ""));
        let duration = duration.trim_end_matches(']');
        let duration =
            if duration.is_empty() { String::new() } else { format!(", \"duration\": {duration}") };
        format!("{{\"action\": \"{action}\", \"time\": {time}{duration}}}")
    });
    let steps: Vec<_> = steps.collect();
    Plan::read(&format!("{{\"temporal\": {temporal}, \"steps\": [{}]}}", steps.join(", "))).unwrap()
}

pub(super) fn lines<T: std::fmt::Display>(items: impl IntoIterator<Item = T>) -> String {
    items.into_iter().fold(String::new(), |mut text, item| {
        writeln!(text, "{item}").unwrap();
        text
    })
}

pub(super) const RESTAURANT: &str = "
skill move destination name
(:action got-to :parameters (?start ?destination - Location ?name - Waiter)
 :precondition (and (at ?start ?name)) :effect (and (not (at ?start ?name))(at ?destination ?name)))
predicates (at ?destination - Location ?name - Waiter)
types Waiter, Location
skill order interlocutor1 interlocutor2 food
(:action order :parameters (?interlocutor1 ?interlocutor2 - Person ?food - Food ?loc - Location)
 :precondition (and (at ?loc ?interlocutor1) (at ?loc ?interlocutor2) (wants ?interlocutor2 ?food))
 :effect (and (wants ?interlocutor1 ?food)))
skill cook chef food
(:action cook :parameters (?chef - Chef ?food - Food) :precondition (wants ?chef ?food)
 :effect (and (has ?chef ?food)(not(wants ?chef ?food))))
skill give interlocutor1 interlocutor2 food
(:action give :parameters (?interlocutor1 ?interlocutor2 - Person ?food - Food ?loc - Location)
 :precondition (and (at ?loc ?interlocutor1) (at ?loc ?interlocutor2) (wants ?interlocutor2 ?food) (has ?interlocutor1 ?food))
 :effect (and (not (wants ?interlocutor2 ?food)) (not (has ?interlocutor1 ?food)) (has ?interlocutor2 ?food)))
skill eat person food
(:action eat :parameters (?person - Person ?food - Food) :precondition (and (has ?person ?food))
 :effect (and (not (has ?person ?food)) (be-full ?person)))
";

pub(super) const PERSONS: &str =
    "Person Object, Food Object, Location Object, Chef Person, Waiter Person, Guest Person";

pub(super) const HUNGRY: &str = "(define (problem alice_is_hungry)(:domain restaurant)
(:objects James - Waiter bob - Chef alice - Guest pizza - Food kitchen table entrance - Location)
(:init (at entrance james) (at table alice) (at kitchen bob) (wants alice pizza))
(:goal (and (be-full alice))))";

pub(super) const LUNCH: &str = "(got-to entrance table james)
(order james alice pizza table)
(got-to table kitchen james)
(order bob james pizza kitchen)
(cook bob pizza)
(give bob james pizza kitchen)
(got-to kitchen table james)
(give james alice pizza table)
(eat alice pizza)";
