//! Whole runs over real sockets: a host with scripts in plain Rust, and viewers that use the protocol.

use crate::drive::error::ValueError;
use crate::places::signals::PREEMPTED;
use crate::record::keep::Keep;
use crate::{Asked, Driver, Host, Opening, Place, Scripts, serve};
use rafcon_engine::{
    Check, Globals, Job, Literals, ModelLiterals, NoGlobals, Program, Returned, ScriptResult,
};
use rafcon_locks::{Mutex, RwLock};
use rafcon_model::edit::{ChildrenEdit, Edit, TransitionEdit};
use rafcon_model::{Machine, Origin, OutcomeId, StateId, StatePath, Target, TransitionId, Value};
use rafcon_protocol::{
    Answer, Command, Crash, Envelope, Event, Form, FrameKind, Hello, Join, Launch, LogLevel,
    OnCrash, Resume, Stream, ToRunner, ToViewer, decode, encode, read_frame,
};
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::stream::StreamReader;
use rafcon_storage::journal::{Kept, Stored};
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use serde_json::json;
use smol_str::SmolStr;
use std::collections::VecDeque;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock, Weak};
use std::thread::JoinHandle;
use tempfile::TempDir;

/// Environment variable of processes whose runs may die.
const MORTAL: &str = "RAFCON_TEST_MORTAL";

/// A host for one run.
#[derive(Debug)]
pub(super) struct Actors;

/// A script for each first word of a state's name: see [`Cast::play`].
#[derive(Debug)]
pub(super) struct Cast {
    program: RwLock<Arc<Program<Value>>>,
    driver: OnceLock<Weak<Driver<Self>>>,
    globals: Mutex<Vec<(String, Value)>>,
}

impl Host for Actors {
    type Scripts = Cast;

    fn literals(&mut self) -> &mut dyn Literals<Value> {
        static LITERALS: ModelLiterals = ModelLiterals;
        // A zero-sized value, so that leaking it needs no memory.
        Box::leak(Box::new(LITERALS))
    }

    fn value(&mut self, json: &serde_json::Value) -> Result<Value, ValueError> {
        from_json(json)
    }

    fn open(self, opening: Opening<Value>) -> Cast {
        Cast {
            program: RwLock::new(opening.program),
            driver: OnceLock::new(),
            globals: Mutex::default(),
        }
    }

    fn opened(driver: &Arc<Driver<Cast>>) {
        driver.scripts().driver.set(Arc::downgrade(driver)).unwrap();
    }
}

impl Cast {
    fn driver(&self) -> Arc<Driver<Self>> {
        self.driver.get().unwrap().upgrade().unwrap()
    }

    /// Runs the script for the first word of the state's name.
    fn play(&self, word: &str, job: &Job<Value>, place: &Arc<Place>) -> ScriptResult<Value> {
        let plain = |returned, outputs| ScriptResult { returned, outputs, error: None };
        match word {
            "wait" => {
                place.signals.wait(PREEMPTED, None);
                plain(Returned::Id(-2), Vec::new())
            }
            "stuck" => {
                place.signals.wait(0, None);
                plain(Returned::Id(0), Vec::new())
            }
            "ask" => self.ask(place, None),
            "consult" => self.ask(place, Some(20)),
            "add" => {
                let Some(Value::Int(number)) = job.inputs.first() else {
                    return self.failure("there is no number");
                };
                plain(Returned::Id(0), vec![Some(Value::Int(number + 1))])
            }
            "fail" => self.failure(&"no way ".repeat(100)),
            "die" if std::env::var_os(MORTAL).is_some() => std::process::abort(),
            "alone" if std::env::var_os(MORTAL).is_some() => {
                self.ask(place, Some(20));
                std::process::abort()
            }
            "say" => {
                self.print(place, LogLevel::Info, "hello".to_owned());
                self.print(place, LogLevel::Error, "help".to_owned());
                plain(Returned::Id(0), Vec::new())
            }
            "shout" => {
                let line = "x".repeat(100_000);
                (0..20).for_each(|_| self.print(place, LogLevel::Info, line.clone()));
                plain(Returned::Id(0), Vec::new())
            }
            "safe" => {
                let recorder = Arc::clone(self.driver().recorder());
                let is_safe = recorder.safety().state().0 == recorder.last();
                plain(Returned::Id(if is_safe { 0 } else { -1 }), Vec::new())
            }
            "chatter" => {
                let count =
                    if let Some(Value::Int(count)) = job.inputs.first() { *count } else { 0 };
                (0..count).for_each(|_| self.print(place, LogLevel::Info, String::new()));
                plain(Returned::Id(0), Vec::new())
            }
            "recall" => {
                let past = self.driver().past();
                let texts: Vec<_> = past.iter().map(|past| text(&past.event)).collect();
                self.print(place, LogLevel::Info, texts.join(" "));
                plain(Returned::Id(0), Vec::new())
            }
            "grow" => self.grow(place),
            "count" => self.count(),
            "show" => {
                let error = job.error.clone().unwrap_or_else(|| Value::str("no error"));
                plain(Returned::Id(0), vec![Some(error)])
            }
            _ => plain(Returned::Id(0), Vec::new()),
        }
    }

