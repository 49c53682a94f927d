//! Summary of a run, without reading its whole journal. Handles folders of runs.

use super::Reader;
use super::end::end_in;
use crate::journal::folder::{
    ABOUT_FILE, About, CRASHED_FILE, DATABASE_FILE, DIVERGED_FILE, GONE, JournalError, writer_of,
};
use rafcon_protocol::{Event, Outcome};
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

/// Summary of a run, for a list.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the run's folder.
    pub id: String,
    /// Path of the run's folder.
    #[serde(skip)]
    pub folder: PathBuf,
    /// Name of the root state.
    pub name: String,
    /// Start time: ms since 1970, UTC.
    pub started_ms: u64,
    /// Current state of the run.
    #[serde(flatten)]
    pub state: RunState,
    /// Length of the run, in ms.
    pub length_ms: u64,
    /// Number of events in the run.
    pub events: u64,
    /// Size of the folder on disk, in bytes.
    pub bytes: u64,
    /// Robot that executes the run, if this is a replica.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Arrival time of a replica's newest event: ms since 1970, UTC, by the clock of this computer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub received_ms: Option<u64>,
}

/// Current state of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum RunState {
    /// The run is active.
    Live {
        /// Id of the runner's process.
        process: u32,
    },
    /// The run ended regularly.
    Finished {
        /// Outcome of the root state.
        outcome: Outcome,
        /// Number of states executed.
        states_run: u64,
    },
    /// The runner died. The run can be resumed.
    Crashed,
    /// The run is a replica. It had not ended when its newest event arrived, and no station receives it now.
    NotReceived,
    /// The run is a replica, and its history differs from the robot's. It accepts no further events.
    Diverged {
        /// Cause and remedy, in words.
        reason: String,
    },
    /// The folder of the run cannot be read.
    Unreadable {
        /// Cause of the failed read, for people.
        reason: String,
    },
}

/// Returns all runs in a folder, the oldest first.
pub fn runs(folder: &Path) -> Result<Vec<Summary>, JournalError> {
    Ok(run_folders(folder)?.iter().map(|run| Summary::of(run)).collect())
}

/// Returns the folders of the runs in a folder, the oldest first, because ids begin with the time.
pub fn run_folders(folder: &Path) -> Result<Vec<PathBuf>, JournalError> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(JournalError::io(folder, crate::journal::Doing::Read, error)),
    };
    let paths = entries.flatten().map(|entry| entry.path());
    // A folder that is being deleted is no longer a run.
    let is_gone = |path: &PathBuf| path.to_string_lossy().ends_with(GONE);
    let is_run = |path: &PathBuf| !is_gone(path) && path.join(ABOUT_FILE).is_file();
    let mut found: Vec<PathBuf> = paths.filter(is_run).collect();
    found.sort();
    Ok(found)
}

impl Summary {
    /// Returns the summary of the run in this folder.
    pub fn of(folder: &Path) -> Self {
        let id = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut summary = Self {
            id,
            folder: folder.to_owned(),
            name: String::new(),
            started_ms: 0,
            state: RunState::Crashed,
            length_ms: 0,
            events: 0,
            bytes: size_of(folder),
            robot: None,
            received_ms: None,
        };
        if let Err(error) = summary.look() {
            summary.state = RunState::Unreadable { reason: error.to_string() };
        }
        summary
    }

    fn look(&mut self) -> Result<(), JournalError> {
        let about = About::read(&self.folder)?;
        (self.name, self.started_ms) = (about.name, about.started_ms);
        self.received_ms = about.robot.as_ref().and_then(|_| written_ms(&self.folder));
        self.robot = about.robot;
        let process = writer_of(&self.folder)?;
        if let Some(process) = process {
            self.state = RunState::Live { process };
            if !self.folder.join(DATABASE_FILE).exists() {
                return Ok(());
            }
        }
        // Only the robot knows that its runner has ended.
        if process.is_none() && self.robot.is_some() && !self.folder.join(CRASHED_FILE).exists() {
            self.state = RunState::NotReceived;
        }
        let reader = Reader::open(&self.folder)?;
        let end = reader.tail()?;
        self.events = reader.last_sequence()?;
        self.length_ms = end.last().map_or(0, |entry| entry.t_ns / 1_000_000);
        if let (None, Some((_, Event::Finished { outcome, states_run, .. }))) =
            (process, end_in(&end))
        {
            self.state = RunState::Finished { outcome: outcome.clone(), states_run: *states_run };
        }
        if process.is_none()
            && let Ok(reason) = fs::read_to_string(self.folder.join(DIVERGED_FILE))
        {
            self.state = RunState::Diverged { reason };
        }
        reader.check()
    }
}

/// Returns the last write time of a run's database, in ms since 1970, UTC.
fn written_ms(folder: &Path) -> Option<u64> {
    let written = |file: String| fs::metadata(folder.join(file)).and_then(|it| it.modified()).ok();
    let files = [DATABASE_FILE.to_owned(), format!("{DATABASE_FILE}-wal")];
    let newest = files.into_iter().filter_map(written).max()?;
    u64::try_from(newest.duration_since(UNIX_EPOCH).ok()?.as_millis()).ok()
}

/// Returns the size of a folder in bytes. Unreadable parts do not count.
pub fn size_of(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let size = |entry: fs::DirEntry| match entry.metadata() {
        Ok(metadata) if metadata.is_dir() => size_of(&entry.path()),
        Ok(metadata) => metadata.len(),
        Err(_) => 0,
    };
    entries.map(size).sum()
}
