//! Stand-in for the runner of a replica. Viewers connect to the socket in the run's folder, as with a runner.

use super::watching::ReplicaWatch;
use crate::words::StationRequest;
use parking_lot::{Condvar, Mutex};
use rafcon_protocol::api::Control;
use rafcon_protocol::{
    Answer, Envelope, Expiry, FRAME_HEAD, FrameKind, Hello, Join, LinkHealth, Snapshot, StateData,
    ToRunner, ToViewer, WatchTarget, WatchedValue, Watching, decode, encode, encode_frame,
    frame_head,
};
use rafcon_storage::journal::folder::{Doing, SOCKET_FILE, bind_socket};
use rafcon_storage::journal::stream::EventBlock;
use rafcon_storage::journal::{About, EventItems, EventSource, JournalError};
use rafcon_supervisor::clock;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Approximate size of a bundle of events in bytes.
const BLOCK_BYTES: usize = 64 << 10;
/// Write timeout of a viewer.
const WRITE_TIMEOUT: Duration = Duration::from_secs(30);
/// Capacity of the frames besides events that wait for a viewer.
const FRAMES_MAX: usize = 256;
/// Longest line of a viewer in bytes.
const LINE_MAX: u64 = 1 << 20;

/// Command of a viewer for the robot, with its id and its expiry by this computer's clock.
#[derive(Debug, Clone)]
pub(crate) struct PendingRequest {
    pub(super) id: String,
    /// None: it is valid as long as is usual over this link.
    pub(super) expiry: Option<Expiry>,
    /// It has no expiry, because it only brings the run to its end.
    pub(super) is_lasting: bool,
    /// Earliest time of effect by this computer's clock.
    pub(super) not_before: Option<u64>,
    /// Epoch of authority of the decision, if its author sent one.
    pub(super) epoch: Option<u64>,
    pub(super) word: StationRequest,
}

impl PendingRequest {
    fn command(envelope: Envelope) -> Self {
        let Envelope { expiry, not_before, epoch, .. } = envelope;
        let is_lasting = expiry.is_none() && envelope.command.lifetime_ms().is_none();
        let (id, word) = (envelope.id.clone(), StationRequest::of(envelope));
        Self { id, expiry, is_lasting, not_before, epoch, word }
    }

    /// A request of the station's server.
    pub(super) fn soon(id: String, word: StationRequest) -> Self {
        Self { id, expiry: None, is_lasting: false, not_before: None, epoch: None, word }
    }

    /// True if it waits for the next contact. A note of presence is repeated instead.
    pub(super) fn is_for_contact(&self) -> bool {
        !matches!(self.word, StationRequest::Present(_))
    }
}

/// Forwards commands of viewers to the robot. Returns false if the queue is full.
type Give = dyn Fn(PendingRequest) -> bool + Send + Sync;

/// Content for viewers.
#[derive(Debug)]
pub(super) struct Shared {
    folder: PathBuf,
    loaded: ToViewer,
    shown: Mutex<Shown>,
    changed: Condvar,
}

#[derive(Debug)]
struct Outgoing {
    stream: UnixStream,
    frames: Vec<Vec<u8>>,
}

#[derive(Debug, Default)]
struct Shown {
    safe: u64,
    snapshot: Option<Snapshot>,
    /// Number of earlier snapshots.
    snapshots: u64,
    link: LinkHealth,
    control: Option<Control>,
    is_closed: bool,
    /// Lists of watched values, and the newest values.
    watched: ReplicaWatch,
    /// Other frames for each viewer, by the number of the viewer.
    viewers: BTreeMap<u64, Outgoing>,
    next_viewer: u64,
}

impl Shared {
    pub(super) fn new(folder: PathBuf, about: &About, safe: u64, link: LinkHealth) -> Self {
        let loaded = ToViewer::Loaded {
            name: about.name.clone(),
            states: about.states,
            problems: Vec::new(),
            run: about.id.clone(),
        };
        let shown = Mutex::new(Shown { safe, link, ..Shown::default() });
        Self { folder, loaded, shown, changed: Condvar::new() }
    }

