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
pub(crate) const GUESTS_MAX: usize = 64;

/// A viewer that was not admitted.
#[derive(Debug, thiserror::Error)]
enum AdmitError {
    /// The run has no more events to show.
    #[error("the run is over; its journal tells how it went")]
    RunOver,
    #[error("{GUESTS_MAX} viewers are connected; let one of them leave")]
    Full,
}

/// The viewers of a run, with their threads.
#[derive(Debug)]
pub(crate) struct ViewerSet<S: Scripts> {
    driver: Arc<Driver<S>>,
    desk: CommandDispatcher<S>,
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
    guests: Vec<Arc<ViewerConnection>>,
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
    told: Mutex<bool>,
}

impl<S: Scripts> ViewerSet<S> {
    /// A set without viewers, with the commands that earlier runners have answered.
    pub(crate) fn new(driver: Arc<Driver<S>>, loaded: ToViewer, answers: Answers) -> Self {
        let desk = CommandDispatcher::new(Arc::clone(&driver), answers);
        let (present, noting) = (Mutex::default(), Mutex::new(()));
        Self { driver, desk, loaded, present, noting, changed: Condvar::new() }
    }

    /// Notes a new connection; false if no more are accepted.
    pub(crate) fn arrive(&self, socket: &Socket) -> bool {
        let mut present = self.present.lock();
        let room = !present.closed && present.arriving.len() < GUESTS_MAX;
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
        let guest =
            ViewerConnection { sender, socket, answering: Mutex::new(()), told: Mutex::new(false) };
        let guest = Arc::new(guest);
        if let Err(refused) = self.admit(&guest) {
            guest.sender.send(&ToViewer::LoadFailed { reason: refused.to_string() });
            return Ok(());
        }
        let seated = self.seat(scope, &guest, receiver, join);
        if seated.is_err() {
            guest.socket.shut();
            self.leave(&guest);
        }
        seated
    }

    /// Starts the threads of a viewer.
    fn seat<'scope>(
        &'scope self,
        scope: &'scope Scope<'scope, '_>,
        guest: &Arc<ViewerConnection>,
        receiver: Receiver,
        join: Join,
    ) -> io::Result<()> {
        let named = |name: &str| thread::Builder::new().name(name.to_owned());
        let [heard, heeded, told] = [(); 3].map(|()| Arc::clone(guest));
        let (rest, words) = viewer::way();
        named("commands").spawn_scoped(scope, move || self.heed(&heeded, &words))?;
        let hear = move || {
            viewer::hear(receiver, &heard.sender, &rest, || self.driver.engine_pulse());
        };
        named("hearing").spawn_scoped(scope, hear)?;
        named("viewer").spawn_scoped(scope, move || self.tell(&told, &join))?;
        Ok(())
    }

    fn admit(&self, guest: &Arc<ViewerConnection>) -> Result<(), AdmitError> {
        let mut present = self.present.lock();
        if present.closed {
            return Err(AdmitError::RunOver);
        }
        if present.guests.len() >= GUESTS_MAX {
            return Err(AdmitError::Full);
        }
        present.guests.push(Arc::clone(guest));
        let first = present.guests.len() == 1;
        drop(present);
        if first {
            self.attended();
        }
        Ok(())
    }

    /// Handles commands until the viewer disconnects. The run continues without it.
    fn heed(&self, guest: &Arc<ViewerConnection>, words: &mpsc::Receiver<IncomingLine>) {
        self.desk.serve(words, &guest.sender, &guest.answering);
        guest.sender.lose();
        self.leave(guest);
    }

    /// Removes a disconnected viewer.
    fn leave(&self, guest: &Arc<ViewerConnection>) {
        let mut present = self.present.lock();
        present.guests.retain(|other| !Arc::ptr_eq(other, guest));
        let last = present.guests.is_empty() && !present.closed;
        self.changed.notify_all();
        drop(present);
        if last {
            self.attended();
        }
    }

    fn tell(&self, guest: &ViewerConnection, join: &Join) {
        guest.sender.send(&self.loaded);
        Viewer::new(&self.driver, &guest.sender, join).follow();
        let _list = self.present.lock();
        *guest.told.lock() = true;
        self.changed.notify_all();
    }

    /// Reports to the engine whether viewers are connected. Reports are serialized, so that the last one is correct.
    fn attended(&self) {
        let _turn = self.noting.lock();
        let anybody = !self.present.lock().guests.is_empty();
        // Refused when the run is over or has not begun, and then it does not matter.
        drop(self.driver.command(Input::Attended(anybody)));
    }

    /// Waits, with a timeout, until all viewers have received everything. Then runs the callback and closes all
    /// connections. So the callback has run before a viewer sees the end of its connection.
    pub(crate) fn part(&self, told: impl FnOnce()) {
        let deadline = Clock::moment(DRAIN_TIMEOUT);
        let mut present = self.present.lock();
        present.closed = true;
        while present.guests.iter().any(|guest| !*guest.told.lock()) {
            let in_time = deadline.is_some_and(|deadline| {
                !self.changed.wait_until(&mut present, deadline).timed_out()
            });
            if !in_time {
                break;
            }
        }
        let guests = present.guests.clone();
        present.arriving.iter().for_each(Socket::shut);
        drop(present);
        told();
        for guest in guests {
            // A command that ended the run is answered like any other.
            drop(deadline.and_then(|deadline| guest.answering.try_lock_until(deadline)));
            guest.socket.shut();
        }
    }
}
