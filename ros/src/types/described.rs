//! Types as remote users describe them: `type_description_interfaces/msg/TypeDescription`.
//!
//! Callers must compare the hash: this module does not verify a description.

use crate::json::Json;

use super::{Base, Field, Message, Shape, hash, literal};

/// Maximum number of types in a description, against malicious peers.
const TYPES_MAX: usize = 1000;
/// Maximum number of fields in all of them.
const FIELDS_MAX: usize = 10_000;

/// The described type, then its nested types.
pub(crate) fn read(told: &Json) -> Result<Vec<Message>, String> {
    let top = told.get("type_description").ok_or("it describes nothing")?;
    let below = list(told, "referenced_type_descriptions")?;
    if below.len() >= TYPES_MAX {
        return Err(format!("it has more than {TYPES_MAX} types"));
    }
    let messages = std::iter::once(top).chain(below).map(message).collect::<Result<Vec<_>, _>>()?;
    if messages.iter().map(|message| message.fields.len()).sum::<usize>() > FIELDS_MAX {
        return Err(format!("it has more than {FIELDS_MAX} fields"));
    }
    Ok(messages)
}

fn list<'a>(of: &'a Json, key: &str) -> Result<&'a [Json], String> {
    match of.get(key) {
        Some(Json::List(values)) => Ok(values),
        _ => Err(format!("it has no list `{key}`")),
    }
}

fn message(told: &Json) -> Result<Message, String> {
    let name = told.text("type_name")?.to_owned();
    let mut fields = Vec::new();
    for told in list(told, "fields")? {
        let field = field(told).map_err(|why| format!("{name}: {why}"))?;
        // IDL has no empty structures; ROS has.
        if field.name != hash::NO_MEMBER {
            fields.push(field);
        }
    }
    Ok(Message { name, fields, constants: Vec::new() })
}

fn field(told: &Json) -> Result<Field, String> {
    let (name, about) = (told.text("name")?, told.get("type").ok_or("a field has no type")?);
    let number = |key: &str| {
        about.number(key).and_then(|number| u32::try_from(number).map_err(|why| why.to_string()))
    };
    let (id, capacity) = (number("type_id")?, number("capacity")?);
    let shape = match id / 48 {
        0 => Shape::One,
        1 => Shape::Fixed(capacity),
        2 => Shape::Bounded(capacity),
        _ => Shape::Unbounded,
    };
    let base = match id % 48 {
        1 => Base::Message(about.text("nested_type_name")?.into()),
        id => Base::Primitive(
            hash::primitive(id).ok_or_else(|| format!("`{name}` is of the unknown type {id}"))?,
        ),
    };
    let is_bounded = matches!(id % 48, 21 | 22);
    let text_max = if is_bounded { number("string_capacity")? } else { 0 };
    let mut field = Field { name: name.to_owned(), base, shape, text_max, default: None };
    let default = told.text("default_value").unwrap_or_default();
    // Defaults are not part of the hash; an invalid one is ignored.
    if !default.is_empty() && matches!(field.base, Base::Primitive(_)) {
        field.default = literal::default(default, &field).ok();
    }
    Ok(field)
}

#[cfg(test)]
mod tests {
    use expect_test::{Expect, expect};

    use super::{FIELDS_MAX, TYPES_MAX, read};
    use crate::json::{self, Json};

    fn check(text: &str, expected: Expect) {
        let found = read(&json::parse(text.as_bytes()).unwrap());
        let text = match found {
            Err(why) => format!("no: {why}"),
            Ok(messages) => messages
                .iter()
                .flat_map(|message| {
                    message.fields.iter().map(move |field| format!("{} {field:?}", message.name))
                })
                .collect::<Vec<_>>()
                .join("\n"),
        };
        expected.assert_eq(&text);
    }

    #[test]
    fn a_description_is_read() {
        check(
            r#"{"type_description": {"type_name": "a/msg/A", "fields": [
                {"name": "b", "type": {"type_id": 145, "capacity": 0, "string_capacity": 0, "nested_type_name": "a/msg/B"}, "default_value": ""},
                {"name": "c", "type": {"type_id": 69, "capacity": 3, "string_capacity": 5, "nested_type_name": ""}, "default_value": ""}]},
               "referenced_type_descriptions": [{"type_name": "a/msg/B", "fields": [
                {"name": "structure_needs_at_least_one_member", "type": {"type_id": 3, "capacity": 0, "string_capacity": 0, "nested_type_name": ""}, "default_value": ""}]}]}"#,
            expect![[r#"
                a/msg/A Field { name: "b", base: Message("a/msg/B"), shape: Unbounded, text_max: 0, default: None }
                a/msg/A Field { name: "c", base: Primitive(Text), shape: Fixed(3), text_max: 5, default: None }"#]],
        );
    }

    /// Parses a description with these numbers of types and of fields in each. Returns the number of types.
    fn described(types: usize, fields: usize) -> Result<usize, String> {
        let field = r#"{"name": "a", "type": {"type_id": 2, "capacity": 0}}"#;
        let fields = vec![field; fields].join(",");
        let one = format!(r#"{{"type_name": "a/msg/A", "fields": [{fields}]}}"#);
        let below = vec![&*one; types - 1].join(",");
        let text =
            format!(r#"{{"type_description": {one}, "referenced_type_descriptions": [{below}]}}"#);
        let told: Json = json::parse(text.as_bytes()).unwrap();
        read(&told).map(|messages| messages.len())
    }

    #[test]
    fn a_description_of_too_many_types_is_refused() {
        assert_eq!(described(TYPES_MAX, 1), Ok(TYPES_MAX));
        let refused = described(TYPES_MAX + 1, 1);
        assert_eq!(refused, Err("it has more than 1000 types".to_owned()));
    }

    #[test]
    fn a_description_of_too_many_fields_is_refused() {
        assert_eq!(described(10, FIELDS_MAX / 10), Ok(10));
        let refused = described(10, FIELDS_MAX / 10 + 1);
        assert_eq!(refused, Err("it has more than 10000 fields".to_owned()));
    }

    #[test]
    fn what_is_no_description_is_refused() {
        check("{}", expect!["no: it describes nothing"]);
        check(
            r#"{"type_description": {}, "referenced_type_descriptions": 1}"#,
            expect!["no: it has no list `referenced_type_descriptions`"],
        );
        check(
            r#"{"type_description": {"type_name": "a/msg/A", "fields": [{"name": "b", "type": {"type_id": 13, "capacity": 0}}]}, "referenced_type_descriptions": []}"#,
            expect!["no: a/msg/A: `b` is of the unknown type 13"],
        );
    }
}
