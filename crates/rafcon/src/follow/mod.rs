//! One run as the command line follows it, started or requested by this program, or only watched: the actions after each
//! cause.
//!
//! Knows deadlines, the meaning of Ctrl-C and the reasons of an end. Knows nothing of sockets, processes, terminals or
//! clocks: input is causes and the time, output is actions.

mod end;
mod known;
mod requests;
mod run_loop;
mod stop_requests;
mod waiting;

use crate::console::UserAction;
use crate::event_queue::{Cause, STUCK};
use crate::view::{harmless, time};
pub(crate) use end::End;
use known::{Active, ProcessEnd, Pulse};
use rafcon_protocol::{
    Answer, Command, EnginePulse, Envelope, Event, Hello, Join, LinkHealth, LogLevel, Outcome,
    Snapshot, Stream, ToRunner, ToViewer,
};
use rafcon_supervisor::{Exit, RunnerDeath};
pub(crate) use run_loop::RunLoop;
use std::time::Duration;
use stop_requests::StopRequests;
pub(crate) use stop_requests::StopSignal;
use waiting::{Unattended, Waiting};

/// Time for a machine to stop after its time limit, before it is killed.
pub(crate) const GRACE: Duration = Duration::from_secs(3);
/// Maximum delay between the end of a run and the exit of its process.
pub(crate) const EXIT_TIMEOUT: Duration = Duration::from_secs(2);

/// An action for the loop.
#[derive(Debug, PartialEq)]
pub(crate) enum Action {
    /// Send this to the run.
    Send(ToRunner),
    /// End the runner's process group at once.
    Kill,
    /// Show this to the user.
    Show(ToViewer),
    /// Show that the run responds, or the duration of its silence.
    Heard(Option<Duration>),
    /// Show the user this text.
    Note(String),
}

/// Relation of this program to the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RunRole {
    /// It watches, and may leave at any time.
    Guest,
    /// It started the run at a server: the run ends at its request, and it may leave a run that does not end.
    Host,
    /// It started the runner's process, and stays until that has ended.
    Owner,
}

/// Contact of a station with a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RobotContact {
    Kept,
    Lost,
}

#[derive(Debug)]
pub(crate) struct RunFollower {
    role: RunRole,
    /// Request to join a run in progress, sent after the runner's hello.
    join: Option<Join>,
    /// True after a valid hello.
    is_greeted: bool,
    /// Time at which the machine is stopped by its time limit.
    deadline: Option<Duration>,
    timed_out: bool,
    /// Time at which the run is killed.
    kill_at: Option<Duration>,
    /// True after a kill command.
    is_kill_sent: bool,
    stop_requests: StopRequests,
    waiting: Waiting,
    unattended: Option<Unattended>,
    /// Author of the commands.
    author: String,
    /// Unique prefix of the ids of our commands.
    prefix: String,
    commands: u32,
    active: Active,
    /// Pings of the engine, unless the server sends them.
    pulse: Option<Pulse>,
    /// Contact of the station with the robot, if the run is a replica.
    contact: RobotContact,
    process: ProcessEnd,
    /// Time of the last event, in the run's own time.
    run_ns: u64,
    end: Option<End>,
}

impl RunFollower {
    /// A follower of an unknown run. `author` sends commands with ids that begin with `prefix`. The machine is stopped at
    /// `deadline`.
    pub(crate) fn new(
        role: RunRole,
        author: &str,
        prefix: String,
        deadline: Option<Duration>,
    ) -> Self {
        Self {
            role,
            join: None,
            is_greeted: false,
            deadline,
            timed_out: false,
            kill_at: None,
            is_kill_sent: false,
            stop_requests: StopRequests::default(),
            waiting: Waiting::default(),
            unattended: None,
            author: author.to_owned(),
            prefix,
            commands: 0,
            active: Active::default(),
            pulse: None,
            contact: RobotContact::Kept,
            process: ProcessEnd::default(),
            run_ns: 0,
            end: None,
        }
    }

    /// Joins a run in progress with this request.
    pub(crate) fn joining(self, join: Join) -> Self {
        Self { join: Some(join), ..self }
    }

