//! Describes edits for users who repeat them by hand. Knows the shape of edits as JSON, not their meaning.

use crate::documents::operation::{Operation, RecordedOperation};
use rafcon_protocol::api::SetAsideEdit;
use serde_json::{Map, Value};

/// Maximum length of a value's description, in characters.
const VALUE_MAX: usize = 200;
/// Maximum number of described edits in a batch.
const BATCH_MAX: usize = 10;

/// Description of an operation for the list.
pub(super) fn of_operation(record: &RecordedOperation) -> SetAsideEdit {
    let (name, what) = match &record.operation {
        Operation::Edit { name, edit } => (
            name.as_str(),
            serde_json::to_value(edit).map(|edit| of_edit(&edit)).unwrap_or_default(),
        ),
        Operation::Undo => ("Undo", "took back the last step of this user".to_owned()),
        Operation::Redo => {
            ("Redo", "repeated the last step that this user had taken back".to_owned())
        }
        Operation::Replace { .. } => ("Reload", "read the files again".to_owned()),
        Operation::Jump { .. } => ("Jump", "went to an earlier step".to_owned()),
    };
    let (author, name) = (record.request.author.clone(), name.to_owned());
    SetAsideEdit { author, at_ms: record.at_ms, name, what }
}

fn of_edit(edit: &Value) -> String {
    let Value::Object(fields) = edit else { return short(edit) };
    if let Some(Value::Array(edits)) = fields.get("edits") {
        return of_batch(edits);
    }
    let text = |key: &str| fields.get(key).and_then(Value::as_str).unwrap_or_default();
    let kind = text("edit").replace('_', " ");
    let head = format!("{kind} {}", text("path"));
    let details = details(fields);
    if details.is_empty() { head } else { format!("{}: {details}", head.trim_end()) }
}

fn of_batch(edits: &[Value]) -> String {
    let mut parts: Vec<_> = edits.iter().take(BATCH_MAX).map(of_edit).collect();
    if edits.len() > BATCH_MAX {
        parts.push(format!("and {} more", edits.len() - BATCH_MAX));
    }
    parts.join("; ")
}

fn details(fields: &Map<String, Value>) -> String {
    let is_detail = |key: &str| key != "edit" && key != "path";
    let details = fields.iter().filter(|(key, _)| is_detail(key));
    let details = details.map(|(key, value)| format!("{} {}", key.replace('_', " "), short(value)));
    details.collect::<Vec<_>>().join(", ")
}

fn short(value: &Value) -> String {
    let text = value.to_string();
    if text.chars().count() <= VALUE_MAX {
        return text;
    }
    text.chars().take(VALUE_MAX).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::{VALUE_MAX, of_operation, short};
    use crate::documents::operation::{EditRequest, Operation, RecordedOperation};
    use expect_test::{Expect, expect};

    fn check(edit: &str, expect: &Expect) {
        let edit = serde_json::from_str(edit).unwrap();
        let request = EditRequest { author: "ann".to_owned(), id: "1".to_owned() };
        let operation = Operation::Edit { name: "Any".to_owned(), edit: Box::new(edit) };
        let listed = of_operation(&RecordedOperation { request, at_ms: 7, operation });
        expect.assert_eq(&listed.what);
    }

    #[test]
    fn an_edit_is_told_with_its_state_and_its_values() {
        check(
            r#"{"edit":"set_name","path":"R/A","name":"Two"}"#,
            &expect![[r#"set name R/A: name "Two""#]],
        );
        check(r#"{"edit":"set_start","path":"R"}"#, &expect!["set start R: to null"]);
        check(
            r#"{"edit":"batch","edits":[{"edit":"remove_state","path":"R","state":"A"},{"edit":"set_version","version":"2"}]}"#,
            &expect![[r#"remove state R: state "A"; set version: version "2""#]],
        );
        assert_eq!(short(&"x".repeat(VALUE_MAX + 1).into()).chars().count(), VALUE_MAX + 1);
    }
}
