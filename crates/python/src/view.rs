//! Views of values for people: bounded JSON, encoded as in `docs/protocol.md`, with a flag for complete views.
//!
//! Knows Python's own types. Does not know the storage of views.

use super::array;
use pyo3::exceptions::PyBaseException;
use pyo3::prelude::*;
use pyo3::types::{
    PyBool, PyByteArray, PyBytes, PyDict, PyFloat, PyFrozenSet, PyInt, PyList, PySet, PySlice,
    PyString, PyTuple, PyType,
};
use rafcon_storage::journal::record::{float, int};
use serde_json::{Map, Value, json};

/// Maximum number of values in one view.
const ITEMS_MAX: usize = 256;
/// Maximum number of array items inside of another value.
const NESTED_MAX: usize = 64;
/// Maximum depth of nested values in a view.
const DEPTH_MAX: usize = 16;
/// Maximum size of one text, in bytes.
const TEXT_MAX: usize = 1024;
/// Maximum length of an exception's text, in characters.
const MESSAGE_MAX: usize = 16 << 10;
/// Maximum length of a text for a value that has no encoding of its own.
const SHOWN_MAX: usize = 200;
/// Keys that give an object a meaning other than a dictionary.
const SPECIAL: [&str; 8] =
    ["__tuple__", "__set__", "__dict__", "__int__", "__float__", "__exc__", "__type__", "__repr__"];
/// Maximum number of bits of an integer that is written out: about 1024 digits.
const INT_BITS_MAX: u64 = 3400;

/// A view of one value.
#[derive(Debug)]
pub(crate) struct View {
    pub(crate) json: Value,
    /// True if [`super::restore::from_view`] restores exactly this value from the view.
    pub(crate) whole: bool,
}

/// The view of any object. May run user code, such as a `__repr__`.
pub(crate) fn view(object: &Bound<'_, PyAny>) -> View {
    let mut looking = Looking { left: ITEMS_MAX, seen: Vec::new(), whole: true };
    let json = looking.at(object, 0);
    View { json, whole: looking.whole }
}

struct Looking {
    /// Number of values that still fit in the view.
    left: usize,
    /// Addresses of the lists and dictionaries visited. A second visit means a shared object, which JSON cannot express.
    seen: Vec<usize>,
    whole: bool,
}

impl Looking {
    fn at(&mut self, object: &Bound<'_, PyAny>, depth: usize) -> Value {
        self.left = self.left.saturating_sub(1);
        if object.is_none() {
            Value::Null
        } else if let Ok(truth) = object.cast_exact::<PyBool>() {
            Value::Bool(truth.is_true())
        } else if object.is_exact_instance_of::<PyInt>() {
            self.int(object)
        } else if let Ok(number) = object.cast_exact::<PyFloat>() {
            self.float(number)
        } else if let Ok(text) = object.cast_exact::<PyString>() {
            self.text(text)
        } else {
            self.container(object, depth)
        }
    }

    fn int(&mut self, object: &Bound<'_, PyAny>) -> Value {
        match object.extract::<i64>() {
            Ok(number) => int(number),
            Err(_too_large) => self.large_int(object),
        }
    }

    fn large_int(&mut self, object: &Bound<'_, PyAny>) -> Value {
        let bits = object.call_method0("bit_length").and_then(|bits| bits.extract());
        let bits = bits.unwrap_or(u64::MAX);
        if bits > INT_BITS_MAX {
            return self.part(|| named(object, &format!("an int of {bits} bits")));
        }
        json!({ "__int__": words(object, object.str()) })
    }

    fn float(&mut self, number: &Bound<'_, PyFloat>) -> Value {
        match float(number.value()) {
            value @ Value::Object(_) if !number.value().is_finite() => self.part(|| value),
            value => value,
        }
    }

    fn text(&mut self, text: &Bound<'_, PyString>) -> Value {
        match text.to_cow() {
            Ok(text) if text.len() <= TEXT_MAX => text.into(),
            Ok(text) => self.part(|| shortened(&text)),
            Err(_lone_surrogates) => self.part(|| represented(text)),
        }
    }

    fn container(&mut self, object: &Bound<'_, PyAny>, depth: usize) -> Value {
        if depth == DEPTH_MAX {
            return self.part(|| named(object, &format!("a nested {}", class_name(object))));
        }
        if let Ok(list) = object.cast_exact::<PyList>() {
            self.meet(object);
            self.sequence(object, list.len(), list.iter(), depth)
        } else if let Ok(tuple) = object.cast_exact::<PyTuple>() {
            let items = self.sequence(object, tuple.len(), tuple.iter(), depth);
            if items.is_array() { json!({ "__tuple__": items }) } else { items }
        } else if let Ok(dict) = object.cast_exact::<PyDict>() {
            self.meet(object);
            self.dict(dict, depth)
        } else {
            let shown = self.part(|| other(object));
            self.with_shape(object, shown, depth)
        }
    }

