//! `GET …/window`, `…/earlier`, `…/overview` and `…/hits`: parts of a long run. Each response is bounded, however long the run
//! is. An outline of the run is cached and updated with new events.
//!
//! Knows outlines. Does not know their display.

use super::events::{COUNT_MAX, cursor, no_such_event};
use super::{History, Json, folder, read};
use crate::extract::{Path, Query};
use crate::{Failure, ServerState};
use axum::extract::State;
use rafcon_locks::Mutex;
use rafcon_protocol::api::{
    ActiveSince, Before, EarlierHistory, EventPage, HistoryEntry, HitQuery, Overview,
    OverviewQuery, Refusal, Window, WindowQuery,
};
use rafcon_storage::journal::{Entry, Outline, Reader, Span, is_about_values};
use std::collections::VecDeque;
use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Capacity of the cache of outlines, in runs.
const OUTLINED: usize = 8;
/// Maximum number of events in a window.
const WINDOW_MAX: u32 = 20_000;
/// Maximum number of events examined for a page of hits.
const LOOK: u64 = 2_000_000;
/// Maximum width of an overview, in pixels.
const PIXELS_MAX: u32 = 10_000;

/// Cached outlines, least recently requested run first.
#[derive(Debug, Default)]
pub(super) struct Outlines(Mutex<VecDeque<(PathBuf, Arc<Mutex<Outline>>)>>);

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new()
        .routes(routes!(window))
        .routes(routes!(earlier))
        .routes(routes!(overview))
        .routes(routes!(hits))
}

