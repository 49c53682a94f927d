//! Several users edit one machine: no edit is lost, and each user undoes only their own edits.

use super::machine::OpenMachine;
use super::operation::{EditRequest, Operation, ReadOperation};
use super::revision_log::RevisionsPage;
use crate::Failure;
use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_model::{BuiltinTypes, Machine, problems};
use rafcon_protocol::api::{MachineStep, Revision};
use rafcon_protocol::document::{Document, Mirror};
use rafcon_protocol::edit::Edit;
use rafcon_testkit::edits::{Dice, edit};
use rafcon_testkit::notation;

const START: &str = "
    hierarchy ROOT
      outcome success
      in a: int
      var v: int
      start -> AAAAAA
      AAAAAA.success -> BBBBBB ; BBBBBB.success -> .success
      flow .a -> AAAAAA.x
      execution AAAAAA
        outcome success
        in x: int
      barrier BBBBBB
        outcome success
        execution DDDDDD
          outcome success
        decider unique_decider_state_id
          outcome success
      hierarchy CCCCCC
        outcome success
        start -> EEEEEE
        execution EEEEEE
";

fn machine(text: &str) -> Machine {
    notation::parse(text).expect("a machine in the notation")
}

/// Performs an operation. Returns the name of the step and the new revision, or the refusal.
fn done(open: &mut OpenMachine, author: &str, deed: ReadOperation) -> String {
    let request = EditRequest { author: author.to_owned(), id: open.revision().to_string() };
    match open.prepare(request, 0, deed) {
        Err(refusal) => {
            let failure = Failure::from(refusal);
            format!("{}: {failure}", failure.refusal().code)
        }
        Ok(prepared) => open.commit(prepared).to_string(),
    }
}

/// One operation per line: the author, then `<` (undo), `>` (redo), `@` or `@!` and a revision (jump, `!` also over others), or an
/// edit as JSON.
fn deed(text: &str) -> ReadOperation {
    let jump = |revision: &str, over_others| {
        let revision = revision.parse().expect("a revision");
        Operation::Jump { revision, over_others }
    };
    match text {
        "<" => Operation::Undo,
        ">" => Operation::Redo,
        text => {
            if let Some(revision) = text.strip_prefix("@!") {
                return jump(revision, true);
            }
            if let Some(revision) = text.strip_prefix('@') {
                return jump(revision, false);
            }
            let edit: Edit = serde_json::from_str(text).expect("an edit");
            let name = text.split('"').nth(3).expect("a name").to_owned();
            Operation::Edit { name, edit: (&edit).try_into().expect("an edit of the model") }
        }
    }
}

fn play(lines: &[&str]) -> (OpenMachine, String) {
    let mut open = OpenMachine::new(machine(START), 0);
    let mut out = Vec::new();
    for line in lines {
        let (author, what) = line.split_once(' ').expect("an author and a deed");
        out.push(format!("{author}: {}\n", done(&mut open, author, deed(what))));
    }
    (open, out.concat())
}

fn check(lines: &[&str], expect: &Expect) {
    let (open, out) = play(lines);
    expect.assert_eq(&(out + &notation::print(open.machine())));
}

/// Compares the refusals, the steps in the log, and the final name of a state.
fn check_steps(lines: &[&str], expect: &Expect) {
    let (open, out) = play(lines);
    let refused = out.lines().filter(|line| line.matches(": ").count() > 1);
    let step = |step: MachineStep| {
        let same = step.same_as.map_or_else(String::new, |same| format!(" = {same}"));
        format!("{}{same} {:?} {} {}", step.revision, step.kind, step.author, step.name)
    };
    let steps = open.steps().steps.into_iter().map(step);
    let name = open.machine().root.container().expect("a container").states.values().next();
    let name = name.expect("a state").name.to_string();
    let told: Vec<_> = refused.map(str::to_owned).chain(steps).chain([name]).collect();
    expect.assert_eq(&told.join("\n"));
}

const NAME: &str = r#"ann {"edit":"set_name","path":"ROOT/AAAAAA","name":"Ann's"}"#;

