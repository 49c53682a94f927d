//! The page at `/` and its files. Exchanges the token of the start link for a cookie, and serves the page to everyone, also before
//! the login. Does not know machines or runs.

use crate::access::{Credential, OuterAddress, Who, in_link};
use crate::extract::Path;
use crate::page_files::{PageFile, PageFiles};
use crate::{Failure, ServerState};
use axum::extract::State;
use axum::http::header::{self, HeaderName};
use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri};
use axum::response::{Html, IntoResponse as _, Response};
use axum::routing::get;
use std::borrow::Cow;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;

/// Content policy of the page: it loads only from this server. Editor and docking set inline styles, and the page may create
/// pictures and workers.
const POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; \
                      font-src 'self' data:; worker-src 'self' blob:; connect-src 'self'; object-src 'none'; \
                      base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/// Files in `assets` never change, because their names include a hash of the content.
const FOREVER: &str = "public, max-age=31536000, immutable";

/// The routes of this part. They are for browsers and are not in the API description.
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
    outer: OuterAddress,
    head: HeaderMap,
    who: Option<Who>,
) -> Result<Response, Failure> {
    match (who, in_link(&address)) {
        (Some(who), Some(_)) if who.by == Credential::Owner => {
            enter(&server, &who, &address, &outer)
        }
        (_, Some(_)) => Ok(without_token(&address, &outer)),
        (_, None) if outer.is_bare => Ok(without_token(&address, &outer)),
        (_, None) => index(&server.settings().page, &head, outer.base.as_str()),
    }
}

/// Logs the owner's browser in, and removes the token from its address.
fn enter(
    server: &ServerState,
    who: &Who,
    address: &Uri,
    outer: &OuterAddress,
) -> Result<Response, Failure> {
    let (secret, who) = server.people().begin(&who.user)?;
    server.audit().note(&who.user, "login", "by the start link");
    let cookie: [(HeaderName, String); 1] =
        [(header::SET_COOKIE, server.set_cookie(secret.text(), outer))];
    Ok((cookie, without_token(address, outer)).into_response())
}

/// Redirects to the address without the token, so that browsers do not store it. The redirect is relative if the base path is
/// unknown: a proxy may have removed one.
fn without_token(address: &Uri, outer: &OuterAddress) -> Response {
    let pairs = address.query().unwrap_or_default().split('&');
    let kept = pairs.filter(|pair| !pair.is_empty() && !pair.starts_with("token="));
    let kept = kept.collect::<Vec<_>>().join("&");
    let mark = if kept.is_empty() { "" } else { "?" };
    let folder = if outer.base.as_str().is_empty() { "." } else { outer.base.as_str() };
    (StatusCode::SEE_OTHER, [(header::LOCATION, format!("{folder}/{mark}{kept}"))]).into_response()
}

fn index(files: &PageFiles, head: &HeaderMap, base: &str) -> Result<Response, Failure> {
    match files.get("index.html") {
        Some(file) if base.is_empty() => current(file, head),
        Some(file) => current(below(file, base)?, head),
        None => Ok(not_built(files.way())),
    }
}

/// The page with absolute addresses below this path. Without it, the page resolves them against its own address.
fn below(file: PageFile, base: &str) -> Result<PageFile, Failure> {
    let file = file.unpacked().map_err(|error| broken(&error))?;
    let text = String::from_utf8_lossy(&file.bytes).replace("\"./", &format!("\"{base}/"));
    Ok(PageFile { bytes: Cow::Owned(text.into_bytes()), ..file })
}

/// The start page of a panel in a separate window.
async fn popout(
    State(server): State<Arc<ServerState>>,
    head: HeaderMap,
) -> Result<Response, Failure> {
    current(server.settings().page.get("popout.html").ok_or_else(no_file)?, &head)
}

async fn icon(
    State(server): State<Arc<ServerState>>,
    head: HeaderMap,
) -> Result<Response, Failure> {
    current(server.settings().page.get("icon.svg").ok_or_else(no_file)?, &head)
}

async fn asset(
    State(server): State<Arc<ServerState>>,
    Path(file): Path<String>,
    head: HeaderMap,
) -> Result<Response, Failure> {
    let file = server.settings().page.get(&format!("assets/{file}")).ok_or_else(no_file)?;
    let mut answer = document(file, &head)?;
    answer.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static(FOREVER));
    Ok(answer)
}

/// A file with a stable name: the browser revalidates it at each request.
fn current(file: PageFile, head: &HeaderMap) -> Result<Response, Failure> {
    let name = blake3::hash(&file.bytes).to_hex();
    // A weak tag, because it is shared by the compressed and the plain form.
    let tag = format!("W/\"{}\"", name.get(..16).unwrap_or_default());
    let is_known = head.get(header::IF_NONE_MATCH).is_some_and(|known| *known == *tag);
    let kept = [(header::ETAG, tag), (header::CACHE_CONTROL, "no-cache".to_owned())];
    if is_known {
        // The headers of this response replace the cached ones, including the policy.
        let policy = [(header::CONTENT_SECURITY_POLICY, POLICY)];
        return Ok((StatusCode::NOT_MODIFIED, policy, kept).into_response());
    }
    Ok((kept, document(file, head)?).into_response())
}

