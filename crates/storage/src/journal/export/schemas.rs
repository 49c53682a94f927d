//! JSON Schemas of the messages of a recording. The log has a schema that Foxglove and Lichtblick support.

use serde_json::{Value, json};

fn time() -> Value {
    json!({
        "type": "object",
        "title": "time",
        "properties": {
            "sec": { "type": "integer", "minimum": 0 },
            "nsec": { "type": "integer", "minimum": 0, "maximum": 999_999_999 }
        }
    })
}

fn text() -> Value {
    json!({ "type": "string" })
}

fn object(title: &str, properties: &Value) -> Value {
    json!({ "title": title, "type": "object", "properties": properties })
}

/// Schema of an event as in `docs/protocol.md`.
pub(super) fn events() -> Value {
    object(
        "rafcon.Event",
        &json!({
            "timestamp": time(),
            "sequence": { "type": "integer" },
            "kind": text(),
            "state": text(),
            "event": { "type": "object" }
        }),
    )
}

/// Schema of the entry or end of a state, and the innermost active states after it.
pub(super) fn states() -> Value {
    object(
        "rafcon.States",
        &json!({
            "timestamp": time(),
            "kind": text(),
            "state": text(),
            "path": text(),
            "outcome": text(),
            "active": { "type": "array", "items": text() }
        }),
    )
}

/// Schema of a value that was given or set.
pub(super) fn values() -> Value {
    object(
        "rafcon.Value",
        &json!({
            "timestamp": time(),
            "kind": text(),
            "state": text(),
            "name": text(),
            "value": {},
            "number": { "type": "number" }
        }),
    )
}

/// Schema of a log line: `foxglove.Log`.
pub(super) fn log() -> Value {
    let levels = ["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"];
    let level = |(number, title): (i32, &str)| json!({ "title": title, "const": number });
    let levels: Vec<Value> = (0..).zip(levels).map(level).collect();
    object(
        "foxglove.Log",
        &json!({
            "timestamp": time(),
            "level": { "title": "foxglove.LogLevel", "oneOf": levels },
            "message": text(),
            "name": text(),
            "file": text(),
            "line": { "type": "integer", "minimum": 0 }
        }),
    )
}
