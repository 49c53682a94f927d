//! Machines in the notation in, their problems out.

use expect_test::{Expect, expect};
use rafcon_model::rules::{MAX_NESTING, Rule};
use rafcon_model::{BuiltinTypes, Json, Machine, Problem, problems};
use rafcon_testkit::notation;
use std::sync::Arc;

/// One line a problem: severity, rule, and what the user reads.
fn shown(machine: &Machine) -> String {
    let line =
        |problem: &Problem| format!("{:?} {}: {problem}\n", problem.severity(), problem.rule);
    problems(machine, &BuiltinTypes).iter().map(line).collect()
}

fn check(text: &str, expect: &Expect) {
    let machine = notation::parse(text).expect("a machine in the notation");
    expect.assert_eq(&shown(&machine));
}

#[test]
fn a_valid_machine_has_none() {
    check(
        r#"
        hierarchy ROOT "Root"
          outcome success
          in a: int
          out b: int
          var v: int = "3"
          start -> AAAAAA
          AAAAAA.success -> BARRIE ; AAAAAA.aborted -> .aborted
          BARRIE.success -> .success
          flow .a -> AAAAAA.x ; .v -> AAAAAA.x ; AAAAAA.y -> .v ; AAAAAA.y -> AAAAAA.x
          flow .v -> .b ; .a -> .b ; .a -> .v
          execution AAAAAA
            outcome success
            in x: int
            out y: bool
            script ""
          barrier BARRIE
            outcome success
            PREEMP.success -> unique_decider_state_id ; PREEMP.aborted -> .preempted
            unique_decider_state_id.success -> .success
            preemptive PREEMP
              outcome success
              CCCCCC.success -> .success
              execution CCCCCC
                outcome success
                script ""
            decider unique_decider_state_id
              outcome success
              script ""
        "#,
        &expect![],
    );
}