    /// Also pings the engine. At a server this is not needed: the server does it.
    pub(crate) fn asking_for_the_engine(self) -> Self {
        Self { pulse: Some(Pulse::default()), ..self }
    }

    /// Marks the run as unwatched: a run that can only wait is stopped, unless its machine `ends_itself`.
    pub(crate) fn unattended(self, ends_itself: impl Fn() -> bool + 'static) -> Self {
        Self { unattended: Some(Unattended(Box::new(ends_itself))), ..self }
    }

    /// Handles one cause, and adds the resulting actions.
    pub(crate) fn handle(&mut self, now: Duration, cause: Cause, out: &mut Vec<Action>) {
        match cause {
            Cause::Hello(hello) => self.hello(&hello, out),
            Cause::Messages(messages) => {
                for message in messages {
                    self.message(now, message, out);
                }
            }
            Cause::Nonsense(what) => {
                out.push(Action::Note(format!("cannot understand the runner: {what}")));
            }
            Cause::Cut(reason) => {
                out.extend([Action::Heard(Some(Duration::ZERO)), Action::Note(reason)]);
            }
            Cause::Mended(how) => out.extend([Action::Heard(None), Action::Note(how)]),
            Cause::Refused(reason) => self.finish(End::LoadFailed { reason }),
            Cause::Silence => self.silence(now),
            Cause::Drained(stream) => self.process.drained(stream),
            Cause::Raw(stream, line) => self.raw(stream, line, out),
            Cause::Exited(exit) => self.process.exited(now, exit),
            Cause::Interrupt(signal) => self.interrupt(now, signal, out),
            Cause::UserAction(UserAction::Leave) | Cause::HungUp if self.role != RunRole::Owner => {
                self.finish(End::Left);
            }
            Cause::UserAction(wish) => self.wish(wish, out),
            Cause::Key(_) | Cause::HungUp | Cause::Suspend | Cause::Tick => {}
        }
        self.watch(now, out);
    }

    /// The reason of the end, once no further cause is expected.
    pub(crate) fn end(&self, now: Duration) -> Option<&End> {
        let is_over = self.role != RunRole::Owner || self.process.is_over(now);
        self.end.as_ref().filter(|_| is_over)
    }

    /// Latest time of the next tick.
    pub(crate) fn wake_at(&self) -> Option<Duration> {
        let asks = self.pulse.as_ref().filter(|_| self.is_greeted).map(Pulse::due);
        [self.deadline, self.kill_at, self.process.settled_at(), asks].into_iter().flatten().min()
    }

    fn hello(&mut self, hello: &Hello, out: &mut Vec<Action>) {
        match (hello.check(), self.role) {
            (Ok(()), _) => {
                self.is_greeted = true;
                out.extend(self.join.take().map(|join| Action::Send(ToRunner::Join(join))));
            }
            (Err(mismatch), RunRole::Owner) => {
                let reason = mismatch.to_string();
                self.finish(End::NotStarted { reason, said: Vec::new() });
                out.push(Action::Kill);
            }
            (Err(mismatch), RunRole::Guest | RunRole::Host) => {
                self.finish(End::LoadFailed { reason: mismatch.to_string() });
            }
        }
    }

    fn message(&mut self, now: Duration, message: ToViewer, out: &mut Vec<Action>) {
        self.active.told(&message);
        match message {
            ToViewer::LoadFailed { reason } => self.finish(End::LoadFailed { reason }),
            ToViewer::Answer { answer, .. } => out.extend(self.refusal(answer).map(Action::Note)),
            ToViewer::Pong { engine, link, now_ms, .. } => {
                self.reached(engine, out);
                if let Some(link) = link {
                    self.robot(&link, now_ms, out);
                }
            }
            ToViewer::Control(_) | ToViewer::Watched { .. } => {}
            ToViewer::Loaded { name, states, run, problems } => {
                let none = Vec::new();
                out.push(Action::Show(ToViewer::Loaded { name, states, run, problems: none }));
                if self.role != RunRole::Guest {
                    out.extend(
                        problems
                            .into_iter()
                            .map(|problem| log(0, LogLevel::Warning, Stream::Engine, problem)),
                    );
                }
            }
            ToViewer::Event { sequence, t_ns, event } => {
                self.run_ns = t_ns;
                if let Event::Finished { outcome, .. } = &event {
                    self.finished(now, outcome.clone());
                }
                out.push(Action::Show(ToViewer::Event { sequence, t_ns, event }));
            }
            ToViewer::Snapshot(snapshot) => {
                self.may_only_wait(&snapshot, out);
                out.push(Action::Show(ToViewer::Snapshot(snapshot)));
            }
            ToViewer::Inspection { .. } => out.push(Action::Show(message)),
        }
    }

