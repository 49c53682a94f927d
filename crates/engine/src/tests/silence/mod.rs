//! Lost link over random machines: random silences, ends of scripts, crashes and commands, checked by an oracle.

mod machine;
mod oracle;

use crate::{
    Counted, Effect, Engine, Event, HeldBy, Input, Interrupted, Job, ModelLiterals, NoGlobals,
    Outbox, PathId, Program, Restore, Returned, ScriptResult, Silence, Start, Status,
};
use machine::{Choices, RandomMachine};
use oracle::{Checked, Given, LossIndex, Oracle, Seen};
use proptest::prelude::{ProptestConfig, TestCaseError, any};
use proptest::test_runner::TestRunner;
use rafcon_model::{Loss, Value};
use rafcon_testkit::notation;
use std::cell::Cell;
use std::sync::Arc;

/// Number of inputs in one run.
const INPUTS: usize = 40;

/// A run, its active scripts and its oracle.
struct Trial {
    engine: Engine<Value>,
    running: Vec<Job<Value>>,
    oracle: Oracle,
    log: String,
}

impl Trial {
    fn new(machine: RandomMachine) -> Self {
        let parsed = notation::parse(&machine.text).expect("a machine in text notation");
        let program = Arc::new(Program::compile(&parsed, &mut ModelLiterals));
        Self {
            engine: Engine::new(program),
            running: Vec::new(),
            oracle: Oracle::new(machine.states),
            log: machine.text,
        }
    }

    /// Passes a legal input to the run, and checks the results with the oracle.
    fn give(&mut self, input: Input<Value>, given: Given) -> Checked {
        let mut out = Outbox::default();
        self.log(&given);
        if self.engine.handle(input, &NoGlobals, &mut out).is_err() {
            return Ok(());
        }
        self.oracle.give(given);
        for event in &out.events {
            if let Some(seen) = self.seen(event) {
                self.log(&seen);
                self.oracle.see(seen)?;
            }
        }
        let jobs = out.effects.into_iter();
        let jobs =
            jobs.filter_map(|effect| if let Effect::Run(job) = effect { Some(job) } else { None });
        self.running.extend(jobs);
        if self.engine.status() == Status::Finished { Ok(()) } else { self.oracle.rest() }
    }

    fn log(&mut self, line: &dyn std::fmt::Debug) {
        self.log.extend([format!("{line:?}"), "\n".to_owned()]);
    }

    fn seen(&self, event: &Event<Value>) -> Option<Seen> {
        let text = |path: PathId| self.engine.path_text(path).to_string();
        Some(match event {
            Event::Entered { path, .. } => Seen::Entered(text(*path)),
            Event::Left { path, node, outcome, .. } => {
                let outcome = self.engine.program().node(*node).outcome(*outcome)?;
                Seen::Left(text(*path), outcome.name.to_string())
            }
            Event::Held { path, next, by } => {
                let loss = if let HeldBy::Loss(loss) = by { Some(index(*loss)) } else { None };
                Seen::Held { path: text(*path), next: next.map(text), loss }
            }
            Event::LossRecovery { path, loss } => Seen::Recovery(text(*path), index(*loss)),
            Event::Scoped { .. }
            | Event::Waiting { .. }
            | Event::Hit { .. }
            | Event::Forced { .. }
            | Event::Dropped { .. }
            | Event::Changed
            | Event::ChangeWaits { .. }
            | Event::Note { .. }
            | Event::Paused(_)
            | Event::Stopping
            | Event::Finished { .. } => return None,
        })
    }

    fn any_input(&mut self, choices: &mut Choices<'_>) -> Checked {
        match choices.below(16) {
            0..=7 => self.end_script(choices),
            8..=11 => {
                let [link_ms, command_ms] = [5, 8].map(|count| match choices.below(count) as u64 {
                    ms @ 0..=4 => 10 * ms,
                    _ => 0,
                });
                let silence = Silence { link_ms, command_ms };
                self.give(Input::Silence(silence), Given::Silence([link_ms, command_ms]))
            }
            12 | 13 => self.give(Input::Resume(None), Given::Resume),
            14 => self.cut(),
            _ => {
                let active = self.engine.snapshot();
                let path = active.get(choices.below(active.len().max(1))).map(|active| active.path);
                let Some(path) = path.map(|path| self.engine.path_text(path)) else {
                    return Ok(());
                };
                let given = Given::Preempt(path.to_string());
                self.give(Input::Preempt(path), given)
            }
        }
    }

    fn end_script(&mut self, choices: &mut Choices<'_>) -> Checked {
        if self.running.is_empty() {
            return Ok(());
        }
        let job = self.running.remove(choices.below(self.running.len()));
        let returned = match choices.below(6) {
            5 => Returned::Raised,
            _ => Returned::Name("ok".into()),
        };
        let result = ScriptResult { returned, outputs: Vec::new(), error: None };
        self.give(Input::Finished { frame: job.frame, result }, Given::Other)
    }

    /// Loses the run, and resumes it in another engine.
    fn cut(&mut self) -> Checked {
        let Some(root) = self.engine.configuration() else { return Ok(()) };
        let silence = self.engine.silence();
        self.engine = Engine::new(Arc::clone(self.engine.program()));
        self.running.clear();
        let given = Given::Silence([silence.link_ms, silence.command_ms]);
        self.engine
            .handle(Input::Silence(silence), &NoGlobals, &mut Outbox::default())
            .expect("taken");
        self.oracle.give(given);
        let restore = Restore {
            root,
            interrupted: Interrupted::Again,
            crash: None,
            hold: false,
            counted: Counted::default(),
            stopping: None,
            begun_at: None,
        };
        self.give(Input::Restore(Box::new(restore)), Given::Cut)
    }
}

fn index(loss: Loss) -> LossIndex {
    usize::from(loss == Loss::Command)
}

fn run(choices: &[u8]) -> Result<[usize; 2], String> {
    let mut choices = Choices(choices.iter());
    let mut trial = Trial::new(RandomMachine::new(&mut choices));
    let mut checked = trial.give(Input::Start(Start::default()), Given::Other);
    for _ in 0..INPUTS {
        checked = checked.and_then(|()| trial.any_input(&mut choices));
    }
    checked.map(|()| trial.oracle.seen).map_err(|broken| format!("{broken}\n{}", trial.log))
}

#[test]
fn policies_hold_and_recover_as_the_oracle_says() {
    let config =
        ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() };
    let (holds, recoveries) = (Cell::new(0), Cell::new(0));
    let choices = proptest::collection::vec(any::<u8>(), 0..240);
    let result = TestRunner::new(config).run(&choices, |choices| {
        let [held, recovered] = run(&choices).map_err(TestCaseError::fail)?;
        holds.set(holds.get() + held);
        recoveries.set(recoveries.get() + recovered);
        Ok(())
    });
    result.unwrap_or_else(|broken| panic!("{broken}"));
    assert!(holds.get() > 500 && recoveries.get() > 500, "{holds:?} {recoveries:?}");
}
