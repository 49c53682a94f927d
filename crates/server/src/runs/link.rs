//! The connection to the runner of one run. Its events go into the ring, its snapshots become the current state, and its replies
//! complete the commands. One for each active run.
//!
//! Knows the protocol. Does not know the authors of commands, the viewers, or the handling of a run without a runner.

use super::pulse::{self, Liveness, RunnerPulse};
use super::run::Run;
use super::talk::{LinkError, RunnerConnection, frame, open};
use rafcon_locks::Mutex;
use rafcon_protocol::api::ControlMove;
use rafcon_protocol::{Answer, Envelope, FrameKind, Join, ToRunner, ToViewer, WatchTarget, encode};
use std::collections::BTreeMap;
use std::sync::Arc;
use tokio::io::{AsyncWriteExt as _, BufReader};
use tokio::net::unix::{OwnedReadHalf, OwnedWriteHalf};
use tokio::sync::{mpsc, oneshot};

/// Capacity of the queue of commands.
const COMMANDS_MAX: usize = 256;

/// An open connection to a runner.
#[derive(Debug)]
pub(super) struct Link {
    out: mpsc::Sender<Vec<u8>>,
    waiting: Mutex<Waiting>,
}

#[derive(Debug, Default)]
struct Waiting {
    is_closed: bool,
    answers: BTreeMap<String, Vec<oneshot::Sender<Answer>>>,
}

/// The current connection to the runner of a run, if any.
#[derive(Debug, Default)]
pub(super) struct RunnerLink(Mutex<HeldLink>);

#[derive(Debug, Default)]
struct HeldLink {
    link: Option<Arc<Link>>,
    /// A note about control that waits for a connection.
    note: Option<Envelope>,
}

/// Reason why a command was not sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NotSent {
    /// The link is closed.
    Gone,
    /// Too many commands are pending.
    Busy,
}

/// Connects to the runner and follows it until the connection ends. Calls `is_up` once connected.
pub(super) async fn follow(run: &Run, is_up: impl FnOnce()) -> Result<(), LinkError> {
    let join = Join { from: run.ring().next(), every_event: true };
    let RunnerConnection { loaded, frames, out } = open(run.folder().to_path_buf(), join).await?;
    if let Some(loaded) = loaded {
        run.set_loaded(loaded);
    }
    let (sender, outgoing) = mpsc::channel(COMMANDS_MAX);
    let link = Arc::new(Link { out: sender, waiting: Mutex::default() });
    let writer = tokio::spawn(write(out, outgoing));
    run.set_link(&link);
    run.ask_for_watched();
    is_up();
    let pulse = RunnerPulse::new();
    let end = tokio::select! {
        end = read(frames, run, &link, &pulse) => end,
        never = pulse::keep_asking(run, &link, &pulse) => match never {},
    };
    // The pulse has the time by the present calendar.
    run.look_at_calendar();
    run.clear_link(pulse.heard_ms());
    link.close();
    writer.abort();
    end
}

impl RunnerLink {
    pub(super) fn get(&self) -> Option<Arc<Link>> {
        self.0.lock().link.clone()
    }

    /// Sets the connection, and sends the pending note.
    pub(super) fn connect(&self, link: &Arc<Link>) {
        let note = {
            let mut held = self.0.lock();
            held.link = Some(Arc::clone(link));
            held.note.take()
        };
        if let Some(note) = note {
            self.send_note(note);
        }
    }

    pub(super) fn disconnect(&self) {
        self.0.lock().link = None;
    }

    /// Sends a note about control. Without a connection, the newest note waits for the next one.
    pub(super) fn send_note(&self, note: Envelope) {
        let link = {
            let mut held = self.0.lock();
            let Some(link) = &held.link else {
                held.note = Some(note);
                return;
            };
            Arc::clone(link)
        };
        // The reply to a note is not needed.
        if link.send(&note).is_err() {
            self.0.lock().note = Some(note);
        }
    }
}

impl Link {
    /// Sends a command. The receiver gets the reply, or an error if the link is lost.
    pub(super) fn send(&self, envelope: &Envelope) -> Result<oneshot::Receiver<Answer>, NotSent> {
        self.send_message(&envelope.id, &ToRunner::Command(envelope.clone()))
    }

    fn send_message(
        &self,
        id: &str,
        message: &ToRunner,
    ) -> Result<oneshot::Receiver<Answer>, NotSent> {
        let line = encode(message).map_err(|_never| NotSent::Gone)?;
        let (answer, answered) = oneshot::channel();
        let mut waiting = self.waiting.lock();
        if waiting.is_closed {
            return Err(NotSent::Gone);
        }
        self.out.try_send(line).map_err(|error| match error {
            mpsc::error::TrySendError::Full(_) => NotSent::Busy,
            mpsc::error::TrySendError::Closed(_) => NotSent::Gone,
        })?;
        waiting.answers.entry(id.to_owned()).or_default().push(answer);
        Ok(answered)
    }

    /// Sends a change of control to the robot of a replica. The receiver gets the reply, or an error if the link is lost.
    pub(super) fn move_control(
        &self,
        id: String,
        author: &str,
        wanted: ControlMove,
    ) -> Result<oneshot::Receiver<Answer>, NotSent> {
        let author = author.to_owned();
        self.send_message(&id.clone(), &ToRunner::MoveControl { id, author, wanted })
    }

    /// Reports to the robot of a replica that this user is active.
    pub(super) fn tell_present(&self, user: &str) {
        if let Ok(line) = encode(&ToRunner::Present { user: user.to_owned() }) {
            // The report is repeated.
            self.out.try_send(line).unwrap_or_default();
        }
    }

