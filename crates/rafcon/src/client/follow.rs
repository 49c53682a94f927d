//! The thread that follows a run through a server: it connects, and passes frames to and from the session. Decides only
//! when to drop a connection and when to reconnect.

use super::session::{Session, Todo};
use super::socket::{Broken, Socket};
use super::{Fault, Server};
use crate::clock::Clock;
use crate::event_queue::{Cause, EventQueue, Flow, Gone, Line, Queue, offer};
use crate::failure::complain;
use anyhow::{Context as _, Result};
use rafcon_protocol::socket::ToServer;
use rafcon_protocol::{ToRunner, ToViewer};
use rafcon_supervisor::clock::since_1970_ms;
use std::io::{self, Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread;
use std::time::Duration;

/// Capacity of the queue of messages to the run.
const QUEUE: usize = 256;
/// Interval of pings, which also keep the connection alive on the other side.
const ASK: Duration = Duration::from_secs(5);
/// Timeout of a connection without received data.
const SILENCE: Duration = Duration::from_secs(15);
/// Reconnection delays, in ms; the last one repeats.
const PAUSES_MS: [u64; 6] = [100, 200, 500, 1000, 2000, 5000];

/// A connection to a run through its server.
#[derive(Debug)]
pub(crate) struct Following {
    words: SyncSender<ToRunner>,
    wake: UnixStream,
}

impl Line for Following {
    /// Queues a message, also while no connection exists.
    fn say(&mut self, message: &ToRunner) -> Result<bool> {
        let is_sent = offer(&self.words, message);
        // A full pipe wakes the thread, too.
        self.wake.write_all(b"!").or_else(|error| match error.kind() {
            io::ErrorKind::WouldBlock | io::ErrorKind::BrokenPipe => Ok(()),
            _ => Err(error),
        })?;
        Ok(is_sent)
    }
}

/// Follows a run of the server; events go into `wires`.
pub(crate) fn follow(
    server: &Arc<Server>,
    run: &str,
    wires: &mut EventQueue,
    clock: Clock,
) -> Result<Following> {
    let (words, said) = sync_channel(QUEUE);
    let (wake, woken) = UnixStream::pair().context("cannot make a pipe")?;
    wake.set_nonblocking(true)?;
    woken.set_nonblocking(true)?;
    let (server, run) = (Arc::clone(server), run.to_owned());
    wires.listen("server", move |queue| {
        let session = Session::new(run.clone());
        Follower { server, run, session, said, woken, queue, clock, is_over: false }.work()
    })?;
    Ok(Following { words, wake })
}

struct Follower<'q> {
    server: Arc<Server>,
    run: String,
    session: Session,
    said: Receiver<ToRunner>,
    woken: UnixStream,
    queue: &'q Queue,
    clock: Clock,
    /// True if the receiver has disconnected.
    is_over: bool,
}

