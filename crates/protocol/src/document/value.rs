//! Values of a machine as JSON that a browser returns unchanged (see "values" in `docs/edits.md`). Converts between the two
//! encodings, whatever a value is used for.

use rafcon_model::{Json, Value};
use serde_json::{Map, Value as Wire, json};

const INT: &str = "__int__";
const FLOAT: &str = "__float__";
const TUPLE: &str = "__tuple__";
const SET: &str = "__set__";
const DICT: &str = "__dict__";
const TYPE: &str = "__type__";
const OBJECT: &str = "__object__";
/// The largest integer that JavaScript holds exactly.
const EXACT: u64 = (1 << 53) - 1;
/// Maximum nesting depth. Deeper values are refused, so that everything that contains them can be read again.
const DEPTH_MAX: usize = 96;

/// Encodes a value of the model for a client.
pub(crate) fn encode(value: &Value) -> Wire {
    match value {
        Value::None => Wire::Null,
        Value::Bool(value) => Wire::Bool(*value),
        Value::Int(number) => int(*number),
        Value::BigInt(digits) => json!({ INT: digits.as_str() }),
        Value::Float(number) => float(*number),
        Value::Str(text) => Wire::String(text.as_ref().into()),
        Value::List(items) => list(items),
        Value::Tuple(items) => json!({ TUPLE: list(items) }),
        Value::Set(items) => json!({ SET: list(items) }),
        Value::Dict(items) => dict(items.iter().map(|(key, value)| (encode(key), encode(value)))),
        Value::Type(name) => json!({ TYPE: name.as_str() }),
        Value::Encoded(object) => json!({ OBJECT: encode_json(object) }),
    }
}

/// Encodes a JSON document of the model for a client.
pub(crate) fn encode_json(value: &Json) -> Wire {
    match value {
        Json::Null => Wire::Null,
        Json::Bool(value) => Wire::Bool(*value),
        Json::Int(number) => int(*number),
        Json::BigInt(digits) => json!({ INT: digits.as_str() }),
        Json::Float(number) => float(*number),
        Json::Str(text) => Wire::String(text.as_str().into()),
        Json::List(items) => Wire::Array(items.iter().map(encode_json).collect()),
        Json::Object(members) => {
            dict(members.iter().map(|(key, value)| (Wire::from(key.as_str()), encode_json(value))))
        }
    }
}

fn list(items: &[Value]) -> Wire {
    Wire::Array(items.iter().map(encode).collect())
}

fn int(number: i64) -> Wire {
    if number.unsigned_abs() <= EXACT {
        Wire::from(number)
    } else {
        json!({ INT: number.to_string() })
    }
}

/// Marks floats that JSON and JavaScript would change: JavaScript writes `1.0` as `1`, and JSON has no NaN or infinity.
fn float(number: f64) -> Wire {
    match serde_json::Number::from_f64(number) {
        Some(exact) if number.fract() != 0.0 => Wire::Number(exact),
        _ => json!({ FLOAT: format!("{number:?}") }),
    }
}

/// Encodes a dict as a plain object if the order and meaning of its members survive every transport, or else as pairs.
fn dict(pairs: impl Iterator<Item = (Wire, Wire)>) -> Wire {
    let pairs: Vec<(Wire, Wire)> = pairs.collect();
    let key = |pair: &(Wire, Wire)| pair.0.as_str().map(str::to_owned);
    let keys: Option<Vec<String>> = pairs.iter().map(key).collect();
    let is_plain = |keys: &Vec<String>| {
        keys.iter().all(|key| !key.starts_with("__") && key.parse::<u64>().is_err())
            && keys.is_sorted_by(|a, b| a < b)
    };
    match keys.filter(is_plain) {
        Some(keys) => {
            let values = pairs.into_iter().map(|(_, value)| value);
            Wire::Object(keys.into_iter().zip(values).collect())
        }
        None => json!({ DICT: pairs }),
    }
}

/// Decodes a client's value. The error describes the fault.
pub(crate) fn decode(value: &Wire) -> Result<Value, String> {
    shallow(value)?;
    read(value)
}

/// Decodes a client's JSON document.
pub(crate) fn decode_json(value: &Wire) -> Result<Json, String> {
    shallow(value)?;
    read_json(value)
}

fn shallow(value: &Wire) -> Result<(), String> {
    let mut open = vec![(value, 0)];
    while let Some((value, depth)) = open.pop() {
        if depth > DEPTH_MAX {
            return Err(format!("it is nested deeper than {DEPTH_MAX} levels; take levels out"));
        }
        match value {
            Wire::Array(items) => open.extend(items.iter().map(|item| (item, depth + 1))),
            Wire::Object(members) => open.extend(members.values().map(|item| (item, depth + 1))),
            Wire::Null | Wire::Bool(_) | Wire::Number(_) | Wire::String(_) => {}
        }
    }
    Ok(())
}