#[test]
fn everybody_takes_back_what_is_their_own() {
    let bobs = r#"bob {"edit":"set_name","path":"ROOT/BBBBBB","name":"Bob's"}"#;
    check(
        &[NAME, bobs, "ann <", "bob <", "ann >", "ann <", "ann <"],
        &expect![[r"
        ann: 1
        bob: 2
        ann: 3
        bob: 4
        ann: 5
        ann: 6
        ann: nothing_to_do: there is no step of yours to be taken back
        hierarchy ROOT
          outcome success
          in a: int
          var v: int
          start -> AAAAAA
          AAAAAA.success -> BBBBBB
          BBBBBB.success -> .success
          flow .a -> AAAAAA.x
          execution AAAAAA
            outcome success
            in x: int
          barrier BBBBBB
            outcome success
            execution DDDDDD
              outcome success
            decider unique_decider_state_id
              outcome success
          hierarchy CCCCCC
            outcome success
            start -> EEEEEE
            execution EEEEEE
    "]],
    );
}

#[test]
fn what_somebody_built_upon_stays() {
    let bobs = r#"bob {"edit":"set_name","path":"ROOT/AAAAAA","name":"Bob's"}"#;
    check(
        &[NAME, bobs, "ann <", "bob <", "ann <", "bob >", "ann >"],
        &expect![[r#"
        ann: 1
        bob: 2
        ann: built_upon: `set_name` cannot be taken back: bob has changed the name of ROOT/AAAAAA since (`set_name`); ask for that to be taken back first, or change it by hand
        bob: 3
        ann: 4
        bob: built_upon: `set_name` cannot be made again: ann has changed the name of ROOT/AAAAAA since (`set_name`); ask for that to be taken back first, or change it by hand
        ann: 5
        hierarchy ROOT
          outcome success
          in a: int
          var v: int
          start -> AAAAAA
          AAAAAA.success -> BBBBBB
          BBBBBB.success -> .success
          flow .a -> AAAAAA.x
          execution AAAAAA "Ann's"
            outcome success
            in x: int
          barrier BBBBBB
            outcome success
            execution DDDDDD
              outcome success
            decider unique_decider_state_id
              outcome success
          hierarchy CCCCCC
            outcome success
            start -> EEEEEE
            execution EEEEEE
    "#]],
    );
}

#[test]
fn what_somebody_built_inside_or_around_stays() {
    let add = r#"ann {"edit":"add_state","path":"ROOT","states":[{"path":"NEWAAA","name":"New","kind":"execution"}]}"#;
    let inside = r#"bob {"edit":"set_script","path":"ROOT/NEWAAA","script":"x = 1"}"#;
    let lead = r#"bob {"edit":"add_transition","path":"ROOT","transition":9,"from":{"state":"NEWAAA","outcome":-1},"to":{"outcome":0}}"#;
    check(
        &[add, inside, "ann <", "bob <", lead, "ann <"],
        &expect![[r#"
            ann: 1
            bob: 2
            ann: built_upon: `add_state` cannot be taken back: bob has changed ROOT/NEWAAA since (`set_script`); ask for that to be taken back first, or change it by hand
            bob: 3
            bob: 4
            ann: built_upon: `add_state` cannot be taken back, for others have changed the machine since: ROOT, transition 9: it begins at NEWAAA, which does not exist; connect the beginning with an outcome of a child, or remove the transition
            hierarchy ROOT
              outcome success
              in a: int
              var v: int
              start -> AAAAAA
              AAAAAA.success -> BBBBBB
              BBBBBB.success -> .success
              NEWAAA.aborted -> .success as 9
              flow .a -> AAAAAA.x
              execution AAAAAA
                outcome success
                in x: int
              barrier BBBBBB
                outcome success
                execution DDDDDD
                  outcome success
                decider unique_decider_state_id
                  outcome success
              hierarchy CCCCCC
                outcome success
                start -> EEEEEE
                execution EEEEEE
              execution NEWAAA "New"
        "#]],
    );
}

#[test]
fn layouts_are_merged_element_by_element() {
    let moved = |who: &str, element: &str, x: u32| {
        format!(
            r#"{who} {{"edit":"set_position","path":"ROOT","element":{element},"position":[{x},0]}}"#
        )
    };
    let ann = moved("ann", r#"{"outcome":0}"#, 1);
    let bob = moved("bob", r#"{"input":0}"#, 2);
    let same = moved("bob", r#"{"outcome":0}"#, 3);
    check(
        &[&ann, &bob, "ann <", "ann >", "bob <", &same, "ann <"],
        &expect![[r#"
        ann: 1
        bob: 2
        ann: 3
        ann: 4
        bob: 5
        bob: 6
        ann: built_upon: `set_position` cannot be taken back: another user has moved this part of ROOT since; move it by hand
        hierarchy ROOT
          outcome success
          in a: int
          var v: int
          layout {"outcome0":{"gui":{"editor_gaphas":{"rel_pos":{"__jsonqualname__":"__builtin__.tuple","items":[3.0,0.0]}}}}}
          start -> AAAAAA
          AAAAAA.success -> BBBBBB
          BBBBBB.success -> .success
          flow .a -> AAAAAA.x
          execution AAAAAA
            outcome success
            in x: int
          barrier BBBBBB
            outcome success
            execution DDDDDD
              outcome success
            decider unique_decider_state_id
              outcome success
          hierarchy CCCCCC
            outcome success
            start -> EEEEEE
            execution EEEEEE
    "#]],
    );
}

#[test]
fn a_reload_is_a_step_like_any_other() {
    let mut open = OpenMachine::new(machine(START), 0);
    let document = machine("execution OTHERR");
    let mut said = vec![done(&mut open, "ann", Operation::Replace { document })];
    let rename = r#"{"edit":"set_name","path":"OTHERR","name":"Bob's"}"#;
    let rename: Edit = serde_json::from_str(rename).expect("an edit");
    let edit = (&rename).try_into().expect("an edit");
    let rename = Operation::Edit { name: "Rename".into(), edit };
    said.push(done(&mut open, "bob", rename));
    said.push(done(&mut open, "ann", Operation::Undo));
    said.push(done(&mut open, "bob", Operation::Undo));
    said.push(done(&mut open, "ann", Operation::Undo));
    assert_eq!(*open.machine(), machine(START));
    expect![[r"
        1
        2
        built_upon: `Reload` cannot be taken back: bob has changed OTHERR since (`Rename`); ask for that to be taken back first, or change it by hand
        3
        4"]].assert_eq(&said.join("\n"));
}

#[test]
fn steps_are_a_tree_and_a_jump_leads_to_any_node() {
    let name =
        |name: &str| format!(r#"ann {{"edit":"set_name","path":"ROOT/AAAAAA","name":"{name}"}}"#);
    let (one, two, other) = (name("One"), name("Two"), name("Other"));
    check_steps(
        &[&one, &two, "ann <", &other, "ann @2", "ann @0", "ann <", "ann @7", "ann @99", &one],
        &expect![[r#"
            ann: nothing_to_do: the machine already is what it was then
            ann: not_kept: revision 99 of the machine is no longer kept: choose one from the list of steps
            1 Edit ann set_name
            2 Edit ann set_name
            3 = 1 Undo ann set_name
            4 Edit ann set_name
            5 = 2 Jump ann Jump to "set_name"
            6 = 0 Jump ann Jump to the start
            7 = 2 Undo ann Jump to the start
            8 = 1 Edit ann set_name
            One"#]],
    );
}

#[test]
fn a_jump_takes_steps_of_others_away_only_if_that_is_said() {
    let anns = r#"ann {"edit":"set_name","path":"ROOT/AAAAAA","name":"Ann's"}"#;
    let bobs = r#"bob {"edit":"set_name","path":"ROOT/BBBBBB","name":"Bob's"}"#;
    let more = r#"bob {"edit":"set_name","path":"ROOT/BBBBBB","name":"More"}"#;
    check_steps(
        &[anns, bobs, more, "ann <", "ann @1", "bob @1", "ann @!1", "bob <", "ann <", "bob <"],
        &expect![[r#"
            ann: others_edits: this reverts 2 steps of bob: ask them first, or set `over_others`; a jump can be taken back
            bob: others_edits: this reverts 1 step of ann: ask them first, or set `over_others`; a jump can be taken back
            bob: built_upon: `set_name` cannot be taken back: ann has changed the name of ROOT/BBBBBB since (`Jump to "set_name"`); ask for that to be taken back first, or change it by hand
            1 Edit ann set_name
            2 Edit bob set_name
            3 Edit bob set_name
            4 Undo ann set_name
            5 = 1 Jump ann Jump to "set_name"
            6 = 4 Undo ann Jump to "set_name"
            7 Undo bob set_name
            AAAAAA"#]],
    );
}

#[test]
fn the_same_request_is_answered_by_what_it_did() {
    let mut open = OpenMachine::new(machine(START), 7);
    let request = EditRequest { author: "ann".into(), id: "one".into() };
    assert_eq!(open.answered(&request), None);
    let other = Operation::Replace { document: machine("execution X") };
    let prepared = open.prepare(request.clone(), 0, other);
    assert_eq!(open.commit(prepared.expect("prepared")), 8);
    assert_eq!(open.answered(&request), Some(8));
    assert_eq!(open.answered(&EditRequest { author: "bob".into(), ..request }), None);
}

/// Makes random edits, undos and redos of two users. Both follow the received changes.
fn two_people(numbers: Vec<u16>) {
    let mut open = OpenMachine::new(machine(START), 0);
    let mut mirror = Mirror::new(Document::of(open.machine()));
    let mut dice = Dice::new(numbers);
    while !dice.is_empty() {
        let author = ["ann", "bob"][dice.roll(2)];
        let deed = match dice.roll(9) {
            0 | 1 => Operation::Undo,
            2 | 3 => Operation::Redo,
            4 => {
                let back = u64::try_from(dice.roll(20)).expect("a number");
                let revision = open.revision().saturating_sub(back);
                Operation::Jump { revision, over_others: dice.roll(2) == 0 }
            }
            _ => Operation::Edit { name: "Any".into(), edit: edit(open.machine(), &mut dice) },
        };
        let before = open.machine().clone();
        let from = open.revision() + 1;
        if done(&mut open, author, deed).parse::<u64>().is_err() {
            assert_eq!(*open.machine(), before);
            continue;
        }
        let RevisionsPage::Revisions(told) = open.since(from) else { panic!("a gap") };
        for (number, text) in (from..).zip(told) {
            let revision: Revision = serde_json::from_str(&text).expect("a revision");
            assert_eq!((revision.revision, revision.author.as_str()), (number, author));
            revision.changes.into_iter().for_each(|change| mirror.apply(change));
        }
    }
    assert_eq!(mirror.document(), Document::of(open.machine()));
    let faults = problems(open.machine(), &BuiltinTypes);
    // A machine may lack a start or states during editing.
    assert!(faults.iter().all(|fault| !fault.rule.refuses_edits()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn two_people_and_whoever_follows_them_see_one_machine(numbers in proptest::collection::vec(any::<u16>(), 0..1500)) {
        two_people(numbers);
    }
}