    /// Adds type and shape of an array, and some of its items.
    fn with_shape(&mut self, object: &Bound<'_, PyAny>, mut shown: Value, depth: usize) -> Value {
        let text = |name: &str| object.getattr(name).ok()?.str().ok()?.extract::<String>().ok();
        let shape = || object.getattr("shape").ok()?.extract::<Vec<u64>>().ok();
        let is_array =
            !object.is_instance_of::<PyType>() && object.hasattr("dtype").unwrap_or(false);
        if let (true, Some(shape), Value::Object(members)) = (is_array, shape(), &mut shown) {
            members.insert("__dtype__".to_owned(), text("dtype").unwrap_or_default().into());
            if let Some(sample) = array::sample(object, &shape, self.room(depth)) {
                self.numbers(sample, members);
            }
            members.insert("__shape__".to_owned(), shape.into());
        }
        shown
    }

    /// Maximum number of array items to show. Inside of other values it leaves room for the values that follow.
    fn room(&self, depth: usize) -> usize {
        if depth == 0 { ITEMS_MAX } else { (self.left / 2).min(NESTED_MAX) }
    }

    /// The sampled items of an array, if they are Python numbers.
    fn numbers(&mut self, sample: array::Sample<'_>, members: &mut Map<String, Value>) {
        let is_number = |item: &Bound<'_, PyAny>| {
            item.is_exact_instance_of::<PyFloat>()
                || item.is_exact_instance_of::<PyInt>()
                || item.is_exact_instance_of::<PyBool>()
        };
        if sample.items.iter().all(is_number) {
            let items = sample.items.iter().map(|item| self.at(item, DEPTH_MAX)).collect();
            members.insert("__items__".to_owned(), Value::Array(items));
            members.insert("__sampled__".to_owned(), sample.sampled.into());
            members.insert("__steps__".to_owned(), sample.steps.into());
        }
    }

    fn meet(&mut self, object: &Bound<'_, PyAny>) {
        let address = object.as_ptr() as usize;
        self.whole &= !self.seen.contains(&address);
        self.seen.push(address);
    }

    fn sequence<'py>(
        &mut self,
        object: &Bound<'py, PyAny>,
        count: usize,
        items: impl Iterator<Item = Bound<'py, PyAny>>,
        depth: usize,
    ) -> Value {
        if count > self.left {
            let first = items.take(self.left).map(|item| self.at(&item, depth + 1)).collect();
            return self.part(|| cut(object, count, "__first__", Value::Array(first)));
        }
        items.map(|item| self.at(&item, depth + 1)).collect()
    }

    fn dict(&mut self, dict: &Bound<'_, PyDict>, depth: usize) -> Value {
        let count = dict.len();
        let entries: Vec<_> = dict.iter().take(self.left).collect();
        let keys: Option<Vec<String>> = entries.iter().map(|(key, _)| plain_key(key)).collect();
        let shown =
            match keys.filter(|keys| keys.is_empty() || !keys.iter().all(|key| is_integer(key))) {
                Some(keys) => self.members(keys, &entries, depth),
                None => self.pairs(&entries, depth),
            };
        if count > entries.len() {
            return self.part(|| cut(dict, count, "__some__", shown));
        }
        shown
    }

    /// A dictionary as a JSON object; all its keys are plain texts.
    fn members(&mut self, keys: Vec<String>, entries: &[Entry<'_>], depth: usize) -> Value {
        // Readers receive the keys sorted. Only a dictionary in that order is restored unchanged.
        self.whole &= keys.is_sorted();
        let entries = keys.into_iter().zip(entries);
        entries.map(|(key, (_, value))| (key, self.at(value, depth + 1))).collect()
    }

    /// A dictionary as a list of pairs, for other keys.
    fn pairs(&mut self, entries: &[Entry<'_>], depth: usize) -> Value {
        let pair = |(key, value): &Entry<'_>| {
            Value::Array(vec![self.at(key, depth + 1), self.at(value, depth + 1)])
        };
        json!({ "__dict__": entries.iter().map(pair).collect::<Vec<_>>() })
    }

    /// Shows a part of the value and marks the view as incomplete.
    fn part(&mut self, show: impl FnOnce() -> Value) -> Value {
        self.whole = false;
        show()
    }
}

