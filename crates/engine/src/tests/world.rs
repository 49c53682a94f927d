//! A driver for tests: parses inputs from text, and writes effects and events as text.

use super::commands::{self, assignments};
use crate::{
    ActiveStateData, Change, Check, Counted, Effect, Engine, Event, Finish, FrameId, Globals,
    Input, Interrupted, Job, ModelLiterals, Note, Outbox, PathId, Program, Restore, Returned,
    ScriptResult, Verdict, WaitReason,
};
use rafcon_model::{Machine, OutcomeId, Port, StatePath, Value, literal};
use rafcon_testkit::notation;
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::num::NonZeroU64;
use std::sync::Arc;

#[derive(Default)]
struct Variables(BTreeMap<String, Value>);

impl Globals<Value> for Variables {
    fn get(&self, name: &str) -> Option<Value> {
        self.0.get(name).cloned()
    }
}

/// A run with its active scripts.
pub(super) struct World {
    engine: Engine<Value>,
    program: Arc<Program<Value>>,
    /// The machine that `change` switches to.
    next: Option<Machine>,
    /// A kept moment of the past.
    moment: Option<ActiveStateData<Value>>,
    running: Vec<Job<Value>>,
    checks: Vec<u64>,
    globals: Variables,
    text: String,
}

impl World {
    pub(super) fn new(machine: &str) -> Self {
        let machine = notation::parse(machine).expect("a machine in text notation");
        let program = Arc::new(Program::compile(&machine, &mut ModelLiterals));
        Self {
            engine: Engine::new(Arc::clone(&program)),
            program,
            next: None,
            moment: None,
            running: Vec::new(),
            checks: Vec::new(),
            globals: Variables::default(),
            text: String::new(),
        }
    }

    /// Sets the machine that `change` switches to.
    pub(super) fn with_next(mut self, machine: &str) -> Self {
        self.next = Some(notation::parse(machine).expect("a machine in text notation"));
        self
    }

    pub(super) fn play(mut self, script: &str) -> String {
        for line in script.split(['\n', ';']).map(str::trim).filter(|line| !line.is_empty()) {
            self.line(line);
        }
        self.text
    }

    fn line(&mut self, line: &str) {
        self.say(&format!("> {line}"));
        let (head, rest) = line.split_once(' ').unwrap_or((line, ""));
        let input = match head {
            "global" => {
                self.globals
                    .0
                    .extend(assignments(rest).into_iter().map(|(k, v)| (k.to_owned(), v)));
                return;
            }
            "trail" => return self.keep_trail(rest),
            "active" => return self.show_active(),
            "cut" => return self.cut(rest),
            "keep" => {
                self.moment = self.engine.configuration();
                return;
            }
            "return" => return self.go_back(),
            "change" => self.change(rest == "or wait"),
            "recover" => recovery(rest),
            "check" => self.checked(rest),
            state => commands::read(head, rest).unwrap_or_else(|| self.finished(state, rest)),
        };
        self.feed(input);
    }

    fn feed(&mut self, input: Input<Value>) {
        let mut out = Outbox::default();
        match self.engine.handle(input, &self.globals, &mut out) {
            Ok(()) => {
                out.events.iter().for_each(|event| self.event(event));
                out.effects.iter().for_each(|effect| self.effect(effect));
            }
            Err(refusal) => {
                assert!(out.events.is_empty() && out.effects.is_empty());
                self.say(&format!("refused: {refusal}"));
            }
        }
        assert_eq!(self.engine.check(), Ok(()));
    }

    fn change(&self, wait: bool) -> Input<Value> {
        let machine = self.next.as_ref().expect("a machine to change to");
        let program = Arc::new(self.program.change(machine, &mut ModelLiterals));
        Input::Change(Change { program, wait })
    }

