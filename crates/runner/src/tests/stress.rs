//! Random machines on real threads, stopped at random moments. Every run ends, and every entered state is left.

use super::players::Run;
use crate::drive::snapshot;
use proptest::prelude::*;
use rafcon_engine::Input;
use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The kind of a state, and its children.
#[derive(Debug, Clone)]
enum Tree {
    Leaf(&'static str),
    Inner(&'static str, Vec<Self>),
}

fn trees() -> impl Strategy<Value = Tree> {
    let leaf =
        prop_oneof![4 => Just("go"), 2 => Just("wait"), 1 => Just("panic")].prop_map(Tree::Leaf);
    leaf.prop_recursive(4, 40, 5, |inner| {
        let kind = prop_oneof![Just("hierarchy"), Just("barrier"), Just("preemptive")];
        (kind, prop::collection::vec(inner, 1..5))
            .prop_map(|(kind, children)| Tree::Inner(kind, children))
    })
}

fn write(tree: &Tree, id: &str, depth: usize, text: &mut String) {
    let pad = "  ".repeat(depth);
    match tree {
        Tree::Leaf(word) => {
            writeln!(text, "{pad}execution {id} \"{word}\"\n{pad}  outcome ok").unwrap();
        }
        Tree::Inner(kind, children) => {
            writeln!(text, "{pad}{kind} {id}\n{pad}  outcome ok").unwrap();
            connect(kind, children.len(), id, &pad, text);
            for (number, child) in children.iter().enumerate() {
                write(child, &format!("{id}{number}"), depth + 1, text);
            }
        }
    }
}

/// Connects the children of a hierarchy in sequence. In a race each child leads to the outcome, and in a barrier an
/// added decider does.
fn connect(kind: &str, children: usize, id: &str, pad: &str, text: &mut String) {
    match kind {
        "hierarchy" => {
            writeln!(text, "{pad}  start -> {id}0").unwrap();
            for number in 1..children {
                writeln!(text, "{pad}  {id}{}.ok -> {id}{number}", number - 1).unwrap();
            }
            writeln!(text, "{pad}  {id}{}.ok -> .ok", children - 1).unwrap();
        }
        "preemptive" => {
            for number in 0..children {
                writeln!(text, "{pad}  {id}{number}.ok -> .ok").unwrap();
            }
        }
        _ => {
            writeln!(text, "{pad}  unique_decider_state_id.ok -> .ok").unwrap();
            writeln!(text, "{pad}  decider unique_decider_state_id \"go\"\n{pad}    outcome ok")
                .unwrap();
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_run_ends(tree in trees(), stop_after in 0_usize..20) {
        let mut text = String::new();
        write(&tree, "S", 0, &mut text);
        let run = Run::new(&text, 1, 0);
        run.start();
        (0..stop_after * 10).for_each(|_| std::thread::yield_now());
        // Refused if the run is over.
        drop(run.driver.command(Input::Stop));
        let report = run.end();
        let count = |sign: char| report.steps.iter().filter(|step| step.starts_with(sign)).count();
        prop_assert_eq!(count('+'), count('-'), "{:?}", report.steps);
        prop_assert!(report.steps.last().is_some_and(|step| step.starts_with("-S=")));
    }
}

/// Branches that each run states of their own, so that each state is entered for the first time.
fn wide(branches: usize, states: usize) -> String {
    let row = Tree::Inner("hierarchy", vec![Tree::Leaf("go"); states]);
    let mut text = String::new();
    write(&Tree::Inner("barrier", vec![row; branches]), "S", 0, &mut text);
    text
}

#[test]
fn a_wide_run_ends_while_snapshots_are_taken_of_it() {
    let run = Run::new(&wide(24, 100), 1, 0);
    let over = AtomicBool::new(false);
    let driver = Arc::clone(&run.driver);
    let report = std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                while !over.load(Ordering::Relaxed) {
                    snapshot::take(&driver).unwrap();
                }
            });
        }
        run.start();
        let report = run.end();
        over.store(true, Ordering::Relaxed);
        report
    });
    let entered = report.steps.iter().filter(|step| step.starts_with('+')).count();
    assert_eq!(entered, 24 * 101 + 2);
}
