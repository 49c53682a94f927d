//! The life of one run as the command line sees it: what is to be done when something happens.
//!
//! Knows phases, deadlines and the reasons of an end. Must never know processes, terminals or clocks: causes and the time
//! come in, actions go out.

mod active;
mod end;

use crate::console::Wish;
use crate::event_queue::Cause;
pub(crate) use active::Active;
pub(crate) use end::End;
use rafcon_protocol::{
    Command, Envelope, Event, Hello, Launch, LogLevel, Snapshot, StateData, Stream, ToRunner,
    ToViewer,
};
use rafcon_supervisor::{Exit, RunnerDeath};
use std::collections::VecDeque;
use std::time::Duration;

/// How long a machine may take to stop after its time is over, before it is killed.
const GRACE: Duration = Duration::from_secs(3);
/// How long a process may outlive its own end, or its last word its process.
const EXIT_TIMEOUT: Duration = Duration::from_secs(2);
/// How long the last words of a dead process are waited for.
const OUTPUT_TIMEOUT: Duration = Duration::from_millis(500);
/// How many lines of a dead process's error output are shown.
const TAIL: usize = 12;

/// What is to be done.
#[derive(Debug, PartialEq)]
pub(crate) enum Action {
    /// Say this to the runner.
    Send(ToRunner),
    /// End the runner's process group at once.
    Kill,
    /// The run begins.
    Loaded {
        /// Name of the root.
        name: String,
        /// Number of states.
        states: u64,
    },
    /// Something happened in the run, so long after its start.
    Event(Duration, Event),
    /// How things stand.
    Snapshot(Snapshot),
    /// What a state holds, as was asked for.
    Inspected {
        /// The state.
        path: String,
        /// Its data; nothing if it is not active.
        data: Option<StateData>,
    },
    /// Something about this program that the user should know.
    Note(String),
}

/// Where a run is.
///
/// `Starting --(Hello)--> Loading --(Loaded)--> Running --(Finished | LoadFailed | Exited | kill)--> Ending`; `Ending` is
/// over when the process is gone and has said its last word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Starting,
    Loading,
    Running,
    Ending,
}

/// Follows one run.
#[derive(Debug)]
pub(crate) struct Supervisor {
    phase: Phase,
    launch: Option<Launch>,
    /// When the machine is stopped because its time is over.
    deadline: Option<Duration>,
    timed_out: bool,
    /// How often the user asked to stop.
    interrupts: u32,
    /// Who gives commands.
    author: String,
    /// How the ids of our commands begin: those that an earlier runner of the run has answered are not carried out again.
    prefix: String,
    /// How often a key asked for something.
    wishes: u32,
    /// When patience ends and the process is killed.
    kill_at: Option<Duration>,
    exit: Option<Exit>,
    silent: bool,
    /// Its error output is at the end: no last word is still on its way.
    drained: bool,
    /// When waiting for last words ends.
    settled_at: Option<Duration>,
    end: Option<End>,
    active: Active,
    /// The last moment in the run's own time.
    run_time: Duration,
    tail: VecDeque<String>,
}

impl Supervisor {
    /// A run that is about to begin; `timeout` counts from now on, and `author` gives commands, whose ids begin with `prefix`.
    pub(crate) fn new(
        launch: Launch,
        now: Duration,
        timeout: Option<Duration>,
        (author, prefix): (&str, &str),
    ) -> Self {
        Self {
            phase: Phase::Starting,
            launch: Some(launch),
            deadline: timeout.map(|timeout| now.saturating_add(timeout)),
            timed_out: false,
            interrupts: 0,
            wishes: 0,
            author: author.to_owned(),
            prefix: prefix.to_owned(),
            kill_at: None,
            exit: None,
            silent: false,
            drained: false,
            settled_at: None,
            end: None,
            active: Active::default(),
            run_time: Duration::ZERO,
            tail: VecDeque::new(),
        }
    }

