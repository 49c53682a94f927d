//! Checks every request: host, origin, authentication and right. Knows headers and rights; does not know the handlers.

use super::connection_slots::{ConnectionSlot, Peer, from_nowhere};
use super::outer_address::{BasePrefix, OuterAddress};
use super::people::CredentialClaim;
use super::rights::{self, ROUTES};
use super::who::{Who, nobody};
use crate::{Failure, Reason, ServerState};
use axum::extract::{MatchedPath, Request, State};
use axum::http::header::{self, HeaderMap};
use axum::http::{Method, Uri};
use axum::middleware::Next;
use axum::response::{Html, IntoResponse as _, Response};
use rafcon_protocol::api::Right;
use std::sync::Arc;

/// Routes that accept a token in the address, because a browser cannot set a header there.
const WITH_LINK: [&str; 2] = ["/", "/api/v1/socket"];

/// Method, path and required right of a request.
struct RequestTarget {
    method: Method,
    path: String,
    right: Right,
}

/// Admits a request, or responds with a refusal.
pub(crate) async fn door(
    State(server): State<Arc<ServerState>>,
    mut request: Request,
    next: Next,
) -> Response {
    match called(&server, &mut request).and_then(|()| admit(&server, &request)) {
        Ok(Some(who)) => {
            server.heard(&who.user);
            if let Some(place) = request.extensions().get::<Arc<ConnectionSlot>>() {
                place.log_in(&who.user);
            }
            request.extensions_mut().insert(who);
            next.run(request).await
        }
        Ok(None) => next.run(request).await,
        Err(failure) if failure.reason() == Reason::WrongHost && is_for_people(&request) => {
            (failure.status(), Html(page(&failure))).into_response()
        }
        Err(failure) => failure.into_response(),
    }
}

/// Adds the address in the browser to the request. Refuses a host name that is not the server's.
fn called(server: &ServerState, request: &mut Request) -> Result<(), Failure> {
    let peer = request.extensions().get::<Peer>().copied().ok_or_else(from_nowhere)?;
    let prefix = request.extensions().get::<BasePrefix>().copied();
    let host = host(request)?.unwrap_or_default();
    let listen = &server.settings().listen;
    let outer = OuterAddress::of(request.headers(), host, peer, prefix, listen)?;
    if !server.names().answers_to(&outer.host) {
        return Err(elsewhere(server, &outer.host));
    }
    request.extensions_mut().insert(outer.peer);
    request.extensions_mut().insert(Arc::new(outer));
    Ok(())
}

/// Authenticates the request. `None` if the route needs no user.
fn admit(server: &ServerState, request: &Request) -> Result<Option<Who>, Failure> {
    let Some(asked) = asked(request)? else { return Ok(None) };
    let claim = claim(server, request, &asked);
    check_origin(server, request, claim.as_ref())?;
    let who = claim.as_ref().map(|claim| server.people().known(claim, is_near(request)));
    match (who, asked.right) {
        (Some(None) | None, Right::Anyone) => Ok(None),
        (Some(Some(who)), Right::Anyone) => Ok(Some(who)),
        (Some(Some(who)), right) => may(server, who, right, &asked).map(Some),
        (Some(None), _) => Err(unknown()),
        (None, _) => Err(nobody()),
    }
}

/// Checks the user's right. Records a refusal.
fn may(
    server: &ServerState,
    who: Who,
    right: Right,
    asked: &RequestTarget,
) -> Result<Who, Failure> {
    let may = who.must(right);
    if may.is_err() {
        let about = format!("{} {}", asked.method, asked.path);
        server.audit().note_often(&who.user, &who.user, "refused", &about);
    }
    may.map(|()| who)
}

