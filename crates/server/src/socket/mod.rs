//! The WebSocket: subscriptions to histories and statuses, commands and edits, over one connection.
//!
//! Knows frames, pace and capacity. Must never slow a runner down, nor buffer more for a slow client than one page per subscription.

mod connection;
mod feed;
mod history;
mod machine;
mod outbox;
mod pulse;
mod request_handler;
mod session;
mod status;
mod words;

use crate::access::Who;
use crate::{Failure, ServerState};
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::response::Response;
use rafcon_protocol::api::Refusal;
use request_handler::RequestHandler;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum size of a received frame, in bytes: an edit may contain a whole machine.
const FRAME_BYTES_MAX: usize = 1 << 20;

/// Size of a connection's read buffer, in bytes. It is small, because clients send little.
const READ_BYTES: usize = 16 << 10;

/// State shared by all connections.
#[derive(Debug, Default)]
pub(crate) struct Sockets {
    /// Number of connections since the start.
    count: AtomicU64,
}

pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(socket))
}

/// A WebSocket; docs/protocol.md describes its frames.
#[utoipa::path(
    get,
    path = "/api/v1/socket",
    tag = "server",
    responses(
        (status = 101, description = "From now on frames are spoken"),
        (status = 400, description = "This is no request for a WebSocket", body = Refusal),
        (status = 401, description = "Nobody is logged in", body = Refusal),
        (status = 403, description = "The request comes from a strange page", body = Refusal),
    )
)]
async fn socket(
    State(server): State<Arc<ServerState>>,
    who: Who,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Failure> {
    let upgrade = upgrade.map_err(|rejection| {
        let message =
            format!("a WebSocket begins here, and this is no request for one: {rejection}");
        Failure::bad("no_websocket", message)
    })?;
    let connection = server.sockets.count.fetch_add(1, Ordering::Relaxed) + 1;
    let handler = RequestHandler::new(server, who, connection);
    let upgrade = upgrade.max_message_size(FRAME_BYTES_MAX).max_frame_size(FRAME_BYTES_MAX);
    let upgrade = upgrade.read_buffer_size(READ_BYTES);
    Ok(upgrade.on_upgrade(move |socket| connection::serve(handler, socket)))
}
