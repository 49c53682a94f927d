//! Exports events as a table for spreadsheets, in the format of RFC 4180.

use super::{ExportError, utc_at};
use crate::journal::read::{Found, kind_of, path_of};
use rafcon_protocol::Event;
use serde_json::{Value, json};

/// Header row of the table.
pub(super) const HEAD: &str =
    "sequence,time_s,utc,kind,path,names,outcome,duration_s,level,text,values\r\n";

/// Returns the row of an event of a run that began at `started_ms`, without the newline.
pub(super) fn line(found: &Found, started_ms: u64) -> Result<String, ExportError> {
    let event = &found.event;
    let duration = found.lasted.map(|lasted| format!("{:.6}", lasted.as_secs_f64()));
    let values = values(event);
    let values = if values.is_null() { String::new() } else { serde_json::to_string(&values)? };
    let fields = [
        found.sequence.to_string(),
        format!("{:.6}", found.time().as_secs_f64()),
        utc_at(started_ms + found.t_ns / 1_000_000),
        kind_of(event).to_owned(),
        guarded(path_of(event)),
        guarded(&found.names),
        guarded(outcome(event).unwrap_or_default()),
        duration.unwrap_or_default(),
        level(event),
        guarded(&text(event)),
        guarded(&values),
    ];
    Ok(fields.iter().map(|field| quoted(field)).collect::<Vec<_>>().join(",") + "\r")
}

fn outcome(event: &Event) -> Option<&str> {
    match event {
        Event::Left { outcome, .. }
        | Event::Forced { outcome, .. }
        | Event::Finished { outcome, .. } => Some(&outcome.name),
        _ => None,
    }
}

fn level(event: &Event) -> String {
    match event {
        Event::Log { level, .. } => format!("{level:?}").to_lowercase(),
        _ => String::new(),
    }
}

fn text(event: &Event) -> String {
    match event {
        Event::Log { message, .. } => message.clone(),
        Event::Waiting { reason, .. } => reason.clone(),
        Event::Root { change, .. } | Event::ChangeWaits { change, .. } => change.clone(),
        Event::Asked { question } => question.message.clone(),
        Event::Damaged { what, .. } => what.clone(),
        Event::Commanded { envelope, .. } => {
            serde_json::to_string(&envelope.command).unwrap_or_default()
        }
        _ => String::new(),
    }
}

/// Returns the values that an event is about, by name.
pub(super) fn values(event: &Event) -> Value {
    match event {
        Event::Entered { inputs: Some(values), .. } if !values.is_empty() => json!(values),
        Event::Left { outputs, error, .. } => {
            let mut values = outputs.clone().unwrap_or_default();
            values.extend(error.clone().map(|error| ("error".to_owned(), error)));
            if values.is_empty() { Value::Null } else { Value::Object(values) }
        }
        Event::Scoped { name, value, .. } => json!({ name: value }),
        Event::Global { name, value } => json!({ name: value }),
        Event::Persistent { value, .. } => value.clone(),
        Event::Finished { outputs, .. } if !outputs.is_empty() => json!(outputs),
        _ => Value::Null,
    }
}

/// Prevents spreadsheets from evaluating a text: puts a quote in front of a formula.
fn guarded(text: &str) -> String {
    let quote = if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { "'" } else { "" };
    format!("{quote}{text}")
}

fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::{guarded, quoted};

    #[test]
    fn no_text_is_a_formula() {
        let texts = ["=cmd|'/C calc'!A0", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1", "a=b", ""];
        let shown = texts.map(guarded);
        assert_eq!(
            shown,
            ["'=cmd|'/C calc'!A0", "'+1", "'-1", "'@SUM(A1)", "'\t=1", "'\r=1", "a=b", ""]
        );
    }

    #[test]
    fn only_what_must_be_is_quoted() {
        let fields = ["plain", "a,b", "say \"hi\"", "two\nlines", ""].map(quoted);
        assert_eq!(fields, ["plain", "\"a,b\"", "\"say \"\"hi\"\"\"", "\"two\nlines\"", ""]);
    }
}