    pub(super) fn set_safe(&self, safe: u64) {
        self.shown.lock().safe = safe;
        self.changed.notify_all();
    }

    pub(super) fn reported(&self, snapshot: Snapshot) {
        let mut shown = self.shown.lock();
        shown.snapshot = Some(snapshot);
        shown.snapshots += 1;
        drop(shown);
        self.changed.notify_all();
    }

    /// Sets the state of the link. Viewers receive it at once if contact, open commands or the planned contact change.
    pub(super) fn set_link(&self, link: LinkHealth) {
        let mut shown = self.shown.lock();
        let before = std::mem::replace(&mut shown.link, link);
        let is_news = before.is_heard != shown.link.is_heard
            || before.commands != shown.link.commands
            || before.contact != shown.link.contact
            || before.contacts_problem != shown.link.contacts_problem;
        drop(shown);
        if is_news {
            self.send_all(&self.pong(0));
        }
    }

    /// Control of the run is like this.
    pub(super) fn set_control(&self, control: Control) {
        let before = self.shown.lock().control.replace(control.clone());
        if before.as_ref() != Some(&control) {
            self.send_all(&ToViewer::Control(control));
        }
    }

    /// Stores the newest watched values from the robot.
    pub(super) fn watched(&self, values: Vec<WatchedValue>) {
        let messages = self.shown.lock().watched.take(values);
        self.send_each(messages);
    }

    /// True if the robot has the list of watched values.
    pub(super) fn set_watching(&self, watching: &Watching) {
        let messages = self.shown.lock().watched.set_watching(watching);
        self.send_each(messages);
    }

    fn send_each(&self, messages: Vec<(u64, ToViewer)>) {
        for (viewer, message) in messages {
            if let Ok(frame) = encode_frame(&message) {
                self.send(viewer, frame);
            }
        }
    }

    /// A viewer watches this now, or nothing any more.
    pub(super) fn watch(&self, viewer: u64, targets: Vec<WatchTarget>) {
        let messages = self.shown.lock().watched.watch(viewer, targets);
        self.send_each(messages);
    }

    /// List of watched values for the robot, if it has changed.
    pub(super) fn take_subscription(&self) -> Option<Vec<WatchTarget>> {
        self.shown.lock().watched.take_subscription()
    }

    /// The robot is asked for nothing of the run for now: it watches as many runs as it can.
    pub(super) fn leave_out(&self) {
        let messages = self.shown.lock().watched.leave_out();
        self.send_each(messages);
    }

    fn pong(&self, id: u64) -> ToViewer {
        let link = Some(Box::new(self.shown.lock().link.clone()));
        ToViewer::Pong { id, now_ms: clock::since_1970_ms(), engine: None, link }
    }

    /// Sends an answer to all viewers: each knows what it has asked.
    pub(super) fn answer(&self, envelope: &str, answer: &Answer) {
        self.send_all(&ToViewer::Answer { id: envelope.to_owned(), answer: answer.clone() });
    }

    fn send_all(&self, message: &ToViewer) {
        let Ok(frame) = encode_frame(message) else { return };
        let viewers: Vec<u64> = self.shown.lock().viewers.keys().copied().collect();
        for viewer in viewers {
            self.send(viewer, frame.clone());
        }
    }

    /// Queues a frame for the thread of the viewer. A viewer with a full queue is disconnected.
    fn send(&self, viewer: u64, frame: Vec<u8>) {
        if let Some(outgoing) = self.shown.lock().viewers.get_mut(&viewer) {
            if outgoing.frames.len() >= FRAMES_MAX {
                drop(outgoing.stream.shutdown(Shutdown::Both));
            } else {
                outgoing.frames.push(frame);
            }
        }
        self.changed.notify_all();
    }

    fn arrive(&self, stream: UnixStream) -> u64 {
        let mut shown = self.shown.lock();
        let viewer = shown.next_viewer;
        shown.next_viewer += 1;
        shown.viewers.insert(viewer, Outgoing { stream, frames: Vec::new() });
        viewer
    }