/// A key of a dictionary with its value.
type Entry<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// The key as a JSON key; `None` unless it is a short text without a special meaning.
fn plain_key(key: &Bound<'_, PyAny>) -> Option<String> {
    let text = key.cast_exact::<PyString>().ok()?;
    let text = text.to_cow().ok().filter(|text| text.len() <= TEXT_MAX)?;
    (!SPECIAL.contains(&&*text)).then(|| text.into_owned())
}

/// True for a key that a reader of files converts to a whole number.
fn is_integer(key: &str) -> bool {
    key.parse::<i64>().is_ok_and(|number| number.to_string() == key)
}

/// A value without an encoding of its own.
fn other(object: &Bound<'_, PyAny>) -> Value {
    if object.is_instance_of::<PyBaseException>() {
        json!({ "__exc__": class_name(object), "msg": message(object) })
    } else if let Ok(class) = object.cast::<PyType>() {
        let name = class.name().map(|name| name.to_string_lossy().into_owned());
        json!({ "__type__": name.unwrap_or_default() })
    } else if let Some(bytes) = leading_bytes(object) {
        let shown = named(object, &words(object, bytes.repr()));
        let is_cut = object.len().is_ok_and(|count| count > SHOWN_MAX);
        if is_cut { with_length(object, shown) } else { shown }
    } else if is_large_set(object) {
        with_length(object, named(object, &format!("{} of many", class_name(object))))
    } else {
        represented(object)
    }
}

/// The first bytes of `bytes` or a `bytearray`, so that a long value is not written out.
fn leading_bytes<'py>(object: &Bound<'py, PyAny>) -> Option<Bound<'py, PyAny>> {
    let is_bytes =
        object.is_exact_instance_of::<PyBytes>() || object.is_exact_instance_of::<PyByteArray>();
    let first = PySlice::new(object.py(), 0, SHOWN_MAX.cast_signed(), 1);
    is_bytes.then(|| object.get_item(first).ok()).flatten()
}

fn is_large_set(object: &Bound<'_, PyAny>) -> bool {
    let is_set =
        object.is_exact_instance_of::<PySet>() || object.is_exact_instance_of::<PyFrozenSet>();
    is_set && object.len().is_ok_and(|count| count > ITEMS_MAX)
}

fn cut(object: &Bound<'_, PyAny>, count: usize, key: &str, some: Value) -> Value {
    let mut shown = named(object, &format!("{} of {count}", class_name(object)));
    if let Value::Object(members) = &mut shown {
        members.insert("__len__".to_owned(), count.into());
        members.insert(key.to_owned(), some);
    }
    shown
}

fn shortened(text: &str) -> Value {
    let first: String = text.chars().take(SHOWN_MAX).collect();
    json!({ "__repr__": first, "__class__": "str", "__len__": text.chars().count() })
}

fn represented(object: &Bound<'_, PyAny>) -> Value {
    named(object, &words(object, object.repr()))
}

fn named(object: &Bound<'_, PyAny>, text: &str) -> Value {
    let shown: String = text.chars().take(SHOWN_MAX).collect();
    let is_cut = shown.len() < text.len();
    let mut shown = json!({ "__repr__": shown, "__class__": class_name(object) });
    if is_cut && let Value::Object(members) = &mut shown {
        members.insert("__len__".to_owned(), text.chars().count().into());
    }
    shown
}

/// Adds the number of items to a truncated view.
fn with_length(object: &Bound<'_, PyAny>, mut shown: Value) -> Value {
    if let (Value::Object(members), Ok(count)) = (&mut shown, object.len()) {
        members.insert("__len__".to_owned(), count.into());
    }
    shown
}

fn class_name(object: &Bound<'_, PyAny>) -> String {
    let name = object.get_type().name().map(|name| name.to_string_lossy().into_owned());
    name.unwrap_or_default()
}

/// The text of an exception, truncated because scripts set its length.
fn message(exception: &Bound<'_, PyAny>) -> String {
    let text = words(exception, exception.str());
    match text.char_indices().nth(MESSAGE_MAX) {
        Some((end, _)) => format!("{}… ({} characters)", &text[..end], text.chars().count()),
        None => text,
    }
}

/// An object's own text, which may fail.
fn words(object: &Bound<'_, PyAny>, said: PyResult<Bound<'_, PyString>>) -> String {
    let said = said.map(|text| text.to_string_lossy().into_owned());
    said.unwrap_or_else(|_failing| format!("<{} that cannot be shown>", class_name(object)))
}
