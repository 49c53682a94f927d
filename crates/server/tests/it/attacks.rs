//! Attacks: foreign names, foreign pages, endless bodies, missing heads, paths out of the project, guessed passwords.

use crate::harness::{PASSWORD, TestServer, name};
use crate::machines::{MACHINE, write};
use crate::raw::{Raw, ask, log_in, login_from, status};
use rafcon_protocol::api::Role;
use rafcon_server::Settings;
use rafcon_server::settings::HashCost;
use serde_json::json;
use std::time::Duration;

/// The status of a request that a page of another site causes in a browser.
fn asked_by(server: &TestServer, line: &str, host: &str, origin: Option<&str>) -> u16 {
    let bearer = format!("Bearer {}", server.token(Role::Admin));
    let mut head = vec![("Host", host), ("Authorization", &bearer)];
    head.extend(origin.map(|origin| ("Origin", origin)));
    status(&ask(server, line, &head))
}

#[test]
fn a_name_that_leads_here_by_a_trick_is_not_answered() {
    let server = TestServer::new();
    let own = server.address().to_string();
    for line in ["GET /api/v1/projects", "GET /", "GET /nothing", "GET /api/v1/health"] {
        let foreign = format!("evil.example:{}", server.address().port());
        assert_eq!(asked_by(&server, line, &foreign, None), 421, "{line}");
        assert_eq!(asked_by(&server, line, "", None), 421, "{line}");
        assert_ne!(asked_by(&server, line, &own, None), 421, "{line}");
    }
    assert_eq!(asked_by(&server, "GET /api/v1/health", "127.0.0.1", None), 421);
}

#[test]
fn a_page_of_somebody_else_changes_nothing_and_opens_no_socket() {
    let server = TestServer::new();
    let own = server.address().to_string();
    let post = |origin: Option<&str>| asked_by(&server, "POST /api/v1/runs/prune", &own, origin);
    assert_eq!(post(Some("http://evil.example")), 403);
    assert_eq!(post(Some("null")), 403);
    assert_eq!(post(Some(&format!("https://{own}"))), 403);
    assert_eq!(post(Some(&format!("http://{own}"))), 400);
    assert_eq!(post(None), 400);
    let socket = |origin: &str| {
        let token = server.token(Role::Viewer);
        let mut raw = Raw::to(&server);
        raw.say(format!(
            "GET /api/v1/socket?token={token} HTTP/1.1\r\nHost: {own}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nOrigin: {origin}\r\n\r\n"
        ));
        status(&raw.head())
    };
    assert_eq!(socket("http://evil.example"), 403);
    assert_eq!(socket(&format!("http://{own}")), 101);
}

#[test]
fn a_cookie_counts_on_pages_of_this_server_only() {
    let server = TestServer::new();
    let own = server.address().to_string();
    let login = json!({"user": "engineer", "password": PASSWORD});
    let answer = server.call(None, "POST", "/api/v1/session", Some(&login));
    let cookie = answer.header("set-cookie").unwrap().split(';').next().unwrap().to_owned();
    let ask = |line: &str, origin: Option<&str>| {
        let mut head = vec![("Host", own.as_str()), ("Cookie", cookie.as_str())];
        head.extend(origin.map(|origin| ("Origin", origin)));
        status(&ask(&server, line, &head))
    };
    assert_eq!(ask("GET /api/v1/session", None), 200);
    assert_eq!(ask("DELETE /api/v1/session", None), 403);
    assert_eq!(ask("DELETE /api/v1/session", Some("http://evil.example")), 403);
    assert_eq!(ask("DELETE /api/v1/session", Some(&format!("http://{own}"))), 204);
    assert_eq!(ask("GET /api/v1/session", None), 401);
}

#[test]
fn a_body_of_a_hundred_megabytes_is_refused() {
    let server = TestServer::new();
    for (path, role) in [("/api/v1/session", None), ("/api/v1/users", Some(Role::Admin))] {
        let mut raw = Raw::to(&server);
        raw.say(head(&server, path, role, "Content-Length: 100000000"));
        let mega = vec![b' '; 1 << 20];
        let taken = (0..100).take_while(|_| raw.say(&mega)).count();
        let answer = raw.rest();
        // A server that has responded and closed the connection may reset it before the response is read.
        assert!([0, 413].contains(&status(&answer)), "{answer}");
        assert!(taken < 100, "all of it was taken");
    }
    assert_eq!(server.call(None, "GET", "/api/v1/health", None).status, 200);
}

#[test]
fn a_body_that_is_just_too_large_is_told_so() {
    let server = TestServer::new();
    let said = |path: &str, role, bytes: usize| {
        let body = json!({"user": "x".repeat(bytes), "password": ""});
        server.call(role, "POST", path, Some(&body)).said()
    };
    assert_eq!(said("/api/v1/session", None, 17 << 10), "413 body_too_large");
    assert_eq!(said("/api/v1/users", Some(Role::Admin), 9 << 20), "413 body_too_large");
}