    /// Increments a global variable.
    fn count(&self) -> ScriptResult<Value> {
        let mut globals = self.globals.lock();
        let count = match globals.last() {
            Some((_, Value::Int(count))) => Value::Int(count + 1),
            _ => Value::Int(1),
        };
        globals.push(("count".to_owned(), count.clone()));
        drop(globals);
        self.driver().global("count", Some(&count));
        ScriptResult { returned: Returned::Id(0), outputs: Vec::new(), error: None }
    }

    fn print(&self, place: &Place, level: LogLevel, line: String) {
        self.driver().log(Some(place.path), level, Stream::Logger, line);
    }

    /// Adds a state to ROOT/C, after its other children.
    fn grow(&self, place: &Arc<Place>) -> ScriptResult<Value> {
        let (driver, container) = (self.driver(), StatePath::parse("ROOT/C"));
        let id = format!("GROWN_{}", place.text.rsplit('/').next().unwrap_or_default());
        let source = format!("execution {id}\n  outcome ok\n");
        let state = notation::parse(&source).unwrap().root;
        let add = Edit::Children(container.clone(), ChildrenEdit::Add(state));
        driver.edit(&[add], "it grows", false).unwrap();
        let grown = container.child(StateId::new(id.as_str()));
        assert!(driver.machine().state(&grown).is_some());
        driver.log(Some(place.path), LogLevel::Info, Stream::Logger, format!("grew {grown}"));
        if place.text.ends_with("/D") {
            let from = Origin::Outcome(StateId::new("D"), OutcomeId(0));
            let transition = |from, to| TransitionEdit::Add { from, to };
            let last = Origin::Outcome(StateId::new(id.as_str()), OutcomeId(0));
            let there = transition(from, Target::State(StateId::new(id.as_str())));
            let back = transition(last, Target::Outcome(OutcomeId(0)));
            let edits = [(71, there), (72, back)].map(|(number, edit)| {
                Edit::Transition(container.clone(), TransitionId(number), edit)
            });
            driver.edit(&edits, "it is connected", false).unwrap();
        }
        ScriptResult { returned: Returned::Id(0), outputs: Vec::new(), error: None }
    }

    fn ask(&self, place: &Arc<Place>, lost_link_ms: Option<u64>) -> ScriptResult<Value> {
        let asked = Asked {
            message: "Go on?".to_owned(),
            form: Form::Buttons { buttons: vec!["Yes".to_owned(), "No".to_owned()] },
            timeout_ms: None,
            lost_link_ms,
            default: lost_link_ms.map(|_| serde_json::json!({ "button": 0 })),
        };
        let closed = self.driver().ask(place, asked).unwrap();
        let button = closed.answer.and_then(|answer| answer["button"].as_i64());
        ScriptResult {
            returned: Returned::Id(button.unwrap_or(-2)),
            outputs: Vec::new(),
            error: None,
        }
    }
}