    fn finished(&mut self, now: Duration, outcome: Outcome) {
        let timed_out = self.timed_out;
        let stopped_for = self.waiting.stopped_for.take().filter(|_| !timed_out);
        let waited = stopped_for.map(|awaited| End::OnlyWaited { awaited });
        self.finish(waited.unwrap_or(End::Finished { outcome, timed_out }));
        self.kill_at = Some(now + EXIT_TIMEOUT);
    }

    /// Reports a run of ours that can only wait, and stops it if nobody watches.
    fn may_only_wait(&mut self, snapshot: &Snapshot, out: &mut Vec<Action>) {
        let awaited = self.waiting.begins(snapshot).filter(|_| self.role == RunRole::Owner);
        let Some(awaited) = awaited else { return };
        match &self.unattended {
            None => out.push(Action::Note(format!(
                "the run can only wait for {awaited}: add it to the machine, or stop the run"
            ))),
            Some(Unattended(ends_itself)) if ends_itself() => {}
            Some(_) => {
                let text =
                    format!("the run can only wait for {awaited}, and nobody watches; stopping");
                self.say(&text, Command::Stop, out);
                self.waiting.stopped_for = Some(awaited);
            }
        }
    }

    /// Message for the user about the answer to our command.
    fn refusal(&self, answer: Answer) -> Option<String> {
        match answer {
            Answer::Applied => None,
            Answer::Refused { reason } if self.role == RunRole::Owner => {
                Some(format!("the runner refused: {reason}"))
            }
            Answer::Refused { reason } => Some(format!("refused: {reason}")),
            Answer::Expired => Some("the command arrived too late".to_owned()),
            Answer::Unknown { reason } => Some(format!("unknown: {reason}")),
        }
    }

    /// Reports when the engine starts or stops taking inputs.
    fn reached(&mut self, engine: Option<EnginePulse>, out: &mut Vec<Action>) {
        let changed = engine.and_then(|engine| self.pulse.as_mut()?.answered(engine));
        let Some(is_reached) = changed else { return };
        let (silence, text) = if is_reached {
            (None, "the run answers again")
        } else {
            (Some(Duration::ZERO), STUCK)
        };
        out.extend([Action::Heard(silence), Action::Note(text.to_owned())]);
    }

    /// Reports gain and loss of contact with the robot of a replica. `now_ms` is the station's clock.
    fn robot(&mut self, link: &LinkHealth, now_ms: u64, out: &mut Vec<Action>) {
        let contact = if link.is_heard { RobotContact::Kept } else { RobotContact::Lost };
        if std::mem::replace(&mut self.contact, contact) == contact {
            return;
        }
        let robot = harmless(&link.robot);
        if link.is_heard {
            out.extend([Action::Heard(None), Action::Note(format!("{robot} responds again"))]);
            return;
        }
        let age = link.heard_ms.map(|at| Duration::from_millis(now_ms.saturating_sub(at)));
        let text = match age {
            Some(age) => {
                format!("no contact with {robot} for {}: this view is that old", time(age))
            }
            None => format!("no contact with {robot} since its station started"),
        };
        out.extend([Action::Heard(Some(age.unwrap_or_default())), Action::Note(text)]);
    }