#[test]
fn a_body_without_end_is_refused() {
    let server = TestServer::new();
    let mut raw = Raw::to(&server);
    raw.say(head(&server, "/api/v1/session", None, "Transfer-Encoding: chunked"));
    let chunk = [b"100000\r\n".as_slice(), &vec![b' '; 1 << 20], b"\r\n"].concat();
    let taken = (0..100).take_while(|_| raw.say(&chunk)).count();
    assert!(taken < 100, "all of it was taken");
    assert!([0, 413].contains(&status(&raw.rest())));
}

/// The head of a request with a body.
fn head(server: &TestServer, path: &str, role: Option<Role>, length: &str) -> String {
    let bearer = role.map(|role| format!("Authorization: Bearer {}\r\n", server.token(role)));
    format!(
        "POST {path} HTTP/1.1\r\nHost: {}\r\n{}Content-Type: application/json\r\n{length}\r\n\r\n",
        server.address(),
        bearer.unwrap_or_default()
    )
}

/// A server with short timeouts.
fn impatient() -> TestServer {
    TestServer::with(|settings| {
        settings.listen.head_patience = Duration::from_secs(1);
        settings.listen.body_patience = Duration::from_secs(1);
    })
}

#[test]
fn a_head_that_never_ends_is_hung_up_on() {
    let server = impatient();
    for begun in ["", "GET /api/v1/health HTTP/1.1\r\nHost: 127", "G"] {
        let mut raw = Raw::to(&server);
        raw.say(begun);
        assert!([0, 408].contains(&status(&raw.rest())), "{begun}");
    }
}

#[test]
fn a_connection_that_stays_for_nothing_is_hung_up_on() {
    let server = impatient();
    let mut raw = Raw::to(&server);
    raw.say(format!("GET /api/v1/health HTTP/1.1\r\nHost: {}\r\n\r\n", server.address()));
    assert_eq!(status(&raw.rest()), 200);
}

#[test]
fn a_body_that_stops_coming_is_hung_up_on() {
    let server = impatient();
    let mut raw = Raw::to(&server);
    raw.say(head(&server, "/api/v1/session", None, "Content-Length: 100"));
    raw.say("{\"user\":");
    assert_eq!(status(&raw.rest()), 400);
}

#[test]
fn a_head_without_bounds_is_refused() {
    let server = TestServer::new();
    let mut raw = Raw::to(&server);
    raw.say(format!("GET /api/v1/health HTTP/1.1\r\nHost: {}\r\n", server.address()));
    let line = format!("X-Long: {}\r\n", "x".repeat(10_000));
    let taken = (0..1000).take_while(|_| raw.say(&line)).count();
    assert!(taken < 1000, "all of it was taken");
    assert!([0, 431].contains(&status(&raw.rest())));
}

#[test]
fn where_all_places_are_taken_who_is_logged_in_keeps_theirs() {
    let server = TestServer::with(|settings| settings.listen.connections_max = 2);
    let mut known = [Raw::to(&server), Raw::to(&server)];
    for (connection, role) in known.iter_mut().zip([Role::Admin, Role::Operator]) {
        connection.say(health(&server, Some(role)));
        assert_eq!(status(&connection.head()), 200);
    }
    let mut late = Raw::to(&server);
    late.say(health(&server, None));
    assert_eq!(status(&late.rest()), 0);
    drop(known);
}

#[test]
fn connections_that_never_read_do_not_keep_out_who_has_to_stop_a_robot() {
    let server = TestServer::with(|settings| settings.listen.connections_max = 4);
    let mut strangers: Vec<Raw> = (0..20).map(|_| Raw::to(&server)).collect();
    for stranger in &mut strangers {
        stranger.say(health(&server, None));
    }
    let mut operator = Raw::to(&server);
    operator.say(health(&server, Some(Role::Operator)));
    assert_eq!(status(&operator.head()), 200);
    let more: Vec<Raw> = (0..20).map(|_| Raw::to(&server)).collect();
    operator.say(health(&server, Some(Role::Operator)));
    assert_eq!(status(&operator.head()), 200);
    drop((strangers, more));
}

fn health(server: &TestServer, role: Option<Role>) -> String {
    let bearer = role.map(|role| format!("Authorization: Bearer {}\r\n", server.token(role)));
    let (host, bearer) = (server.address(), bearer.unwrap_or_default());
    format!("GET /api/v1/health HTTP/1.1\r\nHost: {host}\r\n{bearer}\r\n")
}

#[test]
fn a_request_that_names_two_hosts_is_refused() {
    let server = TestServer::new();
    let own = server.address().to_string();
    for others in [["evil.example", &own], [&own, "evil.example"], [&own, &own]] {
        let head = others.map(|host| ("Host", host));
        assert_eq!(status(&ask(&server, "GET /api/v1/health", &head)), 400, "{others:?}");
    }
    let named = |target: &str| {
        let line = format!("GET http://{target}/api/v1/health");
        status(&ask(&server, &line, &[("Host", &own)]))
    };
    assert_eq!((named("evil.example"), named(&own)), (400, 200));
}

