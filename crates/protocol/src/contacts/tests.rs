//! Plans from text, and the times that follow from them, by a clock that the tests set.

use super::*;
use crate::{Command, Envelope, Expiry, LinkHealth};
use expect_test::{Expect, expect};
use proptest::prelude::*;

/// A minute of the day of all tests, in ms since 1970.
fn at(minute: u64) -> u64 {
    utc_ms("2026-11-28T12:00:00Z").unwrap() + minute * 60_000
}

/// A plan with a contact for each pair of minutes.
fn plan(minutes: &[(u64, u64)]) -> ContactPlan {
    let contact = |(begin, end): &(u64, u64)| Contact {
        begin_ms: at(*begin),
        end_ms: at(*end),
        profile: "deep".to_owned(),
        note: None,
    };
    let plan = ContactPlan(minutes.iter().map(contact).collect());
    let windows = serde_json::to_value(plan.windows()).unwrap();
    assert_eq!(ContactPlan::of_json(&windows), Ok(plan.clone()));
    plan
}

/// Reads a list at the first minute, and writes the plan or the error.
fn check(list: &str, expect: &Expect) {
    let read = ContactPlan::of_text(list).and_then(|plan| {
        plan.check_future(at(0))?;
        Ok(plan)
    });
    let said = read.map(|plan| serde_json::to_string(&plan.windows()).unwrap());
    expect.assert_eq(&said.unwrap_or_else(|error| error.to_string()));
}

/// Windows from short texts such as `12:00 12:20 deep`.
fn list(windows: &[&str]) -> String {
    let window = |text: &&str| {
        let [begin, end, profile]: [&str; 3] =
            text.split(' ').collect::<Vec<_>>().try_into().unwrap();
        let day = |time: &str| format!("2026-11-28T{time}Z");
        serde_json::json!({ "begin": day(begin), "end": day(end), "profile": profile })
    };
    Value::Array(windows.iter().map(window).collect()).to_string()
}

#[test]
fn a_plan_is_read_as_it_is_written() {
    check("[]", &expect!["[]"]);
    check(
        &list(&["11:00 12:20 lan", "12:20 13:00 deep"]),
        &expect![[
            r#"[{"begin":"2026-11-28T11:00:00Z","end":"2026-11-28T12:20:00Z","profile":"lan"},{"begin":"2026-11-28T12:20:00Z","end":"2026-11-28T13:00:00Z","profile":"deep"}]"#
        ]],
    );
    check(
        r#"[{"begin":"2026-11-28T13:00Z","end":"2026-11-28T13:20:00Z","profile":"wifi","note":"Kiruna"}]"#,
        &expect![[
            r#"[{"begin":"2026-11-28T13:00:00Z","end":"2026-11-28T13:20:00Z","profile":"wifi","note":"Kiruna"}]"#
        ]],
    );
}

#[test]
fn a_list_that_is_no_plan_is_refused_with_the_window_and_the_remedy() {
    check(
        "{}",
        &expect![[
            r#"the contacts are no list in JSON (it is another value): write [{"begin": "2026-11-28T14:00:00Z", "end": "2026-11-28T14:20:00Z", "profile": "deep"}]"#
        ]],
    );
    check(
        "[",
        &expect![[
            r#"the contacts are no list in JSON (EOF while parsing a list at line 1 column 1): write [{"begin": "2026-11-28T14:00:00Z", "end": "2026-11-28T14:20:00Z", "profile": "deep"}]"#
        ]],
    );
    check(
        r#"[{"begin":"2026-11-28T14:00:00Z"}]"#,
        &expect![
            "window 1: missing field `end`; a window has begin, end, profile and, if you like, a note"
        ],
    );
    check(
        r#"[{"begin":"2026-11-28T14:00:00Z","ends":1}]"#,
        &expect![
            "window 1: unknown field `ends`, expected one of `begin`, `end`, `profile`, `note`; a window has begin, end, profile and, if you like, a note"
        ],
    );
    check(
        "[7]",
        &expect![
            "window 1: invalid type: integer `7`, expected struct ContactWindow; a window has begin, end, profile and, if you like, a note"
        ],
    );
    check(
        &list(&["13:00 13:20 deep", "14:00 noon deep"]),
        &expect![[
            r#"window 2: the end "2026-11-28TnoonZ" is no time in UTC: write it like 2026-11-28T14:00:00Z"#
        ]],
    );
    check(
        &list(&["13:00 13:20 laser"]),
        &expect![[
            r#"window 1: the profile "laser" is unknown: write lan, wifi, delay-2s or deep"#
        ]],
    );
}

