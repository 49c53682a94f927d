//! The hash of a type by REP 2016: `RIHS01_`, and SHA-256 of the canonical text of its description.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use sha2::{Digest as _, Sha256};

use super::library::{Kind, Type};
use super::{Primitive, Shape};

/// Name of the dummy field in IDL for a structure without fields.
pub(super) const NO_MEMBER: &str = "structure_needs_at_least_one_member";

/// The hash `RIHS01_…` of a type.
pub(crate) fn rihs01(top: &Type) -> String {
    let digest = Sha256::digest(canonical(top).as_bytes());
    digest.iter().fold("RIHS01_".to_owned(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// The description as text: the type, then all nested types, by name.
fn canonical(top: &Type) -> String {
    let mut below = BTreeMap::new();
    collect(top, &mut below);
    let below: Vec<String> = below.values().map(|one| individual(one)).collect();
    let (own, below) = (individual(top), below.join(", "));
    format!(r#"{{"type_description": {own}, "referenced_type_descriptions": [{below}]}}"#)
}

fn collect<'a>(one: &'a Type, below: &mut BTreeMap<&'a str, &'a Type>) {
    for field in &one.fields {
        if let Kind::Message(nested) = &field.kind
            && below.insert(&nested.name, nested).is_none()
        {
            collect(nested, below);
        }
    }
}

fn individual(one: &Type) -> String {
    let mut fields: Vec<String> = Vec::with_capacity(one.fields.len().max(1));
    for field in &one.fields {
        let (number, nested) = match &field.kind {
            Kind::Primitive(primitive) => (number(*primitive, field.text_max), ""),
            Kind::Message(nested) => (1, nested.name.as_str()),
        };
        let (offset, capacity) = match field.shape {
            Shape::One => (0, 0),
            Shape::Fixed(size) => (48, size),
            Shape::Bounded(size) => (96, size),
            Shape::Unbounded => (144, 0),
        };
        fields.push(described(&field.name, number + offset, capacity, field.text_max, nested));
    }
    // IDL has no empty structures.
    if fields.is_empty() {
        fields.push(described(NO_MEMBER, number(Primitive::UInt8, 0), 0, 0, ""));
    }
    format!(r#"{{"type_name": "{}", "fields": [{}]}}"#, one.name, fields.join(", "))
}

fn described(name: &str, id: u32, capacity: u32, text_max: u32, nested: &str) -> String {
    format!(
        r#"{{"name": "{name}", "type": {{"type_id": {id}, "capacity": {capacity}, "string_capacity": {text_max}, "nested_type_name": "{nested}"}}}}"#
    )
}

/// The number of a single value in `type_description_interfaces/msg/FieldType`.
fn number(primitive: Primitive, text_max: u32) -> u32 {
    match primitive {
        Primitive::Int8 => 2,
        Primitive::UInt8 => 3,
        Primitive::Int16 => 4,
        Primitive::UInt16 => 5,
        Primitive::Int32 => 6,
        Primitive::UInt32 => 7,
        Primitive::Int64 => 8,
        Primitive::UInt64 => 9,
        Primitive::Float32 => 10,
        Primitive::Float64 => 11,
        // In interface files `char` is a `uint8`.
        Primitive::Char => 3,
        Primitive::Bool => 15,
        Primitive::Byte => 16,
        Primitive::Text if text_max == 0 => 17,
        Primitive::WideText if text_max == 0 => 18,
        Primitive::Text => 21,
        Primitive::WideText => 22,
    }
}

/// The type of a single value with this number.
pub(super) fn primitive(id: u32) -> Option<Primitive> {
    Some(match id {
        2 => Primitive::Int8,
        3 => Primitive::UInt8,
        4 => Primitive::Int16,
        5 => Primitive::UInt16,
        6 => Primitive::Int32,
        7 => Primitive::UInt32,
        8 => Primitive::Int64,
        9 => Primitive::UInt64,
        10 => Primitive::Float32,
        11 => Primitive::Float64,
        15 => Primitive::Bool,
        16 => Primitive::Byte,
        17 | 21 => Primitive::Text,
        18 | 22 => Primitive::WideText,
        _ => return None,
    })
}
