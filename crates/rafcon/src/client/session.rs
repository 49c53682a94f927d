//! A run that is followed through a server, over as many connections as needed. Pure: input is frames and the time, output
//! is frames and causes.
//!
//! The cursor of the history and the pending commands outlive a connection. The next connection continues from the cursor
//! and resends these commands with unchanged ids, so that each is executed once.

use crate::event_queue::{Cause, STUCK};
use rafcon_protocol::api::{CommandAnswer, LinkState, Refusal, RunNow, RunPhase};
use rafcon_protocol::socket::{ToClient, ToServer, Topic, VERSION};
use rafcon_protocol::{
    Answer, Envelope, Event, Expiry, Hello, Join, LinkHealth, LinkLifetime, Snapshot, ToRunner,
    ToViewer,
};

/// The subscription of the run's status.
const STATUS: u32 = 1;
/// The subscription of its history.
const HISTORY: u32 = 2;
/// Time, in ms, until a crashed run counts as lost: the server may resume it before.
const RESUME_WAIT_MS: u64 = 2000;
/// Retry interval, in ms, of commands that the runner did not answer.
const AGAIN_MS: u64 = 1000;

/// Actions that result from an input.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Todo {
    /// Frames for the server.
    pub(super) frames: Vec<ToServer>,
    /// Causes for the program that follows the run.
    pub(super) causes: Vec<Cause>,
    /// States whose data is requested, with the id of the request.
    pub(super) inspect: Vec<(String, String)>,
}

/// State of the connection to the server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Connection {
    /// No connection was opened yet.
    Awaited,
    Up,
    /// The connection broke or could not be opened.
    Cut,
}

/// State of the connection between server and runner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Runner {
    /// The runner responds, or no report has arrived yet.
    Heard,
    /// It does not respond, though its socket is open.
    Silent,
    /// It responds, but its engine takes no inputs.
    Stuck,
}

/// State of a followed run.
#[derive(Debug)]
pub(super) struct Session {
    run: String,
    wanted: Option<Join>,
    /// Cursor of the history: the next event to report, once known.
    next: Option<u64>,
    /// Pending commands, the oldest first.
    commands: Vec<Envelope>,
    /// True if the server could not deliver a command to the runner yet.
    held_back: bool,
    /// Time of the next retry of unanswered commands.
    again_at_ms: Option<u64>,
    connection: Connection,
    /// The server's last report about its link to the runner.
    runner: Runner,
    is_loaded: bool,
    is_over: bool,
    /// Time of the crash and number of the last event, while no runner executes the run.
    crashed: Option<(u64, u64)>,
    /// The server's clock minus ours, in ms.
    offset_ms: i64,
    /// Lifetime of commands over the link to the robot, if the run is a replica.
    link_lifetime: Option<LinkLifetime>,
}

impl Session {
    /// A session without a connection.
    pub(super) fn new(run: String) -> Self {
        Self {
            run,
            wanted: None,
            next: None,
            commands: Vec::new(),
            held_back: false,
            again_at_ms: None,
            connection: Connection::Awaited,
            runner: Runner::Heard,
            is_loaded: false,
            is_over: false,
            crashed: None,
            offset_ms: 0,
            link_lifetime: None,
        }
    }

    fn is_up(&self) -> bool {
        self.connection == Connection::Up
    }

    /// Handles a message for the run.
    pub(super) fn said(&mut self, message: ToRunner, now_ms: u64, todo: &mut Todo) {
        match message {
            ToRunner::Join(join) => {
                self.next = (join.from > 0).then_some(join.from);
                self.wanted = Some(join);
                self.subscribe(todo);
            }
            ToRunner::Command(envelope) => {
                let envelope = self.dated(envelope, now_ms);
                if self.is_up() {
                    todo.frames.push(self.frame_of(&envelope));
                }
                self.commands.push(envelope);
            }
            ToRunner::Inspect { id, path } => todo.inspect.push((id, path)),
            ToRunner::Launch(_)
            | ToRunner::Ping { .. }
            | ToRunner::Ground { .. }
            | ToRunner::MoveControl { .. }
            | ToRunner::Present { .. }
            | ToRunner::Watch { .. } => {}
        }
    }

