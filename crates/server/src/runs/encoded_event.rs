//! One event as a runner told it: its text, ready to be sent on. Knows words; must never know who reads them.

use rafcon_protocol::api::HistoryEntry;
use rafcon_protocol::{Event, is_about_values, without_values};
use serde::Deserialize;
use serde_json::value::RawValue;
use std::fmt::Write as _;
use std::sync::OnceLock;

/// How the line of an event begins.
const EVENT: &str = r#"{"message":"event","#;
/// How the last event of a run begins.
const FINISHED: &str = r#"{"type":"finished","#;

/// An event of a run. Many followers share one; its text is made once.
#[derive(Debug)]
pub(crate) struct EncodedEvent {
    /// Counts from 1.
    pub(crate) sequence: u64,
    /// A [`HistoryEntry`] as JSON, with values.
    whole: Box<str>,
    /// The same without values; nothing if it is about values only.
    bare: OnceLock<Option<Box<str>>>,
}

#[derive(Deserialize)]
struct EventLine<'l> {
    sequence: u64,
    t_ns: u64,
    #[serde(borrow)]
    event: &'l RawValue,
}

impl EncodedEvent {
    /// What a runner's line says, if it is an event; the line is not read further than it must.
    pub(super) fn read(line: &str) -> Option<Self> {
        if !line.starts_with(EVENT) {
            return None;
        }
        let EventLine { sequence, t_ns, event } = serde_json::from_str(line).ok()?;
        let mut whole = String::with_capacity(line.len() + 16);
        let event = event.get();
        write!(whole, r#"{{"sequence":{sequence},"t_ns":{t_ns},"event":{event}}}"#).ok()?;
        Some(Self { sequence, whole: whole.into(), bare: OnceLock::new() })
    }

    /// A [`HistoryEntry`] as JSON, with or without values; nothing if it is about values only and none are wanted.
    pub(crate) fn text(&self, values: bool) -> Option<&str> {
        if values {
            return Some(&self.whole);
        }
        self.bare.get_or_init(|| self.without_values()).as_deref()
    }

    /// The event, if it is the run's last.
    pub(super) fn finish(&self) -> Option<Event> {
        let (_, event) = self.whole.split_once(r#""event":"#)?;
        if !event.starts_with(FINISHED) {
            return None;
        }
        Some(self.entry()?.event)
    }

    /// How much memory it takes, about.
    pub(super) fn bytes(&self) -> usize {
        self.whole.len() * 2 + size_of::<Self>()
    }

    fn entry(&self) -> Option<HistoryEntry> {
        serde_json::from_str(&self.whole).ok()
    }

    fn without_values(&self) -> Option<Box<str>> {
        let mut entry = self.entry()?;
        if is_about_values(&entry.event) {
            return None;
        }
        without_values(&mut entry.event);
        Some(serde_json::to_string(&entry).ok()?.into())
    }
}

#[cfg(test)]
mod tests {
    use super::EncodedEvent;
    use expect_test::{Expect, expect};

    fn check(line: &str, expect: &Expect) {
        let text = match EncodedEvent::read(line) {
            None => "no event".to_owned(),
            Some(told) => {
                let finish = told.finish().map(|_| "the last").unwrap_or_default();
                format!("{}\n{:?} {finish}", told.text(true).unwrap(), told.text(false))
            }
        };
        expect.assert_eq(&text);
    }

    #[test]
    fn an_event_is_sent_on_as_it_came_with_and_without_values() {
        check(
            r#"{"message":"event","sequence":7,"t_ns":9,"event":{"type":"entered","path":"R/A","inputs":{"a":[1,2.50]}}}"#,
            &expect![[r#"
                {"sequence":7,"t_ns":9,"event":{"type":"entered","path":"R/A","inputs":{"a":[1,2.50]}}}
                Some("{\"sequence\":7,\"t_ns\":9,\"event\":{\"type\":\"entered\",\"path\":\"R/A\"}}") "#]],
        );
        check(
            r#"{"message":"event","sequence":7,"t_ns":9,"event":{"type":"left","path":"R/A","outcome":{"id":0,"name":"ok"},"outputs":{"a":1},"error":{"__exc__":"E","msg":"no"}}}"#,
            &expect![[r#"
                {"sequence":7,"t_ns":9,"event":{"type":"left","path":"R/A","outcome":{"id":0,"name":"ok"},"outputs":{"a":1},"error":{"__exc__":"E","msg":"no"}}}
                Some("{\"sequence\":7,\"t_ns\":9,\"event\":{\"type\":\"left\",\"path\":\"R/A\",\"outcome\":{\"id\":0,\"name\":\"ok\"},\"error\":{\"__exc__\":\"E\",\"msg\":\"no\"}}}") "#]],
        );
        check(
            r#"{"message":"event","sequence":8,"t_ns":9,"event":{"type":"global","name":"n","value":3}}"#,
            &expect![[r#"
                {"sequence":8,"t_ns":9,"event":{"type":"global","name":"n","value":3}}
                None "#]],
        );
    }

    #[test]
    fn the_last_event_is_known_by_its_kind_and_not_by_its_text() {
        check(
            r#"{"message":"event","sequence":9,"t_ns":9,"event":{"type":"finished","outcome":{"id":0,"name":"ok"},"outputs":{},"globals":{},"scoped_variables":{},"states_run":2}}"#,
            &expect![[r#"
                {"sequence":9,"t_ns":9,"event":{"type":"finished","outcome":{"id":0,"name":"ok"},"outputs":{},"globals":{},"scoped_variables":{},"states_run":2}}
                Some("{\"sequence\":9,\"t_ns\":9,\"event\":{\"type\":\"finished\",\"outcome\":{\"id\":0,\"name\":\"ok\"},\"outputs\":{},\"globals\":{},\"scoped_variables\":{},\"states_run\":2}}") the last"#]],
        );
        check(
            r#"{"message":"event","sequence":9,"t_ns":9,"event":{"type":"log","path":"","level":"info","stream":"stdout","message":"{\"type\":\"finished\","}}"#,
            &expect![[r#"
                {"sequence":9,"t_ns":9,"event":{"type":"log","path":"","level":"info","stream":"stdout","message":"{\"type\":\"finished\","}}
                Some("{\"sequence\":9,\"t_ns\":9,\"event\":{\"type\":\"log\",\"path\":\"\",\"level\":\"info\",\"stream\":\"stdout\",\"message\":\"{\\\"type\\\":\\\"finished\\\",\"}}") "#]],
        );
    }

    #[test]
    fn other_lines_are_no_events() {
        check(r#"{"message":"answer","id":"1","answer":"applied"}"#, &expect!["no event"]);
        check(r#"{"message":"event","sequence":"#, &expect!["no event"]);
        check("", &expect!["no event"]);
    }
}
