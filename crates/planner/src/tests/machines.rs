//! Machines built from plans.

use super::{HUNGRY, LUNCH, PERSONS, RESTAURANT, plan, pool, root, task};
use crate::order::Order;
use crate::{
    Build, BuildError, REPLAN as REPLAN_PATH, Recovery, Replanning, Structure, Then, build, explain,
};
use expect_test::{Expect, expect};
use rafcon_model::notation::print;
use rafcon_model::{
    BuiltinTypes, DataType, Header, Json, Machine, Outcome, OutcomeId, Port, PortId, State, Value,
    problems,
};
use std::sync::Arc;

fn library(name: &str) -> Result<Arc<State>, String> {
    if name.ends_with("missing") {
        Err("nobody has it".to_owned())
    } else {
        Ok(root("Is it there?", "chef", &Json::object()))
    }
}

fn make(
    skills: &str,
    steps: &str,
    recovery: Recovery,
    replanning: Option<&Replanning>,
) -> Result<State, BuildError> {
    let pool = pool(skills, PERSONS);
    let (task, _) = task(&pool, HUNGRY);
    let plan = plan(steps);
    assert_eq!(explain(&task, &plan).len(), plan.steps.len());
    let structure = Structure::of(&Order::of(&task, &plan));
    let data = [("PIZZA".into(), Value::str("pizza margherita"))];
    let library = library as fn(&str) -> _;
    let made = build(&Build {
        name: "lunch",
        task: &task,
        pool: &pool,
        plan: &plan,
        structure: &structure,
        data: &data,
        recovery,
        replanning,
        library: &library,
    })?;
    for (step, path) in plan.steps.iter().zip(&made.steps) {
        let machine = Machine { header: Header::default(), root: Arc::new(made.root.clone()) };
        assert!(machine.state(path).is_some(), "{step} stands nowhere");
    }
    Ok(made.root)
}

fn check(made: Result<State, BuildError>, expect: &Expect) {
    let text = match made {
        Ok(root) => {
            let machine = Machine { header: Header::default(), root: Arc::new(root) };
            let found = problems(&machine, &BuiltinTypes);
            assert!(found.is_empty(), "{found:?}");
            let text = print(&machine);
            let shown = text.lines().filter(|line| !line.trim_start().starts_with("layout"));
            // The content of libraries is not part of the plan's machine.
            super::lines(
                shown.filter(|line| !line.contains("SKILLX") && !line.contains("semantic")),
            )
        }
        Err(error) => error.to_string(),
    };
    expect.assert_eq(&text);
}

