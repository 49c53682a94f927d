//! Authentication: who is admitted, for how long, and how that ends.

use crate::harness::{Answer, PASSWORD, TestServer, name};
use crate::raw::{ask, status};
use rafcon_protocol::api::Role;
use rafcon_server::access::Users;
use rafcon_server::settings::HashCost;
use rafcon_server::{ServeError, Server, Settings};
use serde_json::{Value, json};
use std::net::Ipv4Addr;

/// The user and role of a token, or the refusal.
fn who(server: &TestServer, token: &str) -> String {
    let answer = server.ask(Some(token), "GET", "/api/v1/session", None);
    if answer.status == 200 {
        let session = answer.json();
        return format!(
            "{} {}",
            session["user"].as_str().unwrap(),
            session["role"].as_str().unwrap()
        );
    }
    answer.said()
}

/// Logs in and returns the cookie.
fn log_in(server: &TestServer, user: &str, password: &str) -> Result<String, String> {
    let login = json!({"user": user, "password": password});
    let answer = server.call(None, "POST", "/api/v1/session", Some(&login));
    let cookie = answer.header("set-cookie").and_then(|cookie| cookie.split(';').next());
    cookie.map(str::to_owned).ok_or_else(|| answer.said())
}

/// Sends a request with a cookie, like a page of the server.
fn by_cookie(server: &TestServer, cookie: &str, method: &str, path: &str, body: &Value) -> Answer {
    server.send(method, path, &[("Cookie", cookie), ("Origin", server.url())], Some(body))
}

fn who_by_cookie(server: &TestServer, cookie: &str) -> u16 {
    let host = server.address().to_string();
    status(&ask(server, "GET /api/v1/session", &[("Host", &host), ("Cookie", cookie)]))
}

#[test]
fn tokens_let_in_and_nothing_else_does() {
    let server = TestServer::new();
    let said = |token| server.ask(token, "GET", "/api/v1/projects", None).said();
    assert_eq!(said(None), "401 not_logged_in");
    assert_eq!(said(Some("wrong")), "401 not_known");
    assert_eq!(said(Some(server.token(Role::Viewer))), "200");
    assert_eq!(said(Some(server.owner())), "200");
    let by_link = format!("/api/v1/projects?token={}", server.owner());
    assert_eq!(server.call(None, "GET", &by_link, None).said(), "401 not_logged_in");
    assert_eq!(server.call(None, "GET", "/api/v1/health", None).said(), "200");
}

#[test]
fn the_start_link_becomes_a_cookie_and_leaves_the_address() {
    let server = TestServer::new();
    let answer = server.call(None, "GET", &format!("/?token={}", server.owner()), None);
    assert_eq!((answer.status, answer.header("location")), (303, Some("./")));
    let cookie = answer.header("set-cookie").unwrap().to_owned();
    assert!(cookie.ends_with("; Path=/; HttpOnly; SameSite=Strict"), "{cookie}");
    assert!(!cookie.contains(server.owner()), "{cookie}");
    let cookie = cookie.split(';').next().unwrap();
    assert_eq!(who_by_cookie(&server, cookie), 200);
    let wrong = server.call(None, "GET", "/?token=wrong", None);
    assert_eq!((wrong.status, wrong.header("set-cookie")), (303, None));
}

#[test]
fn the_token_of_the_start_link_is_new_each_time_unless_it_is_kept() {
    let server = TestServer::new();
    let first = server.owner().to_owned();
    let server = TestServer::at(server.end(), |settings| settings.access.keep_token = true);
    assert_eq!(server.owner(), first);
    let server = TestServer::at(server.end(), |_settings| {});
    assert_ne!(server.owner(), first);
    assert_eq!(who(&server, &first), "401 not_known");
}

