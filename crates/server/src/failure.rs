//! Responses to failed requests: what failed, where, and a remedy. The only place that maps reasons to HTTP
//! statuses.

use axum::Json;
use axum::http::header::{ALLOW, HeaderName, RETRY_AFTER, WWW_AUTHENTICATE};
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use rafcon_protocol::api::Refusal;

/// The response to a failed request.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Failure {
    reason: Reason,
    code: &'static str,
    message: String,
    header: Option<(HeaderName, String)>,
}

/// Reason why a request fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The request cannot be understood.
    Bad,
    /// The server does not know who sent the request.
    Unauthorized,
    /// The sender lacks a right.
    Forbidden,
    /// The request names something that does not exist.
    NotFound,
    /// The route exists, but not for this method.
    WrongMethod,
    /// The request conflicts with the current state.
    Conflict,
    /// The request is larger than the limit.
    TooLarge,
    /// The request was meant for another server.
    WrongHost,
    /// The request is valid, but the current state does not allow it.
    Unprocessable,
    /// Too many such requests are open, or a limit on stored items is reached.
    TooMany,
    /// A defect of this program.
    Defect,
    /// The server cannot serve the request now.
    Unavailable,
}

impl Failure {
    /// A failure with a reason, a stable code and a message for people.
    pub fn new(reason: Reason, code: &'static str, message: impl Into<String>) -> Self {
        Self { reason, code, message: message.into(), header: None }
    }

    /// Adds `Retry-After`: the request may succeed after this many seconds.
    #[must_use]
    pub fn retry_after(self, seconds: u64) -> Self {
        Self { header: Some((RETRY_AFTER, seconds.to_string())), ..self }
    }

    /// Adds `WWW-Authenticate`: a token is required.
    #[must_use]
    pub fn asking_for_token(self) -> Self {
        Self { header: Some((WWW_AUTHENTICATE, "Bearer".to_owned())), ..self }
    }

    /// Adds `Allow`: the methods of the route.
    #[must_use]
    pub fn allowing(self, methods: String) -> Self {
        Self { header: Some((ALLOW, methods)), ..self }
    }

    /// A failure with [`Reason::NotFound`].
    pub fn not_found(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::NotFound, code, message)
    }

    /// A failure with [`Reason::Bad`].
    pub fn bad(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Bad, code, message)
    }

    /// A failure with [`Reason::Conflict`].
    pub fn conflict(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Conflict, code, message)
    }

    /// A failure with [`Reason::Unprocessable`].
    pub fn unprocessable(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Unprocessable, code, message)
    }

    /// A failure with [`Reason::TooMany`].
    pub fn too_many(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::TooMany, code, message)
    }

    /// A failure with [`Reason::TooLarge`].
    pub fn too_large(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::TooLarge, code, message)
    }

    /// A failure with [`Reason::Unavailable`].
    pub fn unavailable(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Unavailable, code, message)
    }

    /// A failure with [`Reason::Unauthorized`].
    pub fn unauthorized(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Unauthorized, code, message)
    }

    /// A failure with [`Reason::Defect`].
    pub fn defect(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Defect, code, message)
    }

    /// A failure with [`Reason::Forbidden`].
    pub fn forbidden(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Reason::Forbidden, code, message)
    }

    /// The reason of the failure, which determines the status.
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

    /// The stable code for programs.
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// The failure as it is sent to the client.
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