    /// Sets the expiry by the server's clock.
    fn dated(&self, envelope: Envelope, now_ms: u64) -> Envelope {
        let now_ms = now_ms.saturating_add_signed(self.offset_ms);
        let envelope = envelope.dated(now_ms, self.link_lifetime);
        let seen = self.next.map(|next| next.saturating_sub(1)).filter(|seen| *seen > 0);
        Envelope { decided_on: envelope.decided_on.or(seen), ..envelope }
    }

    fn frame_of(&self, envelope: &Envelope) -> ToServer {
        ToServer::Command { run: self.run.clone(), envelope: envelope.clone() }
    }

    /// Handles a frame of the server.
    pub(super) fn heard(&mut self, frame: ToClient, now_ms: u64, todo: &mut Todo) {
        match frame {
            ToClient::Welcome { protocol, session, now_ms: theirs, .. } => {
                self.offset_ms = i64::try_from(theirs).unwrap_or(i64::MAX)
                    - i64::try_from(now_ms).unwrap_or(i64::MAX);
                if protocol == VERSION {
                    self.welcome(todo);
                } else {
                    todo.causes.push(Cause::Refused(other_version(protocol, &session.version)));
                }
            }
            ToClient::Events { subscription: HISTORY, next, events } => {
                let events = events.into_iter().map(|entry| ToViewer::Event {
                    sequence: entry.sequence,
                    t_ns: entry.t_ns,
                    event: entry.event,
                });
                self.events(events, next, todo);
            }
            ToClient::RunStatus { subscription: STATUS, status } => {
                self.crashed = match status.run.phase {
                    RunPhase::Crashed => {
                        Some((self.crashed.map_or(now_ms, |(since, _)| since), status.run.events))
                    }
                    _ => None,
                };
                self.status(*status, todo);
            }
            ToClient::Answer(CommandAnswer { id, answer }) => self.answered(id, answer, todo),
            ToClient::Refused { id: Some(id), refusal } => self.refused(id, refusal, now_ms, todo),
            ToClient::Refused { id: None, refusal } => {
                todo.causes.push(Cause::Refused(refusal.message));
            }
            ToClient::Ended { subscription, refusal } => self.ended(subscription, refusal, todo),
            _ => {}
        }
    }

    /// Time of the next tick.
    pub(super) fn wake_at_ms(&self) -> Option<u64> {
        let again_at = self.again_at_ms.filter(|_| self.is_up());
        [self.lost_at_ms(), again_at].into_iter().flatten().min()
    }

    fn lost_at_ms(&self) -> Option<u64> {
        self.crashed.filter(|_| !self.is_over).map(|(since, _)| since + RESUME_WAIT_MS)
    }

    /// Handles the passing of time. A crashed run without a resume counts as lost once all its events are reported.
    pub(super) fn tick(&mut self, now_ms: u64, todo: &mut Todo) {
        if self.is_up() && self.again_at_ms.is_some_and(|at| now_ms >= at) {
            self.say_again(todo);
        }
        let is_due = self.lost_at_ms().is_some_and(|at| now_ms >= at);
        let last = self.crashed.map_or(0, |(_, last)| last);
        if is_due && self.is_up() && self.next.is_some_and(|next| next > last) {
            self.is_over = true;
            todo.causes.push(Cause::Silence);
        }
    }

    /// Handles the end of the connection.
    pub(super) fn cut(&mut self, reason: &str, todo: &mut Todo) {
        if self.connection != Connection::Cut {
            self.connection = Connection::Cut;
            todo.causes
                .push(Cause::Cut(format!("no connection to the server ({reason}); trying again")));
        }
    }

