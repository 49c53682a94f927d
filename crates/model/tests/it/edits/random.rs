//! Any edits on any machine: no rule is broken that was not broken before, and everything can be taken back.

use proptest::prelude::*;
use rafcon_model::edit::{Edit, apply};
use rafcon_model::{BuiltinTypes, Machine, Rule, problems};
use rafcon_testkit::edits::{Dice, edit};
use rafcon_testkit::notation;
use std::collections::BTreeMap;

const START: &str = "
    hierarchy ROOT
      outcome success
      in a: int
      out b: int
      var v: int
      start -> AAAAAA
      AAAAAA.success -> BBBBBB ; BBBBBB.success -> .success
      flow .a -> AAAAAA.x ; AAAAAA.y -> .v ; .v -> CCCCCC.x
      execution AAAAAA
        outcome success
        in x: int
        out y: int
      barrier BBBBBB
        outcome success
        DDDDDD.success -> unique_decider_state_id
        execution DDDDDD
          outcome success
        decider unique_decider_state_id
          outcome success
      hierarchy CCCCCC
        outcome success
        in x: int
        var w: int
        start -> EEEEEE
        flow .x -> .w
        library EEEEEE from \"lib/one\"
          content
            execution LLLLLL
              outcome success
              in q: object
      preemptive FFFFFF
        outcome success
        GGGGGG.success -> .success
        execution GGGGGG
          outcome success
";

/// Ids at the end of what a number can be.
const FULL: &str = "
    barrier ROOT
      outcome success
      var v: int
      AAAAAA.success -> unique_decider_state_id as 9223372036854775807
      unique_decider_state_id.success -> .success as 0
      flow .v -> AAAAAA.x as 9223372036854775807
      hierarchy AAAAAA
        outcome success
        in 9223372036854775807 x: int
        start -> BBBBBB as -9223372036854775808
        BBBBBB.9223372036854775807 -> .success as 9223372036854775807
        flow .x -> BBBBBB.x as 9223372036854775807
        execution BBBBBB
          outcome 9223372036854775807 done
          in -9223372036854775808 x: int
      decider unique_decider_state_id
        outcome success
";

const FAULTY: &str = "
    hierarchy ROOT
      without -1
      outcome success
      outcome success
      in a: int = \"five\"
      in b: int
      out 1 b: int
      start -> GONE ; start -> AAAAAA
      AAAAAA -> BBBBBB ; AAAAAA.7 -> BBBBBB ; AAAAAA.success -> nowhere ; .0 -> AAAAAA
      flow .a -> AAAAAA.7 ; GONE.0 -> AAAAAA.x ; .a -> .0 ; AAAAAA.0 -> .b
      execution AAAAAA \"\"
        outcome success
        in x: str
      barrier BBBBBB
        start -> AAAAAA
        AAAAAA.success -> .3
        execution AAAAAA
          outcome success
      preemptive CCCCCC
        AAAAAA.success -> AAAAAA
        execution AAAAAA
          outcome success
        decider unique_decider_state_id
      library EEEEEE
        set in 3 = 4
        missing \"no folder\"
";

/// How often each rule is broken.
fn faults(machine: &Machine) -> BTreeMap<Rule, usize> {
    let mut counts = BTreeMap::new();
    for problem in problems(machine, &BuiltinTypes).into_iter().filter(|p| p.rule.refuses_edits()) {
        *counts.entry(problem.rule).or_default() += 1;
    }
    counts
}

/// Makes the edits; holds after each what an edit promises.
fn edit_and_look(text: &str, numbers: Vec<u16>) {
    let mut machine = notation::parse(text).expect("a machine");
    let mut dice = Dice::new(numbers);
    let mut backs = Vec::new();
    while !dice.is_empty() {
        let before = machine.clone();
        let edit = edit(&machine, &mut dice);
        let shown = format!("{edit:?}");
        match apply(&mut machine, edit, &BuiltinTypes) {
            Ok(back) => {
                let (earlier, now) = (faults(&before), faults(&machine));
                for (rule, count) in now {
                    assert!(
                        earlier.get(&rule).is_some_and(|n| *n >= count),
                        "{rule} by {shown}\n{}",
                        notation::print(&before)
                    );
                }
                let after = machine.clone();
                backs.push((before, back, after, shown));
            }
            Err(_) => assert_eq!(machine, before, "{shown}"),
        }
    }
    assert_eq!(notation::parse(&notation::print(&machine)).as_ref(), Ok(&machine));
    take_all_back(machine, backs);
}

fn take_all_back(mut machine: Machine, backs: Vec<(Machine, Edit, Machine, String)>) {
    let mut agains = Vec::new();
    for (before, back, after, shown) in backs.into_iter().rev() {
        let again = apply(&mut machine, back, &BuiltinTypes);
        agains.push((again.unwrap_or_else(|error| panic!("{error} taking back {shown}")), after));
        assert_eq!(machine, before, "{shown}");
    }
    for (again, after) in agains.into_iter().rev() {
        apply(&mut machine, again, &BuiltinTypes).expect("an edit is made again");
        assert_eq!(machine, after);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn any_edits_keep_every_rule_and_can_be_taken_back(numbers in proptest::collection::vec(any::<u16>(), 0..400)) {
        edit_and_look(START, numbers);
    }

    /// The same where ids come to their end.
    #[test]
    fn edits_find_room_for_their_ids(numbers in proptest::collection::vec(any::<u16>(), 0..200)) {
        edit_and_look(FULL, numbers);
    }

    /// The same where much is wrong to begin with.
    #[test]
    fn edits_of_a_faulty_machine_make_nothing_worse(numbers in proptest::collection::vec(any::<u16>(), 0..400)) {
        edit_and_look(FAULTY, numbers);
    }
}