    /// Loses the run, and resumes it in another engine.
    fn cut(&mut self, how: &str) {
        let root = self.engine.configuration().expect("something is active");
        let (counted, stopping) = (self.engine.counted(), self.engine.stopping());
        let begun_at = self.engine.begun_at();
        let (how, elsewhere) = match how.strip_suffix(" elsewhere") {
            Some(how) => (how, self.next.as_ref()),
            None => (how, None),
        };
        if let Some(machine) = elsewhere {
            self.program = Arc::new(Program::compile(machine, &mut ModelLiterals));
        }
        let silence = self.engine.silence();
        self.engine = Engine::new(Arc::clone(&self.program));
        self.feed(Input::Silence(silence));
        self.running.clear();
        let (how, hold) = how.strip_suffix(" held").map_or((how, false), |how| (how, true));
        let restore = restore(root, interrupted(how), hold);
        self.feed(Input::Restore(Box::new(Restore { counted, stopping, begun_at, ..restore })));
    }

    /// Restarts the run, held, at the kept moment.
    fn go_back(&mut self) {
        let root = self.moment.clone().expect("a moment that was kept");
        let restore = restore(root, Interrupted::Again, true);
        self.feed(Input::Restore(Box::new(restore)));
    }

    /// The result of the script whose path ends with `state`, or of an unknown frame if it does not run.
    fn finished(&mut self, state: &str, how: &str) -> Input<Value> {
        let ends = |job: &Job<Value>| {
            let path = self.path(job.path);
            path == state || path.ends_with(&format!("/{state}"))
        };
        let Some(index) = self.running.iter().position(ends) else {
            let result =
                ScriptResult { returned: Returned::Id(0), outputs: Vec::new(), error: None };
            return Input::Finished { frame: FrameId { slot: 77, generation: 0 }, result };
        };
        let job = self.running.remove(index);
        let ports = self.program.node(job.node).outputs();
        Input::Finished { frame: job.frame, result: result(how, ports, &job.outputs) }
    }

    /// The result of the oldest condition: `true`, `false`, or the reason why it cannot be evaluated.
    fn checked(&mut self, answer: &str) -> Input<Value> {
        let check = if self.checks.is_empty() { 77 } else { self.checks.remove(0) };
        let result = answer.parse().map_err(|_no_bool| answer.into());
        Input::Checked { check, result }
    }

    /// Limits the number of steps that can be undone.
    fn keep_trail(&mut self, steps: &str) {
        let engine = Engine::new(Arc::clone(&self.program));
        self.engine = match steps {
            "off" => engine.without_undo_log(),
            steps => engine.with_undo_log(steps.parse().expect("a number of steps")),
        };
    }

    fn show_active(&mut self) {
        for active in self.engine.snapshot() {
            let flag = if active.preempted { " preempted" } else { "" };
            let holds = active.holds.iter().map(|hold| {
                let next = hold.next.map(|next| format!(" before {}", self.path(next)));
                format!(" ({:?}{})", hold.by, next.unwrap_or_default())
            });
            let holds = holds.collect::<String>();
            let line = format!("{} {:?}{flag}{holds}", self.path(active.path), active.activity);
            self.say(&line);
        }
        let line = format!("{:?}, {} states run", self.engine.status(), self.engine.states_run());
        self.say(&line);
    }

    fn path(&self, path: PathId) -> String {
        self.engine.path_text(path).to_string()
    }

    fn outcome(&self, path: PathId, outcome: OutcomeId) -> SmolStr {
        let node = self.engine.path_node(path).map(|node| self.program.node(node));
        node.and_then(|node| Some(node.outcome(outcome)?.name.clone())).unwrap_or_default()
    }

