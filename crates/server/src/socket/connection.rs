//! The connection of one client: each event is a [`Cause`], and causes are processed in order. Knows frames and their routing; does
//! not know the handling of requests, nor the transport.

use super::outbox::{Lane, Outbox, length};
use super::pulse::ClientPulse;
use super::request_handler::{RequestHandler, now_ms};
use super::session::{ClientRequest, Session, binary};
use super::words;
use crate::Failure;
use axum::extract::ws::{CloseFrame, Message, close_code};
use futures_util::future::{AbortHandle, Abortable, Aborted, BoxFuture, FutureExt as _};
use futures_util::stream::{FuturesOrdered, FuturesUnordered};
use futures_util::{Sink, SinkExt as _, Stream, StreamExt as _};
use rafcon_protocol::socket::{ToClient, Topic};
use std::collections::BTreeMap;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;
use tokio::select;

/// Maximum number of pending commands and edits of a client. At the limit, its next frames wait.
const UNDER_WAY_MAX: usize = 32;
/// Time limit for a client to receive the reason before its connection is closed.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(5);

/// A message from the client, or a transport error.
type Received = Result<Message, axum::Error>;

/// An event that the connection processes.
enum Cause {
    /// A message of the client; `None` once it has disconnected.
    Received(Option<Received>),
    /// The result of a command or an edit.
    Answered(ToClient),
    /// The end of a subscription, by itself or by the client.
    NextMessage(Result<u32, Aborted>),
}

/// Serves a client until it disconnects or is rejected.
pub(super) async fn serve<S>(handler: RequestHandler, socket: S)
where
    S: Stream<Item = Received> + Sink<Message, Error = axum::Error> + Send,
{
    let (sink, stream) = socket.split();
    let (outbox, pulse) = (Arc::new(Outbox::new()), ClientPulse::new());
    let mut writer = pin!(write(sink, &outbox, &pulse));
    let connection = Connection::new(handler.clone(), Arc::clone(&outbox));
    let farewell = select! {
        () = &mut writer => None,
        () = pulse.end(&outbox) => None,
        farewell = handler.unwelcome() => Some(farewell),
        farewell = connection.run(stream, &pulse) => farewell,
    };
    handler.leave();
    if let Some((failure, code)) = farewell {
        let reason = CloseFrame { code, reason: failure.refusal().code.into() };
        outbox.farewell(words::text(&words::refused(None, &failure)), reason);
        // A client that does not receive the reason in time is disconnected without it.
        drop(tokio::time::timeout(CLOSE_TIMEOUT, writer).await);
    }
}

/// Sends the frames in the outbox in order, until the last one or a transport error.
async fn write(
    mut sink: impl Sink<Message, Error = axum::Error> + Unpin,
    outbox: &Outbox,
    pulse: &ClientPulse,
) {
    loop {
        let (lane, frame) = outbox.next().await;
        let (length, is_text) = (length(&frame), matches!(frame, Message::Text(_)));
        let is_last = matches!(frame, Message::Close(_));
        if sink.send(frame).await.is_err() || is_last {
            return;
        }
        outbox.sent(lane, length);
        // A sent ping does not prove that the client is alive.
        if is_text {
            pulse.beat();
        }
    }
}

struct Connection {
    handler: RequestHandler,
    session: Session,
    outbox: Arc<Outbox>,
    answers: FuturesOrdered<BoxFuture<'static, ToClient>>,
    feeds: FuturesUnordered<Abortable<BoxFuture<'static, u32>>>,
    /// Cancels a subscription, by number.
    handles: BTreeMap<u32, AbortHandle>,
}

impl Connection {
    fn new(handler: RequestHandler, outbox: Arc<Outbox>) -> Self {
        Self {
            handler,
            session: Session::default(),
            outbox,
            answers: FuturesOrdered::new(),
            feeds: FuturesUnordered::new(),
            handles: BTreeMap::new(),
        }
    }

    /// Serves until the client disconnects (`None`) or is rejected (the reason and the close code).
    async fn run(
        mut self,
        stream: impl Stream<Item = Received> + Send,
        pulse: &ClientPulse,
    ) -> Option<(Failure, u16)> {
        let mut stream = pin!(stream);
        self.tell(&self.handler.welcome());
        loop {
            let cause = self.wait(stream.as_mut()).await;
            match cause {
                Cause::Received(Some(Ok(message))) => {
                    pulse.beat();
                    if let Err(failure) = self.handler.current_user() {
                        return Some((failure, close_code::POLICY));
                    }
                    self.hear(message);
                }
                Cause::Received(Some(Err(error))) => {
                    return Some((unreadable(&error), close_code::POLICY));
                }
                Cause::Received(None) => return None,
                Cause::Answered(answer) => self.tell(&answer),
                Cause::NextMessage(ended) => self.forget(ended),
            }
        }
    }

