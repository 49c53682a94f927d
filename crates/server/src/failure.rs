//! A request that cannot be served, as an answer: what, where, and the way out. The one place that maps reasons to HTTP
//! statuses.

use axum::Json;
use axum::http::header::{ALLOW, HeaderName, RETRY_AFTER, WWW_AUTHENTICATE};
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use rafcon_protocol::api::Refusal;

/// The answer to a request that failed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Failure {
    reason: Reason,
    code: &'static str,
    message: String,
    header: Option<(HeaderName, String)>,
}

/// Why a request is not served.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The request cannot be understood.
    Bad,
    /// The server does not know who sent the request.
    Unauthorized,
    /// The sender may not do this.
    Forbidden,
    /// What the request names does not exist.
    NotFound,
    /// The route exists, but not for this method.
    WrongMethod,
    /// The request does not fit what is there now.
    Conflict,
    /// The request is larger than the server takes.
    TooLarge,
    /// The request was meant for another server.
    WrongHost,
    /// The request is understood and cannot be served with what is there.
    Unprocessable,
    /// Too many such requests are open, or too much is there already.
    TooMany,
    /// A defect of this program.
    Defect,
    /// The server cannot serve the request now.
    Unavailable,
}

impl Failure {
    /// A refusal with a reason, a stable code and a sentence for people.
    pub fn new(reason: Reason, code: &'static str, message: impl Into<String>) -> Self {
        Self { reason, code, message: message.into(), header: None }
    }

    /// Says after how many seconds the same request may succeed.
    #[must_use]
    pub fn retry_after(self, seconds: u64) -> Self {
        Self { header: Some((RETRY_AFTER, seconds.to_string())), ..self }
    }

    /// Says that a token is needed.
    #[must_use]
    pub fn asking_for_token(self) -> Self {
        Self { header: Some((WWW_AUTHENTICATE, "Bearer".to_owned())), ..self }
    }

    /// Says which methods the route has.
    #[must_use]
    pub fn allowing(self, methods: String) -> Self {
        Self { header: Some((ALLOW, methods)), ..self }
    }

    /// See [`Reason::NotFound`].
    pub fn not_found(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::NotFound, code, message)
    }

    /// See [`Reason::Bad`].
    pub fn bad(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Bad, code, message)
    }

    /// See [`Reason::Conflict`].
    pub fn conflict(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Conflict, code, message)
    }

    /// See [`Reason::Unprocessable`].
    pub fn unprocessable(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Unprocessable, code, message)
    }

    /// See [`Reason::TooMany`].
    pub fn too_many(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::TooMany, code, message)
    }

    /// See [`Reason::TooLarge`].
    pub fn too_large(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::TooLarge, code, message)
    }

    /// See [`Reason::Unavailable`].
    pub fn unavailable(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Unavailable, code, message)
    }

    /// See [`Reason::Unauthorized`].
    pub fn unauthorized(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Unauthorized, code, message)
    }

    /// See [`Reason::Defect`].
    pub fn defect(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Defect, code, message)
    }

    /// See [`Reason::Forbidden`].
    pub fn forbidden(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Forbidden, code, message)
    }

    /// Why the request is not served.
    pub fn reason(&self) -> Reason {
        self.reason
    }

    /// The HTTP status of the reason.
    pub fn status(&self) -> StatusCode {
        match self.reason {
            Reason::Bad => StatusCode::BAD_REQUEST,
            Reason::Unauthorized => StatusCode::UNAUTHORIZED,
            Reason::Forbidden => StatusCode::FORBIDDEN,
            Reason::NotFound => StatusCode::NOT_FOUND,
            Reason::WrongMethod => StatusCode::METHOD_NOT_ALLOWED,
            Reason::Conflict => StatusCode::CONFLICT,
            Reason::TooLarge => StatusCode::PAYLOAD_TOO_LARGE,
            Reason::WrongHost => StatusCode::MISDIRECTED_REQUEST,
            Reason::Unprocessable => StatusCode::UNPROCESSABLE_ENTITY,
            Reason::TooMany => StatusCode::TOO_MANY_REQUESTS,
            Reason::Defect => StatusCode::INTERNAL_SERVER_ERROR,
            Reason::Unavailable => StatusCode::SERVICE_UNAVAILABLE,
        }
    }

    /// The stable word for programs.
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// The same, as the wire has it.
    pub fn refusal(&self) -> Refusal {
        Refusal { code: self.code.to_owned(), message: self.message.clone() }
    }
}

impl IntoResponse for Failure {
    fn into_response(self) -> Response {
        let mut response = (self.status(), Json(self.refusal())).into_response();
        if let Some((name, value)) = self.header
            && let Ok(value) = HeaderValue::try_from(value)
        {
            response.headers_mut().insert(name, value);
        }
        response
    }
}

/// An error with its causes, on one line.
pub(crate) fn reason(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}