impl Scripts for Cast {
    type Value = Value;

    fn run(&self, job: Job<Value>, place: &Arc<Place>) -> ScriptResult<Value> {
        let name = self.program.read().node(job.node).name().clone();
        self.play(name.split(' ').next().unwrap_or_default(), &job, place)
    }

    fn failure(&self, reason: &str) -> ScriptResult<Value> {
        let error = Some(Value::str(reason));
        ScriptResult { returned: Returned::Raised, outputs: Vec::new(), error }
    }

    fn inhabit(&self, life: &mut (dyn FnMut() + Send)) {
        life();
    }

    fn park(&self, wait: &mut (dyn FnMut() + Send)) {
        wait();
    }

    fn settle(&self) {}

    fn globals(&self) -> &dyn Globals<Value> {
        &NoGlobals
    }

    /// A run with this name dies after its root was left, before it reports its end.
    fn finished(&self) {
        let program = Arc::clone(&self.program.read());
        let is_brief = program.node(Program::<Value>::ROOT).name() == "brief";
        if is_brief && std::env::var_os(MORTAL).is_some() {
            std::process::abort();
        }
    }

    fn released(&self) {}

    fn encode(&self, value: &Value) -> serde_json::Value {
        to_json(value)
    }

    fn encode_globals(&self) -> serde_json::Map<String, serde_json::Value> {
        let globals = self.globals.lock();
        globals.iter().map(|(name, value)| (name.clone(), to_json(value))).collect()
    }

    fn value(&self, json: &serde_json::Value) -> Result<Value, ValueError> {
        from_json(json)
    }

    fn with_literals(&self, make: &mut dyn FnMut(&mut dyn Literals<Value>)) {
        make(&mut ModelLiterals);
    }

    fn keep<'v>(&self, value: &'v Value) -> Keep<'v> {
        Keep::Plain(match value {
            Value::None => Kept::None,
            Value::Bool(value) => Kept::Bool(*value),
            Value::Int(value) => Kept::Int(*value),
            Value::Float(value) => Kept::Float(*value),
            other => Kept::Text(SmolStr::new(to_json(other).as_str().unwrap_or("a value"))),
        })
    }

    fn plain(&self, kept: &Kept) -> Result<Value, ValueError> {
        match kept {
            Kept::None => Ok(Value::None),
            Kept::Bool(value) => Ok(Value::Bool(*value)),
            Kept::Int(value) => Ok(Value::Int(*value)),
            Kept::Float(value) => Ok(Value::Float(*value)),
            Kept::Text(text) if text == "lost" => Err("it was lost".into()),
            Kept::Text(text) => Ok(Value::str(text)),
            Kept::Absent | Kept::Value(_) => Err("it is not plain".into()),
        }
    }

    fn restore(&self, stored: &Stored, _values: &Path) -> Result<Value, ValueError> {
        match &stored.content {
            Content::View => from_json(&stored.view),
            _ => Err("it was not kept".into()),
        }
    }

    fn lost(&self, why: &str) -> Value {
        Value::str(&format!("lost: {why}"))
    }

    fn is_lost(&self, value: &Value) -> Option<String> {
        match value {
            Value::Str(text) => text.strip_prefix("lost: ").map(str::to_owned),
            _ => None,
        }
    }

    fn restore_global(&self, name: &str, value: Value) -> Result<(), ValueError> {
        self.globals.lock().push((name.to_owned(), value));
        Ok(())
    }

    fn check(&self, check: &Check<Value>, _place: &Arc<Place>) -> Result<bool, SmolStr> {
        match check.condition.as_str() {
            "true" => Ok(true),
            "false" => Ok(false),
            other => Err(SmolStr::new(format!("cannot read {other}"))),
        }
    }

    fn changed(&self, _machine: &Machine, program: &Arc<Program<Value>>) {
        *self.program.write() = Arc::clone(program);
    }
}