    fn leave(&self, viewer: u64) {
        self.shown.lock().viewers.remove(&viewer);
        self.changed.notify_all();
    }

    /// Waits for content that a viewer lacks. `None` if it is disconnected.
    fn wait(&self, viewer: u64, next: u64, snapshots: u64) -> Option<News> {
        let mut shown = self.shown.lock();
        loop {
            let outgoing = shown.viewers.get_mut(&viewer)?;
            let frames = std::mem::take(&mut outgoing.frames);
            let is_news = !frames.is_empty() || shown.safe >= next || shown.snapshots > snapshots;
            if is_news || shown.is_closed {
                let Shown { safe, snapshots, is_closed, .. } = *shown;
                let snapshot = shown.snapshot.clone();
                return Some(News { frames, safe, snapshot, snapshots, is_closed });
            }
            self.changed.wait(&mut shown);
        }
    }

    fn close(&self) {
        let mut shown = self.shown.lock();
        shown.is_closed = true;
        drop(shown);
        self.changed.notify_all();
    }
}

/// Content that a viewer lacks.
struct News {
    frames: Vec<Vec<u8>>,
    safe: u64,
    snapshot: Option<Snapshot>,
    snapshots: u64,
    is_closed: bool,
}

/// The open door of a replica; closed when this is dropped.
pub(super) struct Viewers {
    shared: Arc<Shared>,
    path: PathBuf,
}

impl Viewers {
    /// Accepts viewers. `give` sends their commands and returns false if the queue is full.
    pub(super) fn open(
        folder: &Path,
        shared: Arc<Shared>,
        give: impl Fn(PendingRequest) -> bool + Send + Sync + 'static,
    ) -> Result<Self, JournalError> {
        let path = folder.join(SOCKET_FILE);
        let listener = bind_socket(folder).map_err(|source| JournalError::Io {
            path: path.clone(),
            doing: Doing::Write,
            source,
        })?;
        let (here, give) = (Arc::clone(&shared), Arc::new(give));
        let let_in = move || {
            for stream in listener.incoming() {
                if here.shown.lock().is_closed {
                    return;
                }
                let (Ok(stream), here, give) = (stream, Arc::clone(&here), Arc::clone(&give))
                else {
                    continue;
                };
                // A connection without a greeting ends.
                let talk = move || drop(welcome(&stream, &here, &*give));
                drop(thread::Builder::new().name("viewer".to_owned()).spawn(talk));
            }
        };
        let begun = thread::Builder::new().name("viewers".to_owned()).spawn(let_in);
        begun.map_err(|source| JournalError::Io {
            path: path.clone(),
            doing: Doing::Write,
            source,
        })?;
        Ok(Self { shared, path })
    }
}

impl Drop for Viewers {
    fn drop(&mut self) {
        self.shared.close();
        // Wakes the thread at the door, which then sees that it is closed.
        drop(UnixStream::connect(&self.path));
        drop(fs::remove_file(&self.path));
    }
}

fn welcome(stream: &UnixStream, shared: &Arc<Shared>, give: &Give) -> io::Result<()> {
    stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
    let mut out = stream.try_clone()?;
    let mut lines = BufReader::new(stream.try_clone()?);
    line::<Hello>(&mut lines)?.check().map_err(io::Error::other)?;
    out.write_all(&encode(&Hello::ours()).map_err(io::Error::other)?)?;
    let ToRunner::Join(join) = line(&mut lines)? else { return Ok(()) };
    send(&mut out, &shared.loaded)?;
    let viewer = shared.arrive(stream.try_clone()?);
    let control = shared.shown.lock().control.clone().map(ToViewer::Control);
    for message in [Some(shared.pong(0)), control].into_iter().flatten() {
        shared.send(viewer, encode_frame(&message).map_err(io::Error::other)?);
    }
    let here = Arc::clone(shared);
    let show = move || {
        // However it ends, so does the connection.
        drop(show(&mut out, viewer, &join, &here));
        drop(out.shutdown(Shutdown::Both));
    };
    thread::Builder::new().name("showing".to_owned()).spawn(show)?;
    let handled = handle(&mut lines, viewer, shared, give);
    shared.watch(viewer, Vec::new());
    shared.leave(viewer);
    handled
}