#[test]
fn no_path_leads_out_of_a_project() {
    let server = TestServer::new();
    let outside = server.state().join("secret");
    std::fs::create_dir_all(&outside).unwrap();
    std::os::unix::fs::symlink(&outside, server.project().join("link")).unwrap();
    let bearer = format!("Bearer {}", server.token(Role::Admin));
    let host = server.address().to_string();
    let head = [("Host", host.as_str()), ("Authorization", bearer.as_str())];
    let ways = [
        "..",
        "../state",
        "%2e%2e/state",
        "..%2fstate",
        "a/../../state",
        "/etc",
        "link",
        "%00",
        "link/..",
    ];
    for way in ways {
        let addresses = [
            format!("GET /api/v1/projects/project/tree?path={way}"),
            format!("GET /api/v1/projects/{way}/tree"),
            format!("GET /api/v1/libraries/project/{way}"),
            format!("GET /api/v1/runs/{way}/output"),
            format!("GET /api/v1/runs/{way}"),
        ];
        for line in addresses {
            let answer = ask(&server, &line, &head);
            assert!((400..500).contains(&status(&answer)), "{line}: {answer}");
            assert!(!answer.contains("secret"), "{line}: {answer}");
        }
        let file = json!({"file": {"project": "project", "path": way}, "name": "x"});
        for path in ["/api/v1/machines/open", "/api/v1/machines"] {
            let answer = server.call(Some(Role::Admin), "POST", path, Some(&file));
            let is_plain = way.starts_with('%') || way.starts_with("..%");
            assert!(is_plain || (400..500).contains(&answer.status), "{path} {way}: {answer:?}");
        }
    }
    assert_eq!(std::fs::read_dir(&outside).unwrap().count(), 0);
}

#[test]
fn no_link_in_a_machine_leads_out_of_the_project() {
    let server = TestServer::new();
    let outside = server.state().join("secret.py");
    std::fs::write(&outside, "secret = 1").unwrap();
    write(&server, "one", MACHINE);
    let script = std::fs::read_dir(server.project().join("one")).unwrap();
    let script = script.map(|entry| entry.unwrap().path().join("script.py"));
    let script = script.into_iter().find(|script| script.exists()).unwrap();
    std::fs::remove_file(&script).unwrap();
    std::os::unix::fs::symlink(&outside, &script).unwrap();
    let file = json!({"file": {"project": "project", "path": "one"}});
    let answer = server.call(Some(Role::Viewer), "POST", "/api/v1/machines/open", Some(&file));
    assert_eq!(answer.said(), "403 outside_project");
    assert!(answer.text.contains("script.py leads out"), "{answer:?}");
}

#[test]
fn ten_thousand_wrong_logins_open_nothing_and_lock_nobody_out() {
    let server = TestServer::new();
    let engineer = name(Role::Engineer);
    let right = json!({"user": engineer, "password": PASSWORD});
    assert_eq!(login_from([127, 0, 0, 2], &server, &right), 200);
    let guess = json!({"user": engineer, "password": "wrong"}).to_string();
    let request = |guess: &str| {
        format!(
            "POST /api/v1/session HTTP/1.1\r\nHost: {}\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n{guess}",
            server.address(),
            guess.len()
        )
    };
    let mut guesses = Raw::to(&server);
    let mut counts = std::collections::BTreeMap::new();
    for _ in 0..10_000 {
        guesses.say(request(&guess));
        let head = guesses.head();
        guesses.skip_body(&head);
        *counts.entry(status(&head)).or_insert(0) += 1;
    }
    let (tried, refused) = (counts[&401], counts[&429]);
    assert_eq!(tried + refused, 10_000, "{counts:?}");
    assert!((5..100).contains(&tried), "{counts:?}");
    // Meanwhile, a user at a familiar address can log in, and a token needs no login.
    assert_eq!(login_from([127, 0, 0, 2], &server, &right), 200);
    assert_eq!(server.call(Some(Role::Engineer), "GET", "/api/v1/session", None).status, 200);
}

#[test]
fn who_was_let_in_from_an_address_before_does_not_wait_for_a_flood_of_strangers() {
    let slow = |settings: &mut Settings| {
        settings.access.cost = HashCost { memory_kib: 64, passes: 400 };
    };
    let server = TestServer::with(slow);
    let right = json!({"user": name(Role::Operator), "password": PASSWORD});
    assert_eq!(login_from([127, 0, 0, 2], &server, &right), 200);
    let server = TestServer::at(server.end(), slow);
    let flood: Vec<Raw> = (1..=60_u8)
        .map(|number| {
            let guess = json!({"user": format!("nobody{number}"), "password": "wrong"});
            let mut raw = Raw::from([127, 0, 1, number], &server);
            raw.say(log_in(&server, &guess));
            raw
        })
        .collect();
    assert_eq!(login_from([127, 0, 0, 2], &server, &right), 200);
    let answered = flood.iter().filter(|raw| raw.has_answer()).count();
    assert!(answered < 30, "{answered} of 60 strangers were answered before");
}