#[test]
fn windows_in_a_wrong_order_are_refused_with_both_windows_and_the_remedy() {
    check(
        &list(&["13:20 13:20 deep"]),
        &expect![
            "window 1 (2026-11-28T13:20:00Z to 2026-11-28T13:20:00Z): it does not end after its begin: correct one of the times"
        ],
    );
    check(
        &list(&["13:00 13:20 deep", "13:30 13:25 deep"]),
        &expect![
            "window 2 (2026-11-28T13:30:00Z to 2026-11-28T13:25:00Z): it does not end after its begin: correct one of the times"
        ],
    );
    check(
        &list(&["13:00 13:20 deep", "13:19 13:40 deep"]),
        &expect![
            "window 2 (2026-11-28T13:19:00Z to 2026-11-28T13:40:00Z): it overlaps window 1 (2026-11-28T13:00:00Z to 2026-11-28T13:20:00Z): let it begin at 2026-11-28T13:20:00Z or later, or make one window of both"
        ],
    );
    check(
        &list(&["14:00 14:20 deep", "13:00 13:20 deep"]),
        &expect![
            "window 2 (2026-11-28T13:00:00Z to 2026-11-28T13:20:00Z): it is earlier than window 1 (2026-11-28T14:00:00Z to 2026-11-28T14:20:00Z): put the windows in the order of their times"
        ],
    );
    check(
        &list(&["10:00 10:20 deep", "11:00 12:00 deep"]),
        &expect![
            "window 2 (2026-11-28T11:00:00Z to 2026-11-28T12:00:00Z): this last window is in the past; add a window that ends after 2026-11-28T12:00:00Z, or clear the contacts"
        ],
    );
}

#[test]
fn a_plan_has_at_most_so_many_windows() {
    let windows: Vec<_> = (0..=WINDOWS_MAX as u64).map(|nth| (nth, nth + 1)).collect();
    let most = plan(&windows[..WINDOWS_MAX]);
    assert_eq!(most.current(at(999)).map(|contact| contact.begin_ms), Some(at(999)));
    let mut all = serde_json::to_value(most.windows()).unwrap();
    all.as_array_mut().unwrap().push(Value::Null);
    let refused = ContactPlan::of_json(&all).unwrap_err().to_string();
    assert_eq!(refused, "the list has 1001 windows and the limit is 1000: remove the latest ones");
}

#[test]
fn a_note_is_one_line_of_at_most_so_many_characters() {
    let read = |note: &str| {
        let mut windows = serde_json::to_value(plan(&[(60, 80)]).windows()).unwrap();
        windows[0]["note"] = note.into();
        ContactPlan::of_json(&windows).map(|plan| plan.contacts()[0].note.clone())
    };
    let longest = "é".repeat(NOTE_MAX);
    assert_eq!(read(&longest), Ok(Some(longest.clone())));
    assert_eq!(read(""), Ok(None));
    for note in [format!("{longest}e"), "two\nlines".to_owned()] {
        let refused = read(&note).unwrap_err().to_string();
        assert_eq!(refused, "window 1: the note is no line of at most 200 characters: shorten it");
    }
}

/// Times of a command given at one minute, computed at another: sent, arrival, effect.
fn expected(plan: &ContactPlan, given: &str, now: u64) -> String {
    let mut words = given.split(' ');
    let given_ms = at(words.next().unwrap().parse().unwrap());
    let delay_ms = words.next().unwrap().parse::<u64>().ok().map(|minutes| minutes * 60_000);
    let not_before_ms = words.next().map(|word| at(word.parse().unwrap()));
    let times = plan.expected(GivenTimes { given_ms, delay_ms, not_before_ms }, at(now));
    let minute = |ms: u64| ((ms - at(0)) / 60_000).to_string();
    let word = |ms: Option<u64>, none: &str| ms.map_or(none.to_owned(), minute);
    let ExpectedTimes { send_at_ms, arrives_ms, effect_ms } = times;
    format!(
        "sent {}, arrives {}, effect {}",
        word(send_at_ms, "now"),
        word(arrives_ms, "?"),
        word(effect_ms, "?")
    )
}