    fn event(&mut self, event: &Event<Value>) {
        let line = match event {
            Event::Entered { path, node, inputs, undoes } => {
                let ports = self.program.node(*node).inputs();
                let (path, inputs) = (self.path(*path), values(ports, inputs));
                format!("enter{} {path}{inputs}", back(*undoes))
            }
            Event::Left { path, node, outcome, outputs, error, undoes, .. } => {
                let ports = self.program.node(*node).outputs();
                let outputs = values(ports, outputs);
                let (path, outcome) = (self.path(*path), self.outcome(*path, *outcome));
                let (back, error) = (back(*undoes), shown_error(error.as_deref()));
                format!("leave{back} {path} {outcome}{outputs}{error}")
            }
            Event::Scoped { path, port, value } => {
                let place = self.engine.path_node(*path).map(|node| self.program.node(node));
                let container = place.and_then(|node| node.state().container());
                let port = container.and_then(|c| c.scoped_variables.get(*port));
                let name = port.map(|port| port.name.clone()).unwrap_or_default();
                format!("set {}.{name} = {}", self.path(*path), shown(value))
            }
            Event::Waiting { path, reason } => {
                format!("wait {}: {}", self.path(*path), self.reason(reason))
            }
            Event::Note { path, level, note } => {
                let level = format!("{level:?}").to_lowercase();
                format!("{level} {}: {}", self.path(*path), noted(note))
            }
            Event::Paused(true) => "paused".to_owned(),
            Event::Paused(false) => "goes on".to_owned(),
            Event::Stopping => "stopping".to_owned(),
            Event::Finished { .. } => "finished".to_owned(),
            Event::Held { path, next, by } => {
                let next = next.map(|next| format!(" before {}", self.path(next)));
                format!("hold {}{} ({by:?})", self.path(*path), next.unwrap_or_default())
            }
            Event::Hit { breakpoint, path, hits, held } => {
                let held = if *held { "" } else { ", goes on" };
                format!("hit {breakpoint} at {} for the {hits}. time{held}", self.path(*path))
            }
            Event::Forced { path, outcome } => {
                format!("force {} {}", self.path(*path), self.outcome(*path, *outcome))
            }
            Event::LossRecovery { path, loss } => {
                format!("{} preempts {}", loss.key(), self.path(*path))
            }
            Event::Dropped { path } => format!("drop {}", self.path(*path)),
            Event::Changed => {
                self.program = Arc::clone(self.engine.program());
                "changed".to_owned()
            }
            Event::ChangeWaits { path } => format!("change waits for {}", self.path(*path)),
        };
        self.say(&line);
    }

    fn reason(&self, reason: &WaitReason) -> String {
        match reason {
            WaitReason::NoTransition { child, outcome } => {
                format!(
                    "no transition from {} {}",
                    self.path(*child),
                    self.outcome(*child, *outcome)
                )
            }
            WaitReason::NoStart => "no start".to_owned(),
            WaitReason::NoChildren => "no children".to_owned(),
            WaitReason::Interrupted => "interrupted".to_owned(),
        }
    }

    fn effect(&mut self, effect: &Effect<Value>) {
        let line = match effect {
            Effect::Fork { branch } => format!("  fork {}", branch.0),
            Effect::Run(job) => {
                self.running.push(job.clone());
                self.job(job)
            }
            Effect::Check(check) => {
                self.checks.push(check.check);
                self.check(check)
            }
            Effect::Preempt(path) => format!("  preempt {}", self.path(*path)),
            Effect::Paused(paused) => format!("  paused {paused}"),
            Effect::EndBranch { branch } => format!("  end {}", branch.0),
            Effect::Finish(finish) => format!("  {}", finished(finish)),
        };
        self.say(&line);
    }

    fn job(&self, job: &Job<Value>) -> String {
        let path = self.path(job.path);
        let branch = match job.branch.0 {
            0 => String::new(),
            branch => format!(" on {branch}"),
        };
        let error = shown_error(job.error.as_ref());
        let preempted = if job.preempted { " preempted" } else { "" };
        let run = if job.backward { "undo" } else { "run" };
        let inputs = if job.backward {
            values(self.program.node(job.node).inputs(), &job.inputs)
        } else {
            String::new()
        };
        let verdicts = job.verdicts.iter().flat_map(|verdicts| &verdicts.children).map(verdict);
        let verdicts = verdicts.collect::<String>();
        format!("  {run} {path}{branch}{inputs}{error}{preempted}{verdicts}")
    }

    fn check(&self, check: &Check<Value>) -> String {
        let node = self.program.node(check.node);
        let inputs = values(node.inputs(), &check.inputs);
        let left = check.left.iter().map(|(outputs, outcome)| {
            format!(
                " left {}{}",
                self.outcome(check.path, *outcome),
                values(node.outputs(), outputs)
            )
        });
        let scoped = check.scoped_variables.iter().map(|(name, value)| pair(name, value));
        let data = std::iter::once(inputs).chain(left).chain(scoped).collect::<String>();
        let branch = check.branch.0;
        let branch = if branch == 0 { String::new() } else { format!(" on {branch}") };
        let path = self.path(check.path);
        format!("  check {} at {path}{branch}: {}{data}", check.check, check.condition)
    }

    fn say(&mut self, line: &str) {
        self.text += line;
        self.text.push('\n');
    }
}