fn to_json(value: &Value) -> serde_json::Value {
    match value {
        Value::Bool(value) => json!(value),
        Value::Int(value) => json!(value),
        Value::Float(value) => json!(value),
        Value::Str(text) => json!(&**text),
        _ => json!(null),
    }
}

fn from_json(json: &serde_json::Value) -> Result<Value, ValueError> {
    match json {
        serde_json::Value::Null => Ok(Value::None),
        serde_json::Value::Bool(value) => Ok(Value::Bool(*value)),
        serde_json::Value::Number(number) => {
            number.as_i64().map(Value::Int).ok_or_else(|| format!("{number} is no integer").into())
        }
        serde_json::Value::String(text) => match text.strip_prefix("until closed: ") {
            Some(socket) => Ok(until_closed(socket)),
            None => Ok(Value::str(text)),
        },
        other => Err(format!("this host has no value for {other}").into()),
    }
}

/// A value that blocks until the listener at this socket closes the connection.
fn until_closed(socket: &str) -> Value {
    let mut stream = UnixStream::connect(socket).unwrap();
    stream.read_to_end(&mut Vec::new()).unwrap();
    Value::None
}

/// A machine on disk, and a folder for its run.
pub(super) struct RunFixture {
    home: TempDir,
}

impl RunFixture {
    /// A fixture with this machine.
    pub(super) fn new(machine: &str) -> Self {
        let home = tempfile::tempdir().unwrap();
        std::fs::write(home.path().join("config.yaml"), "{}\n").unwrap();
        let fixture = Self { home };
        fixture.build(machine);
        fixture
    }

    /// Replaces the machine on disk.
    pub(super) fn build(&self, machine: &str) {
        let machine = notation::parse(machine).unwrap();
        save(&machine, &self.machine(), None, Naming::default()).unwrap();
    }

    pub(super) fn machine(&self) -> PathBuf {
        self.home.path().join("machine")
    }

    pub(super) fn run_folder(&self) -> PathBuf {
        self.home.path().join("run")
    }

    /// A launch that requests every event, and lets viewers join.
    pub(super) fn launch(&self) -> Launch {
        launch(self.home.path())
    }

    /// A launch that resumes the run.
    pub(super) fn resume(&self, policy: OnCrash, from: Option<u64>) -> Launch {
        let crash = Crash { reason: "a crash".to_owned(), active: vec!["ROOT/B".to_owned()] };
        let resume = Some(Resume { policy, from });
        Launch { resume, crash: Some(crash), ..self.launch() }
    }

    /// Starts the run of this fixture in a process of its own, where it dies. `test` is the calling test, which does
    /// nothing else in that process.
    pub(super) fn die(&self, test: &str) {
        self.die_after(test, "", &[]);
    }

    /// As [`Self::die`], for a run with a ground that is silent.
    pub(super) fn die_alone(&self, test: &str) {
        self.die_of(test, &[ToRunner::Ground { heard_ms_ago: None }], ("", &[]));
    }

    /// As [`Self::die`], but the process dies after it has received these commands, which follow an event.
    pub(super) fn die_after(&self, test: &str, after: &str, commands: &[(&str, Command)]) {
        self.die_of(test, &[], (after, commands));
    }

    fn die_of(&self, test: &str, first: &[ToRunner], last: (&str, &[(&str, Command)])) {
        if let Some(home) = std::env::var_os(MORTAL) {
            return Self::die_here(Path::new(&home), first, last);
        }
        let child = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", test, "--nocapture"])
            .env(MORTAL, self.home.path())
            .output()
            .unwrap();
        assert_eq!(child.status.code(), None, "{}", String::from_utf8_lossy(&child.stdout));
    }

