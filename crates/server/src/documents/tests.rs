//! Several people edit one machine: nobody's work is lost, and each takes back what is his own.

use super::log::Page;
use super::machine::{Deed, OpenMachine, Request};
use super::steps::Along;
use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_model::edit::any::{Dice, edit};
use rafcon_model::{BuiltinTypes, Machine, notation, problems};
use rafcon_protocol::api::Revision;
use rafcon_protocol::document::{Document, Mirror};
use rafcon_protocol::edit::Edit;

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

/// Does it; the name of the step and the new revision, or the refusal.
fn done(open: &mut OpenMachine, author: &str, deed: Deed) -> String {
    match open.prepare(author, deed) {
        Err(failure) => format!("{}: {failure}", failure.refusal().code),
        Ok(prepared) => {
            let id = open.revision().to_string();
            let request = Request { author: author.to_owned(), id };
            open.commit(prepared, request, 0).to_string()
        }
    }
}

/// One line a deed: the author, then `<` (back), `>` (again) or an edit as JSON.
fn check(lines: &[&str], expect: &Expect) {
    let mut open = OpenMachine::new(machine(START), 0);
    let mut out = Vec::new();
    for line in lines {
        let (author, what) = line.split_once(' ').expect("an author and a deed");
        let deed = match what {
            "<" => Deed::Along(Along::Back),
            ">" => Deed::Along(Along::Again),
            text => {
                let edit: Edit = serde_json::from_str(text).expect("an edit");
                let name = text.split('"').nth(3).expect("a name").to_owned();
                Deed::Edit(name, (&edit).try_into().expect("an edit of the model"))
            }
        };
        out.push(format!("{author}: {}\n", done(&mut open, author, deed)));
    }
    expect.assert_eq(&(out.concat() + &notation::print(open.machine())));
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
        ann: built_upon: `set_position` cannot be taken back: somebody else has moved the same part of ROOT since; move it by hand
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
    let other = Box::new(machine("execution OTHERR"));
    let mut said = vec![done(&mut open, "ann", Deed::Replace(other))];
    let rename = r#"{"edit":"set_name","path":"OTHERR","name":"Bob's"}"#;
    let rename: Edit = serde_json::from_str(rename).expect("an edit");
    let rename = Deed::Edit("Rename".into(), (&rename).try_into().expect("an edit"));
    said.push(done(&mut open, "bob", rename));
    said.push(done(&mut open, "ann", Deed::Along(Along::Back)));
    said.push(done(&mut open, "bob", Deed::Along(Along::Back)));
    said.push(done(&mut open, "ann", Deed::Along(Along::Back)));
    assert_eq!(*open.machine(), machine(START));
    expect![[r"
        1
        2
        built_upon: `Reload` cannot be taken back: bob has changed OTHERR since (`Rename`); ask for that to be taken back first, or change it by hand
        3
        4"]].assert_eq(&said.join("\n"));
}

#[test]
fn the_same_request_is_answered_by_what_it_did() {
    let mut open = OpenMachine::new(machine(START), 7);
    let request = Request { author: "ann".into(), id: "one".into() };
    assert_eq!(open.answered(&request), None);
    let prepared = open.prepare("ann", Deed::Replace(Box::new(machine("execution X"))));
    assert_eq!(open.commit(prepared.expect("prepared"), request.clone(), 0), 8);
    assert_eq!(open.answered(&request), Some(8));
    assert_eq!(open.answered(&Request { author: "bob".into(), ..request }), None);
}

/// Makes random edits and steps back of two people; both follow by what they are told.
fn two_people(numbers: Vec<u16>) {
    let mut open = OpenMachine::new(machine(START), 0);
    let mut mirror = Mirror::new(Document::of(open.machine()));
    let mut dice = Dice::new(numbers);
    while !dice.is_empty() {
        let author = ["ann", "bob"][dice.roll(2)];
        let deed = match dice.roll(4) {
            0 => Deed::Along(Along::Back),
            1 => Deed::Along(Along::Again),
            _ => Deed::Edit("Any".into(), edit(open.machine(), &mut dice)),
        };
        let before = open.machine().clone();
        let from = open.revision() + 1;
        if done(&mut open, author, deed).parse::<u64>().is_err() {
            assert_eq!(*open.machine(), before);
            continue;
        }
        let Page::Revisions(told) = open.since(from) else { panic!("a gap") };
        for told in told {
            let revision: Revision = serde_json::from_str(&told.text).expect("a revision");
            assert_eq!((revision.revision, revision.author.as_str()), (told.number, author));
            revision.changes.into_iter().for_each(|change| mirror.apply(change));
        }
    }
    assert_eq!(mirror.document(), Document::of(open.machine()));
    let faults = problems(open.machine(), &BuiltinTypes);
    assert!(faults.iter().all(|fault| fault.severity() != rafcon_model::Severity::Error));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn two_people_and_whoever_follows_them_see_one_machine(numbers in proptest::collection::vec(any::<u16>(), 0..1500)) {
        two_people(numbers);
    }
}
