//! How long plans take from the command to the plan that is shown: blocks, and logistics, with the default engine.
//! Knows `rafcon plan` as a program.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use serde_json::{Value, json};

use crate::product::{Product, Profile};
use crate::{process, test, workspace};

/// What is measured.
#[derive(clap::Args, Clone, Copy)]
pub(crate) struct PlannerOptions {
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    /// Measure what an earlier debug build made
    #[arg(long)]
    debug: bool,
}

/// Name, action and PDDL of skills.
type Skills = &'static [(&'static str, &'static str)];

const BLOCKS: Skills = &[
    (
        "pick_up",
        "(:action pick-up :parameters (?x - block) :precondition (and (clear ?x) (ontable ?x) (handempty)) :effect (and (not (ontable ?x)) (not (clear ?x)) (not (handempty)) (holding ?x)))",
    ),
    (
        "put_down",
        "(:action put-down :parameters (?x - block) :precondition (holding ?x) :effect (and (not (holding ?x)) (clear ?x) (handempty) (ontable ?x)))",
    ),
    (
        "stack",
        "(:action stack :parameters (?x ?y - block) :precondition (and (holding ?x) (clear ?y)) :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty) (on ?x ?y)))",
    ),
    (
        "unstack",
        "(:action unstack :parameters (?x ?y - block) :precondition (and (on ?x ?y) (clear ?x) (handempty)) :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (handempty)) (not (on ?x ?y))))",
    ),
];

const LOGISTICS: Skills = &[
    (
        "load",
        "(:action load :parameters (?p - package ?v - vehicle ?l - place) :precondition (and (at ?v ?l) (at ?p ?l)) :effect (and (not (at ?p ?l)) (in ?p ?v)))",
    ),
    (
        "unload",
        "(:action unload :parameters (?p - package ?v - vehicle ?l - place) :precondition (and (at ?v ?l) (in ?p ?v)) :effect (and (not (in ?p ?v)) (at ?p ?l)))",
    ),
    (
        "drive",
        "(:action drive :parameters (?t - truck ?a ?b - place ?c - city) :precondition (and (at ?t ?a) (in-city ?a ?c) (in-city ?b ?c)) :effect (and (not (at ?t ?a)) (at ?t ?b)))",
    ),
    (
        "fly",
        "(:action fly :parameters (?t - airplane ?a ?b - airport) :precondition (at ?t ?a) :effect (and (not (at ?t ?a)) (at ?t ?b)))",
    ),
];

/// The largest time in ms from the command to the plan.
const BARS: [(&str, u128); 2] = [("blocks_40", 1500), ("logistics_12_40", 2000)];

/// Measures, and fails where a bar is missed.
pub(crate) fn run(options: PlannerOptions) -> Result<()> {
    let profile = if options.debug { Profile::Debug } else { Profile::Release };
    let product = if options.debug { Product::built(profile)? } else { Product::build(profile)? };
    let folder = workspace::target()?.join("planner");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    pool(&folder.join("blocks"), BLOCKS)?;
    pool(&folder.join("logistics"), LOGISTICS)?;
    let types = json!({"truck": "vehicle", "airplane": "vehicle", "vehicle": "physobj", "package": "physobj", "airport": "place", "city": "object"});
    fs::write(folder.join("types.json"), types.to_string())?;
    fs::write(folder.join("blocks.pddl"), blocks(40))?;
    fs::write(folder.join("logistics.pddl"), logistics(12, 40))?;
    let python = test::engine_environment()?;
    let mut figures = serde_json::Map::new();
    let mut missed = Vec::new();
    for ((name, bar), pool) in BARS.into_iter().zip(["blocks", "logistics"]) {
        let (ms, steps) = measure(&product, &python, (&folder, pool))?;
        figures.insert(format!("{name}_ms"), json!(u64::try_from(ms)?));
        figures.insert(format!("{name}_steps"), json!(steps));
        if ms > bar {
            missed.push(format!("{name}: {ms} ms, at most {bar} ms"));
        }
    }
    if options.json {
        println!("{}", Value::Object(figures));
    } else {
        figures.iter().for_each(|(name, figure)| println!("{name}: {figure}"));
    }
    if !missed.is_empty() {
        bail!("{}", missed.join("; "));
    }
    Ok(())
}

