//! The history of runs: their events, logs, moments, values, machines and figures, read from their journals.
//!
//! Knows journals. Does not know runners: an active run only has a growing journal and cannot be deleted.

mod events;
mod export;
mod fetch;
mod figures;
mod follow;
mod log;
mod machine;
mod moments;
mod readers;
mod refusal;
mod removal;
mod sending;
mod window;

pub(crate) use follow::HistoryReader;
pub(crate) use readers::Readers;
pub(crate) use window::before;

use crate::{Failure, ServerState};
use axum::body::Bytes;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use figures::Figures;
use machine::Machines;
use rafcon_storage::journal::Reader;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use window::Outlines;

/// State shared by all requests about history.
#[derive(Debug, Clone, Default)]
pub(crate) struct History {
    /// Open journals, shared by all readers.
    readers: Arc<Readers>,
    /// Cached machines of runs.
    machines: Arc<Machines>,
    /// Cached figures of runs.
    figures: Arc<Figures>,
    /// Cached outlines of runs.
    outlines: Arc<Outlines>,
    /// Slots of running exports.
    exports: export::Exports,
}

/// The routes of this part.
pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new()
        .merge(events::routes())
        .merge(log::routes())
        .merge(moments::routes())
        .merge(fetch::routes())
        .merge(machine::routes())
        .merge(figures::routes())
        .merge(window::routes())
        .merge(export::routes())
        .merge(removal::routes())
}

impl History {
    /// Open journals, for other parts of the server.
    pub(crate) fn readers(&self) -> &Arc<Readers> {
        &self.readers
    }

    /// Closes and drops everything about a run that was deleted, or is about to be.
    pub(crate) fn forget(&self, folder: &Path) {
        self.readers.forget(folder);
        self.machines.forget(folder);
        self.figures.forget(folder);
        self.outlines.forget(folder);
    }
}

/// JSON that is ready to send.
struct Json(Bytes);

impl Json {
    /// Serializes the response. Call it on a blocking thread.
    fn of(answer: &impl Serialize) -> Result<Self, Failure> {
        let failed = |error: serde_json::Error| {
            let message = format!("the journal's content cannot be converted to JSON: {error}");
            Failure::unprocessable("journal_damaged", message)
        };
        Ok(Self(serde_json::to_vec(answer).map_err(failed)?.into()))
    }
}

impl IntoResponse for Json {
    fn into_response(self) -> axum::response::Response {
        ([(CONTENT_TYPE, "application/json")], self.0).into_response()
    }
}

/// The folder of an existing run.
async fn folder(server: &ServerState, run: &str) -> Result<PathBuf, Failure> {
    Ok(server.runs.get(run).await?.folder().to_owned())
}

/// Reads a run's journal.
async fn read(
    server: &ServerState,
    run: &str,
    work: impl FnOnce(&mut Reader) -> Result<Json, Failure> + Send + 'static,
) -> Result<Json, Failure> {
    let folder = folder(server, run).await?;
    server.history.readers.read(folder, work).await
}

#[cfg(test)]
mod tests {
    use rafcon_storage::journal::{About, Journal, Options, Reader};
    use rafcon_testkit::journal_notation;
    use tempfile::TempDir;

    /// The bytes of each line of [`long_log`].
    pub(super) const LINE_BYTES: usize = 1 << 20;

    /// A run whose events are this number of lines of a MiB.
    pub(super) fn long_log(lines: usize) -> (TempDir, Reader) {
        let folder = tempfile::tempdir().unwrap();
        let options = Options { recorder_bytes: 1 << 22, ..Options::default() };
        let run = folder.path().join("r");
        let journal = Journal::create(&run, &About::default(), &options).unwrap();
        let mut before = 0;
        for _ in 0..lines {
            let text = "x".repeat(LINE_BYTES);
            let line = format!("place R \"Root\" outcome done\nlog R info \"{text}\"\n");
            let batch = journal_notation::batch(&line, before).unwrap();
            before = batch.t_last();
            journal.append(&batch).unwrap();
            journal.commit().unwrap();
        }
        journal.close().unwrap();
        let reader = Reader::open(&run).unwrap();
        (folder, reader)
    }
}
