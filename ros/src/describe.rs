//! Types as JSON, for the parent program.

use std::collections::BTreeMap;

use crate::cdr::write::from_literal;
use crate::json::{self, Json};
use crate::types::library::{Kind, Library, Type, TypeField};
use crate::types::{Literal, Primitive, Shape, hash};

/// All of `types` and their nested types by name:
/// `{"name": {"fields": [[name, type, kind, size, text_max, default]], "constants": {}}}`.
pub(crate) fn all(types: &[&Type]) -> String {
    let mut known = BTreeMap::new();
    types.iter().for_each(|one| collect(one, &mut known));
    let parts: Vec<String> =
        known.iter().map(|(name, text)| format!("{}:{text}", json::quoted(name))).collect();
    format!("{{{}}}", parts.join(","))
}

/// Hashes of types that only this program contains, `{"name": "RIHS01_…"}`: remote users may have another version.
pub(crate) fn hashes(library: &mut Library, names: &[String]) -> String {
    let mut parts = Vec::new();
    for name in names {
        if library.is_bundled(name)
            && let Ok(found) = library.find(name)
        {
            parts.push(format!("{}:{}", json::quoted(name), json::quoted(&hash::rihs01(&found))));
        }
    }
    format!("{{{}}}", parts.join(","))
}

fn collect(one: &Type, known: &mut BTreeMap<String, String>) {
    if known.contains_key(&one.name) {
        return;
    }
    known.insert(one.name.clone(), described(one));
    for field in &one.fields {
        if let Kind::Message(nested) = &field.kind {
            collect(nested, known);
        }
    }
}

fn described(one: &Type) -> String {
    let fields: Vec<String> = one.fields.iter().map(field).collect();
    let constant = |(name, primitive, value): &(String, Primitive, Literal)| {
        format!("{}:{}", json::quoted(name), text(&from_literal(value), is_float(*primitive)))
    };
    let constants: Vec<String> = one.constants.iter().map(constant).collect();
    format!(r#"{{"fields":[{}],"constants":{{{}}}}}"#, fields.join(","), constants.join(","))
}

fn is_float(primitive: Primitive) -> bool {
    matches!(primitive, Primitive::Float32 | Primitive::Float64)
}

fn field(field: &TypeField) -> String {
    let (kind, size) = match field.shape {
        Shape::One => ("one", 0),
        Shape::Fixed(size) => ("fixed", size),
        Shape::Bounded(size) => ("bounded", size),
        Shape::Unbounded => ("unbounded", 0),
    };
    let (type_name, float) = match &field.kind {
        Kind::Primitive(primitive) => (primitive.name(), is_float(*primitive)),
        Kind::Message(nested) => (nested.name.as_str(), false),
    };
    let default =
        field.default.as_ref().map_or("null".to_owned(), |value| text(&from_literal(value), float));
    let name = json::quoted(&field.name);
    format!(r#"[{name},"{type_name}","{kind}",{size},{},{default}]"#, field.text_max)
}

fn text(value: &Json, float: bool) -> String {
    match value {
        Json::Int(value) if float => format!("{:?}", *value as f64),
        Json::Int(value) => value.to_string(),
        Json::Bool(value) => value.to_string(),
        Json::Text(value) => json::quoted(value),
        Json::Float(value) => {
            let mut text = String::new();
            json::write_float(*value, &mut text);
            text
        }
        Json::List(values) => {
            let parts: Vec<String> = values.iter().map(|value| text(value, float)).collect();
            format!("[{}]", parts.join(","))
        }
        Json::Null | Json::Map(_) | Json::Array { .. } => "null".to_owned(),
    }
}
