//! What a client can have of the house: the one place where the socket meets the other parts of the server. Knows who the client
//! is and whom to ask; must never know how anything is told.

use super::feed::tell;
use super::history::{Cursor, RunHistory};
use super::house::HouseStatus;
use super::outbox::Outbox;
use super::session::Step;
use super::status::Status;
use super::words;
use crate::access::Who;
use crate::{Failure, House, runs};
use axum::extract::ws::close_code;
use axum::http::StatusCode;
use rafcon_protocol::Envelope;
use rafcon_protocol::api::{Right, RunNow, Session};
use rafcon_protocol::socket::{ToClient, Topic, VERSION};
use rafcon_supervisor::clock;
use std::sync::Arc;

/// One client's access to the house.
#[derive(Debug, Clone)]
pub(super) struct Desk {
    house: Arc<House>,
    who: Who,
    connection: u64,
}

impl Desk {
    pub(super) fn new(house: Arc<House>, who: Who, connection: u64) -> Self {
        Self { house, who, connection }
    }

    /// Who the client is.
    pub(super) fn who(&self) -> &Who {
        &self.who
    }

    /// The time: ms since 1970, UTC.
    pub(super) fn now_ms(&self) -> u64 {
        clock::since_1970_ms()
    }

    /// The first frame.
    pub(super) fn welcome(&self) -> ToClient {
        ToClient::Welcome {
            protocol: VERSION,
            session: session(&self.who),
            connection: self.connection,
            now_ms: self.now_ms(),
        }
    }

    /// Waits until the client has to go: why, and the code that says so.
    pub(super) async fn unwelcome(&self) -> (Failure, u16) {
        let mut closing = self.house.closing();
        // The house keeps the sender as long as it stands.
        drop(closing.wait_for(|is_closing| *is_closing).await);
        (closes(), close_code::AWAY)
    }

    /// The client said something.
    pub(super) fn heard(&self) {
        self.house.runs.heard(&self.who.user);
    }

    /// Carries a command out.
    pub(super) fn command(
        &self,
        run: String,
        envelope: Envelope,
    ) -> impl Future<Output = ToClient> + Send + 'static + use<> {
        let (house, who, id) = (Arc::clone(&self.house), self.who.clone(), envelope.id.clone());
        async move {
            match runs::command(&house, &who, &run, envelope).await {
                Ok(answer) => ToClient::Answer(answer),
                Err(failure) => words::refused(Some(id), &failure),
            }
        }
    }

    /// Changes an open machine.
    pub(super) fn change(
        &self,
        machine: String,
        step: Step,
    ) -> impl Future<Output = ToClient> + Send + 'static + use<> {
        let id = match step {
            Step::Edit(edit) => edit.id,
            Step::Undo(step) | Step::Redo(step) => step.id,
        };
        async move { words::refused(Some(id), &not_open(&machine)) }
    }

    /// The client looks at these states of an open machine.
    pub(super) fn look(&self, machine: &str, _selection: Vec<String>) -> Result<(), Failure> {
        Err(not_open(machine))
    }

    /// Tells a subscription until nothing more will come, or says why it cannot be told.
    pub(super) async fn tell(
        &self,
        subscription: u32,
        topic: Topic,
        outbox: &Outbox,
    ) -> Result<(), Failure> {
        match topic {
            Topic::RunHistory { run, from, values } => {
                let run = self.house.runs.get(&run).await?;
                let cursor = Cursor::new(subscription, from, values);
                tell(RunHistory::new(&self.house, run, cursor), outbox).await;
            }
            Topic::RunStatus { run } => {
                let now = self.house.runs.get(&run).await?.now();
                let frame = move |now: &Arc<RunNow>| words::run_status(subscription, now);
                tell(Status::new(subscription, now, frame), outbox).await;
            }
            Topic::MachineHistory { machine, .. } | Topic::MachineStatus { machine } => {
                return Err(not_open(&machine));
            }
            Topic::HouseStatus => {
                tell(HouseStatus::new(Arc::clone(&self.house), subscription), outbox).await;
            }
        }
        Ok(())
    }
}

fn session(who: &Who) -> Session {
    let rights = [Right::Observe, Right::Command, Right::Start, Right::Edit, Right::Administer];
    Session {
        user: who.user.clone(),
        role: who.role,
        rights: rights.into_iter().filter(|right| who.role.grants(*right)).collect(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        expires_ms: who.expires_ms,
    }
}

fn closes() -> Failure {
    let message = "the server ends; runs go on: connect again and go on from your cursors";
    Failure::new(StatusCode::SERVICE_UNAVAILABLE, "server_ends", message)
}

fn not_open(machine: &str) -> Failure {
    let message = format!("no machine `{machine}` is open: POST /api/v1/machines/open opens one");
    Failure::not_found("no_such_machine", message)
}