/// The route of a request and its right; `None` if there is no route.
fn asked(request: &Request) -> Result<Option<RequestTarget>, Failure> {
    let Some(path) = request.extensions().get::<MatchedPath>() else { return Ok(None) };
    let path = path.as_str();
    let method = match *request.method() {
        Method::HEAD => Method::GET,
        ref other => other.clone(),
    };
    match rights::of_route(&method, path) {
        Some(right) => Ok(Some(RequestTarget { method, path: path.to_owned(), right })),
        None => Err(no_row(&method, path)),
    }
}

fn no_row(method: &Method, path: &str) -> Failure {
    let others = ROUTES.iter().filter(|row| row.1 == path).map(|row| row.0.as_str());
    let others = others.collect::<Vec<_>>().join(", ");
    if others.is_empty() {
        let message = format!("nobody may use {path}: it has no row in the table of rights");
        return Failure::forbidden("no_right_known", message);
    }
    let message = format!("{method} does not go here; {others} does");
    let failure = Failure::new(Reason::WrongMethod, "wrong_method", message);
    failure.allowing(others)
}

/// The host name that the client requested. Refuses two different names, also if one is in the request target: a proxy may
/// use the other one.
fn host(request: &Request) -> Result<Option<&str>, Failure> {
    let mut named = request.headers().get_all(header::HOST).iter();
    let (first, second) = (named.next(), named.next());
    let named = first.and_then(|host| host.to_str().ok());
    let target = request.uri().authority().map(axum::http::uri::Authority::as_str);
    let differ = matches!((named, target), (Some(named), Some(target)) if named != target);
    if second.is_some() || differ {
        let message = "the request names two hosts: send one `Host` header that matches the host in the target";
        return Err(Failure::bad("two_hosts", message));
    }
    Ok(named.or(target))
}

fn elsewhere(server: &ServerState, host: &str) -> Failure {
    let (called, accepted) = (cut(host), server.names().accepted());
    let name = called.rsplit_once(':').map_or(called, |(name, _port)| name);
    let message = format!(
        "this page was opened at `{called}`, but the server only accepts {accepted}: open one of these, or start the server with \
         `--host {name}`"
    );
    Failure::new(Reason::WrongHost, "wrong_host", message)
}

/// The part of untrusted text that an error repeats.
fn cut(text: &str) -> &str {
    &text[..text.floor_char_boundary(200)]
}

/// True if the client accepts HTML.
fn is_for_people(request: &Request) -> bool {
    let kinds = request.headers().get(header::ACCEPT).and_then(|kinds| kinds.to_str().ok());
    kinds.is_some_and(|kinds| kinds.contains("text/html"))
}

/// A refusal as a page.
fn page(failure: &Failure) -> String {
    let text = failure.to_string();
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>RAFCON</title></head>\n\
         <body><h1>RAFCON</h1>\n<p>{text}</p></body></html>\n"
    )
}

/// The credential of a request: a token in a header, a token in the address where that is allowed, or a cookie.
fn claim(
    server: &ServerState,
    request: &Request,
    asked: &RequestTarget,
) -> Option<CredentialClaim> {
    let link = WITH_LINK.contains(&asked.path.as_str()).then(|| in_link(request.uri())).flatten();
    let token = bearer(request.headers()).or(link).map(CredentialClaim::Token);
    token.or_else(|| cookie(request.headers(), &server.cookie()).map(CredentialClaim::Cookie))
}

fn bearer(headers: &HeaderMap) -> Option<String> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    let (scheme, token) = value.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| token.trim().to_owned())
}

/// The token in the query of an address.
pub(crate) fn in_link(address: &Uri) -> Option<String> {
    let mut pairs = address.query()?.split('&');
    pairs.find_map(|pair| pair.strip_prefix("token=")).map(str::to_owned)
}

/// The cookie of this name.
pub(crate) fn cookie(headers: &HeaderMap, name: &str) -> Option<String> {
    let values = headers.get_all(header::COOKIE).iter().filter_map(|value| value.to_str().ok());
    let mut pairs = values.flat_map(|value| value.split(';')).map(str::trim);
    pairs.find_map(|pair| pair.strip_prefix(name)?.strip_prefix('=')).map(str::to_owned)
}