/// Reads the lines of a viewer until it disconnects.
fn handle(
    lines: &mut BufReader<UnixStream>,
    viewer: u64,
    shared: &Shared,
    give: &Give,
) -> io::Result<()> {
    loop {
        let message = match line(lines)? {
            ToRunner::Command(envelope) => offer(give, PendingRequest::command(envelope)),
            ToRunner::MoveControl { id, author, wanted } => {
                let word = StationRequest::MoveControl(id.clone(), author, wanted);
                offer(give, PendingRequest::soon(id, word))
            }
            ToRunner::Present { user } => {
                let id = format!("present-{user}-{}", clock::since_1970_ms());
                // A present user repeats the notice.
                let _lost = offer(give, PendingRequest::soon(id, StationRequest::Present(user)));
                None
            }
            ToRunner::Ping { id } => Some(shared.pong(id)),
            ToRunner::Watch { targets } => {
                shared.watch(viewer, targets);
                None
            }
            ToRunner::Inspect { id, path } => {
                let data = state_data(&shared.folder, &path);
                Some(ToViewer::Inspection { id, path, data })
            }
            ToRunner::Join(_) | ToRunner::Launch(_) | ToRunner::Ground { .. } => None,
        };
        if let Some(message) = message {
            shared.send(viewer, encode_frame(&message).map_err(io::Error::other)?);
        }
    }
}

/// Data of an active state after the last event here. `None` if it was inactive or is unreadable.
fn state_data(folder: &Path, path: &str) -> Option<StateData> {
    let mut source = EventSource::open(folder).ok()?;
    let moment = source.reader().moment(u64::MAX).ok()?;
    let moment = source.reader().picture(&moment).ok()?;
    let state = moment.active.into_iter().find(|state| state.path == path)?;
    let inputs = state.inputs.unwrap_or_default();
    // The defaults of its outputs are not in the journal.
    Some(StateData { inputs, scoped_variables: state.scoped, ..StateData::default() })
}

/// Gives a word for the robot; a refusal if there is no room for it.
fn offer(give: &Give, word: PendingRequest) -> Option<ToViewer> {
    let id = word.id.clone();
    let reason = "too many commands wait for the link: try again later".to_owned();
    (!give(word)).then_some(ToViewer::Answer { id, answer: Answer::Refused { reason } })
}

/// Sends a viewer everything from its cursor on, until it disconnects or the replica closes.
fn show(out: &mut UnixStream, viewer: u64, join: &Join, shared: &Shared) -> io::Result<()> {
    let mut source = EventSource::open(&shared.folder).map_err(io::Error::other)?;
    let safe = shared.shown.lock().safe;
    let mut next = if join.from == 0 { safe + 1 } else { join.from };
    let mut frame = vec![0; FRAME_HEAD];
    for (first, items) in source.places(next.saturating_sub(1)).map_err(io::Error::other)? {
        EventBlock { first, t_before: 0, items: &items }.write(&mut frame);
    }
    send_events(out, &mut frame)?;
    let mut snapshots = 0;
    loop {
        let Some(news) = shared.wait(viewer, next, snapshots) else { return Ok(()) };
        for frame in news.frames {
            out.write_all(&frame)?;
        }
        while next <= news.safe {
            let read = source.read(next, news.safe, BLOCK_BYTES).map_err(io::Error::other)?;
            let Some(EventItems { first, count, t_before, bytes }) = read else {
                return Err(io::Error::other("the replica has lost events"));
            };
            next = first + count;
            EventBlock { first, t_before, items: &bytes }.write(&mut frame);
            send_events(out, &mut frame)?;
        }
        if news.snapshots > snapshots
            && let Some(snapshot) = news.snapshot
        {
            let disk_safe = snapshot.disk_safe.min(news.safe);
            send(out, &ToViewer::Snapshot(Snapshot { disk_safe, ..snapshot }))?;
        }
        snapshots = news.snapshots;
        if news.is_closed {
            return Ok(());
        }
    }
}

