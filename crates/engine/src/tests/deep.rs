//! Machines that are much deeper than the call stack.

use crate::{
    Effect, Engine, Input, ModelLiterals, NoGlobals, Outbox, Program, Returned, ScriptResult, Start,
};
use rafcon_model::{
    Container, Kind, Machine, Origin, Outcome, OutcomeId, Script, State, StateId, Target,
    Transition, TransitionId,
};
use std::sync::Arc;

/// Nests hierarchies, runs the script at the bottom and then leaves all of them.
pub(super) fn check_depth(depth: usize) {
    let machine = nested(depth);
    let program = Arc::new(Program::compile(&machine, &mut ModelLiterals));
    let mut engine = Engine::new(program);
    let mut out = Outbox::default();
    engine.handle(Input::Start(Start::default()), &NoGlobals, &mut out).expect("a start");
    let Some(Effect::Run(job)) = out.effects.pop() else { panic!("no job") };
    let result = ScriptResult { returned: Returned::Id(0), outputs: Vec::new(), error: None };
    engine.handle(Input::Finished { frame: job.frame, result }, &NoGlobals, &mut out).expect("end");
    let Some(Effect::Finish(finish)) = out.effects.pop() else { panic!("not finished") };
    assert_eq!((finish.outcome, finish.states_run), (OutcomeId(0), depth as u64 + 1));
    drop(machine);
    drop(engine);
}

fn nested(depth: usize) -> Machine {
    let mut state =
        with_outcome(State::new("LEAF".into(), "leaf", Kind::Execution(Script::default())));
    for level in 0..depth {
        let id = StateId::new(format!("L{level}"));
        let mut container = Container::default();
        let child = state.id.clone();
        let steps = [
            (Origin::Income, Target::State(child.clone())),
            (Origin::Outcome(child.clone(), OutcomeId(0)), Target::Outcome(OutcomeId(0))),
        ];
        for (number, (origin, target)) in (1..).zip(steps) {
            container.transitions.insert(Transition::new(
                TransitionId(number),
                origin,
                target,
                &id,
            ));
        }
        container.states.insert(child, Arc::new(state));
        state = with_outcome(State::new(id, "level", Kind::Hierarchy(container)));
    }
    Machine { header: rafcon_model::Header::default(), root: Arc::new(state) }
}

fn with_outcome(mut state: State) -> State {
    state.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
    state
}
