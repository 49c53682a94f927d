//! Limits the size of the values in the last event of a run. This module knows JSON values, not their meaning.

use rafcon_protocol::{Event, LogLevel};
use rafcon_storage::journal::folder::EndValues;
use rafcon_storage::journal::{JournalError, folder::END_VALUES_FILE};
use serde_json::{Map, Value, json};
use std::io;
use std::path::Path;

/// Limit in bytes of JSON up to which the outputs stay whole. It also applies to the global variables, and to the
/// scoped variables.
const WHOLE_MAX: usize = 64 << 10;
/// Limit in bytes of the views of one kind: outputs, global or scoped variables. Beyond it, only the size of a value is
/// shown.
const VIEWS_MAX: usize = 256 << 10;
/// Bytes counted for each value in addition to its text.
const VALUE_BYTES: usize = 24;
/// Limit of the values in one view.
const ITEMS_MAX: usize = 256;
/// Limit of the depth of a view.
const DEPTH_MAX: usize = 16;
/// Limit of one text in bytes.
const TEXT_MAX: usize = 1024;
/// Number of characters of a long text in a view.
const SHOWN_MAX: usize = 200;
/// Limit of the named values in the event.
const NAMES_MAX: usize = 256;

/// Level and text of a line in the log of the run.
type Note = (LogLevel, String);

/// Shortens the values of the last event, so that a link can carry it. If they are long, all values are written to the
/// folder of the run. The notes report a failure, and values that the event does not name.
pub(super) fn bounded(event: Event, folder: &Path) -> (Event, Vec<Note>) {
    let Event::Finished { outcome, outputs, globals, scoped_variables, states_run } = event else {
        return (event, Vec::new());
    };
    let values = EndValues { outputs, globals, scoped_variables };
    let is_whole = [&values.outputs, &values.globals, &values.scoped_variables].map(is_short);
    let (views, notes) = if is_whole == [true; 3] {
        (values, Vec::new())
    } else {
        let written = values.write(folder).err();
        let failed = written.map(|error| (LogLevel::Error, message(&error)));
        let notes = failed.into_iter().chain(left_out(&values, is_whole)).collect();
        let [outputs, globals, scoped_variables] = is_whole;
        let views = EndValues {
            outputs: views(values.outputs, outputs),
            globals: views(values.globals, globals),
            scoped_variables: views(values.scoped_variables, scoped_variables),
        };
        (views, notes)
    };
    let EndValues { outputs, globals, scoped_variables } = views;
    (Event::Finished { outcome, outputs, globals, scoped_variables, states_run }, notes)
}

/// Reports how many values have no name in the event.
fn left_out(values: &EndValues, is_whole: [bool; 3]) -> Option<Note> {
    let all = [&values.outputs, &values.globals, &values.scoped_variables];
    let cut = all.iter().zip(is_whole).filter(|(_, is_whole)| !is_whole);
    let left_out: usize = cut.map(|(all, _)| all.len() - named(all).count()).sum();
    let note = format!(
        "{left_out} values at the end are not in the last event, which names {NAMES_MAX} of each kind; {END_VALUES_FILE} has all"
    );
    (left_out > 0).then_some((LogLevel::Warning, note))
}

fn message(error: &JournalError) -> String {
    format!(
        "the values at the end are shortened, and {END_VALUES_FILE} has not all of them: {error}"
    )
}

/// A writer that fails once it has received more bytes than this.
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

fn is_short(values: &Map<String, Value>) -> bool {
    serde_json::to_writer(Room(WHOLE_MAX), values).is_ok()
}

/// The values that the event names.
fn named(values: &Map<String, Value>) -> impl Iterator<Item = (&String, &Value)> {
    values.iter().filter(|(name, _)| name.len() <= TEXT_MAX).take(NAMES_MAX)
}

fn views(values: Map<String, Value>, is_whole: bool) -> Map<String, Value> {
    if is_whole {
        return values;
    }
    let mut room = VIEWS_MAX;
    let view = |(name, value): (&String, &Value)| (name.clone(), View::of(value, &mut room));
    named(&values).map(view).collect()
}

/// A view under construction.
struct View<'r> {
    /// Number of values that may still be shown.
    left: usize,
    /// Bytes left for this view and later ones.
    room: &'r mut usize,
}

impl<'r> View<'r> {
    fn of(value: &Value, room: &'r mut usize) -> Value {
        Self { left: ITEMS_MAX, room }.at(value, 0)
    }

    /// Takes the room for a value with these bytes of text. Returns false if there is too little room, for this value
    /// and all later ones.
    fn takes(&mut self, text: usize) -> bool {
        let left = self.room.checked_sub(text + VALUE_BYTES);
        *self.room = left.unwrap_or_default();
        left.is_some()
    }

    fn is_spent(&self) -> bool {
        self.left == 0 || *self.room == 0
    }