#[test]
fn a_login_and_a_token_outlive_the_server() {
    let server = TestServer::new();
    let address = server.address();
    let (token, cookie) =
        (server.token(Role::Viewer).to_owned(), log_in(&server, "viewer", PASSWORD));
    let server = TestServer::at(server.end(), |settings| settings.listen.address = address);
    assert_eq!(who(&server, &token), "viewer viewer");
    assert_eq!(who_by_cookie(&server, &cookie.unwrap()), 200);
}

#[test]
fn a_token_that_was_deleted_or_is_over_lets_nobody_in() {
    let server = TestServer::new();
    let cookie = log_in(&server, "engineer", PASSWORD).unwrap();
    let make = |wanted: Value| by_cookie(&server, &cookie, "POST", "/api/v1/tokens", &wanted);
    let made = make(json!({"name": "ci", "role": "operator"})).json();
    let token = made["token"].as_str().unwrap();
    assert_eq!(who(&server, token), "engineer operator");
    let path = format!("/api/v1/tokens/{}", made["id"].as_str().unwrap());
    assert_eq!(server.call(Some(Role::Viewer), "DELETE", &path, None).said(), "404 no_such_token");
    assert_eq!(server.call(Some(Role::Engineer), "DELETE", &path, None).said(), "204");
    assert_eq!(who(&server, token), "401 not_known");
    let over = make(json!({"name": "ci", "lifetime_s": 0})).json();
    assert_eq!(who(&server, over["token"].as_str().unwrap()), "401 not_known");
    assert_eq!(make(json!({"name": "ci", "role": "admin"})).said(), "403 not_your_right");
    assert_eq!(make(json!({"name": ""})).said(), "400 bad_token_name");
}

#[test]
fn the_bridge_to_ros_is_an_operator_of_this_computer_until_the_server_ends() {
    let server = TestServer::new();
    let bridge = server.ros().to_owned();
    let said = |method, path, body: Option<Value>| {
        server.ask(Some(&bridge), method, path, body.as_ref()).said()
    };
    assert_eq!(who(&server, &bridge), "ros operator");
    assert_eq!(said("GET", "/api/v1/projects", None), "200");
    assert_eq!(said("GET", "/api/v1/users", None), "403 not_your_right");
    assert_eq!(said("POST", "/api/v1/tokens", Some(json!({"name": "x"}))), "409 not_a_login");
    let server = TestServer::at(server.end(), |settings| settings.access.keep_token = true);
    assert_ne!(server.ros(), bridge);
    assert_eq!(who(&server, &bridge), "401 not_known");
}

#[test]
fn a_token_makes_no_token_and_changes_no_password() {
    let server = TestServer::new();
    let said =
        |method, path, body| server.call(Some(Role::Admin), method, path, Some(&body)).said();
    assert_eq!(said("POST", "/api/v1/tokens", json!({"name": "x"})), "409 not_a_login");
    let change = json!({"password": PASSWORD, "new_password": "another horse"});
    assert_eq!(said("PUT", "/api/v1/session/password", change), "409 not_a_login");
}

#[test]
fn who_was_removed_or_demoted_has_lost_the_right_at_once() {
    let server = TestServer::new();
    let admin = |method, path, body: Option<Value>| {
        server.call(Some(Role::Admin), method, path, body.as_ref()).said()
    };
    let cookie = log_in(&server, "engineer", PASSWORD).unwrap();
    assert_eq!(admin("PATCH", "/api/v1/users/engineer", Some(json!({"role": "viewer"}))), "204");
    assert_eq!(who(&server, server.token(Role::Engineer)), "engineer viewer");
    assert_eq!(admin("DELETE", "/api/v1/users/engineer", None), "204");
    assert_eq!(who(&server, server.token(Role::Engineer)), "401 not_known");
    assert_eq!(who_by_cookie(&server, &cookie), 401);
    let again = json!({"name": "engineer", "role": "engineer", "password": PASSWORD});
    assert_eq!(admin("POST", "/api/v1/users", Some(again)), "201");
    assert_eq!(who_by_cookie(&server, &cookie), 401);
    assert_eq!(admin("DELETE", "/api/v1/users/admin", None), "409 last_admin");
}

