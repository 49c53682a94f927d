//! A text notation of journals for tests, one item a line. Knows the syntax of items, not their storage.
//!
//! ```text
//! place ROOT "Mission" in speed out dist scoped n outcome done,lost
//! place ROOT/A "Mission/Scan" script outcome success
//! @2.5 enter ROOT speed=1
//! enter ROOT/A undoes 3
//! leave ROOT/A success error="no camera"
//! scoped ROOT n=[1, 2]
//! global map="kitchen"
//! global map
//! persistent ROOT/A {"calls": 1}
//! log ROOT/A warning "too dark"
//! told {"type": "stopping"}
//! ```
//!
//! Places are numbered in order of appearance. So are ports, over all three kinds; the user's outcomes count from 0. `@`
//! sets the time in ms; without it a record is 1 ms after the one before. Values that do not fit into an event are defined
//! automatically.

use rafcon_protocol::{LogLevel, Stream};
use rafcon_storage::journal::record::{Content, TEXT_MAX};
use rafcon_storage::journal::{
    Batch, Definition, Item, Kept, Place, PlaceNumber, Record, Stored, ValueNumber,
};
use serde_json::Value;
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::num::NonZeroU64;
use std::time::Duration;

/// An invalid line of the notation: its number and the problem.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub struct BadNotation {
    line: usize,
    what: String,
}

/// Parses a text line by line. Empty lines are skipped.
pub fn parse(text: &str) -> Result<Vec<Item>, BadNotation> {
    let mut parser = Parser::default();
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.trim();
        if !text.is_empty() {
            parser.line(text).map_err(|what| BadNotation { line, what })?;
        }
    }
    Ok(parser.items)
}

/// Parses all items into one batch, for a journal whose last event was at `t_ns`.
pub fn batch(text: &str, t_ns: u64) -> Result<Batch, BadNotation> {
    let mut batch = Batch::new(t_ns);
    for item in parse(text)? {
        match item {
            Item::Record(t_ns, record) => batch.record(t_ns, &record),
            Item::Definition(definition) => batch.define(&definition),
        }
    }
    Ok(batch)
}

#[derive(Default)]
struct Parser {
    items: Vec<Item>,
    places: BTreeMap<String, (PlaceNumber, Place)>,
    values: u64,
    t_ns: u64,
}

type Parsed<T> = Result<T, String>;

impl Parser {
    fn line(&mut self, text: &str) -> Parsed<()> {
        if let Some(rest) = text.strip_prefix("place ") {
            return self.place(rest);
        }
        let text = self.time(text)?;
        let (word, rest) = text.split_once(' ').unwrap_or((text, ""));
        let record = match word {
            "enter" => self.enter(rest)?,
            "leave" => self.leave(rest)?,
            "scoped" => self.scoped(rest)?,
            "global" => self.global(rest)?,
            "persistent" => {
                let (path, value) = split(rest)?;
                let (place, _) = self.known(path)?;
                Record::Persistent { place, value: self.kept(json(value)?.0) }
            }
            "log" => self.log(rest)?,
            "told" => Record::Told(serde_json::from_str(rest).map_err(|e| e.to_string())?),
            _ => return Err(format!("`{word}` is no kind of record")),
        };
        self.items.push(Item::Record(self.t_ns, record));
        Ok(())
    }