    /// Takes one cause in.
    pub(crate) fn handle(&mut self, now: Duration, cause: Cause, out: &mut Vec<Action>) {
        match cause {
            Cause::Hello(hello) => self.hello(&hello, out),
            Cause::Messages(messages) => {
                for message in messages {
                    self.message(now, message, out);
                }
            }
            Cause::Nonsense(what) => {
                out.push(Action::Note(format!("the runner's words make no sense: {what}")));
            }
            Cause::Silence => self.silence(now),
            Cause::Drained(stream) => self.drained |= stream == Stream::Stderr,
            Cause::Raw(stream, line) => self.raw(stream, line, out),
            Cause::Exited(exit) => self.exited(now, exit),
            Cause::Interrupt => self.interrupt(out),
            Cause::Wish(wish) => self.wish(wish, out),
            Cause::Key(_)
            | Cause::Cut(_)
            | Cause::Mended(_)
            | Cause::Refused(_)
            | Cause::HungUp
            | Cause::Suspend
            | Cause::Tick => {}
        }
        self.watch(now, out);
    }

    /// The reason of the end, once there is nothing more to wait for.
    pub(crate) fn end(&self, now: Duration) -> Option<&End> {
        let settled = self.silent || self.settled_at.is_some_and(|at| now >= at);
        let over = self.exit.is_some() && settled;
        self.end.as_ref().filter(|_| over)
    }

    /// Whether the runner ended itself to bring the run to a stop.
    pub(crate) fn is_stopped_by_itself(&self) -> bool {
        self.exit.is_some_and(Exit::is_stopped)
    }

    /// When the next tick is needed at the latest.
    pub(crate) fn wake_at(&self) -> Option<Duration> {
        [self.deadline, self.kill_at, self.settled_at].into_iter().flatten().min()
    }

    fn hello(&mut self, hello: &Hello, out: &mut Vec<Action>) {
        if let Err(mismatch) = hello.check() {
            self.finish(End::NotStarted { reason: mismatch.to_string(), said: Vec::new() });
            out.push(Action::Kill);
            return;
        }
        if let Some(launch) = self.launch.take() {
            self.phase = Phase::Loading;
            out.push(Action::Send(ToRunner::Launch(launch)));
        }
    }

    fn message(&mut self, now: Duration, message: ToViewer, out: &mut Vec<Action>) {
        self.active.told(&message);
        match message {
            ToViewer::LoadFailed { reason } => self.finish(End::LoadFailed { reason }),
            ToViewer::Inspection { path, data, .. } => {
                out.push(Action::Inspected { path, data });
            }
            ToViewer::Loaded { name, states, problems, .. } => {
                self.loaded(name, states, problems, out);
            }
            ToViewer::Event { sequence: _, t_ns, event } => {
                self.run_time = Duration::from_nanos(t_ns);
                self.event(now, event, out);
            }
            ToViewer::Snapshot(snapshot) => out.push(Action::Snapshot(snapshot)),
            // Nobody has asked.
            ToViewer::Pong { .. } => {}
            ToViewer::Answer { id: _, answer } => {
                out.extend(end::refusal(answer).map(Action::Note));
            }
        }
    }

    fn loaded(&mut self, name: String, states: u64, problems: Vec<String>, out: &mut Vec<Action>) {
        self.phase = Phase::Running;
        out.push(Action::Loaded { name, states });
        let warnings = as_events(problems);
        out.extend(warnings.map(|event| Action::Event(Duration::ZERO, event)));
    }

    fn event(&mut self, now: Duration, event: Event, out: &mut Vec<Action>) {
        if let Event::Finished { outcome, .. } = &event {
            self.finish(End::Finished { outcome: outcome.clone(), timed_out: self.timed_out });
            self.kill_at = Some(now + EXIT_TIMEOUT);
        }
        out.push(Action::Event(self.run_time, event));
    }

    /// Output that no script was caught writing: a line of the log, without a state.
    fn raw(&mut self, stream: Stream, line: String, out: &mut Vec<Action>) {
        let level = if stream == Stream::Stderr { LogLevel::Error } else { LogLevel::Info };
        if stream == Stream::Stderr {
            self.tail.push_back(line.clone());
            if self.tail.len() > TAIL {
                self.tail.pop_front();
            }
        }
        if self.phase != Phase::Starting {
            let event = Event::Log { path: String::new(), level, stream, message: line };
            out.push(Action::Event(self.run_time, event));
        }
    }

