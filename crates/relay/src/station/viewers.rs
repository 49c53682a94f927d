//! Stand-in for the runner of a replica. Viewers connect to the socket in the run's folder, as with a runner.

mod shared;

use crate::words::StationRequest;
use rafcon_protocol::{
    Answer, Envelope, Expiry, FRAME_HEAD, FrameKind, Hello, Join, Snapshot, StateData, ToRunner,
    ToViewer, decode, encode, encode_frame, frame_head,
};
use rafcon_storage::journal::folder::{Doing, SOCKET_FILE, bind_socket};
use rafcon_storage::journal::stream::StreamBlock;
use rafcon_storage::journal::{EventSource, JournalError};
use rafcon_supervisor::clock;
pub(super) use shared::Shared;
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
                if here.is_closed() {
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
    let control = shared.control().map(ToViewer::Control);
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
    let safe = shared.safe();
    let mut next = if join.from == 0 { safe + 1 } else { join.from };
    let mut frame = vec![0; FRAME_HEAD];
    for (first, items) in source.places(next.saturating_sub(1)).map_err(io::Error::other)? {
        StreamBlock { first, t_before: 0, items: &items }.write(&mut frame);
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
            let Some(block) = read else {
                return Err(io::Error::other("the replica has lost events"));
            };
            next = block.last_sequence() + 1;
            let (first, t_before) = (block.first_sequence, block.time_before);
            StreamBlock { first, t_before, items: &block.bytes }.write(&mut frame);
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
