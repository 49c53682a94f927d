//! Middleware around every route: access checks, limits, and security headers for browsers. Knows HTTP, but no routes.

use super::door::door;
use crate::extract::BODY_MAX;
use crate::{Failure, ServerState, log};
use axum::Router;
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::header::{self, HeaderName, HeaderValue};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse as _, Response};
use std::any::Any;
use std::sync::Arc;
use tower_http::CompressionLevel;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::timeout::RequestBodyTimeoutLayer;

/// Headers of every response, for browsers.
const HEADERS: [(HeaderName, HeaderValue); 4] = [
    (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
    (header::REFERRER_POLICY, HeaderValue::from_static("no-referrer")),
    (header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY")),
    (
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::from_static(
            "default-src 'self'; img-src 'self' data:; object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'",
        ),
    ),
];

/// The router with all middleware.
pub(crate) fn guarded(
    router: Router<Arc<ServerState>>,
    server: &Arc<ServerState>,
) -> Router<Arc<ServerState>> {
    let patience = server.settings().listen.body_patience;
    router
        .layer(middleware::from_fn_with_state(Arc::clone(server), door))
        .layer(DefaultBodyLimit::max(BODY_MAX))
        .layer(RequestBodyTimeoutLayer::new(patience))
        .layer(CompressionLayer::new().quality(CompressionLevel::Fastest))
        .layer(CatchPanicLayer::custom(|panic: Box<dyn Any + Send>| broken(&*panic)))
        .layer(middleware::from_fn_with_state(Arc::clone(server), with_headers))
}

/// A browser that trusts the server's certificate uses only TLS for 30 days.
const ONLY_TLS: HeaderValue = HeaderValue::from_static("max-age=2592000");

async fn with_headers(
    State(server): State<Arc<ServerState>>,
    request: Request,
    next: Next,
) -> Response {
    let mut response = next.run(request).await;
    if server.names().is_secure {
        response.headers_mut().insert(header::STRICT_TRANSPORT_SECURITY, ONLY_TLS);
    }
    for (name, value) in HEADERS {
        response.headers_mut().entry(name).or_insert(value);
    }
    let no_store = HeaderValue::from_static("no-store");
    response.headers_mut().entry(header::CACHE_CONTROL).or_insert(no_store);
    response
}

/// Response to a request whose handler panicked.
fn broken(panic: &(dyn Any + Send)) -> Response {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic");
    log::say(&format!("a request met a fault of this program, please report it: {text}"));
    let message = "the server met a fault of its own: it is in its log, please report it";
    Failure::defect("fault", message).into_response()
}
