//! The page at `/`: turns the token of the start link into a cookie, and says what is here. Must never know machines or runs.

use crate::access::{Credential, Who, in_link};
use crate::{Failure, House};
use axum::extract::State;
use axum::http::header::{self, HeaderName};
use axum::http::{StatusCode, Uri};
use axum::response::{Html, IntoResponse as _, Response};
use axum::routing::get;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;

/// The route of this part. It is for browsers and stands in no description.
pub(crate) fn routes() -> OpenApiRouter<Arc<House>> {
    OpenApiRouter::new().route("/", get(page))
}

async fn page(
    State(house): State<Arc<House>>,
    address: Uri,
    who: Option<Who>,
) -> Result<Response, Failure> {
    match (who, in_link(&address)) {
        (Some(who), Some(_)) if who.by == Credential::Owner => enter(&house, &who),
        (_, Some(_)) => Ok(without_token()),
        (Some(who), None) => Ok(greeting(&format!("You are {}.", who.user))),
        (None, None) => Ok(greeting(
            "Open the address that the server printed at its start, or log in at /api/v1/session.",
        )),
    }
}

/// Lets the owner's browser in, and takes the token out of its address.
fn enter(house: &House, who: &Who) -> Result<Response, Failure> {
    let (secret, who) = house.people().begin(&who.user)?;
    house.audit().note(&who.user, "login", "by the start link");
    let cookie: [(HeaderName, String); 1] = [(header::SET_COOKIE, house.set_cookie(secret.text()))];
    Ok((cookie, without_token()).into_response())
}

/// A token shall not stay in an address, where it would be seen and kept.
fn without_token() -> Response {
    (StatusCode::SEE_OTHER, [(header::LOCATION, "/")]).into_response()
}

/// User names are letters, digits and a few signs: nothing that HTML would read.
fn greeting(text: &str) -> Response {
    let page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>RAFCON</title></head>\n\
         <body><h1>RAFCON</h1>\n<p>{text}</p>\n\
         <p>What programs can ask for: <a href=\"/api/v1/openapi.json\">openapi.json</a>.</p></body></html>\n"
    );
    Html(page).into_response()
}
