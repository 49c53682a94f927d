//! The first words with a runner that is joined, and short talks: one question, one answer, on a connection of its own. So a
//! question that takes its time holds up no command.
//!
//! Knows how a run is joined. Does not know what the words lead to.

use rafcon_protocol::api::LoadedMachine;
use rafcon_protocol::{
    Answer, Envelope, FRAME_HEAD, FrameError, FrameKind, Hello, Join, StateData, ToRunner,
    ToViewer, VersionMismatch, decode, encode, read_frame_head,
};
use rafcon_storage::journal::Broken;
use rafcon_supervisor::{JoinError, connect};
use std::io;
use std::path::PathBuf;
use tokio::io::{AsyncBufReadExt as _, AsyncReadExt as _, AsyncWriteExt as _, BufReader};
use tokio::net::UnixStream;
use tokio::net::unix::{OwnedReadHalf, OwnedWriteHalf};

/// How much is read at once.
const BUFFER_BYTES: usize = 256 * 1024;

/// Why a runner is not spoken with.
#[derive(Debug, thiserror::Error)]
pub(super) enum LinkError {
    /// No one listens there.
    #[error(transparent)]
    Join(#[from] JoinError),
    /// The connection broke.
    #[error("the connection to the runner broke")]
    Io(#[from] io::Error),
    /// It says something else than this protocol.
    #[error("the runner's words make no sense")]
    Frame(#[from] FrameError),
    /// It sends events that are none.
    #[error("the runner's events make no sense")]
    Events(#[from] Broken),
    /// It is of another version.
    #[error(transparent)]
    Version(#[from] VersionMismatch),
    /// It lets no one in.
    #[error("the runner lets nobody in: {0}")]
    Refused(String),
    /// It went away before it had answered.
    #[error("the runner went away before it had answered")]
    Gone,
}

/// A run that was joined.
#[derive(Debug)]
pub(super) struct RunnerConnection {
    /// What the runner goes by, if it said so.
    pub(super) loaded: Option<LoadedMachine>,
    pub(super) frames: BufReader<OwnedReadHalf>,
    pub(super) out: OwnedWriteHalf,
}

/// Joins the run in `folder`.
pub(super) async fn open(folder: PathBuf, join: Join) -> Result<RunnerConnection, LinkError> {
    let connected = move || connect(&folder);
    let stream = tokio::task::spawn_blocking(connected).await.map_err(io::Error::other)??;
    stream.set_nonblocking(true)?;
    let (frames, mut out) = UnixStream::from_std(stream)?.into_split();
    let mut frames = BufReader::with_capacity(BUFFER_BYTES, frames);
    let mut words = encode(&Hello::ours())?;
    words.extend(encode(&ToRunner::Join(join))?);
    out.write_all(&words).await?;
    hello(&mut frames).await?.check()?;
    match message(&mut frames).await? {
        ToViewer::LoadFailed { reason } => Err(LinkError::Refused(reason)),
        ToViewer::Loaded { states, problems, .. } => {
            let loaded = Some(LoadedMachine { states, problems });
            Ok(RunnerConnection { loaded, frames, out })
        }
        _other => Ok(RunnerConnection { loaded: None, frames, out }),
    }
}

/// What an active state of the run in `folder` holds; nothing if it is not active.
pub(super) async fn inspect(folder: PathBuf, path: &str) -> Result<Option<StateData>, LinkError> {
    let question = ToRunner::Inspect { id: "1".to_owned(), path: path.to_owned() };
    ask(folder, &question, |message| match message {
        ToViewer::Inspection { data, .. } => Some(data),
        _ => None,
    })
    .await
}

/// Gives a command on a connection of its own.
pub(super) async fn command(folder: PathBuf, envelope: Envelope) -> Result<Answer, LinkError> {
    let wanted = envelope.id.clone();
    ask(folder, &ToRunner::Command(envelope), |message| match message {
        ToViewer::Answer { id, answer } if id == wanted => Some(answer),
        _ => None,
    })
    .await
}

async fn ask<T>(
    folder: PathBuf,
    question: &ToRunner,
    answer: impl Fn(ToViewer) -> Option<T>,
) -> Result<T, LinkError> {
    let RunnerConnection { mut frames, mut out, .. } = open(folder, Join::default()).await?;
    out.write_all(&encode(question)?).await?;
    loop {
        if let Some(answer) = answer(message(&mut frames).await?) {
            return Ok(answer);
        }
    }
}

async fn hello(lines: &mut BufReader<OwnedReadHalf>) -> Result<Hello, LinkError> {
    let mut line = Vec::new();
    if lines.read_until(b'\n', &mut line).await? == 0 {
        return Err(LinkError::Gone);
    }
    Ok(decode(&String::from_utf8_lossy(&line))?)
}

/// The next message; events in between are for others.
async fn message(frames: &mut BufReader<OwnedReadHalf>) -> Result<ToViewer, LinkError> {
    let mut content = Vec::new();
    while let Some(kind) = frame(frames, &mut content).await? {
        if kind == FrameKind::Message {
            return Ok(decode(&String::from_utf8_lossy(&content))?);
        }
    }
    Err(LinkError::Gone)
}

/// Reads the next frame into `content`; nothing at the end.
pub(super) async fn frame(
    frames: &mut BufReader<OwnedReadHalf>,
    content: &mut Vec<u8>,
) -> io::Result<Option<FrameKind>> {
    let mut head = [0; FRAME_HEAD];
    match frames.read_exact(&mut head).await {
        Ok(_) => {}
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
        Err(error) => return Err(error),
    }
    let (kind, length) = read_frame_head(head)?;
    content.clear();
    let count = frames.take(length as u64).read_to_end(content).await?;
    Ok((count == length).then_some(kind))
}
