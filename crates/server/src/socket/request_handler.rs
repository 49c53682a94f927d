//! Access of a client to the server: the only connection between the socket and the other parts. Knows the client and the
//! responsible parts, but not the delivery of frames.

use super::feed::tell;
use super::history::{Cursor, RunHistory};
use super::machine::MachineHistory;
use super::outbox::Outbox;
use super::status::{ServerStatusFeed, Status};
use super::words;
use crate::access::{Who, about};
use crate::documents::{EditRequest, Operation};
use crate::gate::blocking;
use crate::runs::{WatchedNow, Watcher, watched_frame};
use crate::{Failure, ServerState, runs};
use axum::extract::ws::close_code;
use rafcon_protocol::Envelope;
use rafcon_protocol::api::{MachineStatus, Presence, RunNow};
use rafcon_protocol::socket::{ToClient, Topic, VERSION};
use rafcon_supervisor::clock;
use std::sync::Arc;
use std::time::Duration;
use tokio::select;
use tokio::sync::Mutex;
use tokio::time::sleep;

/// Interval of checks of the client's rights, in addition to notifications.
const ASKED_EVERY: Duration = Duration::from_secs(15);

/// Access of one client to the server.
#[derive(Debug, Clone)]
pub(super) struct RequestHandler {
    server: Arc<ServerState>,
    who: Who,
    connection: u64,
    /// Serializes changes of machines, in the order of their requests.
    turn: Arc<Mutex<()>>,
    /// The machine whose states the client shows.
    looks_at: Arc<rafcon_locks::Mutex<Option<String>>>,
}

impl RequestHandler {
    pub(super) fn new(server: Arc<ServerState>, who: Who, connection: u64) -> Self {
        Self { server, who, connection, turn: Arc::default(), looks_at: Arc::default() }
    }

    /// The user when the connection began.
    pub(super) fn who(&self) -> &Who {
        &self.who
    }

    /// The first frame of a connection.
    pub(super) fn welcome(&self) -> ToClient {
        ToClient::Welcome {
            protocol: VERSION,
            session: about(self.who.clone()),
            connection: self.connection,
            now_ms: now_ms(),
        }
    }

    /// Waits until the client must be disconnected. Returns the reason and the close code.
    pub(super) async fn unwelcome(&self) -> (Failure, u16) {
        let (mut closing, mut people) = (self.server.closing(), self.server.people().revision());
        loop {
            let who = match self.current_user() {
                Ok(who) => who,
                Err(failure) => return (failure, close_code::POLICY),
            };
            // The server holds the senders as long as it lives.
            select! {
                _ = closing.wait_for(|is_closing| *is_closing) => return (closes(), close_code::AWAY),
                _ = people.changed() => {}
                () = sleep(patience(&who)) => {}
            }
        }
    }

    /// The current user. Fails if the login is no longer valid or the role has changed.
    pub(super) fn current_user(&self) -> Result<Who, Failure> {
        match self.server.people().still(&self.who) {
            Some(who) if who.role == self.who.role => Ok(who),
            Some(who) => Err(other_role(&who)),
            None => Err(not_known_any_more()),
        }
    }

    /// Notes activity of the client's user.
    pub(super) fn heard(&self) {
        self.server.runs.heard(&self.who.user);
    }

