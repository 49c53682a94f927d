//! `GET …/log`: the log lines of a run in pages. Knows lines.

use super::events::{LOOK, count, cursor};
use super::{Json, read};
use crate::extract::{Path, Query};
use crate::{Failure, ServerState};
use axum::extract::State;
use rafcon_protocol::api::{LogLine, LogPage, LogQuery, Refusal};
use rafcon_protocol::{Event, LogLevel, Stream};
use rafcon_storage::journal::{Filter, Found, Reader, Search};
use std::ops::ControlFlow;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Limit on the text of a page, in bytes.
const BYTES_MAX: usize = 4 << 20;

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(log))
}

/// Lists the log lines of a run.
///
/// A page may hold fewer lines than requested, even none, without being the last: continue from `next` until it exceeds `last`.
#[utoipa::path(get, path = "/api/v1/runs/{run}/log", tag = "history",
    params(("run" = String, Path, description = "The run's id"), LogQuery),
    responses(
        (status = 200, description = "The lines, in order", body = LogPage),
        (status = 400, description = "The query makes no sense", body = Refusal),
        (status = 404, description = "There is no such run, or it has not begun", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn log(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<LogQuery>,
) -> Result<Json, Failure> {
    let count = count(query.count)?;
    read(&server, &run, move |reader| Json::of(&page(reader, &query, count)?)).await
}

fn page(reader: &mut Reader, query: &LogQuery, count: usize) -> Result<LogPage, Failure> {
    let filter = Filter {
        state: query.state.clone(),
        kinds: vec!["log".to_owned()],
        level: query.level,
        ..Filter::default()
    };
    let wanted = query.text.as_ref().map(|text| text.to_lowercase());
    let search = Search { filter: &filter, from: query.from, look: LOOK, values: true };
    let (mut lines, mut bytes) = (Vec::new(), 0);
    let looked = reader.search(&search, |found| -> Result<_, Failure> {
        // Unreadable lines are always included, because they might match.
        let is_damage = matches!(found.event, Event::Damaged { .. });
        let is_wanted = |line: &LogLine| is_damage || has(line, wanted.as_deref());
        if let Some(line) = line(found).filter(is_wanted) {
            bytes += line.message.len();
            lines.push(line);
        }
        let is_full = lines.len() >= count || bytes >= BYTES_MAX;
        Ok(if is_full { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    let (next, last) = cursor(reader, looked)?;
    Ok(LogPage { lines, next, last })
}

fn line(found: Found) -> Option<LogLine> {
    let (path, level, stream, message) = match found.event {
        Event::Log { path, level, stream, message } => (path, level, stream, message),
        Event::Damaged { what, .. } => (
            String::new(),
            LogLevel::Error,
            Stream::Engine,
            format!("the journal is damaged: {what}"),
        ),
        _ => return None,
    };
    let (sequence, t_ns, names) = (found.sequence, found.t_ns, found.names);
    Some(LogLine { sequence, t_ns, path, names, level, stream, message })
}

/// True if the line contains the text, which is in lower case.
fn has(line: &LogLine, wanted: Option<&str>) -> bool {
    wanted.is_none_or(|wanted| line.message.to_lowercase().contains(wanted))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{LINE_BYTES, long_log};
    use super::{BYTES_MAX, LogQuery, page};

    #[test]
    fn a_page_of_the_log_ends_with_so_many_bytes_and_the_next_one_goes_on() {
        let full = BYTES_MAX / LINE_BYTES;
        let (_folder, mut reader) = long_log(full + 1);
        let mut look = |from: u64| {
            let query = LogQuery { from, ..LogQuery::default() };
            let page = page(&mut reader, &query, 1_000).unwrap();
            (page.lines.len(), page.next, page.last)
        };
        let last = full as u64 + 1;
        assert_eq!(look(1), (full, last, last));
        assert_eq!(look(last), (1, last + 1, last));
    }
}
