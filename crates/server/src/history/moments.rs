//! `GET …/moments` and `GET …/values`: the state of a run at an event, and its stored values. Knows snapshots; does not decode
//! pickles, which are for runners.

use super::events::{nanos, no_such_event};
use super::fetch;
use super::{Json, read};
use crate::extract::{Path, Query};
use crate::settings::Robots;
use crate::{Failure, ServerState};
use axum::extract::State;
use rafcon_protocol::api::{KeptAs, KeptValue, Moment, MomentQuery, Refusal};
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::{Reader, Stored, ValueNumber};
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(moment)).routes(routes!(moment_at)).routes(routes!(kept))
}

/// The state of a run after an event; 0 is the state before the first.
#[utoipa::path(get, path = "/api/v1/runs/{run}/moments/{sequence}", tag = "history",
    params(
        ("run" = String, Path, description = "The run's id"),
        ("sequence" = u64, Path, description = "The event"),
    ),
    responses(
        (status = 200, description = "Active states with their data, breakpoints, questions and holds", body = Moment),
        (status = 400, description = "This is no number", body = Refusal),
        (status = 404, description = "There is no such run or event, or the event was given up", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn moment(
    State(server): State<Arc<ServerState>>,
    Path((run, sequence)): Path<(String, u64)>,
) -> Result<Json, Failure> {
    read(&server, &run, move |reader| {
        if sequence > reader.last_sequence()? {
            return Err(no_such_event(sequence));
        }
        picture(reader, sequence)
    })
    .await
}

/// The state of a run at a time, or at the current end of its journal.
#[utoipa::path(get, path = "/api/v1/runs/{run}/moments", tag = "history",
    params(("run" = String, Path, description = "The run's id"), MomentQuery),
    responses(
        (status = 200, description = "After the last event up to this time", body = Moment),
        (status = 400, description = "The query makes no sense", body = Refusal),
        (status = 404, description = "There is no such run, or the time was given up", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn moment_at(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<MomentQuery>,
) -> Result<Json, Failure> {
    read(&server, &run, move |reader| {
        let sequence = match query.t_ns.or(query.t_ms.map(nanos)) {
            Some(ns) => reader.first_at(ns.saturating_add(1))? - 1,
            None => reader.last_sequence()?,
        };
        picture(reader, sequence)
    })
    .await
}

fn picture(reader: &mut Reader, sequence: u64) -> Result<Json, Failure> {
    let moment = reader.moment(sequence)?;
    Json::of(&reader.picture(&moment)?)
}

/// A stored value of a run.
#[utoipa::path(get, path = "/api/v1/runs/{run}/values/{value}", tag = "history",
    params(
        ("run" = String, Path, description = "The run's id"),
        ("value" = u64, Path, description = "The value's number, from the details of an event"),
    ),
    responses(
        (status = 200, description = "View of the value. Pickles are never sent", body = KeptValue),
        (status = 400, description = "This is no number", body = Refusal),
        (status = 404, description = "There is no such run or value, or the value was given up", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now", body = Refusal),
    )
)]
async fn kept(
    State(server): State<Arc<ServerState>>,
    Path((run, number)): Path<(String, u64)>,
) -> Result<Json, Failure> {
    let robots = server.settings.robots.clone();
    read(&server, &run, move |reader| {
        Json::of(&fetch::kept(reader, robots.as_deref(), ValueNumber(number))?)
    })
    .await
}

/// A value in the format of the protocol.
pub(super) fn value(
    reader: &Reader,
    robots: Option<&dyn Robots>,
    number: ValueNumber,
    stored: Stored,
) -> KeptValue {
    let kept = match stored.content {
        Content::View => KeptAs::View,
        Content::Pickle(bytes) => KeptAs::Pickle { bytes: bytes.len() as u64 },
        Content::File { hash, size } => fetch::kept_in_file(reader, robots, number, &hash, size),
        Content::Nothing(reason) => KeptAs::Nothing { reason },
    };
    KeptValue { number: number.0, type_name: stored.type_name.to_string(), view: stored.view, kept }
}