    fn die_here(home: &Path, first: &[ToRunner], last: (&str, &[(&str, Command)])) {
        let launch = launch(home);
        let (ours, theirs) = UnixStream::pair().unwrap();
        let runner = std::thread::Builder::new().spawn(move || serve(theirs, Actors).unwrap());
        let mut viewer = Viewer::new(ours);
        viewer.send(&ToRunner::Launch(launch));
        for message in first {
            viewer.send(message);
        }
        let (after, commands) = last;
        if !commands.is_empty() {
            viewer.until_text(after);
            for (id, command) in commands {
                viewer.command(id, command.clone());
            }
            std::process::abort();
        }
        while viewer.next().is_some() {}
        runner.unwrap().join().unwrap();
    }

    /// Starts a run, with the viewer that launches it.
    pub(super) fn begin(&self, launch: Launch) -> (Viewer, JoinHandle<()>) {
        std::fs::create_dir_all(self.run_folder()).unwrap();
        let (ours, theirs) = UnixStream::pair().unwrap();
        let runner = std::thread::Builder::new().name("runner".to_owned());
        let runner = runner.spawn(move || serve(theirs, Actors).unwrap()).unwrap();
        let mut viewer = Viewer::new(ours);
        viewer.send(&ToRunner::Launch(launch));
        (viewer, runner)
    }

    /// A viewer that joins the run for rare events from now on.
    pub(super) fn look_on(&self) -> Viewer {
        let mut viewer = Viewer::new(self.socket());
        viewer.send(&ToRunner::Join(Join::default()));
        viewer
    }

    fn socket(&self) -> UnixStream {
        UnixStream::connect(self.run_folder().join("socket")).unwrap()
    }

    /// A viewer that joins the run from event number `from` on, with or without values.
    pub(super) fn join(&self, from: u64, values: bool) -> Viewer {
        let stream = self.socket();
        let events = StreamReader::new(from, values, Some(self.run_folder()));
        let mut viewer = Viewer::reading(stream, events);
        viewer.send(&ToRunner::Join(Join { from, every_event: true }));
        viewer
    }
}

fn launch(home: &Path) -> Launch {
    let run_folder = home.join("run");
    Launch {
        machine: home.join("machine"),
        run_folder: Some(run_folder),
        config: Some(home.to_owned()),
        every_event: true,
        listen: true,
        ..Launch::default()
    }
}

/// One viewer of a run.
pub(super) struct Viewer {
    socket: BufReader<UnixStream>,
    events: StreamReader,
    /// Received messages that no test has taken.
    waiting: VecDeque<ToViewer>,
    /// The texts of all received events.
    pub(super) seen: Vec<String>,
}

impl Viewer {
    /// A viewer that has sent its hello.
    pub(super) fn new(stream: UnixStream) -> Self {
        Self::reading(stream, StreamReader::new(0, false, None))
    }

    fn reading(mut stream: UnixStream, events: StreamReader) -> Self {
        stream.write_all(&encode(&Hello::ours()).unwrap()).unwrap();
        let mut socket = BufReader::new(stream);
        let mut hello = String::new();
        socket.read_line(&mut hello).unwrap();
        decode::<Hello>(&hello).unwrap().check().unwrap();
        Self { socket, events, waiting: VecDeque::new(), seen: Vec::new() }
    }

    pub(super) fn send(&mut self, message: &ToRunner) {
        self.socket.get_mut().write_all(&encode(message).unwrap()).unwrap();
    }

    /// Sends an arbitrary text.
    pub(super) fn raw(&mut self, text: &str) {
        self.socket.get_mut().write_all(text.as_bytes()).unwrap();
    }

    /// The next message; `None` after the end of the connection.
    pub(super) fn next(&mut self) -> Option<ToViewer> {
        while self.waiting.is_empty() {
            self.read()?;
        }
        let message = self.waiting.pop_front()?;
        if let ToViewer::Event { event, .. } = &message
            && !matches!(event, Event::Root { .. })
        {
            self.seen.push(text(event));
        }
        Some(message)
    }

    fn read(&mut self) -> Option<()> {
        let mut content = Vec::new();
        let kind = read_frame(&mut self.socket, &mut content).ok()??;
        assert_ne!(kind, FrameKind::Unknown);
        let waiting = &mut self.waiting;
        self.events.read_frame(kind, &content, |message| waiting.push_back(message)).unwrap();
        Some(())
    }