/// The time in ms of the whole command, machine included, and how many steps the plan has.
fn measure(
    product: &Product,
    python: &Path,
    (folder, pool): (&Path, &str),
) -> Result<(u128, usize)> {
    let mut command = process::command(&product.binary);
    command
        .arg("plan")
        .arg(folder.join(pool))
        .arg("--json")
        .arg("--facts")
        .arg(folder.join(format!("{pool}.pddl")));
    command
        .arg("--types")
        .arg(folder.join("types.json"))
        .arg("--out")
        .arg(folder.join(format!("{pool}_machine")));
    command.env("RAFCON_PYTHON", python);
    #[expect(clippy::disallowed_methods, reason = "a measurement of a whole program")]
    let begin = Instant::now();
    let output = command.output().context("rafcon does not start")?;
    let ms = begin.elapsed().as_millis();
    let text = String::from_utf8_lossy(&output.stdout);
    let first: Value =
        serde_json::from_str(text.lines().next().unwrap_or_default()).context("no events")?;
    let steps = first["steps"].as_array().with_context(|| format!("{pool}: no plan: {first}"))?;
    Ok((ms, steps.len()))
}

/// Writes skills as libraries.
fn pool(folder: &Path, skills: Skills) -> Result<()> {
    for (name, action) in skills {
        let library: PathBuf = folder.join(name);
        fs::create_dir_all(&library)?;
        let outcome = |id: i64, name: &str| json!({"__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", "name": name, "outcome_id": id});
        let core = json!({
            "__jsonqualname__": "rafcon.core.states.execution_state.ExecutionState", "description": null, "name": name, "state_id": "SKILLX",
            "income": {"__jsonqualname__": "rafcon.core.state_elements.logical_port.Income"}, "input_data_ports": {}, "output_data_ports": {},
            "outcomes": {"-2": outcome(-2, "preempted"), "-1": outcome(-1, "aborted"), "0": outcome(0, "success")},
        });
        let annotation = json!({"pddl_action": action, "pddl_predicates": "", "pddl_types": "", "requirements": [], "description": ""});
        let files = [
            ("statemachine.json", json!({"creation_time": "2026-01-01 00:00:00", "used_rafcon_version": "2.1.1", "version": null, "root_state_storage_id": ""}).to_string()),
            ("core_data.json", core.to_string()),
            ("semantic_data.json", json!({"RAFCONTPP": {"PDDL_ACTION": annotation}}).to_string()),
            ("script.py", "def execute(self, inputs, outputs, gvm):\n    return \"success\"\n".to_owned()),
        ];
        for (file, text) in files {
            fs::write(library.join(file), text)?;
        }
    }
    Ok(())
}

/// The same numbers each time.
struct Chance(usize);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

/// Towers of blocks by chance, and other towers of the same blocks.
fn blocks(count: usize) -> String {
    let chance = &mut Chance(1);
    let (begin, end) = (towers(count, chance), towers(count, chance));
    let names: Vec<_> = (0..count).map(|block| format!("b{block}")).collect();
    let goal: Vec<_> = end.iter().filter(|fact| fact.starts_with("(on ")).cloned().collect();
    format!(
        "(define (problem blocks) (:domain blocks) (:objects {} - block) (:init (handempty) {}) (:goal (and {})))",
        names.join(" "),
        begin.join(" "),
        goal.join(" ")
    )
}

fn towers(count: usize, chance: &mut Chance) -> Vec<String> {
    let mut blocks: Vec<usize> = (0..count).collect();
    for at in (1..count).rev() {
        blocks.swap(at, chance.below(at + 1));
    }
    let mut facts = Vec::new();
    let mut rest = &blocks[..];
    while !rest.is_empty() {
        let (tower, more) = rest.split_at((1 + chance.below(count / 4)).min(rest.len()));
        facts.push(format!("(ontable b{})", tower[0]));
        facts.extend(tower.windows(2).map(|pair| format!("(on b{} b{})", pair[1], pair[0])));
        facts.push(format!("(clear b{})", tower[tower.len() - 1]));
        rest = more;
    }
    facts
}

/// Packages between places in cities, with a truck in each and two airplanes.
fn logistics(cities: usize, packages: usize) -> String {
    let chance = &mut Chance(3);
    let (mut objects, mut init, mut goal) = (
        "plane0 plane1 - airplane".to_owned(),
        "(at plane0 l0_0) (at plane1 l1_0)".to_owned(),
        String::new(),
    );
    for city in 0..cities {
        let truck = chance.below(3);
        // Text is always written.
        let _infallible = write!(
            objects,
            " c{city} - city t{city} - truck l{city}_0 - airport l{city}_1 l{city}_2 - place"
        );
        let _infallible = write!(
            init,
            " (at t{city} l{city}_{truck}) (in-city l{city}_0 c{city}) (in-city l{city}_1 c{city}) (in-city l{city}_2 c{city})"
        );
    }
    for package in 0..packages {
        let mut place = || format!("l{}_{}", chance.below(cities), chance.below(3));
        let (from, to) = (place(), place());
        let _infallible = write!(objects, " p{package} - package");
        let _infallible = write!(init, " (at p{package} {from})");
        let _infallible = write!(goal, " (at p{package} {to})");
    }
    format!(
        "(define (problem logistics) (:domain logistics) (:objects {objects}) (:init {init}) (:goal (and{goal})))"
    )
}
