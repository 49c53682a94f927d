//! `GET …/export`: a run as a file for other programs. Never holds the whole run in memory.
//!
//! Knows formats and file names. Storage writes the formats.

use super::events::kinds;
use super::sending::{Sending, sending};
use super::{Readers, folder};
use crate::extract::{Path, Query};
use crate::failure::reason;
use crate::{Failure, ServerState};
use axum::body::Body;
use axum::extract::State;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse as _, Response};
use rafcon_protocol::api::{ExportFormat, ExportQuery, Refusal};
use rafcon_storage::journal::{ExportError, Filter, Reader, export_csv, export_jsonl, export_mcap};
use std::fs::File;
use std::io::{self, BufWriter, Read as _, Seek as _, Write as _};
use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum number of parallel exports.
const AT_ONCE: usize = 4;
/// Size of a sent part, in bytes.
const PART_BYTES: usize = 64 << 10;

/// Slots of running exports.
#[derive(Debug, Clone)]
pub(super) struct Exports(Arc<Semaphore>);

impl Default for Exports {
    fn default() -> Self {
        Self(Arc::new(Semaphore::new(AT_ONCE)))
    }
}

impl Exports {
    fn turn(&self) -> Result<OwnedSemaphorePermit, Failure> {
        let turn = Arc::clone(&self.0).try_acquire_owned();
        turn.map_err(|_all_taken| {
            let message =
                format!("{AT_ONCE} runs are being exported already: try again when one is done");
            Failure::too_many("too_many_exports", message)
        })
    }
}

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(export))
}

/// Exports a run in a format of other programs.
#[utoipa::path(get, path = "/api/v1/runs/{run}/export", tag = "history",
    params(("run" = String, Path, description = "The run's id"), ExportQuery),
    responses(
        (status = 200, description = "The file; it ends early, without the last part of the transfer, if the journal cannot be read to its end or is damaged",
            content((String = "application/jsonl"), (String = "text/csv"), (String = "application/octet-stream"))),
        (status = 400, description = "There is no such format", body = Refusal),
        (status = 404, description = "There is no such run, or it has not begun", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 429, description = "Too many runs are being exported", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn export(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<ExportQuery>,
) -> Result<Response, Failure> {
    let filter = filter(&query)?;
    let turn = server.history.exports.turn()?;
    let folder = folder(&server, &run).await?;
    let writing = Writing {
        readers: Arc::clone(&server.history.readers),
        folder,
        format: query.format,
        filter,
        scratch: server.settings.state.clone(),
        tell: server.settings.tell,
    };
    let (sending, written) = sending();
    tokio::task::spawn_blocking(move || {
        let _turn = turn;
        writing.write(sending);
    });
    Ok(file(&run, query.format, written.body().await?))
}

fn filter(query: &ExportQuery) -> Result<Filter, Failure> {
    Ok(Filter {
        state: query.state.clone(),
        outcome: query.outcome.clone(),
        text: query.text.clone(),
        kinds: kinds(query.kinds.as_deref().unwrap_or_default())?,
        level: query.level,
        from_ns: query.since_ns,
        to_ns: query.until_ns,
    })
}

fn file(run: &str, format: ExportFormat, body: Body) -> Response {
    let (ending, kind) = match format {
        ExportFormat::Jsonl => ("jsonl", "application/jsonl"),
        ExportFormat::Csv => ("csv", "text/csv; charset=utf-8"),
        ExportFormat::Mcap => ("mcap", "application/octet-stream"),
    };
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let name: String = run.chars().map(|c| if plain(c) { c } else { '_' }).collect();
    let disposition = format!("attachment; filename=\"{name}.{ending}\"");
    ([(CONTENT_TYPE, kind), (CONTENT_DISPOSITION, &disposition)], body).into_response()
}

/// An export in progress.
struct Writing {
    readers: Arc<Readers>,
    folder: PathBuf,
    format: ExportFormat,
    filter: Filter,
    /// Folder for an unfinished recording.
    scratch: PathBuf,
    tell: fn(&str),
}

impl Writing {
    fn write(&self, mut sending: Sending) {
        let written = self.readers.with(&self.folder, |reader| {
            Ok(match self.format {
                ExportFormat::Jsonl => export_jsonl(reader, &self.filter, &mut sending),
                ExportFormat::Csv => export_csv(reader, &self.filter, &mut sending),
                ExportFormat::Mcap => recording(reader, &mut sending, &self.scratch),
            }
            // Damage is noted in the file at its position. A client that only counts bytes must notice it as well.
            .and_then(|()| Ok(reader.check()?)))
        });
        let failure = match written {
            Ok(Ok(())) => return,
            Ok(Err(error)) if is_gone(&error) => return,
            Ok(Err(error)) => failure(error),
            Err(failure) => failure,
        };
        (self.tell)(&format!("an export of {} ended early: {failure}", self.folder.display()));
        sending.fail(failure);
    }
}

fn failure(error: ExportError) -> Failure {
    match error {
        ExportError::Journal(error) => error.into(),
        error => Failure::unavailable("not_exported", reason(&error)),
    }
}

/// True if the client no longer reads the export.
fn is_gone(error: &ExportError) -> bool {
    let ExportError::Write(error) = error else { return false };
    matches!(error.kind(), io::ErrorKind::BrokenPipe | io::ErrorKind::TimedOut)
}

/// A recording has its index at the end and its length at the beginning, so it is first written to an unnamed file.
fn recording(
    reader: &mut Reader,
    sending: &mut Sending,
    scratch: &FilePath,
) -> Result<(), ExportError> {
    let mut file = tempfile::tempfile_in(scratch)?;
    export_mcap(reader, BufWriter::with_capacity(PART_BYTES, &mut file))?;
    Ok(send(&mut file, sending)?)
}

fn send(file: &mut File, sending: &mut Sending) -> io::Result<()> {
    file.rewind()?;
    let mut part = vec![0; PART_BYTES];
    loop {
        let length = file.read(&mut part)?;
        if length == 0 {
            return Ok(());
        }
        sending.write_all(&part[..length])?;
    }
}