    /// The content of the first message that the predicate accepts.
    pub(super) fn until<T>(&mut self, mut wanted: impl FnMut(&ToViewer) -> Option<T>) -> T {
        loop {
            let message = self.next().unwrap_or_else(|| panic!("the end came: {:#?}", self.seen));
            if let Some(found) = wanted(&message) {
                return found;
            }
        }
    }

    /// Waits for an event with this text, and returns its number.
    pub(super) fn until_text(&mut self, wanted: &str) -> u64 {
        self.until(|message| match message {
            ToViewer::Event { event, sequence, .. } => (text(event) == wanted).then_some(*sequence),
            _ => None,
        })
    }

    /// Sends a command and waits for its answer.
    pub(super) fn command(&mut self, id: &str, command: Command) -> String {
        self.order(id, command);
        self.answer(id)
    }

    /// Sends a command without waiting.
    pub(super) fn order(&mut self, id: &str, command: Command) {
        self.send(&ToRunner::Command(Envelope::new(id, "test", command)));
    }

    /// Waits for the answer to a command.
    pub(super) fn answer(&mut self, id: &str) -> String {
        self.until(|message| match message {
            ToViewer::Answer { id: answered, answer } if answered == id => Some(match answer {
                Answer::Applied => "applied".to_owned(),
                Answer::Expired => "expired".to_owned(),
                Answer::Unknown { reason } => format!("unknown: {reason}"),
                Answer::Refused { reason } => format!("refused: {reason}"),
            }),
            _ => None,
        })
    }

    /// Reads to the end. Returns the texts of all events, one per line, without kept machines, which are recorded
    /// concurrently.
    pub(super) fn into_end(mut self) -> String {
        while self.next().is_some() {}
        self.seen.retain(|text| !text.starts_with("Root "));
        self.seen.push(String::new());
        self.seen.join("\n")
    }
}

/// The short text of one event.
fn text(event: &Event) -> String {
    match event {
        Event::Entered { path, .. } => format!("+{path}"),
        Event::Left { path, outcome, .. } => format!("-{path}={}", outcome.name),
        Event::Log { path, message, .. } => format!("log {path}: {message}"),
        Event::Commanded { envelope, answer } => {
            let command = serde_json::to_value(&envelope.command).unwrap();
            format!("{} by {}: {answer:?}", command["type"].as_str().unwrap(), envelope.author)
        }
        Event::Asked { question } => format!("asked {} by {}", question.id, question.path),
        Event::Closed { id, how, answer, author } => {
            let answer = answer.as_ref().map(ToString::to_string).unwrap_or_default();
            format!("closed {id} {how:?} {answer} by {author}").replace("  ", " ")
        }
        Event::DeadlinePassed { path, deadline_ms } => format!("deadline {path} {deadline_ms} ms"),
        Event::Silence { link_ms, command_ms } => {
            format!("silence: link {link_ms} ms, command {command_ms} ms")
        }
        Event::LossRecovery { path, loss } => format!("{path} recovers: {loss:?}"),
        Event::CutOff { path, grace_ms } => format!("cut off {path} {grace_ms} ms"),
        Event::Paused { paused } => format!("paused {paused}"),
        Event::Stopping => "stopping".to_owned(),
        Event::Finished { outcome, outputs, .. } if outputs.is_empty() => {
            format!("finished {}", outcome.name)
        }
        Event::Finished { outcome, outputs, .. } => {
            format!("finished {} {}", outcome.name, serde_json::to_string(outputs).unwrap())
        }
        Event::Waiting { path, reason } => format!("{path} waits: {reason}"),
        Event::Held { path, next, by } => {
            let next = next.as_deref().unwrap_or("its end");
            format!("{path} is held before {next} by {by:?}")
        }
        Event::Resumed { life, crash, policy } => {
            format!("life {life} after {} of {}: {policy:?}", crash.reason, crash.active.join(", "))
        }
        other => format!("{other:?}"),
    }
}
