//! The page at `/` and its files: turns the token of the start link into a cookie, and gives the page to everybody, who logs in
//! there. Must never know machines or runs.

mod files;

pub use files::PageFiles;

use crate::access::{Credential, Who, in_link};
use crate::extract::Path;
use crate::{Failure, ServerState};
use axum::extract::State;
use axum::http::header::{self, HeaderName};
use axum::http::{StatusCode, Uri};
use axum::response::{Html, IntoResponse as _, Response};
use axum::routing::get;
use files::PageFile;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;

/// What the page may load, and from where: from here only. Its editor and its docking write styles, its pictures and workers
/// may be made in the page.
const POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; \
                      font-src 'self' data:; worker-src 'self' blob:; connect-src 'self'; object-src 'none'; \
                      base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/// The name of a file in `assets` changes with its content.
const FOREVER: &str = "public, max-age=31536000, immutable";

/// The routes of this part. They are for browsers and stand in no description.
pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new()
        .route("/", get(page))
        .route("/popout.html", get(popout))
        .route("/icon.svg", get(icon))
        .route("/assets/{file}", get(asset))
}

async fn page(
    State(server): State<Arc<ServerState>>,
    address: Uri,
    who: Option<Who>,
) -> Result<Response, Failure> {
    match (who, in_link(&address)) {
        (Some(who), Some(_)) if who.by == Credential::Owner => enter(&server, &who, &address),
        (_, Some(_)) => Ok(without_token(&address)),
        (_, None) => Ok(index(&server.settings().page)),
    }
}

/// Lets the owner's browser in, and takes the token out of its address.
fn enter(server: &ServerState, who: &Who, address: &Uri) -> Result<Response, Failure> {
    let (secret, who) = server.people().begin(&who.user)?;
    server.audit().note(&who.user, "login", "by the start link");
    let cookie: [(HeaderName, String); 1] =
        [(header::SET_COOKIE, server.set_cookie(secret.text()))];
    Ok((cookie, without_token(address)).into_response())
}

/// A token shall not stay in an address, where it would be seen and kept. What else the address says stays.
fn without_token(address: &Uri) -> Response {
    let pairs = address.query().unwrap_or_default().split('&');
    let kept = pairs.filter(|pair| !pair.is_empty() && !pair.starts_with("token="));
    let kept = kept.collect::<Vec<_>>().join("&");
    let mark = if kept.is_empty() { "" } else { "?" };
    (StatusCode::SEE_OTHER, [(header::LOCATION, format!("/{mark}{kept}"))]).into_response()
}

/// The page itself is never kept, so that a newer one is seen at once.
fn index(files: &PageFiles) -> Response {
    match files.get("index.html") {
        Some(file) => document(file),
        None => not_built(files.way()),
    }
}

/// What a panel's own window begins with.
async fn popout(State(server): State<Arc<ServerState>>) -> Result<Response, Failure> {
    server.settings().page.get("popout.html").map(document).ok_or_else(no_file)
}

async fn icon(State(server): State<Arc<ServerState>>) -> Result<Response, Failure> {
    server.settings().page.get("icon.svg").map(document).ok_or_else(no_file)
}

async fn asset(
    State(server): State<Arc<ServerState>>,
    Path(file): Path<String>,
) -> Result<Response, Failure> {
    let file = server.settings().page.get(&format!("assets/{file}")).ok_or_else(no_file)?;
    let mut answer = document(file);
    answer.headers_mut().insert(header::CACHE_CONTROL, header::HeaderValue::from_static(FOREVER));
    Ok(answer)
}

fn document(file: PageFile) -> Response {
    let head = [(header::CONTENT_TYPE, file.kind), (header::CONTENT_SECURITY_POLICY, POLICY)];
    (head, file.bytes).into_response()
}

fn no_file() -> Failure {
    let message = "the page has no such file, or none any more: reload the page";
    Failure::not_found("no_such_file", message)
}

/// Says how the page comes here.
fn not_built(way: &str) -> Response {
    let page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>RAFCON</title></head>\n\
         <body><h1>RAFCON</h1>\n<p>The server is here, and its page has not been built: {way}.</p>\n\
         <p>What programs can ask for: <a href=\"/api/v1/openapi.json\">openapi.json</a>.</p></body></html>\n"
    );
    Html(page).into_response()
}