fn restore(root: ActiveStateData<Value>, interrupted: Interrupted, hold: bool) -> Restore<Value> {
    let (crash, counted) = (Some(Value::str("crash")), Counted::default());
    Restore { root, interrupted, crash, hold, counted, stopping: None, begun_at: None }
}

fn interrupted(how: &str) -> Interrupted {
    match how {
        "wait" => Interrupted::Wait,
        "abort" => Interrupted::Abort,
        _ => Interrupted::Again,
    }
}

/// `again`, or `again at ROOT/A`.
fn recovery(text: &str) -> Input<Value> {
    let (how, path) = text.split_once(" at ").unzip();
    let path = path.map(StatePath::parse);
    Input::Recover(path, interrupted(how.unwrap_or(text)))
}

fn result(how: &str, ports: &[Port], defaults: &[Value]) -> ScriptResult<Value> {
    let (first, rest) = how.split_once(' ').unwrap_or((how, ""));
    let (quoted, after) =
        rest.strip_prefix('"').and_then(|r| r.split_once('"')).unwrap_or(("", rest));
    let text = Value::str(quoted);
    let (returned, rest, raised) = match first {
        "raises" => (Returned::Raised, after, Some(text)),
        "other" => (Returned::Other(quoted.into()), after, None),
        word => match word.parse() {
            Ok(id) => (Returned::Id(id), rest, None),
            Err(_) => (Returned::Name(word.into()), rest, None),
        },
    };
    let given = assignments(rest);
    let find = |name: &str| given.iter().find(|(key, _)| *key == name).map(|(_, v)| v.clone());
    let output = |(port, default): (&Port, &Value)| {
        let left_out = rest.split(' ').any(|word| word.strip_prefix('-') == Some(&port.name));
        (!left_out).then(|| find(&port.name).unwrap_or_else(|| default.clone()))
    };
    ScriptResult {
        returned,
        outputs: ports.iter().zip(defaults).map(output).collect(),
        error: raised.or_else(|| find("error")),
    }
}

fn shown(value: &Value) -> String {
    literal::write(value).unwrap_or_else(|| format!("{value:?}"))
}

fn shown_error(error: Option<&Value>) -> String {
    error.map(|error| format!(" error={}", shown(error))).unwrap_or_default()
}

fn verdict(verdict: &Verdict<Value>) -> String {
    let error = shown_error(verdict.error.as_ref());
    format!(" [{} {}{error}]", verdict.name, verdict.outcome_name)
}

fn pair(name: &str, value: &Value) -> String {
    format!(" {name}={}", shown(value))
}

fn values(ports: &[Port], values: &[Value]) -> String {
    ports.iter().zip(values).map(|(port, value)| pair(&port.name, value)).collect()
}

fn named(values: &[(SmolStr, Value)]) -> String {
    values.iter().map(|(name, value)| pair(name, value)).collect()
}

fn finished(finish: &Finish<Value>) -> String {
    let (name, id) = (&finish.outcome_name, finish.outcome);
    let (outputs, variables) = (named(&finish.outputs), named(&finish.scoped_variables));
    let count = finish.states_run;
    let variables =
        if variables.is_empty() { variables } else { format!(" variables:{variables}") };
    format!("end of run: {name} ({id}){outputs}{variables}, {count} states")
}

fn noted(note: &Note) -> String {
    match note {
        Note::TypeMismatch { port, expected, found } => {
            format!("{port} is {found}, not {expected}")
        }
        Note::NoSuchOutcome { returned } => format!("{returned} is no outcome"),
        Note::NoSuchGlobal { name } => format!("no global {name}"),
        Note::BadDefault { port, reason } => format!("default of {port}: {reason}"),
        Note::MissingLibrary { reason } => format!("missing library: {reason}"),
        Note::DamagedState { reason } => format!("damaged state: {reason}"),
        Note::NoSuchInput { name } => format!("no input {name}"),
        Note::BadCondition { breakpoint, reason } => {
            format!("bad condition of {breakpoint}: {reason}")
        }
    }
}

/// Text for the undone entry.
fn back(undoes: Option<NonZeroU64>) -> String {
    undoes.map(|entry| format!(" back {entry}")).unwrap_or_default()
}
