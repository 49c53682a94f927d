//! Extractors for bodies, queries and path parameters. A rejection becomes a [`Failure`], never a library's message. Knows
//! axum's extractors, but not the meaning of the parts.

use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::rejection::{JsonRejection, PathRejection, QueryRejection};
use axum::extract::{DefaultBodyLimit, FromRequest, FromRequestParts, Request};
use axum::http::StatusCode;
use axum::http::header::CONTENT_LENGTH;
use axum::http::request::Parts;
use axum::response::IntoResponse as _;
use futures_util::StreamExt as _;
use serde::de::DeserializeOwned;
use std::sync::Arc;
use tokio::time::timeout;

/// The largest body of a request, in bytes.
pub(crate) const BODY_MAX: usize = 8 << 20;

/// The largest body from a client that need not be logged in yet, in bytes.
const SMALL_MAX: usize = 16 << 10;

/// A body of JSON.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Body<T>(pub(crate) T);

impl<S: Send + Sync, T: DeserializeOwned> FromRequest<S> for Body<T> {
    type Rejection = Failure;

    async fn from_request(request: Request, state: &S) -> Result<Self, Failure> {
        let request = not_too_large(request, BODY_MAX).await?;
        let value = Json::<T>::from_request(request, state).await;
        Ok(Self(value.map_err(|rejection| bad_body(rejection, BODY_MAX))?.0))
    }
}

/// A short body of JSON that must arrive soon: unauthenticated clients cannot occupy much memory, nor for long.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Small<T>(pub(crate) T);

impl<T: DeserializeOwned> FromRequest<Arc<ServerState>> for Small<T> {
    type Rejection = Failure;

    async fn from_request(
        mut request: Request,
        server: &Arc<ServerState>,
    ) -> Result<Self, Failure> {
        DefaultBodyLimit::max(SMALL_MAX).apply(&mut request);
        let patience = server.settings().listen.body_patience;
        let value = timeout(patience, async {
            let request = not_too_large(request, SMALL_MAX).await?;
            let value = Json::<T>::from_request(request, server).await;
            value.map_err(|rejection| bad_body(rejection, SMALL_MAX))
        });
        let value = value.await.map_err(|_elapsed| too_slow(patience.as_secs()))?;
        Ok(Self(value?.0))
    }
}

/// Refuses a body whose announced size is too large. A body that is slightly too large is read and discarded, because a client
/// that is still sending when the connection is closed never sees the response.
async fn not_too_large(request: Request, bytes_max: usize) -> Result<Request, Failure> {
    let length = request.headers().get(CONTENT_LENGTH).and_then(|length| length.to_str().ok());
    let length = length.and_then(|length| length.parse().ok()).unwrap_or(0);
    if length <= bytes_max {
        return Ok(request);
    }
    if length <= bytes_max * 2 {
        let mut pieces = request.into_body().into_data_stream();
        while pieces.next().await.is_some_and(|piece| piece.is_ok()) {}
    }
    Err(too_large(bytes_max))
}

fn too_slow(seconds: u64) -> Failure {
    let message = format!("the body was not there after {seconds} s: send it at once");
    Failure::bad("bad_body", message)
}

fn bad_body(rejection: JsonRejection, bytes_max: usize) -> Failure {
    if let JsonRejection::MissingJsonContentType(_) = rejection {
        let message = "this route takes JSON: send it with `Content-Type: application/json`";
        return Failure::bad("not_json", message);
    }
    let text = rejection.body_text();
    match rejection.into_response().status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_large(bytes_max),
        _other => Failure::bad("bad_body", format!("the body does not fit: {text}")),
    }
}

fn too_large(bytes_max: usize) -> Failure {
    let message = format!("the body is larger than {} KiB: send less at a time", bytes_max >> 10);
    Failure::too_large("body_too_large", message)
}

/// The query: what follows the `?` of an address.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Query<T>(pub(crate) T);

impl<S: Send + Sync, T: DeserializeOwned> FromRequestParts<S> for Query<T> {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Failure> {
        let bad = |rejection: QueryRejection| {
            let message = format!("the query does not fit: {}", rejection.body_text());
            Failure::bad("bad_query", message)
        };
        let query = axum::extract::Query::<T>::from_request_parts(parts, state).await;
        Ok(Self(query.map_err(bad)?.0))
    }
}

/// The parts of the path that the route names.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Path<T>(pub(crate) T);

impl<S: Send + Sync, T: DeserializeOwned + Send> FromRequestParts<S> for Path<T> {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Failure> {
        let bad = |rejection: PathRejection| {
            let message = format!("the address does not fit: {}", rejection.body_text());
            Failure::bad("bad_path", message)
        };
        let path = axum::extract::Path::<T>::from_request_parts(parts, state).await;
        Ok(Self(path.map_err(bad)?.0))
    }
}

/// The maximum length of an id, in bytes.
const LENGTH_MAX: usize = 128;

/// Refuses an invalid id.
pub(crate) fn check_request_id(id: &str) -> Result<(), Failure> {
    if id.is_empty() || id.len() > LENGTH_MAX {
        let message =
            format!("an id has 1 to {LENGTH_MAX} bytes: a random one does for each request");
        return Err(Failure::bad("bad_id", message));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{LENGTH_MAX, Small, check_request_id};
    use crate::{ServerState, Settings};
    use axum::body::{Body, Bytes};
    use axum::extract::{FromRequest as _, Request};
    use futures_util::stream;
    use serde_json::Value;
    use std::convert::Infallible;
    use std::time::Duration;
    use tokio::time::{Instant, sleep};

    /// The result for a body whose parts arrive at intervals of one second.
    async fn check(piece: &'static [u8]) -> (u16, u64) {
        let place = tempfile::tempdir().unwrap();
        let settings = Settings::new(place.path().join("state"), place.path().join("runs"));
        std::fs::create_dir(&settings.state).unwrap();
        let server = ServerState::new(settings).unwrap();
        let pieces = stream::unfold((), move |()| async move {
            sleep(Duration::from_secs(1)).await;
            Some((Ok::<_, Infallible>(Bytes::from_static(piece)), ()))
        });
        let request = Request::builder().header("content-type", "application/json");
        let request = request.body(Body::from_stream(pieces)).unwrap();
        let begin = Instant::now();
        let failure = Small::<Value>::from_request(request, &server).await.unwrap_err();
        (failure.status().as_u16(), begin.elapsed().as_secs())
    }

    #[tokio::test(start_paused = true)]
    async fn strangers_can_keep_little_and_not_for_long() {
        assert_eq!(check(b" ").await, (400, 30));
        assert_eq!(check(&[b' '; 4096]).await, (413, 5));
    }

    #[test]
    fn an_id_has_at_most_so_many_bytes() {
        check_request_id(&"i".repeat(LENGTH_MAX)).unwrap();
        for id in ["", &"i".repeat(LENGTH_MAX + 1), &"ä".repeat(LENGTH_MAX / 2 + 1)] {
            assert_eq!(check_request_id(id).unwrap_err().code(), "bad_id");
        }
    }
}