#[test]
fn a_step_is_a_library_state_with_its_values() {
    check(
        make(
            RESTAURANT,
            "(order james alice pizza table)\n(cook bob pizza)",
            Recovery::default(),
            None,
        ),
        &expect![[r#"
            hierarchy IZHCZT "lunch"
              outcome success
              start -> WSGWTV
              WSGWTV.aborted -> .aborted
              WSGWTV.success -> .success
              barrier WSGWTV "order James alice pizza table, cook bob pizza"
                outcome success
                TEVWVM.success -> unique_decider_state_id
                TEVWVM.aborted -> unique_decider_state_id
                ACCTFZ.success -> unique_decider_state_id
                ACCTFZ.aborted -> unique_decider_state_id
                unique_decider_state_id.success -> .success
                unique_decider_state_id.aborted -> .aborted
                library ACCTFZ "cook bob pizza" from "pool/cook"
                  set in chef = "bob"
                  set in food = "pizza margherita"
                  content
                      outcome success
                      in chef: str
                      in food: str
                      script ""
                library TEVWVM "order James alice pizza table" from "pool/order"
                  set in interlocutor1 = "James"
                  set in interlocutor2 = "alice"
                  set in food = "pizza margherita"
                  content
                      outcome success
                      in interlocutor1: str
                      in interlocutor2: str
                      in food: str
                      script ""
                decider unique_decider_state_id "Decider"
                  outcome success
                  in wanted: dict = {"TEVWVM": "success", "ACCTFZ": "success"}
                  script |
                    def execute(self, inputs, outputs, gvm):
                        ends = {state_id: outcome.name for state_id, (_, outcome) in self.final_outcomes_dict.items()}
                        missed = [state_id for state_id, outcome in inputs["wanted"].items() if ends.get(state_id) != outcome]
                        return "aborted" if missed else "success"
        "#]],
    );
}

#[test]
fn a_plan_without_steps_is_a_machine() {
    check(
        make(RESTAURANT, "", Recovery::default(), None),
        &expect![[r#"
        hierarchy JJLIVD "lunch"
          outcome success
          start -> AIJCRI
          AIJCRI.success -> .success
          execution AIJCRI "Nothing to do"
            outcome success
            script |
              def execute(self, inputs, outputs, gvm):
                  return "success"
    "#]],
    );
}

#[test]
fn failures_lead_to_what_is_declared() {
    let declared = r#"planning {"check": "pool/is_there", "retries": 2, "then": "ask"}"#;
    let skills = RESTAURANT.replace("skill give", &format!("{declared}\nskill give"));
    check(
        make(&skills, "(cook bob pizza)", Recovery::default(), None),
        &expect![[r#"
            hierarchy THSKWG "lunch"
              outcome success
              start -> DIOOLJ
              DIOOLJ.aborted -> .aborted
              DIOOLJ.success -> .success
              hierarchy DIOOLJ "cook bob pizza"
                outcome success
                var tries: int = 0
                start -> OWHXCX
                TWYPAX.success -> .success
                FINGMD.again -> OWHXCX
                FINGMD.done -> .success
                FINGMD."give up" -> .aborted
                FINGMD.aborted -> .aborted
                OWHXCX.success -> TWYPAX
                OWHXCX.aborted -> FINGMD
                TWYPAX.aborted -> CTUECC
                CTUECC.again -> OWHXCX
                CTUECC.over -> FINGMD
                CTUECC.aborted -> .aborted
                flow .tries -> CTUECC.tries
                flow CTUECC.tries -> .tries
                execution CTUECC "Try again"
                  outcome again
                  outcome over
                  in tries: int = 0
                  in retries: int = 2
                  out tries: int = 0
                  script |
                    def execute(self, inputs, outputs, gvm):
                        outputs["tries"] = inputs["tries"] + 1
                        return "again" if outputs["tries"] <= inputs["retries"] else "over"
                execution FINGMD "Ask"
                  outcome again
                  outcome done
                  outcome "give up"
                  in step: str = "cook bob pizza"
                  script |
                    from rafcon import dialog

                    ANSWERS = ("again", "done", "give up")


                    def execute(self, inputs, outputs, gvm):
                        pressed = dialog.ask(f"{inputs['step']} has failed.", ("Try again", "It is done", "Give up"), default=2)
                        return ANSWERS[pressed.button]
                library OWHXCX "Check before cook bob pizza" from "pool/is_there"
                  set in chef = "bob"
                  content
                      outcome success
                      in chef: str
                      script ""
                library TWYPAX "cook bob pizza" from "pool/cook"
                  set in chef = "bob"
                  set in food = "pizza margherita"
                  content
                      outcome success
                      in chef: str
                      in food: str
                      script ""
        "#]],
    );
}

#[test]
fn what_a_recovery_needs_and_is_not_there_is_named() {
    let cook = "(cook bob pizza)";
    let skills =
        RESTAURANT.replace("skill give", "planning {\"check\": \"pool/missing\"}\nskill give");
    check(
        make(&skills, cook, Recovery::default(), None),
        &expect!["the library pool/missing is missing: nobody has it"],
    );
    check(
        make(RESTAURANT, cook, Recovery { retries: 0, then: Then::Replan }, None),
        &expect!["pool/cook plans again when it fails: name the library that observes the facts"],
    );
}

const REPLAN: Recovery = Recovery { retries: 0, then: Then::Replan };

fn observed_by(path: &str, root: Arc<State>) -> Replanning {
    let inputs = vec![("goal".into(), Value::str("(be-full alice)"))];
    Replanning {
        observe: (path.into(), root),
        replan: (REPLAN_PATH.into(), replanner(&["replanned", "reached", "given up"])),
        inputs,
    }
}

/// A minimal library that plans again.
fn replanner(outcomes: &[&str]) -> Arc<State> {
    let mut again = (*root("Plan again", "facts goal plans=list", &Json::object())).clone();
    let own = (0..).zip(outcomes).map(|(id, name)| Outcome::new(OutcomeId(id), name));
    again.outcomes =
        again.outcomes.iter().filter(|other| other.id.0 < 0).cloned().chain(own).collect();
    again.outputs.insert(Port::new(PortId(3), "plans", DataType::List, Value::List([].into())));
    Arc::new(again)
}

fn observed() -> Replanning {
    let mut observer = (*root("observe", "", &Json::object())).clone();
    observer.outputs.insert(Port::new(PortId(7), "facts", DataType::Str, Value::str("")));
    observed_by("pool/observe", Arc::new(observer))
}

#[test]
fn a_machine_plans_again_around_a_failure() {
    check(
        make(RESTAURANT, "(cook bob pizza)", REPLAN, Some(&observed())),
        &expect![[r#"
            hierarchy THSKWG "lunch"
              outcome success
              var plans: list = [["(cook bob pizza)"]]
              OWHXCX.success -> TWYPAX
              OWHXCX.aborted -> .aborted
              TWYPAX.reached -> .success
              TWYPAX.aborted -> .aborted
              TWYPAX."given up" -> .aborted
              start -> DIOOLJ
              DIOOLJ.aborted -> OWHXCX
              DIOOLJ.success -> .success
              TWYPAX.replanned -> DIOOLJ
              flow OWHXCX.facts -> TWYPAX.facts
              flow .plans -> TWYPAX.plans
              flow TWYPAX.plans -> .plans
              library DIOOLJ "cook bob pizza" from "pool/cook"
                set in chef = "bob"
                set in food = "pizza margherita"
                content
                    outcome success
                    in chef: str
                    in food: str
                    script ""
              library OWHXCX "Observe" from "pool/observe"
                set out facts = "" unused
                content
                    outcome success
                    out 7 facts: str = ""
                    script ""
              library TWYPAX "Plan again" from "planning/replan"
                set in facts = None unused
                set in goal = "(be-full alice)"
                set in plans = None unused
                set out plans = [] unused
                content
                    outcome replanned
                    outcome reached
                    outcome "given up"
                    in facts: str
                    in goal: str
                    in plans: list
                    out plans: list = []
                    script ""
        "#]],
    );
}

#[test]
fn who_observes_must_say_the_facts() {
    let blind = observed_by("pool/blind", root("blind", "", &Json::object()));
    check(
        make(RESTAURANT, LUNCH, REPLAN, Some(&blind)),
        &expect!["the library pool/blind has no output `facts`: add it"],
    );
}

#[test]
fn who_plans_again_must_be_complete() {
    let mut replanning = observed();
    replanning.replan.1 = replanner(&["replanned", "given up"]);
    check(
        make(RESTAURANT, LUNCH, REPLAN, Some(&replanning)),
        &expect!["the library planning/replan has no outcome `reached`: add it"],
    );
    let mut replanning = observed();
    replanning.inputs.push(("engine".into(), Value::str("kairos")));
    check(
        make(RESTAURANT, LUNCH, REPLAN, Some(&replanning)),
        &expect!["the library planning/replan has no input `engine`: add it"],
    );
}

#[test]
fn a_port_that_nothing_can_set_is_named() {
    let skills = RESTAURANT.replace("skill cook chef food", "skill cook chef=dict food");
    check(
        make(&skills, "(cook bob pizza)", Recovery::default(), None),
        &expect![
            "pool/cook: the input `chef` takes dict, and the runtime data of `bob` has none: give one"
        ],
    );
}

fn shape(structure: &Structure) -> String {
    let all = |parts: &[Structure], between: &str| {
        parts.iter().map(shape).collect::<Vec<_>>().join(between)
    };
    match structure {
        Structure::Step(step) => step.to_string(),
        Structure::Series(parts) => format!("({})", all(parts, " ")),
        Structure::Parallel(parts) => format!("[{}]", all(parts, " | ")),
    }
}

fn check_shape(count: usize, pairs: &[(usize, usize)], expect: &Expect) {
    expect.assert_eq(&shape(&Structure::of(&Order::from_pairs(count, pairs))));
}

#[test]
fn what_is_free_is_done_at_the_same_time() {
    check_shape(1, &[], &expect!["(0)"]);
    check_shape(3, &[(0, 1), (1, 2)], &expect!["(0 1 2)"]);
    check_shape(3, &[(0, 2), (1, 2)], &expect!["([0 | 1] 2)"]);
    check_shape(5, &[(0, 1), (0, 2), (2, 3), (1, 4), (3, 4)], &expect!["(0 [1 | (2 3)] 4)"]);
    // The shape N is no series of parallels, so it runs level by level.
    check_shape(4, &[(0, 2), (1, 2), (1, 3)], &expect!["([0 | 1] [2 | 3])"]);
    check_shape(5, &[(0, 2), (1, 2), (1, 3), (3, 4), (2, 4)], &expect!["(([0 | 1] [2 | 3]) 4)"]);
}

#[test]
fn what_nests_too_deep_is_done_level_by_level() {
    // Each even step precedes all later ones. Each odd step runs in parallel to all later ones.
    let nested = |count: usize| {
        let pairs: Vec<_> = (0..count)
            .step_by(2)
            .flat_map(|before| (before + 1..count).map(move |after| (before, after)))
            .collect();
        shape(&Structure::of(&Order::from_pairs(count, &pairs)))
    };
    let around = |inner: &str| {
        (0..20)
            .step_by(2)
            .rev()
            .fold(inner.to_owned(), |inner, first| format!("({first} [{} | {inner}])", first + 1))
    };
    assert_eq!(nested(23), around("(20 [21 | 22])"));
    assert_eq!(nested(24), around("(20 [21 | 22] 23)"));
}

#[test]
fn the_lost_time_is_known() {
    let plan = plan("0: (a) [5]\n0: (b) [1]\n5: (c) [1]\n1: (d) [5]");
    let order = Order::from_pairs(4, &[(0, 3), (1, 2), (1, 3)]);
    let structure = Structure::of(&order);
    let figures = format!(
        "{} {} lost {}",
        shape(&structure),
        structure.makespan(&plan),
        structure.lost(&plan)
    );
    expect!["([0 | 1] [2 | 3]) 10 lost 4"].assert_eq(&figures);
}