    fn welcome(&mut self, todo: &mut Todo) {
        if self.wanted.is_none() {
            todo.causes.push(Cause::Hello(Hello::ours()));
        }
        if std::mem::replace(&mut self.connection, Connection::Up) == Connection::Cut {
            todo.causes.push(Cause::Mended("the connection is back".to_owned()));
        }
        self.runner = Runner::Heard;
        self.subscribe(todo);
        self.say_again(todo);
    }

    /// Subscribes to the status of the run, and to its history once the run is loaded.
    fn subscribe(&mut self, todo: &mut Todo) {
        if self.wanted.is_none() || !self.is_up() || self.is_over {
            return;
        }
        let topic = Topic::RunStatus { run: self.run.clone() };
        todo.frames.push(ToServer::Subscribe { subscription: STATUS, topic });
        if self.is_loaded {
            self.subscribe_history(todo);
        }
    }

    fn subscribe_history(&self, todo: &mut Todo) {
        let (run, from) = (self.run.clone(), self.next.unwrap_or(1));
        let topic = Topic::RunHistory { run, from, values: false };
        todo.frames.push(ToServer::Subscribe { subscription: HISTORY, topic });
    }

    fn say_again(&mut self, todo: &mut Todo) {
        self.held_back = false;
        self.again_at_ms = None;
        todo.frames.extend(self.commands.iter().map(|envelope| self.frame_of(envelope)));
    }

    fn events(&mut self, events: impl Iterator<Item = ToViewer>, next: u64, todo: &mut Todo) {
        let seen = self.next.unwrap_or(1);
        let every_event = self.wanted.as_ref().is_some_and(|join| join.every_event);
        let is_new = |message: &ToViewer| {
            let ToViewer::Event { sequence, event, .. } = message else { return true };
            *sequence >= seen && (every_event || is_rare(event))
        };
        let new: Vec<ToViewer> = events.filter(is_new).collect();
        self.next = Some(seen.max(next));
        let is_end = |message: &ToViewer| {
            matches!(message, ToViewer::Event { event: Event::Finished { .. }, .. })
        };
        self.is_over |= new.iter().any(is_end);
        if !new.is_empty() {
            todo.causes.push(Cause::Messages(new));
        }
    }

    fn status(&mut self, now: RunNow, todo: &mut Todo) {
        let mut messages = Vec::new();
        let (link, robot, now_ms) = (now.link, now.robot.clone(), now.now_ms);
        self.link_lifetime = now.robot.as_ref().and_then(LinkHealth::lifetime);
        let is_linked = matches!(link, LinkState::Up | LinkState::Silent | LinkState::Stuck);
        let is_told = is_linked && (self.next.is_some() || now.snapshot.is_some());
        if !self.is_loaded && (is_told || !is_live(&now.run.phase)) {
            self.is_loaded = true;
            self.next.get_or_insert_with(|| from_now_on(&now));
            messages.push(loaded(&now));
            self.subscribe_history(todo);
        }
        let phase = now.run.phase.clone();
        messages.extend(aged(now).map(ToViewer::Snapshot));
        if !messages.is_empty() {
            todo.causes.push(Cause::Messages(messages));
        }
        if let Some(robot) = robot {
            let pong = ToViewer::Pong { id: 0, now_ms, engine: None, link: Some(Box::new(robot)) };
            todo.causes.push(Cause::Messages(vec![pong]));
        } else {
            self.linked(link, todo);
        }
        match phase {
            RunPhase::NotStarted { reason }
            | RunPhase::Diverged { reason }
            | RunPhase::Unreadable { reason } => {
                todo.causes.push(Cause::Refused(reason));
            }
            _ if self.held_back && is_linked => self.say_again(todo),
            _ => {}
        }
    }