    fn interrupt(&mut self, out: &mut Vec<Action>) {
        self.interrupts += 1;
        let may_stop = matches!(self.phase, Phase::Loading | Phase::Running);
        if self.interrupts == 1 && may_stop {
            out.push(Action::Note("stopping; press Ctrl-C again to kill".to_owned()));
            out.push(Action::Send(self.command("stop", Command::Stop)));
        } else {
            self.finish(self.killed());
            out.push(Action::Kill);
        }
    }

    /// What the user asked for by a key.
    fn wish(&mut self, wish: Wish, out: &mut Vec<Action>) {
        self.wishes += 1;
        let id = format!("key-{}", self.wishes);
        match wish {
            Wish::Send(asked) => out.push(Action::Send(self.command(&id, asked))),
            Wish::Inspect(path) => out.push(Action::Send(ToRunner::Inspect { id, path })),
            Wish::Say(text) => out.push(Action::Note(text)),
            Wish::Leave => {}
        }
    }

    fn command(&self, id: &str, command: Command) -> ToRunner {
        ToRunner::Command(Envelope {
            id: format!("{}-{id}", self.prefix),
            author: self.author.clone(),
            decided_on: None,
            expiry: None,
            command,
        })
    }

    fn exited(&mut self, now: Duration, exit: Exit) {
        self.exit = Some(exit);
        self.settled_at = Some(now + OUTPUT_TIMEOUT);
    }

    /// The control socket is closed: normal at the end, and a defect of a script before.
    fn silence(&mut self, now: Duration) {
        self.silent = true;
        self.kill_at.get_or_insert(now + EXIT_TIMEOUT);
    }

    /// What the time alone brings about, and the death of a process that has said its last word.
    fn watch(&mut self, now: Duration, out: &mut Vec<Action>) {
        let said = self.silent && self.drained || self.settled_at.is_some_and(|at| now >= at);
        if let Some(exit) = self.exit.filter(|_| said && self.end.is_none()) {
            self.finish(self.death(exit.to_string()));
        }
        if self.deadline.is_some_and(|at| now >= at) {
            self.deadline = None;
            self.time_is_over(now, out);
        }
        if self.kill_at.is_some_and(|at| now >= at) && self.exit.is_none() {
            self.kill_at = None;
            if self.end.is_none() {
                self.finish(if self.timed_out {
                    self.killed()
                } else {
                    self.death("it closed its control connection and went on".to_owned())
                });
            }
            out.push(Action::Kill);
        }
    }

    fn time_is_over(&mut self, now: Duration, out: &mut Vec<Action>) {
        if self.end.is_some() {
            return;
        }
        self.timed_out = true;
        if self.phase == Phase::Starting {
            self.kill_at = Some(now);
            return;
        }
        self.kill_at = Some(now + GRACE);
        out.push(Action::Note("the time is over; stopping".to_owned()));
        out.push(Action::Send(self.command("timeout", Command::Stop)));
    }

    /// The first reason counts.
    fn finish(&mut self, end: End) {
        self.phase = Phase::Ending;
        self.end.get_or_insert(end);
    }

    fn killed(&self) -> End {
        End::Killed { timed_out: self.timed_out, active: self.active.paths().to_vec() }
    }

    fn death(&self, reason: String) -> End {
        let said = self.tail.iter().cloned().collect();
        if self.phase == Phase::Starting {
            return End::NotStarted { reason, said };
        }
        let is_cut_off = self.exit.is_some_and(Exit::is_cut_off);
        let active = self.active.paths().to_vec();
        End::Died(RunnerDeath { reason, active, said, is_cut_off })
    }
}

/// Faults of a machine as they are told to whoever asked for its run: lines of the log.
pub(crate) fn as_events(problems: Vec<String>) -> impl Iterator<Item = Event> {
    problems.into_iter().map(|message| Event::Log {
        path: String::new(),
        level: LogLevel::Warning,
        stream: Stream::Engine,
        message,
    })
}

#[cfg(test)]
mod tests;
