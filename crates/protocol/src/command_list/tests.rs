//! Lists of commands from short texts, and the fault of each line, by a clock that the tests set.

use super::*;
use expect_test::{Expect, expect};

const PLAN: &str = r#"[
    {"begin": "2026-11-28T13:00:00Z", "end": "2026-11-28T13:20:00Z", "profile": "deep"},
    {"begin": "2026-11-28T15:00:00Z", "end": "2026-11-28T15:20:00Z", "profile": "deep"}
]"#;

/// A time such as `14:05`, or `13:00+30`: seconds after the begin of a contact.
fn time(text: &str) -> Option<ListTime> {
    let utc = |text: &str| format!("2026-11-28T{text}:00Z");
    match text.split_once('+') {
        _ if text == "-" => None,
        None => Some(ListTime::Utc(utc(text))),
        Some((begin, after)) => {
            let after_s = after.parse().unwrap();
            Some(ListTime::Contact(ContactTime { contact: utc(begin), after_s }))
        }
    }
}

/// Checks lines of `RUN NOT_BEFORE EXPIRY` at noon. Each list is read as it is written.
fn check(lines: &[&str], expect: &Expect) {
    let listed = |line: &&str| {
        let [run, not_before, expiry]: [&str; 3] =
            line.split(' ').collect::<Vec<_>>().try_into().unwrap();
        ListedCommand {
            run: run.to_owned(),
            command: Command::Pause,
            not_before: time(not_before),
            expiry: time(expiry),
        }
    };
    let list: Vec<_> = lines.iter().map(listed).collect();
    let json = serde_json::to_string(&list).unwrap();
    assert_eq!(ListedCommand::list_of_text(&json), Ok(list.clone()));
    let plan = ContactPlan::of_text(PLAN).unwrap();
    let now_ms = utc_ms("2026-11-28T12:00:00Z").unwrap();
    let text = |ms: Option<u64>| ms.map_or("-".to_owned(), utc_text);
    let said = list_times(&list, &plan, now_ms).into_iter().map(|times| match times {
        Ok(times) => format!("{} {}\n", text(times.not_before_ms), text(times.expiry_ms)),
        Err(fault) => format!("{fault}\n"),
    });
    expect.assert_eq(&said.collect::<String>());
}

/// Reads a text, and writes the list or the error.
fn check_text(text: &str, expect: &Expect) {
    let read = ListedCommand::list_of_text(text);
    let said = read.map(|list| serde_json::to_string(&list).unwrap());
    expect.assert_eq(&said.unwrap_or_else(|error| error.to_string()));
}