    /// Handles a change of the server's link to the runner.
    fn linked(&mut self, link: LinkState, todo: &mut Todo) {
        let runner = match link {
            LinkState::Up => Runner::Heard,
            LinkState::Silent => Runner::Silent,
            LinkState::Stuck => Runner::Stuck,
            _ => return,
        };
        if std::mem::replace(&mut self.runner, runner) != runner {
            todo.causes.push(match runner {
                Runner::Heard => Cause::Mended("the run answers again".to_owned()),
                Runner::Silent => Cause::Cut("the run does not answer; trying again".to_owned()),
                Runner::Stuck => Cause::Cut(STUCK.to_owned()),
            });
        }
    }

    fn answered(&mut self, id: String, answer: Answer, todo: &mut Todo) {
        self.commands.retain(|envelope| envelope.id != id);
        todo.causes.push(Cause::Messages(vec![ToViewer::Answer { id, answer }]));
    }

    /// Handles the refusal of a command. A command without a runner is sent again when a runner is available, and an
    /// unanswered one after an interval. Other refusals are final.
    fn refused(&mut self, id: String, refusal: Refusal, now_ms: u64, todo: &mut Todo) {
        match refusal.code.as_str() {
            "link_lost" => self.held_back = true,
            "no_answer" if self.is_wanted(&id, now_ms) => {
                self.again_at_ms = Some(now_ms + AGAIN_MS);
            }
            "no_answer" => self.answered(id, Answer::Unknown { reason: refusal.message }, todo),
            _ => self.answered(id, Answer::Refused { reason: refusal.message }, todo),
        }
    }

    /// True if a command is pending and has not expired.
    fn is_wanted(&self, id: &str, now_ms: u64) -> bool {
        let theirs = now_ms.saturating_add_signed(self.offset_ms);
        let mut asked = self.commands.iter();
        asked.any(|one| one.id == id && one.expiry.is_none_or(|Expiry(until)| theirs < until))
    }

    fn ended(&mut self, subscription: u32, refusal: Option<Refusal>, todo: &mut Todo) {
        match refusal {
            Some(refusal) => todo.causes.push(Cause::Refused(refusal.message)),
            None if subscription == HISTORY && !self.is_over => {
                self.is_over = true;
                todo.causes.push(Cause::Silence);
            }
            None => {}
        }
    }
}

fn other_version(protocol: u32, program: &str) -> String {
    format!(
        "the server (version {program}) speaks version {protocol} of the socket's frames, this program {VERSION}: install \
         the same version of rafcon on both computers"
    )
}

/// First message of a runner.
fn loaded(now: &RunNow) -> ToViewer {
    let (name, run) = (now.run.name.clone(), now.run.id.clone());
    let (states, problems) =
        now.loaded.clone().map_or((0, Vec::new()), |loaded| (loaded.states, loaded.problems));
    ToViewer::Loaded { name, states, problems, run }
}

fn is_live(phase: &RunPhase) -> bool {
    matches!(phase, RunPhase::Live | RunPhase::Starting)
}

/// Number of the next event to come; for an ended run, that of its end.
fn from_now_on(now: &RunNow) -> u64 {
    let told = now.snapshot.as_ref().map(|snapshot| snapshot.disk_safe);
    if is_live(&now.run.phase) { told.unwrap_or(now.run.events) + 1 } else { now.run.events.max(1) }
}

/// Last snapshot of the runner, with its times advanced by its age.
fn aged(now: RunNow) -> Option<Snapshot> {
    let age = now.now_ms.saturating_sub(now.snapshot_ms.unwrap_or(now.now_ms));
    let mut snapshot = now.snapshot?;
    if now.link != LinkState::Over {
        snapshot.elapsed_ms += age;
        snapshot.active.iter_mut().for_each(|state| state.since_ms += age);
    }
    Some(snapshot)
}

/// True if viewers without a subscription to all events receive this event too, as from a runner.
fn is_rare(event: &Event) -> bool {
    !matches!(
        event,
        Event::Entered { .. }
            | Event::Left { .. }
            | Event::Scoped { .. }
            | Event::Global { .. }
            | Event::Persistent { .. }
    )
}

#[cfg(test)]
mod tests;
