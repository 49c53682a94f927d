//! `rafcon user` and the beginning and end of `rafcon serve`, as whoever looks after a server meets them.

use crate::harness::{Answer, Place, Run};
use expect_test::{Expect, expect};
use rustix::process::Signal;
use std::io::Write as _;
use std::os::unix::fs::PermissionsExt as _;
use std::process::Stdio;

/// Calls the program with a password in its pipe.
fn with_password(place: &Place, words: &str, password: &str) -> Answer {
    let mut command = place.command(words);
    let command = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(format!("{password}\n").as_bytes()).unwrap();
    place.answer(&child.wait_with_output().unwrap())
}

fn check(answer: &Answer, expected: &Expect) {
    let code = answer.code.unwrap_or(-1);
    expected.assert_eq(&format!("{code}\n{}{}", answer.stdout, answer.stderr));
}

#[test]
fn users_are_added_listed_changed_and_removed() {
    let place = Place::empty();
    check(
        &with_password(&place, "user add anna --role operator", "correct horse"),
        &expect![["0\n"]],
    );
    check(
        &with_password(&place, "user add bob --role viewer", "short"),
        &expect![[r"
            1
            error: a password has 10 characters at least and 1024 bytes at most: choose another
        "]],
    );
    check(&place.call("user role anna engineer"), &expect![["0\n"]]);
    check(&with_password(&place, "user password anna", "another horse"), &expect![["0\n"]]);
    check(
        &place.call("user list"),
        &expect![[r"
        0
        anna  engineer
    "]],
    );
    check(&place.call("user remove anna"), &expect![["0\n"]]);
    check(
        &place.call("user remove anna"),
        &expect![[r"
            1
            error: there is no user anna: `rafcon user list` names them
        "]],
    );
}

#[test]
fn a_token_is_printed_once_and_kept_as_a_digest() {
    let place = Place::empty();
    let made = place.call("user token owner --for ci --role viewer --days 7");
    assert_eq!((made.code, made.stdout.trim().len()), (Some(0), 64), "{made:?}");
    let kept = place.path(".local/state/rafcon/server/users.json");
    assert_eq!(kept.metadata().unwrap().permissions().mode() & 0o777, 0o600);
    let text = std::fs::read_to_string(kept).unwrap();
    assert!(text.contains("\"ci\"") && !text.contains(made.stdout.trim()), "{text}");
}

#[test]
fn a_server_prints_the_way_in_and_ends_in_order() {
    let place = Place::empty();
    std::fs::create_dir(place.path("robots")).unwrap();
    let mut server = Run::of(place.command("serve robots --bind 127.0.0.1:0"));
    let link = server.wait_for("?token=");
    let state = place.path(".local/state/rafcon/server");
    let token = std::fs::read_to_string(state.join("token")).unwrap();
    assert!(link.starts_with("http://127.0.0.1:") && link.ends_with(&token), "{link}");
    assert_eq!(state.metadata().unwrap().permissions().mode() & 0o777, 0o700);
    let second = place.call("serve robots --bind 127.0.0.1:0");
    assert_eq!(second.code, Some(1));
    assert!(second.stderr.contains("name another folder with --state"), "{second:?}");
    assert!(state.join("server.json").exists());
    server.signal(Signal::TERM);
    let (code, _, said) = server.end();
    assert_eq!((code, said.as_str()), (Some(0), ""));
    assert!(!state.join("server.json").exists());
}

#[test]
fn what_cannot_be_served_is_said() {
    let place = Place::empty();
    check(
        &place.call("serve nowhere"),
        &expect![[r"
            1
            error: the folder nowhere does not exist
              because: No such file or directory (os error 2)
        "]],
    );
    check(
        &place.call("serve --bind 0.0.0.0:0"),
        &expect![[r"
            1
            error: other computers reach 0.0.0.0:0, and nobody could log in: add a user first, with `rafcon user add NAME --role admin`
        "]],
    );
}
