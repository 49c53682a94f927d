//! Scripts without an interpreter, and runs with them.

use crate::drive::document::Document;
use crate::drive::ending::RunEnd;
use crate::drive::error::ValueError;
use crate::places::active::Active;
use crate::places::signals::PREEMPTED;
use crate::record::blocks::Chunk;
use crate::record::recorder::Recorder;
use crate::{Clock, Driver, Place, Scripts};
use rafcon_engine::{
    Finish, Globals, Input, Job, Literals, ModelLiterals, NodeId, Program, Returned, ScriptResult,
    Start, Status,
};
use rafcon_model::Value;
use rafcon_protocol::Event;
use rafcon_storage::journal::stream::StreamReader;
use rafcon_testkit::notation;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Barrier};

/// A script for each first word of a state's name.
#[derive(Debug)]
pub(super) struct Players {
    program: Arc<Program<Value>>,
    meeting: Barrier,
    rounds: AtomicI64,
}

impl Players {
    fn name(&self, node: NodeId) -> &str {
        self.program.node(node).name()
    }

    fn play(&self, word: &str, place: &Place) -> Returned {
        match word {
            "wait" => {
                place.signals.wait(PREEMPTED, None);
                Returned::Id(0)
            }
            "meet" => {
                self.meeting.wait();
                Returned::Id(0)
            }
            "panic" => panic!("as the test wants it"),
            "again" => Returned::Id(i64::from(self.rounds.fetch_sub(1, Ordering::Relaxed) <= 0)),
            _ => Returned::Id(0),
        }
    }
}

impl Scripts for Players {
    type Value = Value;

    fn run(&self, job: Job<Value>, place: &Arc<Place>) -> ScriptResult<Value> {
        let word = self.name(job.node).split(' ').next().unwrap_or_default();
        ScriptResult { returned: self.play(word, place), outputs: Vec::new(), error: None }
    }

    fn failure(&self, reason: &str) -> ScriptResult<Value> {
        ScriptResult {
            returned: Returned::Raised,
            outputs: Vec::new(),
            error: Some(Value::str(reason)),
        }
    }

    fn inhabit(&self, life: &mut (dyn FnMut() + Send)) {
        life();
    }

    fn park(&self, wait: &mut (dyn FnMut() + Send)) {
        wait();
    }

    fn settle(&self) {}

    fn finished(&self) {}

    fn released(&self) {}

    fn globals(&self) -> &dyn Globals<Value> {
        &Panics
    }

    fn encode(&self, _value: &Value) -> serde_json::Value {
        serde_json::Value::Null
    }

    fn value(&self, _json: &serde_json::Value) -> Result<Value, ValueError> {
        Ok(Value::None)
    }

    fn with_literals(&self, make: &mut dyn FnMut(&mut dyn Literals<Value>)) {
        make(&mut ModelLiterals);
    }

    fn lost(&self, why: &str) -> Value {
        Value::str(why)
    }

    fn is_lost(&self, _value: &Value) -> Option<String> {
        None
    }

    fn encode_globals(&self) -> serde_json::Map<String, serde_json::Value> {
        serde_json::Map::new()
    }
}

/// Globals without variables. Reading the one with this name panics.
struct Panics;

impl Globals<Value> for Panics {
    fn get(&self, name: &str) -> Option<Value> {
        assert!(name != "panic", "as the test wants it");
        None
    }
}

/// A run of a machine, with its driver.
pub(super) struct Run {
    pub(super) driver: Arc<Driver<Players>>,
}

/// The result of a run.
pub(super) struct Report {
    pub(super) finish: Finish<Value>,
    /// Entries as `+path` and ends as `-path=outcome`, in order.
    pub(super) steps: Vec<String>,
    /// Number of threads that the run needed.
    pub(super) threads: usize,
}

impl Run {
    /// A run of this machine. `meeting` states meet; states with the word `again` take their first outcome `rounds`
    /// times.
    pub(super) fn new(machine: &str, meeting: usize, rounds: i64) -> Self {
        Self::recorded(machine, (meeting, rounds), Recorder::default())
    }

    /// A run of this machine with the caller's recorder.
    pub(super) fn recorded(
        machine: &str,
        (meeting, rounds): (usize, i64),
        recorder: Recorder,
    ) -> Self {
        let machine = notation::parse(machine).unwrap();
        let program = Arc::new(Program::compile(&machine, &mut ModelLiterals));
        let players = Players {
            program: Arc::clone(&program),
            meeting: Barrier::new(meeting),
            rounds: AtomicI64::new(rounds),
        };
        let (document, active) = (Document::new(machine, program, None), Active::default());
        Self { driver: Driver::new(document, players, Clock::start(), active, recorder) }
    }

    /// Waits until the engine has this status.
    pub(super) fn wait_for_status(&self, status: Status) {
        while self.driver.with_core(|core| core.engine.status()) != Some(status) {
            std::thread::yield_now();
        }
    }

    pub(super) fn start(&self) {
        self.driver.command(Input::Start(Start::default())).unwrap();
    }

    /// Waits for the first event that the predicate accepts.
    pub(super) fn wait_for(&self, wanted: impl Fn(&str) -> bool) {
        let mut past = Past::new(self.driver.recorder());
        while !past.more().iter().any(|text| wanted(text)) {
            self.driver.recorder().wait(past.next, u64::MAX - 1, None);
        }
    }

    /// Waits for the end of the run.
    pub(super) fn end(self) -> Report {
        let Some(RunEnd::Finished(finish)) = self.driver.wait() else { panic!("cut off") };
        let threads = self.driver.with_core(|core| core.threads()).unwrap();
        self.driver.close();
        let mut past = Past::new(self.driver.recorder());
        let mut steps = Vec::new();
        while past.next < self.driver.recorder().tellable() {
            steps.extend(past.more());
        }
        Report { finish, steps, threads }
    }
}

/// The recorded events, read from the first one on.
struct Past<'r> {
    recorder: &'r Recorder,
    events: StreamReader,
    next: u64,
}

impl<'r> Past<'r> {
    fn new(recorder: &'r Recorder) -> Self {
        Self { recorder, events: StreamReader::new(0, false, None), next: 1 }
    }

    /// The next events, as texts.
    fn more(&mut self) -> Vec<String> {
        let (mut chunk, mut texts) = (Chunk::default(), Vec::new());
        self.next = self.recorder.read(self.next, false, &mut chunk).next;
        let mut show = |_, _, event| texts.push(text(&event));
        chunk.blocks().for_each(|block| self.events.read_block(&block, &mut show).unwrap());
        texts
    }
}

fn text(event: &Event) -> String {
    match event {
        Event::Entered { path, .. } => format!("+{path}"),
        Event::Left { path, outcome, .. } => format!("-{path}={}", outcome.name),
        event => format!("{event:?}"),
    }
}
