//! `GET …/statistics` and `GET …/compare`: figures over a whole run. They are cached and updated with new events.
//!
//! Knows figures. Does not know their display.

use super::{History, Json, folder};
use crate::extract::{Path, Query};
use crate::{Failure, ServerState};
use axum::extract::State;
use rafcon_locks::Mutex;
use rafcon_protocol::api::{Comparison, Refusal, Statistics, StatisticsQuery};
use rafcon_storage::journal::{Reader, Tally, compare};
use std::collections::VecDeque;
use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;
use tokio::sync::Semaphore;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Capacity of the cache of figures, in runs.
const COUNTED: usize = 32;
/// Limit on the events of a compared run: a comparison takes memory for each event.
const COMPARED_MAX: u64 = 1_000_000;

/// Cached figures of runs.
#[derive(Debug)]
pub(super) struct Figures {
    /// Least recently requested run first.
    tallies: Mutex<VecDeque<(PathBuf, Arc<Mutex<Tally>>)>>,
    /// Allows one comparison at a time.
    comparing: Arc<Semaphore>,
}

impl Default for Figures {
    fn default() -> Self {
        Self { tallies: Mutex::default(), comparing: Arc::new(Semaphore::new(1)) }
    }
}

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(statistics)).routes(routes!(comparison))
}

/// Figures of the states of a run, or of its part up to an event: visits, outcomes, times.
#[utoipa::path(get, path = "/api/v1/runs/{run}/statistics", tag = "history",
    params(("run" = String, Path, description = "The run's id"), StatisticsQuery),
    responses(
        (status = 200, description = "Every state that ended", body = Statistics),
        (status = 400, description = "The query makes no sense", body = Refusal),
        (status = 404, description = "There is no such run, or it has not begun", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn statistics(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<StatisticsQuery>,
) -> Result<Json, Failure> {
    let folder = folder(&server, &run).await?;
    let History { readers, figures, .. } = &server.history;
    let figures = Arc::clone(figures);
    let counted = move |reader: &mut Reader| match query.until {
        Some(until) => Json::of(&counted_to(reader, until)?),
        None => Json::of(&figures.counted(reader)?),
    };
    readers.read_slowly(folder, counted).await
}

/// Compares two runs: the point of divergence, the data that differed before it, and the time they took.
#[utoipa::path(get, path = "/api/v1/runs/{run}/compare/{other}", tag = "history",
    params(
        ("run" = String, Path, description = "The one run's id"),
        ("other" = String, Path, description = "The other's"),
    ),
    responses(
        (status = 200, description = "Branch by branch: their order among each other means nothing", body = Comparison),
        (status = 400, description = "The address makes no sense", body = Refusal),
        (status = 404, description = "There is no such run, or it has not begun", body = Refusal),
        (status = 422, description = "A journal is damaged or of a newer version, or a run is too long", body = Refusal),
        (status = 503, description = "A journal cannot be read now", body = Refusal),
    )
)]
async fn comparison(
    State(server): State<Arc<ServerState>>,
    Path((run, other)): Path<(String, String)>,
) -> Result<Json, Failure> {
    let (one, other) = (folder(&server, &run).await?, folder(&server, &other).await?);
    let History { readers, figures, .. } = &server.history;
    let alone = Arc::clone(&figures.comparing).acquire_owned().await.ok();
    let others = Arc::clone(readers);
    let compared = move |one: &mut Reader| {
        let _alone = alone;
        others.with(&other, |other| {
            short_enough(one)?;
            short_enough(other)?;
            Json::of(&compare(one, other)?)
        })
    };
    readers.read_slowly(one, compared).await
}

fn short_enough(reader: &Reader) -> Result<(), Failure> {
    let events = reader.last_sequence()?;
    check_length(&reader.about().id, events)
}

fn check_length(id: &str, events: u64) -> Result<(), Failure> {
    if events <= COMPARED_MAX {
        return Ok(());
    }
    let message = format!(
        "{id} has {events} events, and up to {COMPARED_MAX} are compared here: use `rafcon compare` beside the runs"
    );
    Err(Failure::unprocessable("too_long_to_compare", message))
}

fn counted_to(reader: &mut Reader, until: u64) -> Result<Statistics, Failure> {
    let mut tally = Tally::default();
    tally.go_on_to(reader, until)?;
    Ok(tally.statistics(reader.known_places()))
}

impl Figures {
    /// Drops the figures of a run.
    pub(super) fn forget(&self, folder: &FilePath) {
        self.tallies.lock().retain(|(counted, _)| counted != folder);
    }

    /// The current figures. Counts only new events.
    fn counted(&self, reader: &mut Reader) -> Result<Statistics, Failure> {
        let tally = self.tally(reader.folder());
        let mut tally = tally.lock();
        tally.go_on(reader)?;
        Ok(tally.statistics(reader.known_places()))
    }

    fn tally(&self, folder: &FilePath) -> Arc<Mutex<Tally>> {
        let mut tallies = self.tallies.lock();
        let known = tallies.iter().position(|(counted, _)| counted == folder);
        let known = known.and_then(|index| tallies.remove(index));
        let (folder, tally) = known.unwrap_or_else(|| (folder.to_owned(), Arc::default()));
        tallies.push_back((folder, Arc::clone(&tally)));
        if tallies.len() > COUNTED {
            tallies.pop_front();
        }
        tally
    }
}

#[cfg(test)]
mod tests {
    use super::{COMPARED_MAX, check_length};

    #[test]
    fn a_run_that_is_too_long_to_compare_is_refused_with_the_way_out() {
        check_length("r", COMPARED_MAX).unwrap();
        let failure = check_length("r", COMPARED_MAX + 1).unwrap_err();
        assert_eq!((failure.status().as_u16(), failure.code()), (422, "too_long_to_compare"));
        assert!(failure.refusal().message.contains("rafcon compare"));
    }
}