#[test]
fn times_are_in_utc_or_after_the_begin_of_a_contact() {
    check(
        &["a - -", "a 13:00+30 13:30", "b 14:05 15:00+600"],
        &expect![[r"
            - -
            2026-11-28T13:00:30Z 2026-11-28T13:30:00Z
            2026-11-28T14:05:00Z 2026-11-28T15:10:00Z
        "]],
    );
}

#[test]
fn each_line_has_its_own_fault_and_remedy() {
    check(
        &["a 11:59 -", "b - 12:00", "c 14:00 14:00", "d - 12:59", "e 13:05+0 -", "f - -"],
        &expect![[r"
            its time 2026-11-28T11:59:00Z is past: choose a later one
            its expiry 2026-11-28T12:00:00Z is past: choose a later one
            it expires at 2026-11-28T14:00:00Z and takes effect at 2026-11-28T14:00:00Z at the earliest: correct one of the times
            the command would expire at 2026-11-28T12:59:00Z, and the next contact begins at 2026-11-28T13:00:00Z: let it expire later than that, or change the contacts
            no planned contact begins at 2026-11-28T13:05:00Z: choose a contact of `rafcon contacts`
            - -
        "]],
    );
}

#[test]
fn the_commands_of_a_run_have_rising_times() {
    check(
        &["a - -", "b 14:00 -", "a - -", "b 14:00 -", "b 13:00+5 -", "a 15:00+0 -"],
        &expect![[r"
            - -
            2026-11-28T14:00:00Z -
            it has no later time than line 1 of this run: give it a later not_before, or move it up
            it has no later time than line 2 of this run: give it a later not_before, or move it up
            it has no later time than line 4 of this run: give it a later not_before, or move it up
            2026-11-28T15:00:00Z -
        "]],
    );
}

#[test]
fn a_text_that_is_no_list_is_refused_with_the_line_and_the_remedy() {
    check_text("[]", &expect!["[]"]);
    check_text(
        "{}",
        &expect![[
            r#"the commands are no list in JSON (it is another value): write [{"run": "RUN", "command": {"type": "pause"}, "not_before": "2026-11-28T14:00:00Z"}]"#
        ]],
    );
    check_text(
        "[",
        &expect![[
            r#"the commands are no list in JSON (EOF while parsing a list at line 1 column 1): write [{"run": "RUN", "command": {"type": "pause"}, "not_before": "2026-11-28T14:00:00Z"}]"#
        ]],
    );
    check_text(
        r#"[{"run":"a"}]"#,
        &expect![
            "line 1: missing field `command`; a line has run, command and, if you like, not_before and expiry"
        ],
    );
    check_text(
        r#"[{"run":"a","command":{"type":"dance"}}]"#,
        &expect![
            "line 1: unknown variant `dance`, expected one of `start`, `pause`, `resume`, `stop`, `kill`, `step_mode`, `step_into`, `step_over`, `step_out`, `step_back`, `run_to`, `run_selected`, `run_only_selected`, `start_from_history`, `force_outcome`, `preempt`, `set_breakpoint`, `remove_breakpoint`, `answer_question`, `recover`, `reload`, `edit_script`, `control`; a line has run, command and, if you like, not_before and expiry"
        ],
    );
    check_text(
        r#"[{"run":"a","command":{"type":"pause"},"later":1}]"#,
        &expect![
            "line 1: unknown field `later`, expected one of `run`, `command`, `not_before`, `expiry`; a line has run, command and, if you like, not_before and expiry"
        ],
    );
    let timed = |time: &str| format!(r#"[{{"run":"a","command":{{"type":"pause"}},{time}}}]"#);
    check_text(
        &timed(r#""not_before":"noon""#),
        &expect![[
            r#"line 1: not_before: "noon" is no time in UTC: write it like 2026-11-28T14:00:00Z"#
        ]],
    );
    check_text(
        &timed(r#""expiry":{"contact":"noon","after_s":1}"#),
        &expect![[
            r#"line 1: expiry: "noon" is no time in UTC: write it like 2026-11-28T14:00:00Z"#
        ]],
    );
    check_text(
        &timed(r#""expiry":{"contact":"2026-11-28T13:00:00Z"}"#),
        &expect![[
            r#"line 1: expiry is no time: write "2026-11-28T14:00:00Z" or {"contact": "2026-11-28T14:00:00Z", "after_s": 30}"#
        ]],
    );
    check_text(
        &timed(r#""not_before":null"#),
        &expect![[r#"[{"run":"a","command":{"type":"pause"}}]"#]],
    );
}

#[test]
fn a_list_has_at_most_so_many_commands() {
    let list = |count| {
        let line = serde_json::json!({ "run": "a", "command": { "type": "pause" } });
        ListedCommand::list_of_json(&Value::Array(vec![line; count])).map(|list| list.len())
    };
    assert_eq!(list(LISTED_MAX), Ok(LISTED_MAX));
    assert_eq!(list(LISTED_MAX + 1), Err(BadCommandList::TooMany(LISTED_MAX + 1)));
}

#[test]
fn all_faults_are_named_with_their_lines() {
    let line = |fault: Option<&str>| ListLine {
        listed: ListedCommand {
            run: "r".to_owned(),
            command: Command::Stop,
            not_before: None,
            expiry: None,
        },
        not_before_ms: None,
        expires_ms: None,
        send_at_ms: None,
        effect_ms: None,
        fault: fault.map(str::to_owned),
        fate: None,
    };
    let lines = vec![line(Some("too late")), line(None), line(Some("unknown"))];
    let list = CommandList { revision: String::new(), released: None, lines };
    expect![[r"
        line 1 (stop of run r): too late
        line 3 (stop of run r): unknown"]]
    .assert_eq(&list.faults().join("\n"));
}