#[test]
fn places_where_a_run_waits_for_ever_are_named() {
    check(
        r#"
        hierarchy ROOT
          outcome success
          start -> EMPTYX
          EMPTYX.success -> BARRIE ; BARRIE.success -> RACERS ; RACERS.success -> NOBODY
          NOBODY.success -> .success
          hierarchy EMPTYX
            outcome success
          barrier BARRIE
            outcome success
            CHILDX.success -> unique_decider_state_id
            execution CHILDX
              outcome success
              outcome other
              script ""
            decider unique_decider_state_id
              outcome success
              script ""
          preemptive RACERS
            outcome success
            execution RACERX
              outcome success
              script ""
          preemptive NOBODY
            outcome success
        "#,
        &expect![[r"
            Note OutcomeUnconnected: ROOT/BARRIE/unique_decider_state_id, outcome 0: no transition begins at the outcome `success`; connect the outcome if it can happen
            Error ChildrenMissing: ROOT/EMPTYX, state: no state is in it; add a state; in a hierarchy, also connect the income with it
            Error ChildrenMissing: ROOT/NOBODY, state: no state is in it; add a state; in a hierarchy, also connect the income with it
            Note OutcomeUnconnected: ROOT/RACERS/RACERX, outcome 0: no transition begins at the outcome `success`; connect the outcome if it can happen
        "]],
    );
}

#[test]
fn names_and_ids() {
    check(
        r#"
        hierarchy ROOT ""
          without -2
          outcome a
          outcome a
          outcome 5 ""
          in 1 x: int
          in 2 x: int
          out 1 "": "no-type"
          var 1 error: int
          start -> .a
          execution ROOT "a/b"
            script ""
          execution "a/b"
            semantic {}
        "#,
        &expect![[r"
            Error StateName: ROOT, state: the name is empty; give the state a name
            Error OutcomeMissing: ROOT, state: the outcome preempted (-2) is missing; add the outcome
            Error OutcomeNameTwice: ROOT, outcome 0: the outcome 1 has the name `a`, too; rename one of the outcomes
            Error OutcomeNameTwice: ROOT, outcome 1: the outcome 0 has the name `a`, too; rename one of the outcomes
            Error OutcomeName: ROOT, outcome 5: the name is empty; give the outcome a name
            Error PortNameTwice: ROOT, input 1: the input 2 has the name `x`, too; rename one of the ports
            Error PortIdTwice: ROOT, input 1: there is an output with the id 1, too; remove one of the ports and add it again
            Error PortNameTwice: ROOT, input 2: the input 1 has the name `x`, too; rename one of the ports
            Error PortName: ROOT, output 1: the name is empty; give the port a name
            Error PortIdTwice: ROOT, output 1: there is an input with the id 1, too; remove one of the ports and add it again
            Error DataTypeName: ROOT, output 1: `no-type` is not the name of a type; write the type as in Python, such as int or numpy.ndarray
            Note PortNamedError: ROOT, scoped variable 1: the name `error` is where errors of scripts arrive; choose another name unless the port takes the error
            Error PortIdTwice: ROOT, scoped variable 1: there is an input with the id 1, too; remove one of the ports and add it again
            Note Unreachable: ROOT/a/b, state: no way leads to it from the start; lead a transition to the state, or remove it
            Error StateNameSlash: ROOT/ROOT, state: the name `a/b` contains a `/`; take the `/` out of the name
            Error StateIdOfParent: ROOT/ROOT, state: its parent has the id ROOT, too; give the state another id
            Error StateNameSlash: ROOT/a/b, state: the name `a/b` contains a `/`; take the `/` out of the name
            Error StateId: ROOT/a/b, state: the id `a/b` is empty or contains a `/` or a control character; give the state another id
            Note ScriptMissing: ROOT/a/b, state: there is no script; write a script
        "]],
    );
}

#[test]
fn semantic_data_is_a_dictionary() {
    let mut machine = notation::parse("execution ROOT\n  script \"\"").expect("a machine");
    Arc::make_mut(&mut machine.root).semantic_data = Some(Arc::new(Json::Int(3)));
    expect![[r"
        Error SemanticData: ROOT, state: the semantic data is not a dictionary; put the data under a key
    "]].assert_eq(&shown(&machine));
}

#[test]
fn defaults_fit_their_types() {
    check(
        r#"
        execution ROOT
          in a: int = "five"
          in b: float = 5
          in c: numpy.ndarray = [1]
          in d: "numpy..ndarray"
          in e: int = "$global"
          in f: list = "[1"
          script ""
        "#,
        &expect![[r#"
            Error DefaultType: ROOT, input 0: the default: "five" is not of the type int; change the default or the type
            Error DefaultType: ROOT, input 1: the default: 5 is not of the type float; change the default or the type
            Error DataTypeName: ROOT, input 3: `numpy..ndarray` is not the name of a type; write the type as in Python, such as int or numpy.ndarray
            Error DefaultType: ROOT, input 5: the default: "[1" is not a Python literal (character 2: expected a comma or the closing bracket); change the default or the type
        "#]],
    );
}

#[test]
fn transitions_begin_at_an_outcome() {
    check(
        r#"
        hierarchy ROOT
          outcome done
          start -> AAAAAA ; start -> .done ; start.3 -> AAAAAA ; AAAAAA -> AAAAAA
          .done -> AAAAAA ; GONE.0 -> AAAAAA ; AAAAAA.7 -> AAAAAA
          AAAAAA.success -> AAAAAA ; AAAAAA.success -> .done
          execution AAAAAA
            outcome success
            script ""
        "#,
        &expect![[r"
            Error StartTwice: ROOT, transition 1: the transition 2 begins at the income, too; remove one of the start transitions
            Error StartTwice: ROOT, transition 2: the transition 1 begins at the income, too; remove one of the start transitions
            Error OriginIncomplete: ROOT, transition 3: it begins at an outcome but at no state; connect the beginning with an outcome of a child
            Error OriginIncomplete: ROOT, transition 4: it begins at the state AAAAAA but at none of its outcomes; connect the beginning with an outcome of a child
            Error OriginContainer: ROOT, transition 5: it begins at the container itself; connect the beginning with an outcome of a child
            Error OriginState: ROOT, transition 6: it begins at GONE, which does not exist; connect the beginning with an outcome of a child, or remove the transition
            Error OriginOutcome: ROOT, transition 7: it begins at the outcome 7 of AAAAAA, which does not exist; connect the beginning with an outcome that exists, or remove the transition
            Error OriginTwice: ROOT, transition 8: the transition 9 begins at the outcome `success` of AAAAAA, too; remove one of the transitions
            Error OriginTwice: ROOT, transition 9: the transition 8 begins at the outcome `success` of AAAAAA, too; remove one of the transitions
        "]],
    );
}

#[test]
fn transitions_lead_somewhere() {
    check(
        r#"
        hierarchy ROOT
          start -> nowhere ; AAAAAA.0 -> nowhere.3 ; AAAAAA.1 -> ROOT ; AAAAAA.2 -> .9
          AAAAAA.3 -> GONE ; AAAAAA.4 -> AAAAAA.0
          execution AAAAAA
            outcome a
            outcome b
            outcome c
            outcome d
            outcome e
            script ""
        "#,
        &expect![[r"
            Error TargetMissing: ROOT, transition 1: it leads nowhere; connect the end with a child or an outcome of the container
            Error TargetMissing: ROOT, transition 2: it leads nowhere; connect the end with a child or an outcome of the container
            Error TargetIncomplete: ROOT, transition 3: it leads to the container but to none of its outcomes; connect the end with an outcome of the container
            Error TargetOutcome: ROOT, transition 4: it leads to the outcome 9 of the container, which does not exist; connect the end with an outcome that exists, or remove the transition
            Error TargetState: ROOT, transition 5: it leads to GONE, which does not exist; connect the end with a child or an outcome of the container, or remove the transition
            Error TargetOutcomeOfChild: ROOT, transition 6: it leads to the outcome 0 of the child AAAAAA; connect the end with the child's income
            Note Unreachable: ROOT/AAAAAA, state: no way leads to it from the start; lead a transition to the state, or remove it
        "]],
    );
}

#[test]
fn concurrency_states_have_their_own_rules() {
    check(
        r#"
        preemptive ROOT
          outcome done
          start -> BARRIE ; BARRIE.done -> AAAAAA
          barrier BARRIE
            outcome done
            start -> CCCCCC ; CCCCCC.done -> .done ; CCCCCC.aborted -> .done
            CCCCCC.preempted -> CCCCCC ; unique_decider_state_id.done -> CCCCCC
            execution CCCCCC
              outcome done
              script ""
            execution unique_decider_state_id
              outcome done
              script ""
          barrier AAAAAA
            decider EEEEEE
              script ""
          decider unique_decider_state_id
            script ""
        "#,
        &expect![[r"
            Error StartInConcurrency: ROOT, transition 1: it begins at the income of a preemptive concurrency state; remove the start transition
            Error PreemptiveTarget: ROOT, transition 2: it leads to a child of a preemptive concurrency state; connect the end with an outcome of the container
            Error DeciderMissing: ROOT/AAAAAA, state: the barrier has no decider; add the decider, or make the state another kind
            Error DeciderMisplaced: ROOT/AAAAAA/EEEEEE, state: a decider has the id unique_decider_state_id; make it an execution state with an id of its own
            Error StartInConcurrency: ROOT/BARRIE, transition 1: it begins at the income of a barrier concurrency state; remove the start transition
            Error BarrierTarget: ROOT/BARRIE, transition 2: it leads from the child CCCCCC of a barrier past the decider; connect the end with the decider
            Error BarrierTarget: ROOT/BARRIE, transition 3: it leads from the child CCCCCC of a barrier past the decider; connect the end with the decider
            Error BarrierTarget: ROOT/BARRIE, transition 4: it leads from the child CCCCCC of a barrier past the decider; connect the end with the decider
            Error DeciderTarget: ROOT/BARRIE, transition 5: it leads from the decider to a child; connect the end with an outcome of the container
            Error DeciderMisplaced: ROOT/BARRIE/unique_decider_state_id, state: the id unique_decider_state_id is that of a decider; make it an execution state with an id of its own
            Error DeciderMisplaced: ROOT/unique_decider_state_id, state: a decider is outside of a barrier; make it an execution state with an id of its own
        "]],
    );
}

#[test]
fn data_flows_connect_ports_that_fit() {
    check(
        r#"
        hierarchy ROOT
          in i: int
          out o: str
          var v: int
          var w: int
          flow GONE.0 -> .v ; AAAAAA.9 -> .v ; .v -> .v ; .1 -> .v ; AAAAAA.0 -> .v
          flow .i -> AAAAAA.1 ; .i -> .0 ; .v -> .w ; .i -> .o ; .i -> AAAAAA.m
          flow AAAAAA.y -> .v ; AAAAAA.y -> .v ; .v -> CCCCCC.0
          execution AAAAAA
            in x: float
            out y: int
            in m: numpy.ndarray
            script ""
          hierarchy CCCCCC
            var hidden: int
        "#,
        &expect![[r"
            Error StartMissing: ROOT, state: no child is where it starts; connect the income with a child
            Error FlowState: ROOT, data flow 1: it begins at GONE, which does not exist; connect the data flow with a child or the container, or remove it
            Error FlowPort: ROOT, data flow 2: it begins at the port 9 of AAAAAA, which does not exist; connect the data flow with a port that exists, or remove it
            Error FlowSamePort: ROOT, data flow 3: it leads to the port where it begins; connect the two ends with different ports
            Error FlowSource: ROOT, data flow 4: it begins at the output `o` of the container; begin at an output of a child, or at an input or scoped variable of the container
            Error FlowSource: ROOT, data flow 5: it begins at the input `x` of a child; begin at an output of a child, or at an input or scoped variable of the container
            Error FlowTarget: ROOT, data flow 6: it ends at the output `y` of a child; end at an input of a child, or at an output or scoped variable of the container
            Error FlowSamePort: ROOT, data flow 7: it leads to the port where it begins; connect the two ends with different ports
            Error FlowBetweenVariables: ROOT, data flow 8: it connects two scoped variables; let a state pass the value on
            Error FlowType: ROOT, data flow 9: the types do not fit from `i` (int) to `o` (str); change one of the types, or use object
            Note FlowTypeUnknown: ROOT, data flow 10: it is unknown whether the types fit from `i` (int) to `m` (numpy.ndarray); it is checked when the machine runs
            Error FlowTwice: ROOT, data flow 11: the data flow 12 already connects these ports; remove one of the data flows
            Error FlowTwice: ROOT, data flow 12: the data flow 11 already connects these ports; remove one of the data flows
            Error FlowPort: ROOT, data flow 13: it ends at the port 0 of CCCCCC, which does not exist; connect the data flow with a port that exists, or remove it
            Error ChildrenMissing: ROOT/CCCCCC, state: no state is in it; add a state; in a hierarchy, also connect the income with it
        "]],
    );
}

#[test]
fn libraries_are_looked_at_once() {
    check(
        r#"
        define lib
          hierarchy LIBRAR
            outcome success
            in x: int
            start -> GONE
        hierarchy ROOT
          library AAAAAA from "lib/one"
            set in x = "three"
            set in 7 = 1
            set out 0 = 1
            content lib
          library BBBBBB from "lib/one"
            set in x = "three" unused
            content lib
          library CCCCCC from "lib/one"
            outcome other
            content lib
          library DDDDDD
            missing "no such folder"
        "#,
        &expect![[r#"
            Error StartMissing: ROOT, state: no child is where it starts; connect the income with a child
            Note OutcomeUnconnected: ROOT/AAAAAA, outcome 0: no transition begins at the outcome `success`; connect the outcome if it can happen
            Error RuntimeValueType: ROOT/AAAAAA, runtime value of input 0: the runtime value of `x`: "three" is not of the type int; change the runtime value or do not use it
            Error RuntimeValuePort: ROOT/AAAAAA, runtime value of input 7: there is no input with the id 7; remove the runtime value
            Error RuntimeValuePort: ROOT/AAAAAA, runtime value of output 0: there is no output with the id 0; remove the runtime value
            Error TargetState: ROOT/AAAAAA/LIBRAR, transition 1: it leads to GONE, which does not exist; connect the end with a child or an outcome of the container, or remove the transition
            Note OutcomeUnconnected: ROOT/BBBBBB, outcome 0: no transition begins at the outcome `success`; connect the outcome if it can happen
            Error LibraryInterface: ROOT/CCCCCC, state: its outcomes or ports are not those of the library; load the machine again, so that the state takes over the ports of its library
            Note OutcomeUnconnected: ROOT/CCCCCC, outcome 0: no transition begins at the outcome `other`; connect the outcome if it can happen
            Error LibraryName: ROOT/DDDDDD, state: the library has no name; substitute the state by a library that exists
            Error LibraryMissing: ROOT/DDDDDD, state: the library / was not found: no such folder; check the library paths, or substitute the state
        "#]],
    );
}

#[test]
fn deep_machines_are_no_danger() {
    let level = |depth: usize| format!("{}hierarchy S{depth}\n", " ".repeat(depth));
    let text = |levels: usize| (0..levels).map(level).collect::<String>();
    let nesting = |levels: usize| {
        let machine = notation::parse(&text(levels)).expect("a machine");
        problems(&machine, &BuiltinTypes).iter().filter(|p| p.rule == Rule::Nesting).count()
    };
    assert_eq!((nesting(MAX_NESTING), nesting(MAX_NESTING + 1)), (0, 1));
}

#[test]
fn every_rule_has_a_way_out() {
    for rule in Rule::ALL {
        assert!(!rule.way_out().is_empty() && !rule.way_out().ends_with('.'), "{rule}");
    }
}

#[test]
fn states_that_nothing_reaches_are_noted() {
    check(
        "hierarchy ROOT
           outcome success
           start -> AAAAAA
           AAAAAA.success -> BBBBBB ; BBBBBB.success -> .success ; LOOPXX.success -> LOOPXX
           execution AAAAAA
             outcome success
             script \"\"
           execution BBBBBB
             outcome success
             script \"\"
           execution LOOPXX
             outcome success
             script \"\"",
        &expect![[r"
            Note Unreachable: ROOT/LOOPXX, state: no way leads to it from the start; lead a transition to the state, or remove it
        "]],
    );
}

#[test]
fn lost_link_policies_are_understood_and_lead_on() {
    check(
        r#"hierarchy ROOT
           outcome success
           start -> AAAAAA
           AAAAAA.success -> .success ; AAAAAA.preempted -> BBBBBB
           BBBBBB.success -> .success
           semantic {"lost_link": {"recover_s": 30}}
           execution AAAAAA
             outcome success
             script ""
             semantic {"lost_command": {"recover_s": 30}}
           execution BBBBBB
             outcome success
             script ""
             semantic {"lost_command": {"recover_s": 30}, "lost_link": "go home"}"#,
        &expect![[r"
            Note LostLinkRecovery: ROOT, state: `lost_link` preempts the state, and no transition begins at `preempted`; lead the outcome preempted to the state that recovers
            Note LostLinkWayHome: ROOT/AAAAAA, state: the recovery of `lost_command` leads to BBBBBB, and `recover_s` of BBBBBB pauses that state; write continue under this key on the state to which preempted leads
            Note LostLink: ROOT/BBBBBB, state: the semantic data `lost_link` is not understood; write the text continue, or seconds under finish_s, hold_s or recover_s; it is ignored until then
            Note LostLinkRecovery: ROOT/BBBBBB, state: `lost_command` preempts the state, and no transition begins at `preempted`; lead the outcome preempted to the state that recovers
        "]],
    );
}

#[test]
fn a_finish_that_pauses_nothing_is_noted() {
    check(
        r#"hierarchy ROOT
           outcome success
           start -> LOOPXX
           LOOPXX.success -> ENDING ; ENDING.success -> .success
           semantic {"lost_command": {"finish_s": 30}}
           hierarchy LOOPXX
             outcome success
             semantic {"lost_link": {"finish_s": 30}}
             start -> AAAAAA
             AAAAAA.success -> BBBBBB ; AAAAAA.aborted -> .success ; BBBBBB.success -> AAAAAA
             execution AAAAAA
               outcome success
               script ""
             execution BBBBBB
               outcome success
               script ""
           hierarchy ENDING
             outcome success
             semantic {"lost_link": {"finish_s": 30}}
             start -> CCCCCC ; CCCCCC.success -> .success
             execution CCCCCC
               outcome success
               script """#,
        &expect![[r"
            Note LostLinkFinish: ROOT, state: `finish_s` of `lost_command` pauses nothing: the run ends with the root; set hold_s or recover_s on the state, or finish_s on the states in it
            Note LostLinkFinish: ROOT/LOOPXX, state: `finish_s` of `lost_link` pauses nothing: the state never ends by itself; set hold_s or recover_s on the state, or finish_s on the states in it
        "]],
    );
}

#[test]
fn a_state_that_may_be_paused_before_it_recovers_is_noted() {
    check(
        r#"hierarchy ROOT
           outcome success
           start -> AAAAAA
           AAAAAA.success -> MISSIO ; AAAAAA.preempted -> .success
           MISSIO.success -> .success ; MISSIO.preempted -> .success
           execution AAAAAA
             outcome success
             script ""
             semantic {"lost_link": {"finish_s": 30, "recover_s": 60}}
           hierarchy MISSIO
             outcome success
             semantic {"lost_link": {"recover_s": 60}}
             start -> BBBBBB ; BBBBBB.success -> .success ; BBBBBB.preempted -> .success
             execution BBBBBB
               outcome success
               script ""
               semantic {"lost_link": {"finish_s": 30, "recover_s": 60}}"#,
        &expect![[r"
            Note LostLinkFinishFirst: ROOT/AAAAAA, state: if the state ends between `finish_s` and `recover_s` of `lost_link`, its branch is paused and never recovers; put the state into one that recovers, too, or remove finish_s
        "]],
    );
}

#[test]
fn a_way_home_that_a_policy_around_pauses_is_noted() {
    let machine = r#"hierarchy ROOT
           outcome success
           start -> AAAAAA
           AAAAAA.success -> .success ; AAAAAA.preempted -> HOMEXX
           HOMEXX.success -> .success
           semantic {"lost_link": {"hold_s": 30}}
           execution AAAAAA
             outcome success
             script ""
             semantic {"lost_link": {"recover_s": 60}}
           execution HOMEXX
             outcome success
             script """#;
    check(
        machine,
        &expect![[r"
        Note LostLinkWayHome: ROOT/AAAAAA, state: the recovery of `lost_link` leads to HOMEXX, and `hold_s` of ROOT pauses that state; write continue under this key on the state to which preempted leads
    "]],
    );
    let own = "\n             semantic {\"lost_link\": \"continue\"}";
    check(&format!("{machine}{own}"), &expect![]);
    let own = own.replace("\"continue\"", "{\"hold_s\": 90}");
    check(
        &format!("{machine}{own}"),
        &expect![[r"
        Note LostLinkWayHome: ROOT/AAAAAA, state: the recovery of `lost_link` leads to HOMEXX, and `hold_s` of HOMEXX pauses that state; write continue under this key on the state to which preempted leads
    "]],
    );
}
