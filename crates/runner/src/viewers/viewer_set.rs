//! The viewers connected to a run. Each receives events and may send commands. No viewer delays another or the run.
//! This module knows who is connected, but not the messages.

use crate::drive::driver::Driver;
use crate::viewers::commands::{Answers, CommandDispatcher};
use crate::viewers::connection::{IncomingLine, Line, Receiver, Sender, Socket};
use crate::viewers::viewer;
use crate::viewers::viewer::Viewer;
use crate::{Clock, Scripts};
use rafcon_engine::Input;
use rafcon_locks::{Condvar, Mutex};
use rafcon_protocol::{Join, ToViewer};
use std::io;
use std::sync::{Arc, mpsc};
use std::thread::{self, Scope};
use std::time::Duration;

/// Timeout for viewers that do not read, after the run is over. Then the process ends.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(10);
/// Limit of the connected viewers.
pub(crate) const VIEWERS_MAX: usize = 64;

/// A viewer that was not admitted.
#[derive(Debug, thiserror::Error)]
enum AdmitError {
    /// The run has no more events to show.
    #[error("the run has ended; see its journal")]
    RunOver,
    #[error("{VIEWERS_MAX} viewers are connected; let one of them leave")]
    Full,
}

/// The viewers of a run, with their threads.
#[derive(Debug)]
pub(crate) struct ViewerSet<S: Scripts> {
    driver: Arc<Driver<S>>,
    dispatcher: CommandDispatcher<S>,
    /// The first message to each viewer.
    loaded: ToViewer,
    present: Mutex<Present>,
    /// Locked while the engine receives a report about connected viewers.
    noting: Mutex<()>,
    /// Signals that a viewer has received everything, or has disconnected.
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Present {
    connections: Vec<Arc<ViewerConnection>>,
    /// Connections without a hello.
    arriving: Vec<Socket>,
    /// True if the run is over, so that no viewer is admitted.
    closed: bool,
}

/// The connection of one viewer.
#[derive(Debug)]
struct ViewerConnection {
    sender: Sender,
    socket: Socket,
    /// Locked from a command to its answer.
    answering: Mutex<()>,
    /// True once everything was sent. Written with the list locked.
    is_drained: Mutex<bool>,
}

impl<S: Scripts> ViewerSet<S> {
    /// A set without viewers, with the commands that earlier runners have answered.
    pub(crate) fn new(driver: Arc<Driver<S>>, loaded: ToViewer, answers: Answers) -> Self {
        let dispatcher = CommandDispatcher::new(Arc::clone(&driver), answers);
        let (present, noting) = (Mutex::default(), Mutex::new(()));
        Self { driver, dispatcher, loaded, present, noting, changed: Condvar::new() }
    }

    /// Notes a new connection; false if no more are accepted.
    pub(crate) fn arrive(&self, socket: &Socket) -> bool {
        let mut present = self.present.lock();
        let room = !present.closed && present.arriving.len() < VIEWERS_MAX;
        if room {
            present.arriving.push(socket.clone());
        }
        room
    }

    /// Notes that a connection became a viewer, or ended.
    pub(crate) fn arrived(&self, socket: &Socket) {
        self.present.lock().arriving.retain(|other| !other.is(socket));
    }

    /// Admits a viewer, whose threads send it the events that it requests.
    pub(crate) fn welcome<'scope>(
        &'scope self,
        scope: &'scope Scope<'scope, '_>,
        line: Line,
        join: Join,
    ) -> io::Result<()> {
        let Line { sender, receiver, socket } = line;
        let connection = ViewerConnection {
            sender,
            socket,
            answering: Mutex::new(()),
            is_drained: Mutex::new(false),
        };
        let connection = Arc::new(connection);
        if let Err(refused) = self.admit(&connection) {
            connection.sender.send(&ToViewer::LoadFailed { reason: refused.to_string() });
            return Ok(());
        }
        let seated = self.seat(scope, &connection, receiver, join);
        if seated.is_err() {
            connection.socket.shut();
            self.leave(&connection);
        }
        seated
    }

    /// Starts the threads of a viewer.
    fn seat<'scope>(
        &'scope self,
        scope: &'scope Scope<'scope, '_>,
        connection: &Arc<ViewerConnection>,
        receiver: Receiver,
        join: Join,
    ) -> io::Result<()> {
        let named = |name: &str| thread::Builder::new().name(name.to_owned());
        let [receiving, handling, sending] = [(); 3].map(|()| Arc::clone(connection));
        let (rest, words) = viewer::way();
        named("commands").spawn_scoped(scope, move || self.handle_commands(&handling, &words))?;
        let hear = move || {
            viewer::hear(receiver, &receiving.sender, &rest, || self.driver.engine_pulse());
        };
        named("hearing").spawn_scoped(scope, hear)?;
        named("viewer").spawn_scoped(scope, move || self.send_events(&sending, &join))?;
        Ok(())
    }

    fn admit(&self, connection: &Arc<ViewerConnection>) -> Result<(), AdmitError> {
        let mut present = self.present.lock();
        if present.closed {
            return Err(AdmitError::RunOver);
        }
        if present.connections.len() >= VIEWERS_MAX {
            return Err(AdmitError::Full);
        }
        present.connections.push(Arc::clone(connection));
        let first = present.connections.len() == 1;
        drop(present);
        if first {
            self.attended();
        }
        Ok(())
    }

    /// Handles commands until the viewer disconnects. The run continues without it.
    fn handle_commands(
        &self,
        connection: &Arc<ViewerConnection>,
        words: &mpsc::Receiver<IncomingLine>,
    ) {
        self.dispatcher.serve(words, &connection.sender, &connection.answering);
        connection.sender.lose();
        self.leave(connection);
    }

    /// Removes a disconnected viewer.
    fn leave(&self, connection: &Arc<ViewerConnection>) {
        let mut present = self.present.lock();
        present.connections.retain(|other| !Arc::ptr_eq(other, connection));
        let last = present.connections.is_empty() && !present.closed;
        self.changed.notify_all();
        drop(present);
        if last {
            self.attended();
        }
    }

    fn send_events(&self, connection: &ViewerConnection, join: &Join) {
        connection.sender.send(&self.loaded);
        Viewer::new(&self.driver, &connection.sender, join).follow();
        let _list = self.present.lock();
        *connection.is_drained.lock() = true;
        self.changed.notify_all();
    }

    /// Reports to the engine whether viewers are connected. Reports are serialized, so that the last one is correct.
    fn attended(&self) {
        let _turn = self.noting.lock();
        let anybody = !self.present.lock().connections.is_empty();
        // Refused when the run is over or has not begun, and then it does not matter.
        drop(self.driver.command(Input::Attended(anybody)));
    }

    /// Waits, with a timeout, until all viewers have received everything. Then runs the callback and closes all
    /// connections. So the callback has run before a viewer sees the end of its connection.
    pub(crate) fn part(&self, before_closing: impl FnOnce()) {
        let deadline = Clock::moment(DRAIN_TIMEOUT);
        let mut present = self.present.lock();
        present.closed = true;
        while present.connections.iter().any(|connection| !*connection.is_drained.lock()) {
            let in_time = deadline.is_some_and(|deadline| {
                !self.changed.wait_until(&mut present, deadline).timed_out()
            });
            if !in_time {
                break;
            }
        }
        let connections = present.connections.clone();
        present.arriving.iter().for_each(Socket::shut);
        drop(present);
        before_closing();
        for connection in connections {
            // A command that ended the run is answered like any other.
            drop(deadline.and_then(|deadline| connection.answering.try_lock_until(deadline)));
            connection.socket.shut();
        }
    }
}