#[test]
fn a_command_is_sent_in_the_open_contact_or_the_next_one() {
    let plan = plan(&[(10, 20), (30, 40)]);
    // Given before a contact.
    assert_eq!(expected(&plan, "5 3", 6), "sent 10, arrives 13, effect 13");
    assert_eq!(expected(&plan, "5 3", 11), "sent now, arrives 13, effect 13");
    // Given in a contact, then not confirmed in it.
    assert_eq!(expected(&plan, "15 3", 15), "sent now, arrives 18, effect 18");
    assert_eq!(expected(&plan, "15 3", 20), "sent 30, arrives 33, effect 33");
    // For later.
    assert_eq!(expected(&plan, "5 3 12", 6), "sent 10, arrives 13, effect 13");
    assert_eq!(expected(&plan, "5 3 90", 6), "sent 10, arrives 13, effect 90");
    // A delay that was never measured.
    assert_eq!(expected(&plan, "5 - 90", 6), "sent 10, arrives ?, effect ?");
    // After the last contact, and without a plan.
    assert_eq!(expected(&plan, "41 3", 42), "sent now, arrives 44, effect 44");
    assert_eq!(expected(&ContactPlan::default(), "5 3", 6), "sent now, arrives 8, effect 8");
}

#[test]
fn an_expiry_before_the_next_contact_is_refused() {
    let plan = plan(&[(10, 20), (30, 40)]);
    let check = |now, expiry| plan.check_expiry(at(now), at(expiry));
    assert_eq!(check(5, 11), Ok(()));
    assert_eq!(check(12, 13), Ok(()));
    assert_eq!(check(41, 42), Ok(()));
    assert_eq!(
        check(5, 10).unwrap_err(),
        "the command would expire at 2026-11-28T12:10:00Z, and the next contact begins at 2026-11-28T12:10:00Z: let it expire later than that, or change the contacts"
    );
    assert!(check(20, 25).is_err());
}

#[test]
fn a_lifetime_over_a_link_counts_from_the_next_contact() {
    let contact = plan(&[(10, 20)]).current(at(0)).cloned();
    let link = LinkHealth { lifetime_ms: Some(60_000), contact, ..LinkHealth::default() };
    let expiry = |now, not_before: Option<u64>| {
        let envelope = Envelope::new("1", "ana", Command::Pause);
        let envelope = Envelope { not_before: not_before.map(at), ..envelope };
        envelope.dated(at(now), link.lifetime()).expiry.map(|Expiry(ms)| (ms - at(0)) / 60_000)
    };
    assert_eq!([expiry(5, None), expiry(5, Some(15))], [Some(11), Some(16)]);
    assert_eq!(expiry(12, None), Some(13));
    let stop = Envelope::new("1", "ana", Command::Stop).dated(at(5), link.lifetime());
    assert_eq!(stop.expiry, None);
}

proptest! {
    #[test]
    fn the_current_contact_is_the_first_that_is_not_over(
        steps in prop::collection::vec((0_u64..50, 1_u64..50), 0..30),
        now in 0_u64..3_000,
    ) {
        let mut end = 0;
        let windows: Vec<_> = steps
            .iter()
            .map(|(gap, length)| {
                let begin = end + gap;
                end = begin + length;
                (begin, end)
            })
            .collect();
        let plan = plan(&windows);
        let first = windows.iter().find(|(_, end)| *end > now).map(|(begin, _)| at(*begin));
        prop_assert_eq!(plan.current(at(now)).map(|contact| contact.begin_ms), first);
        let is_open = windows.iter().any(|(begin, end)| (*begin..*end).contains(&now));
        prop_assert_eq!(plan.current(at(now)).is_some_and(|it| it.is_open(at(now))), is_open);
        prop_assert_eq!(plan.next_begin(at(now)), first.filter(|_| !is_open));
        let given = GivenTimes { given_ms: at(now), delay_ms: Some(1), not_before_ms: None };
        let expected = plan.expected(given, at(now));
        // A send is never planned outside of the contacts.
        prop_assert_eq!(expected.send_at_ms, plan.next_begin(at(now)));
        prop_assert_eq!(expected.effect_ms, Some(expected.send_at_ms.unwrap_or(at(now)) + 1));
    }
}
