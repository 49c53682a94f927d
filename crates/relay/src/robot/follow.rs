//! The connection to the runner of a run that continues.

use super::parcels::SentParcel;
use super::scanner::FoundRun;
use crate::inbox::Input;
use crate::meter::millis;
use crate::pairing::Pairing;
use rafcon_link::SessionTime;
use rafcon_protocol::api::RobotAnswer;
use rafcon_protocol::{
    Envelope, FrameKind, Hello, Join, Snapshot, ToRunner, ToViewer, decode, encode, read_frame,
};
use rafcon_supervisor::connect;
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::Duration;

/// Write timeout of a command to a runner.
const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// Output of a run's runner.
#[derive(Debug)]
pub(super) enum FromRun {
    /// There are more events in the journal of this run.
    Happened(String),
    /// This is its present state.
    Snapshot(String, Box<Snapshot>),
    /// This became of a request: its run, if it was for a runner, and its id.
    Answered(Option<String>, String, RobotAnswer),
    /// The connection to the runner of this run ended.
    Gone(String),
    /// These parcels are sent, and no others.
    Parcels(Vec<SentParcel>),
    /// The disk has these runs.
    Scanned(Vec<FoundRun>),
    /// A key for the station lies ready.
    NextKey(Box<Pairing>),
    /// The pairing was replaced by the offered one, or not, with the reason.
    KeyReplaced(Result<(), String>),
}

/// A runner that is followed until this is dropped.
#[derive(Debug)]
pub(super) struct Followed {
    out: UnixStream,
    /// Time of the last contact that the runner received, if any.
    heard: Option<SessionTime>,
    is_told: bool,
}

impl Followed {
    /// Joins the run in `folder`; what it sends from event `from` on arrives at `inbox`.
    pub(super) fn join(
        folder: &Path,
        run: &str,
        from: u64,
        inbox: &SyncSender<Input<FromRun>>,
    ) -> Option<Self> {
        let stream = connect(folder).ok()?;
        let mut out = stream.try_clone().ok()?;
        out.set_write_timeout(Some(WRITE_TIMEOUT)).ok()?;
        let mut words = encode(&Hello::ours()).ok()?;
        words.extend(encode(&ToRunner::Join(Join { from, every_event: true })).ok()?);
        out.write_all(&words).ok()?;
        let (run, inbox) = (run.to_owned(), inbox.clone());
        let follow = move || {
            // The run is scanned again after any end.
            drop(follow(BufReader::new(stream), &run, &inbox));
            inbox.send(Input::Other(FromRun::Gone(run))).unwrap_or_default();
        };
        thread::Builder::new().name("run".to_owned()).spawn(follow).ok()?;
        Some(Self { out, heard: None, is_told: false })
    }

    /// Sends the time of the last contact at `now` if it has changed.
    pub(super) fn tell_ground(&mut self, now: SessionTime, heard: Option<SessionTime>) {
        if self.is_told && self.heard == heard {
            return;
        }
        let heard_ms_ago = heard.map(|heard| millis(now.since(heard)));
        let line = encode(&ToRunner::Ground { heard_ms_ago });
        if line.is_ok_and(|line| self.out.write_all(&line).is_ok()) {
            (self.heard, self.is_told) = (heard, true);
        }
    }

    /// Sends a command. Returns false if the runner has ended.
    pub(super) fn command(&mut self, envelope: Envelope) -> bool {
        let line = encode(&ToRunner::Command(envelope));
        line.is_ok_and(|line| self.out.write_all(&line).is_ok())
    }
}

impl Drop for Followed {
    fn drop(&mut self) {
        // One that is shut already is as shut as it should be.
        drop(self.out.shutdown(Shutdown::Both));
    }
}

fn follow(
    mut frames: BufReader<UnixStream>,
    run: &str,
    inbox: &SyncSender<Input<FromRun>>,
) -> io::Result<()> {
    let mut hello = String::new();
    frames.read_line(&mut hello)?;
    let theirs = decode::<Hello>(&hello).map_err(io::Error::other)?;
    theirs.check().map_err(io::Error::other)?;
    let mut content = Vec::new();
    while let Some(kind) = read_frame(&mut frames, &mut content)? {
        let input = match kind {
            FrameKind::Events => Some(FromRun::Happened(run.to_owned())),
            FrameKind::Message => said(run, &content),
            FrameKind::Unknown => None,
        };
        if let Some(input) = input
            && inbox.send(Input::Other(input)).is_err()
        {
            break;
        }
    }
    Ok(())
}

fn said(run: &str, content: &[u8]) -> Option<FromRun> {
    match serde_json::from_slice(content).ok()? {
        ToViewer::Snapshot(snapshot) => Some(FromRun::Snapshot(run.to_owned(), Box::new(snapshot))),
        ToViewer::Answer { id, answer } => {
            Some(FromRun::Answered(Some(run.to_owned()), id, answer.into()))
        }
        ToViewer::Loaded { .. }
        | ToViewer::LoadFailed { .. }
        | ToViewer::Inspection { .. }
        | ToViewer::Event { .. }
        | ToViewer::Control(_)
        | ToViewer::Watched { .. }
        | ToViewer::Pong { .. } => None,
    }
}
