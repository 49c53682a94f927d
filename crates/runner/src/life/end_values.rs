//! Bounds the values in the last event of a run. Knows JSON values, not their meaning.

use rafcon_protocol::Event;
use rafcon_storage::journal::folder::EndValues;
use rafcon_storage::journal::{JournalError, folder::END_VALUES_FILE};
use serde_json::{Map, Value, json};
use std::io;
use std::path::Path;

/// Up to this many bytes of JSON the values are whole.
const WHOLE_MAX: usize = 64 << 10;
/// Values in one view, at most.
const ITEMS_MAX: usize = 256;
/// Maximum depth of a view.
const DEPTH_MAX: usize = 16;
/// Bytes of one text, at most.
const TEXT_MAX: usize = 1024;
/// Characters of a long text in a view.
const SHOWN_MAX: usize = 200;
/// Named values in the event, at most.
const NAMES_MAX: usize = 256;

/// The last event with bounded values. If they are long, the folder of the run gets all of them. The message reports a failure.
pub(super) fn bounded(event: Event, folder: &Path) -> (Event, Option<String>) {
    let Event::Finished { outcome, outputs, globals, scoped_variables, states_run } = event else {
        return (event, None);
    };
    let values = EndValues { outputs, globals, scoped_variables };
    let (views, message) = if is_short(&values) {
        (values, None)
    } else {
        let written = values.write(folder).err();
        let views = EndValues {
            outputs: views(&values.outputs),
            globals: views(&values.globals),
            scoped_variables: views(&values.scoped_variables),
        };
        (views, written.map(|error| message(&error)))
    };
    let EndValues { outputs, globals, scoped_variables } = views;
    (Event::Finished { outcome, outputs, globals, scoped_variables, states_run }, message)
}

fn message(error: &JournalError) -> String {
    format!(
        "the values at the end are shortened, and {END_VALUES_FILE} has not all of them: {error}"
    )
}

/// Counts the bytes up to the limit.
struct Room(usize);

impl io::Write for Room {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::FileTooLarge)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn is_short(values: &EndValues) -> bool {
    serde_json::to_writer(Room(WHOLE_MAX), values).is_ok()
}

fn views(values: &Map<String, Value>) -> Map<String, Value> {
    let view = |(name, value): (&String, &Value)| (name.clone(), View::of(value));
    values.iter().take(NAMES_MAX).map(view).collect()
}

/// A view on its way.
struct View {
    /// Values that may still be shown.
    left: usize,
}

impl View {
    fn of(value: &Value) -> Value {
        Self { left: ITEMS_MAX }.at(value, 0)
    }

    fn at(&mut self, value: &Value, depth: usize) -> Value {
        self.left = self.left.saturating_sub(1);
        match value {
            Value::String(text) if text.len() > TEXT_MAX => {
                let shown: String = text.chars().take(SHOWN_MAX).collect();
                json!({ "__repr__": shown, "__class__": "str", "__len__": text.chars().count() })
            }
            Value::Array(items) => self.list(items, depth),
            Value::Object(members) => match tag_of(members) {
                Some((tag, inner)) => self.tagged(tag, inner, depth),
                None => self.dict(members, depth),
            },
            short => short.clone(),
        }
    }

    /// Shortens a value with a tag as a whole: a tag around a shortened content would be another value.
    fn tagged(&mut self, tag: &str, inner: &Value, depth: usize) -> Value {
        let mut shown = self.at(inner, depth);
        if shown.is_object() && !inner.is_object() {
            shown["__class__"] = tag.trim_matches('_').into();
            return shown;
        }
        json!({ tag: shown })
    }

    fn list(&mut self, items: &[Value], depth: usize) -> Value {
        let is_whole = depth < DEPTH_MAX && items.len() <= self.left;
        let count = if depth < DEPTH_MAX { items.len().min(self.left) } else { 0 };
        let mut first = Vec::new();
        for item in &items[..count] {
            if self.left == 0 {
                break;
            }
            first.push(self.at(item, depth + 1));
        }
        if is_whole && first.len() == items.len() {
            return first.into();
        }
        let shown = format!("a list of {} items", items.len());
        json!({ "__repr__": shown, "__class__": "list", "__len__": items.len(), "__first__": first })
    }

    fn dict(&mut self, members: &Map<String, Value>, depth: usize) -> Value {
        let count = if depth < DEPTH_MAX { members.len().min(self.left) } else { 0 };
        let mut some = Map::new();
        for (name, member) in members.iter().take(count) {
            if self.left == 0 || name.len() > TEXT_MAX {
                break;
            }
            some.insert(name.clone(), self.at(member, depth + 1));
        }
        if some.len() == members.len() {
            return some.into();
        }
        let shown = format!("a dict of {} members", members.len());
        json!({ "__repr__": shown, "__class__": "dict", "__len__": members.len(), "__some__": some })
    }
}

/// The tag of a value that JSON does not have, such as a tuple, and its content.
fn tag_of(members: &Map<String, Value>) -> Option<(&str, &Value)> {
    let (tag, inner) = members.iter().next().filter(|_| members.len() == 1)?;
    let is_tag = tag.len() > 4 && tag.starts_with("__") && tag.ends_with("__");
    is_tag.then_some((tag.as_str(), inner))
}