/// Sends the frame, if there is anything in it.
fn send_events(out: &mut UnixStream, frame: &mut Vec<u8>) -> io::Result<()> {
    let length = frame.len() - FRAME_HEAD;
    if length > 0 {
        frame[..FRAME_HEAD].copy_from_slice(&frame_head(FrameKind::Events, length));
        out.write_all(frame)?;
        frame.truncate(FRAME_HEAD);
    }
    Ok(())
}

fn send(out: &mut UnixStream, message: &ToViewer) -> io::Result<()> {
    out.write_all(&encode_frame(message).map_err(io::Error::other)?)
}

fn line<T: serde::de::DeserializeOwned>(lines: &mut BufReader<UnixStream>) -> io::Result<T> {
    let mut line = String::new();
    let length = lines.by_ref().take(LINE_MAX).read_line(&mut line)?;
    if length == 0 {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    decode(&line).map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rafcon_protocol::Contact;

    #[test]
    fn a_viewer_that_does_not_take_its_frames_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let health = LinkHealth::default();
        let shared = Shared::new(folder.path().to_owned(), &About::default(), 0, health);
        let (ours, mut theirs) = UnixStream::pair().unwrap();
        let viewer = shared.arrive(ours);
        (0..FRAMES_MAX).for_each(|_| shared.send(viewer, vec![1]));
        theirs.set_nonblocking(true).unwrap();
        let open = theirs.read(&mut [0]).unwrap_err();
        assert_eq!(open.kind(), io::ErrorKind::WouldBlock);
        shared.send(viewer, vec![2]);
        assert_eq!(theirs.read(&mut [0]).unwrap(), 0);
        // The capacity holds, and other viewers are served.
        let news = shared.wait(viewer, 1, 0).unwrap();
        assert_eq!(news.frames.len(), FRAMES_MAX);
        let (ours, _theirs) = UnixStream::pair().unwrap();
        let other = shared.arrive(ours);
        shared.send(other, vec![3]);
        assert_eq!(shared.wait(other, 1, 0).unwrap().frames, [[3]]);
    }

    #[test]
    fn a_viewer_receives_a_change_of_the_planned_contact_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let health = LinkHealth::default();
        let shared = Shared::new(folder.path().to_owned(), &About::default(), 0, health.clone());
        let (ours, _theirs) = UnixStream::pair().unwrap();
        let viewer = shared.arrive(ours);
        let frames = || shared.shown.lock().viewers[&viewer].frames.len();
        let profile = "deep".to_owned();
        let contact = Some(Contact { begin_ms: 1, end_ms: 2, profile, note: None });
        shared.set_link(LinkHealth { up_bytes_per_s: 7, ..health.clone() });
        assert_eq!(frames(), 0);
        shared.set_link(LinkHealth { contact, ..health.clone() });
        assert_eq!(frames(), 1);
        let contacts_problem = Some("damaged".to_owned());
        shared.set_link(LinkHealth { contacts_problem, ..health });
        assert_eq!(frames(), 2);
    }

    #[test]
    fn a_line_of_a_viewer_has_at_most_so_many_bytes() {
        let said = |bytes: usize| {
            let (mut theirs, ours) = UnixStream::pair().unwrap();
            let text = format!("\"{}\"\n", "x".repeat(bytes - 3));
            let write = move || theirs.write_all(text.as_bytes());
            let writing = thread::Builder::new().spawn(write).unwrap();
            let heard = line::<String>(&mut BufReader::new(ours));
            drop(writing.join().unwrap());
            heard.map(|text| text.len()).map_err(|error| error.kind())
        };
        let most = usize::try_from(LINE_MAX).unwrap();
        assert_eq!(said(most), Ok(most - 3));
        assert_eq!(said(most + 2), Err(io::ErrorKind::Other));
    }
}