fn read(value: &Wire) -> Result<Value, String> {
    Ok(match value {
        Wire::Array(items) => Value::List(read_all(items)?.into()),
        Wire::Object(members) => return read_object(members),
        Wire::Null | Wire::Bool(_) | Wire::Number(_) | Wire::String(_) => {
            Value::from_json(&read_json(value)?)
        }
    })
}

fn read_all(items: &[Wire]) -> Result<Vec<Value>, String> {
    items.iter().map(read).collect()
}

fn read_object(members: &Map<String, Wire>) -> Result<Value, String> {
    let Some((tag, inner)) = tagged(members) else {
        let pairs = members.iter().map(|(key, value)| Ok((Value::str(key), read(value)?)));
        return Ok(Value::Dict(pairs.collect::<Result<_, String>>()?));
    };
    Ok(match tag {
        INT | FLOAT => Value::from_json(&number(tag, inner)?),
        TUPLE => Value::Tuple(read_all(items_of(tag, inner)?)?.into()),
        SET => Value::Set(read_all(items_of(tag, inner)?)?.into()),
        TYPE => Value::Type(text_of(tag, inner)?.into()),
        OBJECT => Value::Encoded(read_json(inner)?.into()),
        _ => Value::Dict(
            pairs_of(inner)?
                .map(|pair| {
                    let (key, value) = pair?;
                    Ok((read_key(key)?, read(value)?))
                })
                .collect::<Result<_, String>>()?,
        ),
    })
}

/// Decodes a key of a dict. Only types that a file can hold are accepted.
fn read_key(key: &Wire) -> Result<Value, String> {
    match read(key)? {
        key @ (Value::Int(_) | Value::Str(_)) => Ok(key),
        _ => Err(format!("a key of `{DICT}` is a text or a whole number")),
    }
}

fn read_json(value: &Wire) -> Result<Json, String> {
    Ok(match value {
        Wire::Null => Json::Null,
        Wire::Bool(value) => Json::Bool(*value),
        Wire::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(number), _) => Json::Int(number),
            (None, _) if number.is_u64() => Json::BigInt(number.to_string().into()),
            (None, Some(number)) => Json::Float(number),
            (None, None) => return Err(format!("{number} is no number")),
        },
        Wire::String(text) => Json::Str(text.into()),
        Wire::Array(items) => Json::List(items.iter().map(read_json).collect::<Result<_, _>>()?),
        Wire::Object(members) => match tagged(members) {
            Some((tag @ (INT | FLOAT), inner)) => number(tag, inner)?,
            Some((DICT, inner)) => Json::Object(
                pairs_of(inner)?
                    .map(|pair| {
                        let (key, value) = pair?;
                        Ok((text_of(DICT, key)?.into(), read_json(value)?))
                    })
                    .collect::<Result<_, String>>()?,
            ),
            _ => Json::Object(
                members
                    .iter()
                    .map(|(key, value)| Ok((key.into(), read_json(value)?)))
                    .collect::<Result<_, String>>()?,
            ),
        },
    })
}

/// Returns the tag and the content of an object that encodes another value.
fn tagged(members: &Map<String, Wire>) -> Option<(&'static str, &Wire)> {
    const TAGS: [&str; 7] = [INT, FLOAT, TUPLE, SET, DICT, TYPE, OBJECT];
    let (key, inner) = members.iter().next().filter(|_| members.len() == 1)?;
    TAGS.into_iter().find(|tag| tag == key).map(|tag| (tag, inner))
}

fn number(tag: &str, inner: &Wire) -> Result<Json, String> {
    let text = text_of(tag, inner)?;
    if tag == FLOAT {
        let number = text.parse().map_err(|error| format!("`{tag}`: {text}: {error}"));
        return number.map(Json::Float);
    }
    if let Ok(number) = text.parse() {
        return Ok(Json::Int(number));
    }
    let digits = text.strip_prefix('-').unwrap_or(text);
    if digits.is_empty() || digits.starts_with('0') || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(format!("`{tag}`: {text} is no whole number"));
    }
    Ok(Json::BigInt(text.into()))
}

fn text_of<'w>(tag: &str, inner: &'w Wire) -> Result<&'w str, String> {
    inner.as_str().ok_or_else(|| format!("`{tag}` holds a text"))
}

fn items_of<'w>(tag: &str, inner: &'w Wire) -> Result<&'w Vec<Wire>, String> {
    inner.as_array().ok_or_else(|| format!("`{tag}` holds a list"))
}

fn pairs_of(inner: &Wire) -> Result<impl Iterator<Item = Result<(&Wire, &Wire), String>>, String> {
    let pairs = items_of(DICT, inner)?.iter();
    Ok(pairs.map(|pair| match pair.as_array().map(Vec::as_slice) {
        Some([key, value]) => Ok((key, value)),
        _ => Err(format!("`{DICT}` holds pairs of a key and a value")),
    }))
}

