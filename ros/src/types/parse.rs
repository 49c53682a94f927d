//! Parser for interface files: `.msg`, and the parts of `.srv` and `.action`.
//!
//! Any text gives messages, or an error with its line. Nothing panics.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Base, Field, Message, Primitive, Shape, Sort, literal};

/// Maximum number of fields of a type.
const FIELDS_MAX: usize = 10_000;

/// The messages in a file: one, or the named parts of a service or action.
pub(crate) fn file(
    text: &str,
    package: &str,
    sort: Sort,
    name: &str,
) -> Result<Vec<Message>, String> {
    let endings: &[&str] = match sort {
        Sort::Message => &[""],
        Sort::Service => &["_Request", "_Response"],
        Sort::Action => &["_Goal", "_Result", "_Feedback"],
    };
    let full = format!("{package}/{}/{name}", sort.word());
    let mut parts = vec![Vec::new()];
    for (index, line) in text.lines().enumerate() {
        let line = without_comment(line).trim();
        if line == "---" && sort != Sort::Message {
            parts.push(Vec::new());
        } else if let Some(part) = parts.last_mut()
            && !line.is_empty()
        {
            part.push((index + 1, line));
        }
    }
    if parts.len() != endings.len() {
        let lines = endings.len() - 1;
        return Err(format!("{full} has {} lines `---`, not {lines}", parts.len() - 1));
    }
    let parts = parts.iter().zip(endings);
    parts.map(|(lines, ending)| message(lines, package, format!("{full}{ending}"))).collect()
}

fn message(lines: &[(usize, &str)], package: &str, name: String) -> Result<Message, String> {
    let mut message = Message { name, fields: Vec::new(), constants: Vec::new() };
    let mut names = BTreeSet::new();
    for (number, line) in lines {
        let wrong = |why: String| format!("{}, line {number}: {why}", message.name);
        let entry = entry(line, package).map_err(wrong)?;
        if !names.insert(entry.name().to_owned()) {
            return Err(format!(
                "{}, line {number}: `{}` is there twice",
                message.name,
                entry.name()
            ));
        }
        match entry {
            Entry::Field(field) => message.fields.push(*field),
            Entry::Constant(name, primitive, value) => {
                message.constants.push((name, primitive, value))
            }
        }
        if message.fields.len() + message.constants.len() > FIELDS_MAX {
            return Err(format!("{} has more than {FIELDS_MAX} fields", message.name));
        }
    }
    Ok(message)
}

enum Entry {
    Field(Box<Field>),
    Constant(String, Primitive, super::Literal),
}

impl Entry {
    fn name(&self) -> &str {
        match self {
            Self::Field(field) => &field.name,
            Self::Constant(name, ..) => name,
        }
    }
}

/// Parses `type name`, `type name default`, or `type NAME=value`.
fn entry(line: &str, package: &str) -> Result<Entry, String> {
    // Annotations such as `@key` before a field are for the middleware.
    if line.starts_with('@') {
        return Err("annotations are not known here".to_owned());
    }
    let (type_text, rest) =
        line.split_once(char::is_whitespace).ok_or("a type and a name are needed")?;
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
    let (name, after) = rest.split_at(end);
    if !name.starts_with(|first: char| first.is_ascii_alphabetic()) {
        return Err(format!("`{rest}` begins with no name"));
    }
    let mut field = typed(type_text, package)?;
    field.name = name.to_owned();
    let after = after.trim();
    if let Some(value) = after.strip_prefix('=') {
        let Base::Primitive(primitive) = field.base else {
            return Err(format!("`{type_text}` is no type for a constant"));
        };
        if field.shape != Shape::One {
            return Err(format!("`{type_text}` is no type for a constant"));
        }
        let value = literal::constant(value.trim(), primitive)?;
        return Ok(Entry::Constant(field.name, primitive, value));
    }
    if !after.is_empty() {
        field.default = Some(literal::default(after, &field)?);
    }
    Ok(Entry::Field(Box::new(field)))
}

/// Parses `float64[9]`, `string<=10[<=3]`, `Point`, `geometry_msgs/Point[]`.
fn typed(text: &str, package: &str) -> Result<Field, String> {
    let (base, shape) = match text.strip_suffix(']') {
        None => (text, Shape::One),
        Some(open) => {
            let (base, size) =
                open.rsplit_once('[').ok_or_else(|| format!("`{text}` lacks a `[`"))?;
            (base, shape(size)?)
        }
    };
    let (base, text_max) = match base.split_once("<=") {
        None => (base, 0),
        Some((base @ ("string" | "wstring"), size)) => (base, number(size)?),
        Some(_) => return Err(format!("`{text}`: only texts are bounded by `<=`")),
    };
    let base = match Primitive::named(base) {
        Some(primitive) => Base::Primitive(primitive),
        None => Base::Message(message_name(base, package)?),
    };
    Ok(Field { name: String::new(), base, shape, text_max, default: None })
}

fn shape(size: &str) -> Result<Shape, String> {
    Ok(match size.strip_prefix("<=") {
        Some(most) => Shape::Bounded(number(most)?),
        None if size.is_empty() => Shape::Unbounded,
        None => Shape::Fixed(number(size)?),
    })
}

fn number(text: &str) -> Result<u32, String> {
    let value = text.parse().ok().filter(|value| *value > 0);
    value.ok_or_else(|| format!("`{text}` is no size"))
}