#[cfg(test)]
mod tests {
    use super::{View, WHOLE_MAX, bounded};
    use rafcon_protocol::{Event, Outcome};
    use rafcon_storage::journal::folder::EndValues;
    use serde_json::{Map, Value, json};

    fn finished(outputs: &Value) -> Event {
        Event::Finished {
            outcome: Outcome { id: 0, name: "success".to_owned() },
            outputs: outputs.as_object().unwrap().clone(),
            globals: Map::new(),
            scoped_variables: Map::new(),
            states_run: 1,
        }
    }

    #[test]
    fn short_values_stay_whole() {
        let folder = tempfile::tempdir().unwrap();
        let event = finished(&json!({ "text": "x".repeat(2_000), "list": vec![0; 1_000] }));
        assert_eq!(bounded(event.clone(), folder.path()), (event, None));
        assert_eq!(EndValues::read(folder.path()).unwrap(), None);
    }

    #[test]
    fn a_long_value_with_a_tag_is_shortened_as_a_whole() {
        let folder = tempfile::tempdir().unwrap();
        let outputs = json!({
            "number": { "__int__": "9".repeat(40_000) },
            "pair": { "__tuple__": [1, 2] },
            "tuple": { "__tuple__": vec![7; 50_000] },
        });
        let (event, _) = bounded(finished(&outputs), folder.path());
        let Event::Finished { outputs: views, .. } = event else { panic!("the end") };
        let class = |name: &str| (&views[name]["__class__"], &views[name]["__len__"]);
        assert_eq!(class("number"), (&json!("int"), &json!(40_000)));
        assert_eq!(class("tuple"), (&json!("tuple"), &json!(50_000)));
        assert_eq!(views["pair"], json!({ "__tuple__": [1, 2] }));
    }

    #[test]
    fn of_long_values_the_event_has_views_and_the_folder_all() {
        let folder = tempfile::tempdir().unwrap();
        let outputs = json!({
            "cloud": vec![7; 1_000_000],
            "text": "é".repeat(2_000),
            "nested": { "first": [1, 2], "long": vec![vec!["x"; 100]; 1_000] },
            "names": (0..9_000).map(|it| (it.to_string(), it.into())).collect::<Map<_, _>>(),
            "count": 3,
        });
        let (event, message) = bounded(finished(&outputs), folder.path());
        assert_eq!(message, None);
        let length = serde_json::to_vec(&event).unwrap().len();
        assert!(length < WHOLE_MAX / 2, "{length} bytes");
        let Event::Finished { outputs: views, .. } = event else { panic!("the end") };
        assert_eq!((&views["count"], &views["nested"]["first"]), (&json!(3), &json!([1, 2])));
        assert_eq!(views["cloud"]["__len__"], 1_000_000);
        assert_eq!(views["cloud"]["__first__"].as_array().unwrap().len(), 255);
        assert_eq!(
            (&views["text"]["__len__"], &views["names"]["__len__"]),
            (&json!(2_000), &json!(9_000))
        );
        let whole = EndValues::read(folder.path()).unwrap().unwrap();
        assert_eq!(Value::from(whole.outputs), outputs);
    }

    #[test]
    fn a_view_has_so_many_items_levels_and_characters() {
        let list = |count: usize| Value::from(vec![7; count]);
        let nested = |levels: usize| (0..levels).fold(json!(7), |inner, _| json!([inner]));
        let text = |length: usize| Value::from("x".repeat(length));
        for whole in [list(255), nested(16), text(1024), json!([text(1024), 1])] {
            assert_eq!(View::of(&whole), whole);
        }
        let cut = View::of(&list(256));
        assert_eq!((&cut["__len__"], &cut["__first__"]), (&json!(256), &list(255)));
        let spent = View::of(&json!([list(253), 1, 2]));
        assert_eq!((&spent["__len__"], &spent["__first__"]), (&json!(3), &json!([list(253), 1])));
        let cut = View::of(&text(1025));
        assert_eq!(
            cut,
            json!({ "__repr__": "x".repeat(200), "__class__": "str", "__len__": 1025 })
        );
        let mut deep = &View::of(&json!([nested(16), 1]));
        while let Value::Array(items) = deep {
            deep = &items[0];
        }
        assert_eq!(
            (&deep["__repr__"], &deep["__first__"]),
            (&json!("a list of 1 items"), &json!([]))
        );
    }

    #[test]
    fn the_event_has_so_many_names_and_the_folder_all() {
        let folder = tempfile::tempdir().unwrap();
        let long = ("long".to_owned(), Value::from("x".repeat(WHOLE_MAX)));
        for (count, left) in [(256, 256), (257, 256), (9_000, 256)] {
            let names = (1..count).map(|it| (format!("name{it:05}"), it.into()));
            let outputs: Value = names.chain([long.clone()]).collect::<Map<_, _>>().into();
            let (event, message) = bounded(finished(&outputs), folder.path());
            let Event::Finished { outputs: views, .. } = event else { panic!("the end") };
            assert_eq!((views.len(), message), (left, None), "of {count}");
            let whole = EndValues::read(folder.path()).unwrap().unwrap();
            assert_eq!(Value::from(whole.outputs), outputs);
        }
    }

    #[test]
    fn a_disk_that_does_not_take_the_values_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let event = finished(&json!({ "text": "x".repeat(WHOLE_MAX) }));
        let (_, message) = bounded(event, &folder.path().join("gone"));
        assert!(message.is_some_and(|message| message.contains("end-values.json")));
    }
}