#[test]
fn what_the_command_line_changes_counts_at_once() {
    let server = TestServer::new();
    let users = Users::open(&server.state(), HashCost { memory_kib: 8, passes: 1 }).unwrap();
    users.change(name(Role::Operator), Some(Role::Viewer), None).unwrap();
    assert_eq!(who(&server, server.token(Role::Operator)), "operator viewer");
    users.remove(name(Role::Operator)).unwrap();
    assert_eq!(who(&server, server.token(Role::Operator)), "401 not_known");
}

#[test]
fn another_password_ends_the_other_logins() {
    let server = TestServer::new();
    let (own, other) = (log_in(&server, "viewer", PASSWORD), log_in(&server, "viewer", PASSWORD));
    let (own, other) = (own.unwrap(), other.unwrap());
    let change = |password: &str, new: &str| {
        let body = json!({"password": password, "new_password": new});
        by_cookie(&server, &own, "PUT", "/api/v1/session/password", &body).said()
    };
    assert_eq!(change("wrong", "another horse"), "401 wrong_login");
    assert_eq!(change(PASSWORD, "short"), "400 bad_password");
    assert_eq!(change(PASSWORD, "another horse"), "204");
    assert_eq!((who_by_cookie(&server, &own), who_by_cookie(&server, &other)), (200, 401));
    assert_eq!(log_in(&server, "viewer", PASSWORD), Err("401 wrong_login".to_owned()));
    assert!(log_in(&server, "viewer", "another horse").is_ok());
    assert_eq!(who(&server, server.token(Role::Viewer)), "viewer viewer");
}

#[test]
fn who_came_and_who_was_refused_is_on_record_and_no_secret_is() {
    let server = TestServer::new();
    log_in(&server, "viewer", PASSWORD).unwrap();
    log_in(&server, "viewer", "wrong horse").unwrap_err();
    server.call(Some(Role::Viewer), "GET", "/api/v1/users", None);
    let (viewer, owner) = (server.token(Role::Viewer).to_owned(), server.owner().to_owned());
    let place = server.end();
    let read = |file: &str| std::fs::read_to_string(place.path().join("state").join(file)).unwrap();
    let (record, kept) = (read("audit.jsonl"), read("users.json"));
    for what in ["\"login\"", "\"wrong_login\"", "\"refused\",\"about\":\"GET /api/v1/users\""] {
        assert!(record.contains(what), "{record}");
    }
    for secret in [PASSWORD, "wrong horse", &viewer, &owner] {
        assert!(!record.contains(secret), "{record}");
    }
    assert!(!kept.contains(PASSWORD) && !kept.contains(&viewer), "{kept}");
}

/// The error at the start of a server.
fn refused(settings: Settings) -> ServeError {
    let runtime = tokio::runtime::Runtime::new().unwrap();
    runtime.block_on(Server::bind(settings)).unwrap_err()
}

#[test]
fn a_folder_has_one_server_and_a_port_too() {
    let server = TestServer::new();
    let place = tempfile::tempdir().unwrap();
    let mut settings = Settings::new(server.state(), server.runs());
    settings.listen.address = (Ipv4Addr::LOCALHOST, 0).into();
    assert!(matches!(refused(settings), ServeError::Taken { .. }));
    let mut settings = Settings::new(place.path().join("state"), server.runs());
    settings.listen.address = server.address();
    assert!(matches!(refused(settings), ServeError::Busy { .. }));
}

#[test]
fn where_others_reach_it_there_is_no_server_without_users() {
    let place = tempfile::tempdir().unwrap();
    let mut settings = Settings::new(place.path().join("state"), place.path().join("runs"));
    settings.listen.address = (Ipv4Addr::UNSPECIFIED, 0).into();
    assert!(matches!(refused(settings), ServeError::Nobody { .. }));
}
