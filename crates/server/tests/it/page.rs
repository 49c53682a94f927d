//! The page: access to its files, caching by browsers, and its content policy.

use crate::harness::TestServer;
use rafcon_server::PageFiles;
use std::path::Path;

/// A page of three files.
pub(crate) fn page(folder: &Path) -> PageFiles {
    let page = folder.join("dist");
    std::fs::create_dir_all(page.join("assets")).unwrap();
    for (name, text) in
        [("index.html", "<!doctype html>"), ("popout.html", ""), ("assets/a-1.js", "let a")]
    {
        std::fs::write(page.join(name), text).unwrap();
    }
    PageFiles::Folder(page)
}

#[test]
fn everybody_gets_the_page_and_browsers_keep_what_never_changes() {
    let place = tempfile::tempdir().unwrap();
    let server = TestServer::with(|settings| settings.page = page(place.path()));
    let get = |path: &str| server.call(None, "GET", path, None);
    let index = get("/?machine=m1");
    assert_eq!((index.status, index.text.as_str()), (200, "<!doctype html>"));
    assert_eq!(index.header("content-type"), Some("text/html; charset=utf-8"));
    assert_eq!(index.header("cache-control"), Some("no-cache"));
    assert!(index.header("etag").is_some_and(|tag| tag.starts_with("W/\"")), "{index:?}");
    assert_eq!(index.header("referrer-policy"), Some("no-referrer"));
    let policy = index.header("content-security-policy").unwrap();
    for rule in ["default-src 'self'", "frame-ancestors 'none'", "worker-src 'self' blob:"] {
        assert!(policy.contains(rule), "{policy}");
    }
    assert!(!policy.contains("script-src") && !policy.contains("eval"), "{policy}");
    let asset = get("/assets/a-1.js");
    assert_eq!((asset.status, asset.text.as_str()), (200, "let a"));
    assert_eq!(asset.header("content-type"), Some("text/javascript; charset=utf-8"));
    assert_eq!(asset.header("cache-control"), Some("public, max-age=31536000, immutable"));
    assert_eq!(get("/popout.html").status, 200);
}

#[test]
fn what_is_no_file_of_the_page_is_not_there() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("secret.js"), "x").unwrap();
    let server = TestServer::with(|settings| settings.page = page(place.path()));
    let said = |path: &str| server.call(None, "GET", path, None).said();
    assert_eq!(said("/assets/none.js"), "404 no_such_file");
    assert_eq!(said("/assets/..%2f..%2fsecret.js"), "404 no_such_file");
    assert_eq!(said("/assets/%2fetc%2fpasswd"), "404 no_such_file");
    assert_eq!(said("/secret.js"), "404 no_such_route");
    assert_eq!(said("/machines/m1"), "404 no_such_route");
}

#[test]
fn where_the_page_was_not_built_it_says_how() {
    let place = tempfile::tempdir().unwrap();
    let server =
        TestServer::with(|settings| settings.page = PageFiles::Folder(place.path().to_owned()));
    let page = server.call(None, "GET", "/", None);
    assert_eq!(page.status, 200);
    assert!(page.text.contains("cargo xtask web"), "{page:?}");
}

#[test]
fn what_else_the_start_link_says_is_kept() {
    let server = TestServer::new();
    let to = |path: &str| {
        let answer = server.call(None, "GET", path, None);
        answer.header("location").map(str::to_owned)
    };
    let path = format!("/?machine=m1&token={}&follow=a%2Fb", server.owner());
    assert_eq!(to(&path).as_deref(), Some("./?machine=m1&follow=a%2Fb"));
    assert_eq!(to("/?token=wrong&x=//elsewhere").as_deref(), Some("./?x=//elsewhere"));
}