/// A part of a run's events, and the states that were active before it.
#[utoipa::path(get, path = "/api/v1/runs/{run}/window", tag = "history",
    params(("run" = String, Path, description = "The run's id"), WindowQuery),
    responses(
        (status = 200, description = "The events, in order", body = Window),
        (status = 400, description = "The query makes no sense", body = Refusal),
        (status = 404, description = "There is no such run, or it has not begun, or the events were given up", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn window(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<WindowQuery>,
) -> Result<Json, Failure> {
    let count = bounded(query.count, WINDOW_MAX)?;
    read(&server, &run, move |reader| Json::of(&seen(reader, query.from.max(1), count)?)).await
}

/// Activity of each state up to an event, and the marks up to it; 0 is before the first.
#[utoipa::path(get, path = "/api/v1/runs/{run}/earlier/{sequence}", tag = "history",
    params(
        ("run" = String, Path, description = "The run's id"),
        ("sequence" = u64, Path, description = "The event"),
    ),
    responses(
        (status = 200, description = "Every state that was entered", body = EarlierHistory),
        (status = 400, description = "This is no number", body = Refusal),
        (status = 404, description = "There is no such run or event", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn earlier(
    State(server): State<Arc<ServerState>>,
    Path((run, sequence)): Path<(String, u64)>,
) -> Result<Json, Failure> {
    outlined(&server, &run, move |outline, reader| {
        if sequence > reader.last_sequence()? {
            return Err(no_such_event(sequence));
        }
        let earlier: EarlierHistory = outline.earlier(reader, sequence)?;
        Json::of(&earlier)
    })
    .await
}

/// The calls in a part of a run's time, at the resolution of a drawing.
///
/// The response is bounded by the width of the drawing: calls too narrow to distinguish are merged.
#[utoipa::path(get, path = "/api/v1/runs/{run}/overview", tag = "history",
    params(("run" = String, Path, description = "The run's id"), OverviewQuery),
    responses(
        (status = 200, description = "Calls by the rows that they are drawn in", body = Overview),
        (status = 400, description = "The query makes no sense", body = Refusal),
        (status = 404, description = "There is no such run, or it has not begun", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn overview(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<OverviewQuery>,
) -> Result<Json, Failure> {
    let pixels = bounded(query.pixels, PIXELS_MAX)?;
    outlined(&server, &run, move |outline, reader| {
        let to_ns = query.to_ns.unwrap_or_else(|| outline.t_ns());
        let span = Span { from_ns: query.from_ns.min(to_ns), to_ns, pixels };
        let overview: Overview = outline.overview(reader, span)?;
        Json::of(&overview)
    })
    .await
}

/// Finds a text in the names of entered states, in outcomes and in log lines.
///
/// A page may hold fewer hits than requested, even none, without being the last: continue from `next` until it exceeds `last`.
#[utoipa::path(get, path = "/api/v1/runs/{run}/hits", tag = "history",
    params(("run" = String, Path, description = "The run's id"), HitQuery),
    responses(
        (status = 200, description = "The events, in order", body = EventPage),
        (status = 400, description = "The query makes no sense", body = Refusal),
        (status = 404, description = "There is no such run, or it has not begun", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn hits(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<HitQuery>,
) -> Result<Json, Failure> {
    let count = bounded(query.count, COUNT_MAX)?;
    if query.text.trim().is_empty() {
        return Err(Failure::bad("no_text", "the search has no text: set `text`"));
    }
    let folder = folder(&server, &run).await?;
    let found = move |reader: &mut Reader| {
        let (found, looked) =
            reader.hits(&query.text, query.from, usize::try_from(count).unwrap_or(1), LOOK)?;
        let (next, last) = cursor(reader, looked)?;
        Json::of(&EventPage { events: told(reader, &found)?, next, last })
    };
    server.history.readers.read_slowly(folder, found).await
}

/// States that were active before event number `from`.
pub(crate) fn before(reader: &mut Reader, from: u64) -> Result<Before, Failure> {
    let moment = reader.moment(from.saturating_sub(1))?;
    let active = moment.active().into_iter().map(|state| ActiveSince {
        path: state.place.path.clone(),
        sequence: state.order,
        t_ns: state.since_ns,
    });
    Ok(Before { sequence: moment.sequence(), t_ns: moment.t_ns(), active: active.collect() })
}

fn seen(reader: &mut Reader, from: u64, count: u32) -> Result<Window, Failure> {
    let last = reader.last_sequence()?;
    if from > last.saturating_add(1) {
        return Err(no_such_event(from));
    }
    let before = before(reader, from)?;
    let next = from.saturating_add(u64::from(count));
    let mut entries = reader.page(from, usize::try_from(count).unwrap_or(1))?;
    let next = entries.last().map_or(next, |entry| next.min(entry.sequence + 1)).max(from);
    entries.retain(|entry| !is_about_values(&entry.record));
    Ok(Window { before, events: told(reader, &entries)?, next, last })
}

fn told(reader: &Reader, entries: &[Entry]) -> Result<Vec<HistoryEntry>, Failure> {
    let told = |entry: &Entry| {
        let event = reader.event(entry, false)?;
        Ok(HistoryEntry { sequence: entry.sequence, t_ns: entry.t_ns, event })
    };
    entries.iter().map(told).collect()
}

fn bounded(wanted: Option<u32>, most: u32) -> Result<u32, Failure> {
    let count = wanted.unwrap_or(most);
    if (1..=most).contains(&count) {
        return Ok(count);
    }
    Err(Failure::bad("bad_count", format!("that is 1 to {most}, and {most} if it is left out")))
}

/// Updates the outline of a run and derives a response from it.
async fn outlined(
    server: &ServerState,
    run: &str,
    work: impl FnOnce(&Outline, &mut Reader) -> Result<Json, Failure> + Send + 'static,
) -> Result<Json, Failure> {
    let folder = folder(server, run).await?;
    server.history.outlined(folder, work).await
}

impl History {
    /// Updates the outline of a run in the background, because the client that opens a long run requests it next.
    pub(crate) fn begin_outline(&self, folder: PathBuf) {
        let history = self.clone();
        tokio::spawn(async move {
            // Errors are reported to the client that requests the outline.
            drop(history.outlined(folder, |_, _| Ok(())).await);
        });
    }

    async fn outlined<T: Send + 'static>(
        &self,
        folder: PathBuf,
        work: impl FnOnce(&Outline, &mut Reader) -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        let outlines = Arc::clone(&self.outlines);
        let answer = move |reader: &mut Reader| {
            let outline = outlines.of(reader.folder());
            let mut outline = outline.lock();
            outline.go_on(reader)?;
            work(&outline, reader)
        };
        self.readers.read_slowly(folder, answer).await
    }
}

impl Outlines {
    /// Drops the outline of a run.
    pub(super) fn forget(&self, folder: &FilePath) {
        self.0.lock().retain(|(outlined, _)| outlined != folder);
    }

    fn of(&self, folder: &FilePath) -> Arc<Mutex<Outline>> {
        let mut outlines = self.0.lock();
        let known = outlines.iter().position(|(outlined, _)| outlined == folder);
        let known = known.and_then(|index| outlines.remove(index));
        let (folder, outline) = known.unwrap_or_else(|| (folder.to_owned(), Arc::default()));
        outlines.push_back((folder, Arc::clone(&outline)));
        if outlines.len() > OUTLINED {
            outlines.pop_front();
        }
        outline
    }
}

#[cfg(test)]
mod tests {
    use super::{COUNT_MAX, PIXELS_MAX, WINDOW_MAX, bounded};

    #[test]
    fn what_is_asked_for_at_once_is_bounded() {
        for most in [COUNT_MAX, PIXELS_MAX, WINDOW_MAX] {
            assert_eq!(bounded(Some(most), most).unwrap(), most);
            assert_eq!(bounded(None, most).unwrap(), most);
            assert_eq!(bounded(Some(most + 1), most).unwrap_err().code(), "bad_count");
            assert_eq!(bounded(Some(0), most).unwrap_err().code(), "bad_count");
        }
    }
}