/// The full name of a message type in a field of `package`.
fn message_name(text: &str, package: &str) -> Result<Arc<str>, String> {
    let full = match text.split('/').collect::<Vec<_>>()[..] {
        // Short name in files of ROS 1.
        ["Header"] => "std_msgs/msg/Header".to_owned(),
        [name] => format!("{package}/msg/{name}"),
        [package, name] => format!("{package}/msg/{name}"),
        [package, "msg", name] => format!("{package}/msg/{name}"),
        _ => return Err(format!("`{text}` is no type")),
    };
    super::TypeName::parse(&full).map_err(|_| format!("`{text}` is no type"))?;
    Ok(full.into())
}

/// The line up to a `#` outside of quotes.
fn without_comment(line: &str) -> &str {
    let (mut quote, mut escaped) = (None, false);
    for (at, c) in line.char_indices() {
        match quote {
            _ if escaped => escaped = false,
            Some(_) if c == '\\' => escaped = true,
            Some(open) if c == open => quote = None,
            None if c == '#' => return &line[..at],
            None if c == '"' || c == '\'' => quote = Some(c),
            _ => {}
        }
    }
    // An unclosed quote is an apostrophe.
    match quote {
        Some(_) => line.split('#').next().unwrap_or(line),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use expect_test::{Expect, expect};
    use proptest::prelude::*;

    use super::super::Sort;
    use super::{FIELDS_MAX, file};

    fn check(sort: Sort, text: &str, expected: Expect) {
        let shown = match file(text, "own", sort, "Own") {
            Err(why) => why,
            Ok(messages) => messages
                .iter()
                .flat_map(|message| {
                    let fields = message.fields.iter().map(|field| {
                        format!(
                            "  {} {:?} {:?} {} {:?}",
                            field.name, field.base, field.shape, field.text_max, field.default
                        )
                    });
                    let constants = message
                        .constants
                        .iter()
                        .map(|(name, of, value)| format!("  {name} = {of:?} {value:?}"));
                    [message.name.clone()]
                        .into_iter()
                        .chain(fields)
                        .chain(constants)
                        .collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
                .join("\n"),
        };
        expected.assert_eq(&shown);
    }

    #[test]
    fn fields_constants_defaults_and_bounds_are_read() {
        check(
            Sort::Message,
            "# a comment\nint8 A=-0x7f # more\nstring T=it's # no comment\nstring<=10[<=3] names ['a, b', \"c#\"]\n\nfloat64[9] m\n\tother/Thing[] t\nHeader header\nbool b true",
            expect![[r#"
                own/msg/Own
                  names Primitive(Text) Bounded(3) 10 Some(List([Text("a, b"), Text("c#")]))
                  m Primitive(Float64) Fixed(9) 0 None
                  t Message("other/msg/Thing") Unbounded 0 None
                  header Message("std_msgs/msg/Header") One 0 None
                  b Primitive(Bool) One 0 Some(Bool(true))
                  A = Int8 Int(-127)
                  T = Text Text("it's")"#]],
        );
    }

    #[test]
    fn a_type_of_too_many_fields_is_refused() {
        let text =
            |count: usize| (0..count).map(|number| format!("int8 a{number}\n")).collect::<String>();
        let whole = file(&text(FIELDS_MAX), "own", Sort::Message, "Own").unwrap();
        assert_eq!(whole[0].fields.len(), FIELDS_MAX);
        check(
            Sort::Message,
            &text(FIELDS_MAX + 1),
            expect!["own/msg/Own has more than 10000 fields"],
        );
    }

    #[test]
    fn services_and_actions_have_their_parts() {
        check(
            Sort::Service,
            "int8 a\n---\nint8 b",
            expect![[r#"
            own/srv/Own_Request
              a Primitive(Int8) One 0 None
            own/srv/Own_Response
              b Primitive(Int8) One 0 None"#]],
        );
        check(
            Sort::Action,
            "---\nint8 b\n---",
            expect![[r#"
            own/action/Own_Goal
            own/action/Own_Result
              b Primitive(Int8) One 0 None
            own/action/Own_Feedback"#]],
        );
        check(Sort::Action, "int8 b\n---", expect!["own/action/Own has 1 lines `---`, not 2"]);
    }

    #[test]
    fn what_is_no_interface_is_refused_with_its_line() {
        for (text, expected) in [
            ("int8 a\nint8 a", expect!["own/msg/Own, line 2: `a` is there twice"]),
            ("\nint8", expect!["own/msg/Own, line 2: a type and a name are needed"]),
            ("int8 A=128", expect!["own/msg/Own, line 1: `128` is no int8"]),
            ("int8[0] a", expect!["own/msg/Own, line 1: `0` is no size"]),
            (
                "int8[2] a [1]",
                expect!["own/msg/Own, line 1: the default has 1 values, which do not fit"],
            ),
            (
                "int8<=3 a",
                expect!["own/msg/Own, line 1: `int8<=3`: only texts are bounded by `<=`"],
            ),
            ("a/b/c/d e", expect!["own/msg/Own, line 1: `a/b/c/d` is no type"]),
            ("float64 9", expect!["own/msg/Own, line 1: `9` begins with no name"]),
            ("Point p 3", expect!["own/msg/Own, line 1: a message has no default"]),
        ] {
            check(Sort::Message, text, expected);
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "([a-z0-9/<=\\[\\]#'\"\\\\ \n,.A-Z-]|int8 |string |---\n){0,80}") {
            for sort in [Sort::Message, Sort::Service, Sort::Action] {
                let _ = file(&text, "own", sort, "Own");
            }
        }
    }
}