/// Refuses requests that pages of other sites send through a browser, if they change something or open a WebSocket.
fn check_origin(
    server: &ServerState,
    request: &Request,
    claim: Option<&CredentialClaim>,
) -> Result<(), Failure> {
    let headers = request.headers();
    let is_read = matches!(*request.method(), Method::GET | Method::HEAD);
    if is_read && !headers.contains_key(header::UPGRADE) {
        return Ok(());
    }
    let origin = headers.get(header::ORIGIN).map(|origin| origin.to_str().unwrap_or_default());
    let outer = request.extensions().get::<Arc<OuterAddress>>().ok_or_else(from_nowhere)?;
    // Browsers report other sites, including those that differ only by the scheme.
    let is_strange = headers
        .get("sec-fetch-site")
        .is_some_and(|site| *site == "cross-site" || *site == "same-site");
    match origin {
        Some(origin) if server.names().is_own(origin, outer) && !is_strange => Ok(()),
        None if !matches!(claim, Some(CredentialClaim::Cookie(_))) => Ok(()),
        Some(origin) => Err(strange_page(server, origin, outer)),
        None => Err(no_page()),
    }
}

fn strange_page(server: &ServerState, origin: &str, outer: &OuterAddress) -> Failure {
    let (page, called, accepted) = (cut(origin), cut(&outer.host), server.names().accepted());
    let name = page.split_once("://").map_or(page, |(_, name)| name);
    let name = name.rsplit_once(':').map_or(name, |(name, _port)| name);
    let message = format!(
        "this page was opened at {page}, but the server was called `{called}` and only accepts {accepted}: open one of these; if a \
         proxy is in between, start the server with `--host {name} --trusted-proxy` and the proxy's address, and let the proxy \
         send X-Forwarded-Host and X-Forwarded-Proto"
    );
    Failure::forbidden("wrong_origin", message)
}

fn no_page() -> Failure {
    let message = "this request does not come from a page of this server: open the server's own address, or send a \
                   token instead of a cookie";
    Failure::forbidden("wrong_origin", message)
}

fn unknown() -> Failure {
    let message = "this token or login is not known here, or its time is over: log in again, or make a new token";
    let failure = Failure::unauthorized("not_known", message);
    failure.asking_for_token()
}

/// True if the request comes from this computer.
fn is_near(request: &Request) -> bool {
    request.extensions().get::<Peer>().is_some_and(|peer| peer.is_near)
}

#[cfg(test)]
mod tests {
    use super::{bearer, cookie, in_link};
    use axum::http::header::{AUTHORIZATION, COOKIE};
    use axum::http::{HeaderMap, HeaderValue, Uri};

    #[test]
    fn a_cookie_is_found_among_others() {
        let mut headers = HeaderMap::new();
        headers.append(COOKIE, HeaderValue::from_static("a=1; rafcon_4747=x; rafcon_47=y"));
        headers.append(COOKIE, HeaderValue::from_static("late=z"));
        assert_eq!(cookie(&headers, "rafcon_47").as_deref(), Some("y"));
        assert_eq!(cookie(&headers, "rafcon_4747").as_deref(), Some("x"));
        assert_eq!(cookie(&headers, "late").as_deref(), Some("z"));
        assert_eq!(cookie(&headers, "rafcon"), None);
    }

    #[test]
    fn a_token_is_found_in_header_and_address() {
        let mut headers = HeaderMap::new();
        headers.insert(AUTHORIZATION, HeaderValue::from_static("bearer abc"));
        assert_eq!(bearer(&headers).as_deref(), Some("abc"));
        headers.insert(AUTHORIZATION, HeaderValue::from_static("Basic abc"));
        assert_eq!(bearer(&headers), None);
        assert_eq!(in_link(&Uri::from_static("/?a=b&token=abc")).as_deref(), Some("abc"));
        assert_eq!(in_link(&Uri::from_static("/?mytoken=abc")), None);
    }
}
