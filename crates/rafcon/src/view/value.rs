//! Values of a run for people: from the encoding of `docs/protocol.md` to Python syntax, truncated to one line.

use serde_json::{Map, Value};

/// Maximum length of a value; longer ones are truncated.
const WIDTH: usize = 200;

/// One line for a value.
pub(crate) fn shown(value: &Value) -> String {
    let text = full(value);
    match text.char_indices().nth(WIDTH) {
        Some((index, _)) => format!("{}…", &text[..index]),
        None => text,
    }
}

fn full(value: &Value) -> String {
    match value {
        Value::Null => "None".to_owned(),
        Value::Bool(true) => "True".to_owned(),
        Value::Bool(false) => "False".to_owned(),
        Value::Number(number) => number.to_string(),
        Value::String(text) => format!("{text:?}"),
        Value::Array(items) => format!("[{}]", list(items)),
        Value::Object(members) => object(members),
    }
}

fn list(items: &[Value]) -> String {
    items.iter().map(full).collect::<Vec<_>>().join(", ")
}

fn object(members: &Map<String, Value>) -> String {
    let text = |key: &str| members.get(key).and_then(Value::as_str);
    if let Some(class) = text("__exc__") {
        return match text("msg") {
            None | Some("") => class.to_owned(),
            Some(message) => format!("{class}: {message}"),
        };
    }
    if let Some(items) = members.get("__tuple__").and_then(Value::as_array) {
        let comma = if items.len() == 1 { "," } else { "" };
        return format!("({}{comma})", list(items));
    }
    let written = ["__int__", "__float__", "__type__"].into_iter().find_map(text);
    if let Some(written) = written {
        return written.to_owned();
    }
    if let Some(shown) = text("__repr__") {
        let is_cut = members.contains_key("__len__");
        return if is_cut { format!("{shown}…") } else { shown.to_owned() };
    }
    if let Some(pairs) = members.get("__dict__").and_then(Value::as_array) {
        let pair = |pair: &Value| format!("{}: {}", full(&pair[0]), full(&pair[1]));
        return format!("{{{}}}", pairs.iter().map(pair).collect::<Vec<_>>().join(", "));
    }
    let members = members.iter().map(|(key, value)| format!("{key:?}: {}", full(value)));
    format!("{{{}}}", members.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::shown;
    use serde_json::json;

    #[test]
    fn values_look_as_in_python() {
        let shown = |value| shown(&value);
        assert_eq!(shown(json!([1, 2.5, null, true, "x"])), r#"[1, 2.5, None, True, "x"]"#);
        assert_eq!(shown(json!({"__exc__": "KeyError", "msg": "'a'"})), "KeyError: 'a'");
        assert_eq!(shown(json!({"__tuple__": [1]})), "(1,)");
        assert_eq!(shown(json!({"a": {"__type__": "int"}})), r#"{"a": int}"#);
        assert_eq!(shown(json!({"__repr__": "<Arm>", "__class__": "Arm"})), "<Arm>");
        assert_eq!(shown(json!({"__int__": "9007199254740993"})), "9007199254740993");
        assert_eq!(shown(json!({"__float__": "-0.0"})), "-0.0");
        assert_eq!(shown(json!({"__dict__": [[1, "l"], ["1", "r"]]})), r#"{1: "l", "1": "r"}"#);
        assert_eq!(shown(json!({"__repr__": "b'x", "__class__": "bytes", "__len__": 9})), "b'x…");
        assert_eq!(shown(json!("a".repeat(300))).chars().count(), 201);
    }
}