    fn time<'t>(&mut self, text: &'t str) -> Parsed<&'t str> {
        let Some(rest) = text.strip_prefix('@') else {
            self.t_ns += 1_000_000;
            return Ok(text);
        };
        let (ms, rest) = split(rest)?;
        let ms: f64 = ms.parse().map_err(|_bad| format!("`{ms}` is no time in ms"))?;
        let time = Duration::try_from_secs_f64(ms / 1e3).map_err(|error| error.to_string())?;
        self.t_ns = u64::try_from(time.as_nanos()).map_err(|error| error.to_string())?;
        Ok(rest)
    }

    fn place(&mut self, text: &str) -> Parsed<()> {
        let (path, rest) = split(text)?;
        let (names, rest) = json(rest)?;
        let mut place = Place {
            path: path.to_owned(),
            names: names.as_str().unwrap_or(path).to_owned(),
            is_library: false,
            is_script: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
            scoped: Vec::new(),
            outcomes: vec![(-2, "preempted".into()), (-1, "aborted".into())],
        };
        let mut ids = 0..;
        let mut words = rest.split_whitespace();
        while let Some(word) = words.next() {
            let ports = match word {
                "library" => {
                    place.is_library = true;
                    continue;
                }
                "script" => {
                    place.is_script = true;
                    continue;
                }
                "outcome" => {
                    let names = words.next().ok_or("names of outcomes are missing")?.split(',');
                    place.outcomes.extend((0..).zip(names.map(SmolStr::from)));
                    continue;
                }
                "in" => &mut place.inputs,
                "out" => &mut place.outputs,
                "scoped" => &mut place.scoped,
                _ => return Err(format!("`{word}` is nothing that a place has")),
            };
            let names = words.next().ok_or("names of ports are missing")?.split(',');
            ports.extend(names.map(|name| (ids.next().unwrap_or(0), SmolStr::from(name))));
        }
        let count = u32::try_from(self.places.len()).map_err(|error| error.to_string())?;
        let number = self.places.get(path).map_or(PlaceNumber(count), |(number, _)| *number);
        self.places.insert(path.to_owned(), (number, place.clone()));
        self.items.push(Item::Definition(Definition::Place(number, place)));
        Ok(())
    }

    fn enter(&mut self, text: &str) -> Parsed<Record> {
        let (path, rest) = split(text)?;
        let (number, place) = self.known(path)?;
        let (mut values, undoes) = self.values(rest)?;
        let inputs = in_order(&place.inputs, &mut values);
        nothing_left(&values)?;
        Ok(Record::Entered { place: number, inputs, undoes })
    }

    fn leave(&mut self, text: &str) -> Parsed<Record> {
        let (path, rest) = split(text)?;
        let (number, place) = self.known(path)?;
        let (outcome, rest) = split(rest)?;
        let outcome = place.outcomes.iter().find(|(_, name)| name == outcome);
        let (outcome, _) = *outcome.ok_or_else(|| format!("{path} has no such outcome"))?;
        let (mut values, undoes) = self.values(rest)?;
        let error = values.remove("error");
        let outputs = in_order(&place.outputs, &mut values);
        nothing_left(&values)?;
        Ok(Record::Left { place: number, outcome, outputs, error, undoes })
    }

    fn scoped(&mut self, text: &str) -> Parsed<Record> {
        let (path, rest) = split(text)?;
        let (number, place) = self.known(path)?;
        let (values, _) = self.values(rest)?;
        let (name, value) = values.into_iter().next().ok_or("a value is missing")?;
        let port = place.scoped.iter().find(|(_, known)| **known == name);
        let (port, _) = *port.ok_or_else(|| format!("{path} has no variable {name}"))?;
        Ok(Record::Scoped { place: number, port, value })
    }

    fn global(&mut self, text: &str) -> Parsed<Record> {
        let (values, _) = self.values(text)?;
        let (name, value) = match values.into_iter().next() {
            Some((name, value)) => (name, Some(value)),
            None => (text.to_owned(), None),
        };
        Ok(Record::Global { name: name.into(), value })
    }

    fn log(&mut self, text: &str) -> Parsed<Record> {
        let (path, rest) = split(text)?;
        let (level, rest) = split(rest)?;
        let place = if path == "-" { None } else { Some(self.known(path)?.0) };
        let level: LogLevel =
            serde_json::from_value(level.into()).map_err(|_bad| format!("no level: {level}"))?;
        let message = json(rest)?.0.as_str().unwrap_or_default().to_owned();
        Ok(Record::Log { place, level, stream: Stream::Logger, message })
    }

    fn known(&self, path: &str) -> Parsed<(PlaceNumber, Place)> {
        self.places.get(path).cloned().ok_or_else(|| format!("no place {path} was defined"))
    }

    /// Parses any number of `name=json`, and `undoes N`.
    fn values(&mut self, text: &str) -> Parsed<(BTreeMap<String, Kept>, Option<NonZeroU64>)> {
        let mut values = BTreeMap::new();
        let mut rest = text.trim_start();
        while let Some((name, after)) = rest.split_once('=') {
            if name.contains(' ') {
                break;
            }
            let (value, after) = json(after)?;
            values.insert(name.to_owned(), self.kept(value));
            rest = after;
        }
        let undoes = rest.strip_prefix("undoes ").and_then(|number| number.trim().parse().ok());
        Ok((values, undoes))
    }

    fn kept(&mut self, value: Value) -> Kept {
        match value {
            Value::Null => Kept::None,
            Value::Bool(value) => Kept::Bool(value),
            Value::Number(ref number) => match (number.as_i64(), number.as_f64()) {
                (Some(number), _) => Kept::Int(number),
                (None, Some(number)) => Kept::Float(number),
                (None, None) => self.defined(value),
            },
            Value::String(text) if text.len() <= TEXT_MAX => Kept::Text(text.into()),
            value => self.defined(value),
        }
    }

    fn defined(&mut self, view: Value) -> Kept {
        self.values += 1;
        let type_name = match view {
            Value::Array(_) => "list",
            Value::Object(_) => "dict",
            _ => "str",
        };
        let stored = Stored { view, type_name: type_name.into(), content: Content::View };
        let number = ValueNumber(self.values);
        self.items.push(Item::Definition(Definition::Value(number, stored)));
        Kept::Value(number)
    }
}

/// Splits the text after the first word.
fn split(text: &str) -> Parsed<(&str, &str)> {
    let (word, rest) = text.split_once(' ').unwrap_or((text, ""));
    if word.is_empty() { Err("the line is not complete".to_owned()) } else { Ok((word, rest)) }
}

/// Splits the text after the JSON value at its beginning.
fn json(text: &str) -> Parsed<(Value, &str)> {
    let mut values = serde_json::Deserializer::from_str(text).into_iter::<Value>();
    match values.next() {
        Some(Ok(value)) => Ok((value, text[values.byte_offset()..].trim_start())),
        Some(Err(error)) => Err(error.to_string()),
        None => Err("a value is missing".to_owned()),
    }
}

/// One value for each port. If none is named, no values were kept.
fn in_order(ports: &[(u64, SmolStr)], values: &mut BTreeMap<String, Kept>) -> Vec<Kept> {
    if values.is_empty() {
        return Vec::new();
    }
    let value = |(_, name): &(u64, SmolStr)| values.remove(name.as_str()).unwrap_or(Kept::Absent);
    ports.iter().map(value).collect()
}

fn nothing_left(values: &BTreeMap<String, Kept>) -> Parsed<()> {
    values.keys().next().map_or(Ok(()), |name| Err(format!("there is no port {name}")))
}