    /// The next event. Reads no frames while the outbox is full or too many requests are pending.
    async fn wait(&mut self, mut stream: impl Stream<Item = Received> + Unpin) -> Cause {
        let (outbox, is_free) = (&self.outbox, self.answers.len() < UNDER_WAY_MAX);
        let heard = async {
            outbox.session().await;
            stream.next().await
        };
        select! {
            Some(answer) = self.answers.next() => Cause::Answered(answer),
            Some(ended) = self.feeds.next() => Cause::NextMessage(ended),
            heard = heard, if is_free => Cause::Received(heard),
        }
    }

    fn tell(&self, frame: &ToClient) {
        self.outbox.push(Lane::Status, words::text(frame));
    }

    fn hear(&mut self, message: Message) {
        self.handler.heard();
        match message {
            Message::Text(text) => {
                let act = self.session.hear(&text, self.handler.who(), now_ms());
                self.act(act);
            }
            Message::Binary(_) => self.tell(&binary()),
            Message::Ping(_) | Message::Pong(_) | Message::Close(_) => {}
        }
    }

    fn act(&mut self, act: ClientRequest) {
        match act {
            ClientRequest::Tell(frame) => self.tell(&frame),
            ClientRequest::Begin(subscription, topic) => self.begin(subscription, topic),
            ClientRequest::GiveUp(subscription) => self.give_up(subscription),
            ClientRequest::Command { run, envelope } => {
                self.answers.push_back(self.handler.command(run, *envelope).boxed());
            }
            ClientRequest::Change { machine, id, operation } => {
                self.answers.push_back(self.handler.change(machine, id, operation).boxed());
            }
            ClientRequest::Look { machine, selection } => {
                if let Err(failure) = self.handler.look(&machine, selection) {
                    self.tell(&words::refused(None, &failure));
                }
            }
        }
    }

    fn begin(&mut self, subscription: u32, topic: Topic) {
        let (handler, outbox) = (self.handler.clone(), Arc::clone(&self.outbox));
        let told = async move {
            if let Err(failure) = handler.tell(subscription, topic, &outbox).await {
                let ended = words::text(&words::ended(subscription, Some(&failure)));
                outbox.push(Lane::History, ended);
            }
            subscription
        };
        let (handle, registration) = AbortHandle::new_pair();
        self.feeds.push(Abortable::new(told.boxed(), registration));
        self.handles.insert(subscription, handle);
    }

    fn give_up(&mut self, subscription: u32) {
        if let Some(handle) = self.handles.remove(&subscription) {
            handle.abort();
        }
        // Queued after all frames of the subscription.
        self.outbox.push(Lane::History, words::text(&words::ended(subscription, None)));
    }

    /// Removes a subscription that has ended by itself. A cancelled one is already removed.
    fn forget(&mut self, ended: Result<u32, Aborted>) {
        if let Ok(subscription) = ended {
            self.handles.remove(&subscription);
            self.session.ended(subscription);
        }
    }
}

fn unreadable(error: &axum::Error) -> Failure {
    let message = format!(
        "the frame cannot be read ({error}): a frame is text of at most 1 MiB; reconnect and continue from your cursors"
    );
    Failure::bad("unreadable", message)
}

#[cfg(test)]
mod tests {
    use super::{Cause, Connection, Message, Outbox, RequestHandler, ToClient};
    use super::{Received, UNDER_WAY_MAX};
    use crate::access::{Credential, Who};
    use crate::{ServerState, Settings};
    use futures_util::{FutureExt as _, stream};
    use rafcon_protocol::api::Role;
    use std::sync::Arc;
    use tokio::sync::oneshot;

    #[tokio::test]
    async fn who_has_too_much_under_way_is_heard_again_after_an_answer() {
        let place = tempfile::tempdir().unwrap();
        let settings = Settings::new(place.path().join("state"), place.path().join("runs"));
        std::fs::create_dir(&settings.state).unwrap();
        let (by, user) = (Credential::Owner, "owner".to_owned());
        let who = Who { user, role: Role::Admin, expires_ms: None, by };
        let handler = RequestHandler::new(ServerState::new(settings).unwrap(), who, 1);
        let mut connection = Connection::new(handler, Arc::new(Outbox::new()));
        let mut frames = Box::pin(stream::repeat_with(|| Received::Ok(Message::text("x"))));
        let mut open = Vec::new();
        for _ in 0..UNDER_WAY_MAX {
            let heard = connection.wait(frames.as_mut()).now_or_never();
            assert!(matches!(heard, Some(Cause::Received(_))));
            let (answer, answered) = oneshot::channel::<ToClient>();
            connection.answers.push_back(async move { answered.await.unwrap() }.boxed());
            open.push(answer);
        }
        assert!(connection.wait(frames.as_mut()).now_or_never().is_none());
        open.remove(0).send(ToClient::Pong { id: 1, now_ms: 0 }).unwrap();
        let answered = connection.wait(frames.as_mut()).now_or_never();
        assert!(matches!(answered, Some(Cause::Answered(_))));
        let heard = connection.wait(frames.as_mut()).now_or_never();
        assert!(matches!(heard, Some(Cause::Received(_))));
    }
}
