//! The handshake with a runner, and short exchanges: one question and one answer on a separate connection, so that a slow question
//! delays no command.
//!
//! Knows the handshake. Does not know the effect of messages.

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

/// Size of the read buffer, in bytes.
const BUFFER_BYTES: usize = 256 * 1024;

/// Reason why communication with a runner failed.
#[derive(Debug, thiserror::Error)]
pub(super) enum LinkError {
    /// No runner listens at the socket.
    #[error(transparent)]
    Join(#[from] JoinError),
    /// An I/O error of the connection.
    #[error("the connection to the runner broke")]
    Io(#[from] io::Error),
    /// Its message does not follow the protocol.
    #[error("the runner's words make no sense")]
    Frame(#[from] FrameError),
    /// Its events are malformed.
    #[error("the runner's events make no sense")]
    Events(#[from] Broken),
    /// Its version of the protocol differs.
    #[error(transparent)]
    Version(#[from] VersionMismatch),
    /// It refuses the connection.
    #[error("the runner lets nobody in: {0}")]
    Refused(String),
    /// It closed the connection before its reply.
    #[error("the runner went away before it had answered")]
    Gone,
}

/// A connection to a runner after the handshake.
#[derive(Debug)]
pub(super) struct RunnerConnection {
    /// Facts about the loaded machine, if the runner sent them.
    pub(super) loaded: Option<LoadedMachine>,
    pub(super) frames: BufReader<OwnedReadHalf>,
    pub(super) out: OwnedWriteHalf,
}

/// Connects to the runner of the run in `folder`.
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

/// Data of an active state of the run in `folder`. `None` if the state is not active.
pub(super) async fn inspect(folder: PathBuf, path: &str) -> Result<Option<StateData>, LinkError> {
    let question = ToRunner::Inspect { id: "1".to_owned(), path: path.to_owned() };
    ask(folder, &question, |message| match message {
        ToViewer::Inspection { data, .. } => Some(data),
        _ => None,
    })
    .await
}

/// Sends a command on a separate connection.
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

/// The next message. Skips events.
async fn message(frames: &mut BufReader<OwnedReadHalf>) -> Result<ToViewer, LinkError> {
    let mut content = Vec::new();
    while let Some(kind) = frame(frames, &mut content).await? {
        if kind == FrameKind::Message {
            return Ok(decode(&String::from_utf8_lossy(&content))?);
        }
    }
    Err(LinkError::Gone)
}

/// Reads the next frame into `content`. `None` at the end of the stream.
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