    /// Sends the watched targets to the station of a replica.
    pub(super) fn watch(&self, targets: Vec<WatchTarget>) {
        if let Ok(line) = encode(&ToRunner::Watch { targets }) {
            // If the queue is full, the next change sends them.
            self.out.try_send(line).unwrap_or_default();
        }
    }

    /// True while a command is pending. The runner processes commands in order.
    pub(super) fn is_busy(&self) -> bool {
        !self.waiting.lock().answers.is_empty()
    }

    /// Pings the runner. With a full queue, its next message serves as the reply.
    pub(super) fn ask(&self) {
        if let Ok(line) = encode(&ToRunner::Ping { id: 0 }) {
            self.out.try_send(line).unwrap_or_default();
        }
    }

    fn answered(&self, id: &str, answer: &Answer) {
        let waiting = self.waiting.lock().answers.remove(id);
        for asker in waiting.into_iter().flatten() {
            // The sender may have stopped waiting.
            asker.send(answer.clone()).unwrap_or_default();
        }
    }

    /// Ends all waits with a lost link.
    fn close(&self) {
        *self.waiting.lock() = Waiting { is_closed: true, answers: BTreeMap::new() };
    }
}

async fn write(mut out: OwnedWriteHalf, mut outgoing: mpsc::Receiver<Vec<u8>>) {
    while let Some(line) = outgoing.recv().await {
        if out.write_all(&line).await.is_err() {
            return;
        }
    }
}

async fn read(
    mut frames: BufReader<OwnedReadHalf>,
    run: &Run,
    link: &Link,
    pulse: &RunnerPulse,
) -> Result<(), LinkError> {
    let mut content = Vec::new();
    while let Some(kind) = frame(&mut frames, &mut content).await? {
        if pulse.note_heard() == Liveness::Again {
            run.mark_heard();
        }
        match kind {
            FrameKind::Events => run.happened(&content)?,
            FrameKind::Message => said(&content, run, link),
            FrameKind::Unknown => {}
        }
    }
    Ok(())
}

/// Handles a message of the runner that is not an event.
fn said(content: &[u8], run: &Run, link: &Link) {
    match serde_json::from_slice::<ToViewer>(content) {
        Ok(ToViewer::Snapshot(snapshot)) => run.set_snapshot(snapshot),
        Ok(ToViewer::Answer { id, answer }) => link.answered(&id, &answer),
        Ok(ToViewer::Pong { engine: Some(engine), .. }) => run.engine_answers(engine),
        Ok(ToViewer::Pong { link: Some(link), .. }) => run.robot_stands(*link),
        Ok(ToViewer::Control(control)) => run.robot_controls(control),
        Ok(ToViewer::Watched { watching, values }) => run.watched().take(watching, values),
        // Messages that a link never requests, and those of newer runners.
        Ok(
            ToViewer::Loaded { .. }
            | ToViewer::LoadFailed { .. }
            | ToViewer::Inspection { .. }
            | ToViewer::Event { .. }
            // A plain pong only proves that the runner is alive.
            | ToViewer::Pong { .. },
        )
        | Err(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::{COMMANDS_MAX, Link, NotSent, RunnerLink, Waiting};
    use rafcon_locks::Mutex;
    use rafcon_protocol::{Command, Envelope};
    use std::sync::Arc;
    use tokio::sync::mpsc;

    #[test]
    fn a_note_without_a_connection_is_sent_over_the_next_one_and_only_the_newest() {
        let runner = RunnerLink::default();
        let note = |id: &str| {
            let command = Command::Control { holder: Some("anna".to_owned()) };
            runner.send_note(Envelope::new(id, "anna", command));
        };
        let connect = || {
            let (out, outgoing) = mpsc::channel(COMMANDS_MAX);
            runner.connect(&Arc::new(Link { out, waiting: Mutex::new(Waiting::default()) }));
            outgoing
        };
        let sent = |outgoing: &mut mpsc::Receiver<Vec<u8>>| {
            let ids = std::iter::from_fn(|| outgoing.try_recv().ok()).map(|line| {
                let line: serde_json::Value = serde_json::from_slice(&line).unwrap();
                line["id"].as_str().unwrap().to_owned()
            });
            ids.collect::<Vec<_>>().join(" ")
        };
        ["one", "two"].into_iter().for_each(note);
        let mut first = connect();
        note("three");
        assert_eq!(sent(&mut first), "two three");
        drop(first);
        // A note fails while the connection ends, and then waits.
        note("four");
        runner.disconnect();
        assert_eq!(sent(&mut connect()), "four");
    }

    #[test]
    fn a_runner_that_reads_nothing_is_sent_a_limited_number_of_commands() {
        let (out, mut outgoing) = mpsc::channel(COMMANDS_MAX);
        let link = Link { out, waiting: Mutex::new(Waiting::default()) };
        let send = |number: usize| {
            let envelope = Envelope::new(number.to_string(), "anna", Command::Pause);
            link.send(&envelope).map(drop)
        };
        assert_eq!((0..COMMANDS_MAX).map(send).find(Result::is_err), None);
        assert_eq!(send(COMMANDS_MAX), Err(NotSent::Busy));
        assert_eq!(link.waiting.lock().answers.len(), COMMANDS_MAX);
        outgoing.try_recv().unwrap();
        assert_eq!(send(COMMANDS_MAX), Ok(()));
    }
}