    /// Executes a command for a run.
    pub(super) fn command(
        &self,
        run: String,
        envelope: Envelope,
    ) -> impl Future<Output = ToClient> + Send + 'static + use<> {
        let (server, who, id) = (Arc::clone(&self.server), self.who.clone(), envelope.id.clone());
        async move {
            match runs::command(&server, &who, &run, envelope).await {
                Ok(answer) => ToClient::Answer(answer),
                Err(failure) => words::refused(Some(id), &failure),
            }
        }
    }

    /// Changes an open machine, after all earlier changes of this client.
    pub(super) fn change(
        &self,
        machine: String,
        id: String,
        operation: Operation,
    ) -> impl Future<Output = ToClient> + Send + 'static + use<> {
        let (server, who, turn) = (Arc::clone(&self.server), self.who.clone(), self.turn.clone());
        async move {
            let _turn = turn.lock().await;
            let request = EditRequest { author: who.user, id: id.clone() };
            let work = move || server.documents.change(&server, &machine, request, operation);
            match blocking(work).await {
                Ok(revision) => ToClient::Edited { id, revision },
                Err(failure) => words::refused(Some(id), &failure),
            }
        }
    }

    /// Sets the states that the client shows, and leaves the previous machine.
    pub(super) fn look(&self, machine: &str, selection: Vec<String>) -> Result<(), Failure> {
        let (connection, user) = (self.connection, self.who.user.clone());
        let presence = Presence { connection, user, selection };
        let mut looks_at = self.looks_at.lock();
        if looks_at.as_deref().is_some_and(|before| before != machine) {
            self.leave();
        }
        *looks_at = Some(machine.to_owned());
        self.server.documents.looks(&self.server, machine, presence)
    }

    /// Removes the client from the viewers.
    pub(super) fn leave(&self) {
        self.server.documents.leaves(self.connection);
    }

    /// Serves a subscription to its end. Fails if it cannot be started.
    pub(super) async fn tell(
        &self,
        subscription: u32,
        topic: Topic,
        outbox: &Outbox,
    ) -> Result<(), Failure> {
        match topic {
            Topic::RunHistory { run, from, values } => {
                let run = self.server.runs.get(&run).await?;
                let cursor = Cursor::new(subscription, from, values);
                tell(RunHistory::new(&self.server, run, cursor), outbox).await;
            }
            Topic::RunNewest { run, from, most, newest } => {
                let run = self.server.runs.get(&run).await?;
                let cursor = Cursor::new(subscription, from, false);
                let history = RunHistory::new(&self.server, run, cursor);
                tell(history.newest(most, newest), outbox).await;
            }
            Topic::RunStatus { run } => {
                let run = self.server.runs.get(&run).await?;
                let (now, _onlooker) = (run.now(), run.audience().join());
                // An onlooker must not keep a deleted run in memory.
                drop(run);
                let frame = move |now: &Arc<RunNow>| words::run_status(subscription, now);
                tell(Status::new(subscription, now, frame), outbox).await;
            }
            Topic::RunWatched { run, targets } => {
                let run = self.server.runs.get(&run).await?;
                let is_replica = run.is_replica();
                let watcher = Watcher::begin(run, targets.clone())?;
                let frame = move |now: &Arc<WatchedNow>| {
                    words::text(&watched_frame(subscription, &targets, is_replica, now))
                };
                tell(Status::new(subscription, watcher.now(), frame), outbox).await;
            }
            Topic::MachineHistory { machine, from } => {
                let session = self.server.documents.session(&machine)?;
                tell(MachineHistory::new(session, subscription, from)?, outbox).await;
            }
            Topic::MachineStatus { machine } => {
                let now = self.server.documents.session(&machine)?.status()?;
                let frame = move |status: &MachineStatus| {
                    let status = status.clone();
                    words::text(&ToClient::MachineStatus { subscription, status })
                };
                tell(Status::new(subscription, now, frame), outbox).await;
            }
            Topic::ServerStatus => {
                tell(ServerStatusFeed::new(Arc::clone(&self.server), subscription), outbox).await;
            }
        }
        Ok(())
    }
}

/// Time until the next check of a user's rights, at latest when the credential expires.
fn patience(who: &Who) -> Duration {
    let end = who.expires_ms.map(|end| end.saturating_sub(now_ms()) + 1);
    end.map_or(ASKED_EVERY, |end| ASKED_EVERY.min(Duration::from_millis(end)))
}

/// The time: ms since 1970, UTC.
pub(super) fn now_ms() -> u64 {
    clock::since_1970_ms()
}

fn closes() -> Failure {
    let message = "the server shuts down; runs continue: reconnect and continue from your cursors";
    Failure::unavailable("server_ends", message)
}

fn not_known_any_more() -> Failure {
    let message = "the login or token with which this connection began does not count any more: log in, and connect again";
    Failure::unauthorized("not_known_any_more", message)
}

fn other_role(who: &Who) -> Failure {
    let role = format!("{:?}", who.role).to_lowercase();
    let message = format!("{} is {role} now: reconnect to use this role", who.user);
    Failure::forbidden("other_role", message)
}

#[cfg(test)]
mod tests {
    use super::{ASKED_EVERY, RequestHandler, patience};
    use crate::access::OWNER;
    use crate::{ServerState, Settings};

    #[tokio::test]
    async fn a_login_that_was_used_meanwhile_ends_later_than_it_did() {
        let place = tempfile::tempdir().unwrap();
        let settings = Settings::new(place.path().join("state"), place.path().join("runs"));
        std::fs::create_dir(&settings.state).unwrap();
        let server = ServerState::new(settings).unwrap();
        let (_secret, mut who) = server.people().begin(OWNER).unwrap();
        who.expires_ms = Some(1);
        let handler = RequestHandler::new(server, who, 1);
        assert_eq!(patience(&handler.current_user().unwrap()), ASKED_EVERY);
    }
}