    fn at(&mut self, value: &Value, depth: usize) -> Value {
        self.left = self.left.saturating_sub(1);
        let has_room = self.takes(value.as_str().map_or(0, str::len));
        match value {
            Value::String(text) if text.len() > TEXT_MAX || !has_room => {
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

    /// Shortens a value with a tag as a whole, because a tag around shortened content would be another value.
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
            if self.is_spent() {
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
            if self.is_spent() || name.len() > TEXT_MAX || !self.takes(name.len()) {
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

/// The tag and the content of a value that JSON does not have, such as a tuple.
fn tag_of(members: &Map<String, Value>) -> Option<(&str, &Value)> {
    let (tag, inner) = members.iter().next().filter(|_| members.len() == 1)?;
    let is_tag = tag.len() > 4 && tag.starts_with("__") && tag.ends_with("__");
    is_tag.then_some((tag.as_str(), inner))
}

#[cfg(test)]
mod tests {
    use super::{ITEMS_MAX, NAMES_MAX, TEXT_MAX, View, WHOLE_MAX, bounded};
    use rafcon_protocol::{Event, LogLevel, Outcome};
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

    fn view_of(value: &Value) -> Value {
        let mut room = usize::MAX;
        View::of(value, &mut room)
    }

    #[test]
    fn the_event_is_bounded_whatever_the_values_are_and_short_outputs_stay_whole_beside_long_globals()
     {
        let folder = tempfile::tempdir().unwrap();
        let text = "x".repeat(TEXT_MAX);
        let many = |value: &Value| -> Map<String, Value> {
            (0..NAMES_MAX)
                .map(|nth| (format!("{nth}-{}", "n".repeat(900)), value.clone()))
                .collect()
        };
        let long_name = ("n".repeat(20_000_000), Value::from(1));
        let all = [json!(vec![text; ITEMS_MAX - 1]), json!(vec![0.123_456_789; ITEMS_MAX - 1])];
        for value in all {
            let globals: Map<_, _> = many(&value).into_iter().chain([long_name.clone()]).collect();
            let outputs = json!({ "numbers": vec![7; 3_000] });
            let mut event = finished(&outputs);
            let Event::Finished { globals: all, scoped_variables, .. } = &mut event else {
                panic!()
            };
            (*all, *scoped_variables) = (globals, many(&value));
            let (event, notes) = bounded(event, folder.path());
            let length = serde_json::to_vec(&event).unwrap().len();
            assert!(length < 2 << 20, "{length} bytes");
            let Event::Finished { outputs: shown, globals: views, .. } = &event else { panic!() };
            assert_eq!(Value::from(shown.clone()), outputs);
            // A value without room still shows its length.
            assert_eq!(views.values().next_back().unwrap()["__len__"], ITEMS_MAX - 1);
            assert_eq!((views.len(), notes.len()), (NAMES_MAX, 1));
        }
    }

    #[test]
    fn short_values_stay_whole() {
        let folder = tempfile::tempdir().unwrap();
        let event = finished(&json!({ "text": "x".repeat(2_000), "list": vec![0; 1_000] }));
        assert_eq!(bounded(event.clone(), folder.path()), (event, Vec::new()));
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
        let (event, notes) = bounded(finished(&outputs), folder.path());
        assert_eq!(notes, []);
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
            assert_eq!(view_of(&whole), whole);
        }
        let cut = view_of(&list(256));
        assert_eq!((&cut["__len__"], &cut["__first__"]), (&json!(256), &list(255)));
        let spent = view_of(&json!([list(253), 1, 2]));
        assert_eq!((&spent["__len__"], &spent["__first__"]), (&json!(3), &json!([list(253), 1])));
        let cut = view_of(&text(1025));
        assert_eq!(
            cut,
            json!({ "__repr__": "x".repeat(200), "__class__": "str", "__len__": 1025 })
        );
        let mut deep = &view_of(&json!([nested(16), 1]));
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
        let note = |left_out: usize| {
            let rest = "values at the end are not in the last event, which names 256 of each kind; end-values.json has all";
            (LogLevel::Warning, format!("{left_out} {rest}"))
        };
        for (count, reported) in [(256, vec![]), (257, vec![note(1)]), (9_000, vec![note(8_744)])] {
            let names = (1..count).map(|it| (format!("name{it:05}"), it.into()));
            let outputs: Value = names.chain([long.clone()]).collect::<Map<_, _>>().into();
            let (event, notes) = bounded(finished(&outputs), folder.path());
            let Event::Finished { outputs: views, .. } = event else { panic!("the end") };
            assert_eq!((views.len(), notes), (256, reported), "of {count}");
            let whole = EndValues::read(folder.path()).unwrap().unwrap();
            assert_eq!(Value::from(whole.outputs), outputs);
        }
    }

    #[test]
    fn a_disk_that_does_not_take_the_values_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let event = finished(&json!({ "text": "x".repeat(WHOLE_MAX) }));
        let (_, notes) = bounded(event, &folder.path().join("gone"));
        let [(LogLevel::Error, note)] = notes.as_slice() else { panic!("{notes:?}") };
        assert!(note.contains("end-values.json"));
    }
}