    /// Logs output that the runner did not log, without a state. The last output of a dead runner counts as errors.
    fn raw(&mut self, stream: Stream, line: String, out: &mut Vec<Action>) {
        let is_death = stream == Stream::Stderr && self.end.is_none();
        let level = if is_death { LogLevel::Error } else { LogLevel::Info };
        if stream == Stream::Stderr {
            self.process.said(&line);
        }
        if self.is_greeted || self.end.is_some() {
            out.push(log(self.run_ns, level, stream, line));
        }
    }

    /// Handles the end of the connection. For our own process this is normal at the end, and earlier a defect of a script.
    /// Any other runner has died, by our kill command or by itself.
    fn silence(&mut self, now: Duration) {
        match self.role {
            RunRole::Owner => {
                self.process.silent();
                self.kill_at.get_or_insert(now + EXIT_TIMEOUT);
            }
            RunRole::Guest | RunRole::Host if self.is_kill_sent => self.finish(self.killed()),
            RunRole::Guest | RunRole::Host => {
                self.finish(self.death("the runner died".to_owned()));
            }
        }
    }

    /// Handles expired deadlines, and the death of a process whose output has been read.
    fn watch(&mut self, now: Duration, out: &mut Vec<Action>) {
        if let Some(exit) = self.process.last_word(now).filter(|_| self.end.is_none()) {
            self.finish(self.death(exit.to_string()));
        }
        if self.deadline.is_some_and(|at| now >= at) {
            self.deadline = None;
            self.time_is_over(now, out);
        }
        if self.kill_at.is_some_and(|at| now >= at) {
            self.kill_at = None;
            self.patience_is_over(out);
        }
        let pulse = self.pulse.as_mut().filter(|_| self.is_greeted);
        out.extend(pulse.and_then(|pulse| pulse.question(now)).map(Action::Send));
    }

    fn time_is_over(&mut self, now: Duration, out: &mut Vec<Action>) {
        if self.end.is_some() {
            return;
        }
        self.timed_out = true;
        if self.role == RunRole::Owner && !self.is_greeted {
            self.kill_at = Some(now);
            return;
        }
        self.kill_at = Some(now + GRACE);
        self.say("the time limit expired; stopping", Command::Stop, out);
    }

    fn patience_is_over(&mut self, out: &mut Vec<Action>) {
        match self.role {
            RunRole::Owner if self.process.exit().is_some() => {}
            RunRole::Owner if self.timed_out => self.kill(self.killed(), out),
            RunRole::Owner => {
                let reason = "the runner closed its control connection but did not end".to_owned();
                self.kill(self.death(reason), out);
            }
            RunRole::Guest | RunRole::Host => {
                self.have_killed("the run did not stop; killing", out);
            }
        }
    }

    /// Ends our process at once.
    fn kill(&mut self, end: End, out: &mut Vec<Action>) {
        self.finish(end);
        out.push(Action::Kill);
    }

    /// Stores the first reason of the end.
    fn finish(&mut self, end: End) {
        self.end.get_or_insert(end);
    }

    fn killed(&self) -> End {
        let active = self.active.paths().to_vec();
        End::Killed { timed_out: self.timed_out, has_begun: self.is_greeted, active }
    }

    fn death(&self, reason: String) -> End {
        let said = self.process.tail();
        if self.role == RunRole::Owner && !self.is_greeted {
            return End::NotStarted { reason, said };
        }
        let exit = self.process.exit();
        let is_cut_off = exit.is_some_and(Exit::is_cut_off);
        let is_wanted = exit.is_some_and(Exit::is_stopped);
        let active = self.active.paths().to_vec();
        End::Died(RunnerDeath { reason, active, said, is_cut_off, is_wanted })
    }
}

/// A log line without a state.
fn log(t_ns: u64, level: LogLevel, stream: Stream, message: String) -> Action {
    let event = Event::Log { path: String::new(), level, stream, message };
    Action::Show(ToViewer::Event { sequence: 0, t_ns, event })
}

/// A command of the user at this terminal.
pub(crate) fn envelope(id: String, author: &str, command: Command) -> Envelope {
    Envelope::new(id, author, command)
}

#[cfg(test)]
mod tests;