impl Follower<'_> {
    fn work(mut self) -> Flow {
        let mut pauses = PAUSES_MS.into_iter();
        let mut pause = 0;
        while !self.is_over {
            let reason = match self.server.socket() {
                Ok(socket) => {
                    pauses = PAUSES_MS.into_iter();
                    self.talk(socket)?
                }
                Err(fault) if fault.is_passing() => in_words(&fault),
                Err(fault) => return self.queue.send(Cause::Refused(in_words(&fault))),
            };
            let mut todo = Todo::default();
            self.session.cut(&reason, &mut todo);
            self.tell(&mut todo)?;
            pause = pauses.next().unwrap_or(pause);
            thread::park_timeout(Duration::from_millis(pause));
        }
        Ok(())
    }

    /// Exchanges messages until the connection breaks; returns the reason.
    fn talk(&mut self, mut socket: Socket) -> Result<Broken, Gone> {
        let (mut heard_at, mut asked_at) = (self.clock.now(), self.clock.now());
        loop {
            let (mut todo, mut is_heard) = (Todo::default(), false);
            let read = self.read(&mut socket, &mut todo, &mut is_heard);
            self.listen(&mut todo);
            self.session.tick(since_1970_ms(), &mut todo);
            let spoken = speak(&mut socket, &mut todo);
            self.tell(&mut todo)?;
            if self.is_over {
                return Err(Gone);
            }
            if let Err(broken) = read.and(spoken) {
                return Ok(broken);
            }
            let now = self.clock.now();
            if is_heard {
                heard_at = now;
            }
            if now >= heard_at + SILENCE {
                return Ok(format!("no answer for {} s", SILENCE.as_secs()));
            }
            if now >= asked_at + ASK {
                asked_at = now;
                if let Err(broken) = socket.say(&ToServer::Ping { id: 0 }) {
                    return Ok(broken);
                }
            }
            if is_heard {
                continue;
            }
            let until = (asked_at + ASK).min(heard_at + SILENCE).saturating_sub(now);
            let until = until.min(self.patience());
            if let Err(error) = socket.wait(&self.woken, until) {
                return Ok(error.to_string());
            }
            self.rub_out();
        }
    }

    /// Maximum wait until the session needs the next tick.
    fn patience(&self) -> Duration {
        let left = self.session.wake_at_ms().map(|at| at.saturating_sub(since_1970_ms()));
        left.map_or(Duration::MAX, |ms| Duration::from_millis(ms.max(PAUSES_MS[0])))
    }

    /// Handles a frame, if one has arrived.
    fn read(
        &mut self,
        socket: &mut Socket,
        todo: &mut Todo,
        is_heard: &mut bool,
    ) -> Result<(), Broken> {
        let Some(frame) = socket.next()? else { return Ok(()) };
        *is_heard = true;
        self.session.heard(frame, since_1970_ms(), todo);
        Ok(())
    }

    /// Receives the queued messages for the run.
    fn listen(&mut self, todo: &mut Todo) {
        loop {
            match self.said.try_recv() {
                Ok(message) => self.session.said(message, since_1970_ms(), todo),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    self.is_over = true;
                    return;
                }
            }
        }
    }

    fn tell(&self, todo: &mut Todo) -> Flow {
        for (id, path) in todo.inspect.drain(..) {
            self.inspect(id, path);
        }
        todo.causes.drain(..).try_for_each(|cause| self.queue.send(cause))
    }

    /// Requests the data of a state on a separate thread.
    fn inspect(&self, id: String, path: String) {
        let (server, run, queue) = (Arc::clone(&self.server), self.run.clone(), self.queue.clone());
        let ask = move || match server.state(&run, &path) {
            Ok(data) => queue.send(Cause::Messages(vec![ToViewer::Inspection { id, path, data }])),
            Err(fault) => queue.send(Cause::Nonsense(in_words(&fault))),
        };
        let asked = thread::Builder::new().name("inspect".to_owned()).spawn(ask);
        if let Err(error) = asked {
            complain(&format!("cannot start a thread: {error}"));
        }
    }

    /// Drains the pipe that wakes the thread.
    fn rub_out(&mut self) {
        let mut rest = [0; 64];
        while self.woken.read(&mut rest).is_ok_and(|read| read == rest.len()) {}
    }
}

fn speak(socket: &mut Socket, todo: &mut Todo) -> Result<(), Broken> {
    socket.flush()?;
    todo.frames.drain(..).try_for_each(|frame| socket.say(&frame))
}

fn in_words(fault: &Fault) -> String {
    let because = std::error::Error::source(fault).map(|cause| format!(": {cause}"));
    format!("{fault}{}", because.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::{Following, QUEUE};
    use crate::event_queue::Line as _;
    use rafcon_protocol::{Join, ToRunner};
    use std::os::unix::net::UnixStream;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn while_nothing_is_connected_messages_wait_up_to_the_bound_and_the_keyboard_never_does() {
        let (words, said) = sync_channel(QUEUE);
        let (wake, _woken) = UnixStream::pair().unwrap();
        let mut following = Following { words, wake };
        let mut say = || following.say(&ToRunner::Join(Join::default())).unwrap();
        assert!((0..QUEUE).all(|_| say()));
        assert!(!say());
        said.recv().unwrap();
        assert!(say());
    }
}
