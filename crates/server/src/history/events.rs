//! `GET …/events`: the events of a run, filtered and paged. Knows cursors and filters.

use super::{Json, read};
use crate::extract::{Path, Query};
use crate::settings::Robots;
use crate::{Failure, ServerState};
use axum::extract::State;
use rafcon_protocol::api::{EventDetail, EventPage, EventQuery, HistoryEntry, NamedValue, Refusal};
use rafcon_storage::journal::{
    Entry, Filter, Found, KINDS, Looked, Reader, Search, path_of, place_of,
};
use std::ops::ControlFlow;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The maximum number of events on a page.
pub(super) const COUNT_MAX: u32 = 1000;
/// The maximum number of events that are examined for a page.
pub(super) const LOOK: u64 = 200_000;
/// The limit with a text filter, which examines each event as text.
const LOOK_FOR_TEXT: u64 = 20_000;
/// Approximate limit on the values of a page, in bytes.
const BYTES_MAX: usize = 4 << 20;

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(events)).routes(routes!(event))
}

/// Lists the events of a run.
///
/// A page may hold fewer events than requested, even none, without being the last: continue from `next` until it exceeds `last`.
#[utoipa::path(get, path = "/api/v1/runs/{run}/events", tag = "history",
    params(("run" = String, Path, description = "The run's id"), EventQuery),
    responses(
        (status = 200, description = "The events, in order", body = EventPage),
        (status = 400, description = "The query makes no sense", body = Refusal),
        (status = 404, description = "There is no such run, or it has not begun", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn events(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<EventQuery>,
) -> Result<Json, Failure> {
    let (filter, count) = (filter(&query)?, count(query.count)?);
    read(&server, &run, move |reader| Json::of(&page(reader, &query, &filter, count)?)).await
}

/// One event of a run with its stored values.
#[utoipa::path(get, path = "/api/v1/runs/{run}/events/{sequence}", tag = "history",
    params(
        ("run" = String, Path, description = "The run's id"),
        ("sequence" = u64, Path, description = "The event"),
    ),
    responses(
        (status = 200, description = "The event", body = EventDetail),
        (status = 400, description = "This is no number", body = Refusal),
        (status = 404, description = "There is no such run or event", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn event(
    State(server): State<Arc<ServerState>>,
    Path((run, sequence)): Path<(String, u64)>,
) -> Result<Json, Failure> {
    let robots = server.settings.robots.clone();
    read(&server, &run, move |reader| Json::of(&detail(reader, robots.as_deref(), sequence)?)).await
}

/// The requested number of events, checked against the limit.
pub(super) fn count(wanted: Option<u32>) -> Result<usize, Failure> {
    let count = wanted.unwrap_or(COUNT_MAX);
    if (1..=COUNT_MAX).contains(&count) {
        return Ok(usize::try_from(count).unwrap_or(1));
    }
    let message = format!(
        "a page has 1 to {COUNT_MAX} entries: request {COUNT_MAX} and continue from `next`"
    );
    Err(Failure::bad("bad_count", message))
}

/// The first event to examine, according to cursor and start time.
fn first(reader: &mut Reader, query: &EventQuery) -> Result<u64, Failure> {
    match query.since_ms {
        Some(ms) => Ok(reader.first_at(nanos(ms))?.max(query.from)),
        None => Ok(query.from),
    }
}

/// The cursor of the next page, and the number of the last event in the journal.
pub(super) fn cursor(reader: &Reader, looked: Looked) -> Result<(u64, u64), Failure> {
    let last = reader.last_sequence()?;
    let next = if looked.is_past { looked.next.max(last + 1) } else { looked.next };
    Ok((next, last))
}

fn page(
    reader: &mut Reader,
    query: &EventQuery,
    filter: &Filter,
    count: usize,
) -> Result<EventPage, Failure> {
    let from = first(reader, query)?;
    let look = if filter.text.is_some() { LOOK_FOR_TEXT } else { LOOK };
    let search = Search { filter, from, look, values: query.values };
    let (mut events, mut bytes) = (Vec::new(), 0);
    let looked = reader.search(&search, |found: Found| -> Result<_, Failure> {
        let Found { sequence, t_ns, event, .. } = found;
        if query.values {
            bytes += serde_json::to_string(&event).map_or(0, |text| text.len());
        }
        events.push(HistoryEntry { sequence, t_ns, event });
        let is_full = events.len() >= count || bytes >= BYTES_MAX;
        Ok(if is_full { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    let (next, last) = cursor(reader, looked)?;
    Ok(EventPage { events, next, last })
}

fn filter(query: &EventQuery) -> Result<Filter, Failure> {
    Ok(Filter {
        state: query.state.clone(),
        outcome: query.outcome.clone(),
        text: query.text.clone(),
        kinds: kinds(query.kinds.as_deref().unwrap_or_default())?,
        level: None,
        from_ns: query.since_ms.map(nanos),
        to_ns: query.until_ms.map(nanos),
    })
}

pub(super) fn kinds(text: &str) -> Result<Vec<String>, Failure> {
    let kinds = text.split(',').map(str::trim).filter(|kind| !kind.is_empty());
    let known = |kind: &str| {
        if KINDS.contains(&kind) {
            return Ok(kind.to_owned());
        }
        let message = format!("`{kind}` is no kind of event: they are {}", KINDS.join(", "));
        Err(Failure::bad("no_such_kind", message))
    };
    kinds.map(known).collect()
}

/// A time in ns, the unit of events.
pub(super) fn nanos(ms: u64) -> u64 {
    ms.saturating_mul(1_000_000)
}

fn detail(
    reader: &mut Reader,
    robots: Option<&dyn Robots>,
    sequence: u64,
) -> Result<EventDetail, Failure> {
    let page = reader.page(sequence, 1)?;
    reader.check_event(sequence, page.first())?;
    let entry = page.first().filter(|entry| entry.sequence == sequence);
    let entry = entry.ok_or_else(|| no_such_event(sequence))?;
    let event = reader.event(entry, true)?;
    let places = reader.known_places();
    let place = place_of(&entry.record).or_else(|| places.number(path_of(&event)));
    let names = place.and_then(|place| places.get(place)).map(|place| place.names.clone());
    Ok(EventDetail {
        names: names.unwrap_or_else(|| path_of(&event).to_owned()),
        values: values(reader, robots, entry)?,
        entry: HistoryEntry { sequence, t_ns: entry.t_ns, event },
    })
}

fn values(
    reader: &Reader,
    robots: Option<&dyn Robots>,
    entry: &Entry,
) -> Result<Vec<NamedValue>, Failure> {
    let mut values = Vec::new();
    for (name, number) in reader.named_values(entry) {
        let stored = reader.value(number)?;
        let kept = |stored| super::moments::value(reader, robots, number, stored);
        values.extend(stored.map(|stored| NamedValue { name, value: kept(stored) }));
    }
    Ok(values)
}

pub(super) fn no_such_event(sequence: u64) -> Failure {
    let message = format!("the run has no event {sequence}: take a number from its list of events");
    Failure::not_found("no_such_event", message)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{LINE_BYTES, long_log};
    use super::{BYTES_MAX, COUNT_MAX, EventQuery, Filter, count, page};

    #[test]
    fn a_page_of_events_with_values_ends_with_so_many_bytes_and_the_next_one_goes_on() {
        let full = BYTES_MAX / LINE_BYTES;
        let (_folder, mut reader) = long_log(full + 1);
        let mut look = |from: u64, values: bool| {
            let query = EventQuery { from, values, ..EventQuery::default() };
            let page = page(&mut reader, &query, &Filter::default(), 1_000).unwrap();
            (page.events.len(), page.next, page.last)
        };
        let last = full as u64 + 1;
        assert_eq!(look(1, true), (full, last, last));
        assert_eq!(look(last, true), (1, last + 1, last));
    }

    #[test]
    fn a_page_has_at_most_so_many_events() {
        assert_eq!(count(Some(COUNT_MAX)).unwrap(), COUNT_MAX as usize);
        assert_eq!(count(Some(COUNT_MAX + 1)).unwrap_err().code(), "bad_count");
        assert_eq!(count(Some(0)).unwrap_err().code(), "bad_count");
    }
}
