//! What requests bring, taken apart: bodies, queries and parts of paths. What does not fit is answered as a [`Failure`], never
//! in the words of a library. Knows axum's extractors; must never know what the parts mean.

use crate::Failure;
use axum::Json;
use axum::extract::rejection::{JsonRejection, PathRejection, QueryRejection};
use axum::extract::{FromRequest, FromRequestParts, Request};
use axum::http::StatusCode;
use axum::http::request::Parts;
use axum::response::IntoResponse as _;
use serde::de::DeserializeOwned;

/// The largest body of a request, in bytes.
pub(crate) const BODY_MAX: usize = 8 << 20;

/// A body of JSON.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Body<T>(pub(crate) T);

impl<S: Send + Sync, T: DeserializeOwned> FromRequest<S> for Body<T> {
    type Rejection = Failure;

    async fn from_request(request: Request, state: &S) -> Result<Self, Failure> {
        let Json(value) = Json::<T>::from_request(request, state).await.map_err(bad_body)?;
        Ok(Self(value))
    }
}

fn bad_body(rejection: JsonRejection) -> Failure {
    if let JsonRejection::MissingJsonContentType(_) = rejection {
        let message = "this route takes JSON: send it with `Content-Type: application/json`";
        return Failure::bad("not_json", message);
    }
    let text = rejection.body_text();
    match rejection.into_response().status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_large(),
        _other => Failure::bad("bad_body", format!("the body does not fit: {text}")),
    }
}

fn too_large() -> Failure {
    let message = format!("the body is larger than {} MB: send less at a time", BODY_MAX >> 20);
    Failure::new(StatusCode::PAYLOAD_TOO_LARGE, "body_too_large", message)
}

/// What stands behind the `?` of an address.
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

/// The parts of a path that the route names.
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