#[cfg(test)]
mod tests {
    use super::{DEPTH_MAX, decode, encode};
    use expect_test::{Expect, expect};
    use proptest::prelude::*;
    use rafcon_model::{Json, Value, json};

    fn check(file: &str, expect: &Expect) {
        let value = Value::from_json(&json::parse(file).expect("JSON of a file"));
        let wire = encode(&value);
        assert_eq!(decode(&wire), Ok(value));
        expect.assert_eq(&wire.to_string());
    }

    #[test]
    fn values_look_as_in_events_where_both_have_them() {
        check(
            r#"{"__jsonqualname__":"__builtin__.tuple","items":[1,null,"a"]}"#,
            &expect![[r#"{"__tuple__":[1,null,"a"]}"#]],
        );
        check(
            r#"{"__type__":"__builtin__.float"}"#,
            &expect![[r#"{"__type__":"builtins.float"}"#]],
        );
        check(r#"{"a":{"b":[true]}}"#, &expect![[r#"{"a":{"b":[true]}}"#]]);
        check(
            r#"{"__jsonqualname__":"numpy.ndarray","items":[1]}"#,
            &expect![[
                r#"{"__object__":{"__dict__":[["__jsonqualname__","numpy.ndarray"],["items",[1]]]}}"#
            ]],
        );
    }

    #[test]
    fn what_a_browser_would_change_is_marked() {
        check(
            "[1, 1.0, 1.5, NaN, -Infinity]",
            &expect![[r#"[1,{"__float__":"1.0"},1.5,{"__float__":"NaN"},{"__float__":"-inf"}]"#]],
        );
        check(
            "[9007199254740993, 123456789012345678901]",
            &expect![[r#"[{"__int__":"9007199254740993"},{"__int__":"123456789012345678901"}]"#]],
        );
        check(r#"{"b":1,"a":2}"#, &expect![[r#"{"__dict__":[["b",1],["a",2]]}"#]]);
        check(r#"{"1":"one"}"#, &expect![[r#"{"__dict__":[[1,"one"]]}"#]]);
        check(r#"{"__int__":1}"#, &expect![[r#"{"__dict__":[["__int__",1]]}"#]]);
    }

    #[test]
    fn what_is_no_value_is_refused() {
        let refused =
            |text: &str| decode(&serde_json::from_str(text).expect("JSON")).expect_err("refused");
        expect!["`__int__`: 1.5 is no whole number"].assert_eq(&refused(r#"{"__int__":"1.5"}"#));
        expect!["`__tuple__` holds a list"].assert_eq(&refused(r#"{"__tuple__":1}"#));
        expect!["`__dict__` holds pairs of a key and a value"]
            .assert_eq(&refused(r#"{"__dict__":[[1]]}"#));
        expect!["a key of `__dict__` is a text or a whole number"]
            .assert_eq(&refused(r#"{"__dict__":[[null,1]]}"#));
        // The outermost list has depth 0.
        let nested = |levels: usize| "[".repeat(levels) + &"]".repeat(levels);
        expect!["it is nested deeper than 96 levels; take levels out"]
            .assert_eq(&refused(&nested(DEPTH_MAX + 2)));
        let most = serde_json::from_str(&nested(DEPTH_MAX + 1)).expect("JSON");
        assert!(decode(&most).is_ok());
    }

    fn any_value() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::None),
            any::<bool>().prop_map(Value::Bool),
            any::<i64>().prop_map(Value::Int),
            any::<f64>().prop_map(Value::Float),
            "[a-z_0-9]{0,4}".prop_map(|text| Value::str(&text)),
            Just(Value::Type("numpy.ndarray".into())),
            Just(Value::Encoded(
                Json::Object(vec![("__jsonqualname__".into(), Json::Float(2.0))]).into()
            )),
        ];
        leaf.prop_recursive(4, 32, 5, |inner| {
            let items = proptest::collection::vec(inner.clone(), 0..4);
            let key = prop_oneof![
                any::<i64>().prop_map(Value::Int),
                "[a-z_0-9]{0,3}".prop_map(|t| Value::str(&t))
            ];
            let pairs = proptest::collection::vec((key, inner), 0..4);
            prop_oneof![
                items.clone().prop_map(|items| Value::List(items.into())),
                items.clone().prop_map(|items| Value::Tuple(items.into())),
                items.prop_map(|items| Value::Set(items.into())),
                pairs.prop_map(|pairs| Value::Dict(pairs.into())),
            ]
        })
    }

    proptest! {
        #[test]
        fn any_value_comes_back_as_it_was(value in any_value()) {
            let text = encode(&value).to_string();
            let wire = serde_json::from_str(&text).expect("JSON");
            prop_assert_eq!(decode(&wire), Ok(value));
        }
    }
}
