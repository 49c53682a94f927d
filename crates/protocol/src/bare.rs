//! Events for readers that do not request values: removes values and shortens errors.

use crate::Event;
use serde_json::{Value, json};

/// Maximum number of characters of an error's text without values.
const ERROR_MAX: usize = 200;

/// Returns true for events that only carry a value. They are omitted without values.
pub fn is_about_values(event: &Event) -> bool {
    matches!(event, Event::Scoped { .. } | Event::Global { .. } | Event::Persistent { .. })
}

/// Removes inputs and outputs of states and shortens their errors.
pub fn without_values(event: &mut Event) {
    match event {
        Event::Entered { inputs, .. } => *inputs = None,
        Event::Left { outputs, error, .. } => {
            *outputs = None;
            *error = error.take().map(short_error);
        }
        _ => {}
    }
}

/// Shortens an error of any kind: class and text of an exception, a text, or the text form of another value. Each is cut to 200
/// characters.
pub fn short_error(error: Value) -> Value {
    match error {
        Value::String(text) => cut(&text).into(),
        Value::Object(members) => match ["__exc__", "__repr__"].map(|key| text(&members, key)) {
            [Some(class), _] => {
                let message = text(&members, "msg").unwrap_or_default();
                json!({ "__exc__": cut(class), "msg": cut(message) })
            }
            [None, Some(shown)] => {
                let class = text(&members, "__class__").unwrap_or_default();
                json!({ "__repr__": cut(shown), "__class__": cut(class) })
            }
            [None, None] => looks(&Value::Object(members)),
        },
        Value::Array(_) => looks(&error),
        plain => plain,
    }
}

fn text<'m>(members: &'m serde_json::Map<String, Value>, key: &str) -> Option<&'m str> {
    members.get(key)?.as_str()
}

fn looks(value: &Value) -> Value {
    let class = if value.is_array() { "list" } else { "dict" };
    json!({ "__repr__": cut(&value.to_string()), "__class__": class })
}

fn cut(text: &str) -> String {
    match text.char_indices().nth(ERROR_MAX) {
        Some((end, _)) => {
            let kept = &text[..end];
            let last = kept.char_indices().next_back().map_or(0, |(last, _)| last);
            format!("{}…", &kept[..last])
        }
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{short_error, without_values};
    use crate::{Event, Outcome};
    use expect_test::{Expect, expect};
    use serde_json::{Value, json};

    fn check(error: Value, expect: &Expect) {
        expect.assert_eq(&short_error(error).to_string());
    }

    #[test]
    fn an_error_is_told_in_few_words() {
        check(
            json!({"__exc__": "OSError", "msg": "no camera", "more": [1, 2]}),
            &expect![[r#"{"__exc__":"OSError","msg":"no camera"}"#]],
        );
        check(json!({"__exc__": "E"}), &expect![[r#"{"__exc__":"E","msg":""}"#]]);
        check(json!("no camera"), &expect![[r#""no camera""#]]);
        check(json!(7), &expect!["7"]);
        check(
            json!({"__repr__": "<Pose>", "__class__": "Pose", "__len__": 3}),
            &expect![[r#"{"__class__":"Pose","__repr__":"<Pose>"}"#]],
        );
        check(
            json!({"why": "slips"}),
            &expect![[r#"{"__class__":"dict","__repr__":"{\"why\":\"slips\"}"}"#]],
        );
    }

    #[test]
    fn no_error_is_long() {
        let long = "ä".repeat(201);
        for error in [
            json!(long),
            json!({"__exc__": long, "msg": long}),
            json!({"__repr__": long, "__class__": long}),
            json!([long, long]),
            json!({ "why": long }),
        ] {
            let short = short_error(error);
            assert!(short.to_string().chars().count() < 450, "{short}");
        }
        assert_eq!(short_error(json!(long)), json!("ä".repeat(199) + "…"));
        assert_eq!(short_error(json!("ä".repeat(200))), json!("ä".repeat(200)));
    }

    #[test]
    fn values_are_left_out_and_the_error_stays() {
        let mut event = Event::Left {
            path: "R".to_owned(),
            outcome: Outcome { id: 0, name: "done".to_owned() },
            outputs: Some(serde_json::Map::default()),
            error: Some(json!({"__exc__": "E", "msg": "no"})),
            undoes: None,
        };
        without_values(&mut event);
        let Event::Left { outputs, error, .. } = event else { unreachable!() };
        assert_eq!((outputs, error), (None, Some(json!({"__exc__": "E", "msg": "no"}))));
    }
}