fn document(file: PageFile, head: &HeaderMap) -> Result<Response, Failure> {
    let fixed = [
        (header::CONTENT_TYPE, file.kind),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::VARY, "accept-encoding"),
    ];
    if file.is_packed && takes_gzip(head) {
        return Ok((fixed, [(header::CONTENT_ENCODING, "gzip")], file.bytes).into_response());
    }
    let file = file.unpacked().map_err(|error| broken(&error))?;
    Ok((fixed, file.bytes).into_response())
}

/// True if the client accepts gzip, as all browsers do.
fn takes_gzip(head: &HeaderMap) -> bool {
    let codings =
        head.get_all(header::ACCEPT_ENCODING).iter().filter_map(|line| line.to_str().ok());
    codings.flat_map(|line| line.split(',')).any(|coding| {
        let mut parts = coding.split(';').map(str::trim);
        let is_gzip = parts.next().is_some_and(|name| name.eq_ignore_ascii_case("gzip"));
        is_gzip && !parts.any(|weight| matches!(weight, "q=0" | "q=0.0" | "q=0.00" | "q=0.000"))
    })
}

fn broken(error: &std::io::Error) -> Failure {
    let message = format!("a file of the page cannot be unpacked: {error}");
    Failure::defect("fault", message)
}

fn no_file() -> Failure {
    let message = "the page has no such file, or none any more: reload the page";
    Failure::not_found("no_such_file", message)
}

/// The response while the page has not been built, with instructions.
fn not_built(way: &str) -> Response {
    let page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>RAFCON</title></head>\n\
         <body><h1>RAFCON</h1>\n<p>The server is here, and its page has not been built: {way}.</p>\n\
         <p>What programs can ask for: <a href=\"/api/v1/openapi.json\">openapi.json</a>.</p></body></html>\n"
    );
    Html(page).into_response()
}

#[cfg(test)]
mod tests {
    use super::{POLICY, below, current, document, takes_gzip};
    use crate::page_files::PageFile;
    use axum::http::header::{self, HeaderMap, HeaderName};
    use axum::http::{HeaderValue, StatusCode};
    use flate2::{Compression, write::GzEncoder};
    use std::borrow::Cow;
    use std::io::Write as _;

    fn asks(name: HeaderName, value: &str) -> HeaderMap {
        HeaderMap::from_iter([(name, HeaderValue::from_str(value).unwrap())])
    }

    fn packed() -> PageFile {
        let mut packer = GzEncoder::new(Vec::new(), Compression::best());
        packer.write_all(b"let a = 1;").unwrap();
        let bytes = Cow::Owned(packer.finish().unwrap());
        PageFile { bytes, is_packed: true, kind: "text/javascript; charset=utf-8" }
    }

    #[test]
    fn gzip_is_taken_by_who_says_so() {
        let check = |said: &str| takes_gzip(&asks(header::ACCEPT_ENCODING, said));
        assert!(check("gzip") && check("deflate, gzip;q=1.0, br") && check("GZIP"));
        assert!(!check("br") && !check("gzip;q=0, br") && !check("") && !check("xgzip"));
        assert!(!takes_gzip(&HeaderMap::new()));
    }

    #[test]
    fn a_packed_file_goes_out_as_it_is_or_unpacked() {
        let encoding = |head: &HeaderMap| {
            let answer = document(packed(), head).unwrap();
            let text =
                |name| answer.headers().get(name).map(|value| value.to_str().unwrap().to_owned());
            (text(header::CONTENT_ENCODING), text(header::VARY))
        };
        let gzip = asks(header::ACCEPT_ENCODING, "gzip, deflate");
        assert_eq!(encoding(&gzip), (Some("gzip".into()), Some("accept-encoding".into())));
        assert_eq!(encoding(&HeaderMap::new()), (None, Some("accept-encoding".into())));
    }

    #[test]
    fn below_a_path_the_page_names_its_files_there() {
        let html = br#"<meta name="base" content="./" /><script src="./assets/a.js"></script>"#;
        let file = PageFile { bytes: Cow::Borrowed(html), is_packed: false, kind: "text/html" };
        let text = String::from_utf8(below(file, "/robot").unwrap().bytes.into_owned()).unwrap();
        let expected =
            r#"<meta name="base" content="/robot/" /><script src="/robot/assets/a.js"></script>"#;
        assert_eq!(text, expected);
    }

    #[test]
    fn a_browser_that_has_the_file_is_not_given_it_again() {
        let first = current(packed(), &HeaderMap::new()).unwrap();
        assert_eq!(first.headers()[header::CACHE_CONTROL], "no-cache");
        let tag = first.headers()[header::ETAG].to_str().unwrap();
        let again = current(packed(), &asks(header::IF_NONE_MATCH, tag)).unwrap();
        assert_eq!(again.status(), StatusCode::NOT_MODIFIED);
        assert_eq!(again.headers()[header::CONTENT_SECURITY_POLICY], POLICY);
        let other = current(packed(), &asks(header::IF_NONE_MATCH, "W/\"other\"")).unwrap();
        assert_eq!(other.status(), StatusCode::OK);
    }
}
