//! Encoding: a message in JSON, followed by arrays of numbers, becomes CDR in the byte order of this computer.
//!
//! Missing values get the default of the type. Invalid values are refused with their location.

use crate::json::Json;
use crate::types::library::{Kind, Type, TypeField};
use crate::types::{Literal, Primitive, Shape, literal};

use super::aligned;

/// Encodes a message of type `of`; `arrays` are the bytes after the text of `value`.
pub(crate) fn write(value: &Json, arrays: &[u8], of: &Type) -> Result<Vec<u8>, String> {
    let mut writer = Writer { bytes: Vec::new(), arrays };
    writer.message(value, of).map_err(|why| format!("{}{why}", of.name))?;
    Ok(writer.bytes)
}

struct Writer<'a> {
    bytes: Vec<u8>,
    arrays: &'a [u8],
}

impl Writer<'_> {
    fn align(&mut self, width: usize) {
        self.bytes.resize(aligned(self.bytes.len(), width), 0);
    }

    fn put<const WIDTH: usize>(&mut self, bytes: [u8; WIDTH]) {
        self.align(WIDTH);
        self.bytes.extend_from_slice(&bytes);
    }

    fn length(&mut self, count: usize) -> Result<(), String> {
        let count = u32::try_from(count).map_err(|_| ": is too long".to_owned())?;
        self.put(count.to_ne_bytes());
        Ok(())
    }

    fn message(&mut self, value: &Json, of: &Type) -> Result<(), String> {
        let Json::Map(entries) = value else { return Err(format!(": is no {}", of.name)) };
        if let Some((name, _)) =
            entries.iter().find(|(name, _)| of.fields.iter().all(|field| field.name != *name))
        {
            let names: Vec<&str> = of.fields.iter().map(|field| field.name.as_str()).collect();
            return Err(format!(" has no field `{name}`; it has {}", names.join(", ")));
        }
        for (index, field) in of.fields.iter().enumerate() {
            // Most messages have their values in the order of the type.
            let here =
                entries.get(index).filter(|(name, _)| *name == field.name).map(|(_, value)| value);
            let given = here.or_else(|| value.get(&field.name));
            match given {
                Some(given) => self.field(given, field),
                None => self.default(field),
            }
            .map_err(|why| format!(".{}{why}", field.name))?;
        }
        if of.fields.is_empty() {
            self.bytes.push(0);
        }
        Ok(())
    }

    fn field(&mut self, value: &Json, field: &TypeField) -> Result<(), String> {
        if field.shape == Shape::One {
            return self.value(value, &field.kind, field.text_max);
        }
        match value {
            Json::Array { code, start, bytes } => self.array(*code, *start, *bytes, field),
            Json::List(values) => {
                self.count(values.len(), field.shape)?;
                for (index, value) in values.iter().enumerate() {
                    self.value(value, &field.kind, field.text_max)
                        .map_err(|why| format!("[{index}]{why}"))?;
                }
                Ok(())
            }
            _ => Err(": is no list".to_owned()),
        }
    }

    /// Checks the number of values, and writes it unless the type fixes it.
    fn count(&mut self, count: usize, shape: Shape) -> Result<(), String> {
        match shape {
            Shape::Fixed(size) if count != size as usize => {
                Err(format!(": has {count} values, not {size}"))
            }
            Shape::Bounded(most) if count > most as usize => {
                Err(format!(": has {count} values, of {most} at most"))
            }
            Shape::Bounded(_) | Shape::Unbounded => self.length(count),
            Shape::Fixed(_) | Shape::One => Ok(()),
        }
    }

    fn array(
        &mut self,
        code: char,
        start: usize,
        bytes: usize,
        field: &TypeField,
    ) -> Result<(), String> {
        let taken = start.checked_add(bytes).and_then(|end| self.arrays.get(start..end));
        let taken = taken.ok_or(": its bytes are missing")?;
        let width = match code {
            'b' | 'B' => 1,
            'h' | 'H' => 2,
            'i' | 'I' | 'f' => 4,
            'q' | 'Q' | 'd' => 8,
            _ => return Err(format!(": arrays of code `{code}` are not known")),
        };
        if !bytes.is_multiple_of(width) {
            return Err(format!(": {bytes} bytes are no whole number of values"));
        }
        self.count(bytes / width, field.shape)?;
        let Kind::Primitive(primitive) = field.kind else {
            return Err(": is no list of messages".to_owned());
        };
        if primitive.code() == Some(code) {
            if bytes > 0 {
                self.align(width);
            }
            self.bytes.extend_from_slice(taken);
            return Ok(());
        }
        for (index, chunk) in taken.chunks_exact(width).enumerate() {
            self.value(&number(code, chunk), &field.kind, 0)
                .map_err(|why| format!("[{index}]{why}"))?;
        }
        Ok(())
    }

    fn value(&mut self, value: &Json, kind: &Kind, text_max: u32) -> Result<(), String> {
        match (kind, value) {
            (Kind::Message(nested), _) => self.message(value, nested),
            (
                Kind::Primitive(primitive @ (Primitive::Text | Primitive::WideText)),
                Json::Text(text),
            ) => self.text(text, *primitive, text_max),
            (Kind::Primitive(Primitive::Bool), Json::Bool(value)) => {
                self.bytes.push(u8::from(*value));
                Ok(())
            }
            (Kind::Primitive(primitive), _) => self.number(value, *primitive),
        }
    }

    fn number(&mut self, value: &Json, primitive: Primitive) -> Result<(), String> {
        let wrong = || format!(": {} is no {}", shown(value), primitive.name());
        match (primitive, value) {
            (Primitive::Float32 | Primitive::Float64, Json::Int(_) | Json::Float(_)) => {
                let value = match value {
                    Json::Float(value) => *value,
                    Json::Int(value) => *value as f64,
                    _ => return Err(wrong()),
                };
                match primitive {
                    Primitive::Float32 => self.put((value as f32).to_ne_bytes()),
                    _ => self.put(value.to_ne_bytes()),
                }
                Ok(())
            }
            (Primitive::Bool | Primitive::Text | Primitive::WideText, _) => Err(wrong()),
            (_, Json::Int(whole)) => {
                let (least, most) = literal::range(primitive);
                if !(least..=most).contains(whole) {
                    return Err(format!(": {whole} is out of the range of {}", primitive.name()));
                }
                self.whole(*whole, primitive.width());
                Ok(())
            }
            _ => Err(wrong()),
        }
    }

    fn whole(&mut self, value: i128, width: usize) {
        match width {
            1 => self.put((value as u8).to_ne_bytes()),
            2 => self.put((value as u16).to_ne_bytes()),
            4 => self.put((value as u32).to_ne_bytes()),
            _ => self.put((value as u64).to_ne_bytes()),
        }
    }

    fn text(&mut self, text: &str, primitive: Primitive, most: u32) -> Result<(), String> {
        if text.contains('\0') {
            return Err(": a NUL character cannot be in a text of ROS".to_owned());
        }
        if most > 0 && text.chars().count() > most as usize {
            return Err(format!(": has {} characters, of {most} at most", text.chars().count()));
        }
        if primitive == Primitive::WideText {
            let units: Vec<u16> = text.encode_utf16().collect();
            self.length(units.len())?;
            self.bytes.extend(units.iter().flat_map(|unit| u32::from(*unit).to_ne_bytes()));
        } else {
            self.length(text.len() + 1)?;
            self.bytes.extend_from_slice(text.as_bytes());
            self.bytes.push(0);
        }
        Ok(())
    }

    fn default(&mut self, field: &TypeField) -> Result<(), String> {
        if let Some(default) = &field.default {
            return self.field(&from_literal(default), field);
        }
        match field.shape {
            Shape::Bounded(_) | Shape::Unbounded => self.length(0),
            Shape::One => self.zero(&field.kind),
            Shape::Fixed(size) => (0..size).try_for_each(|_| self.zero(&field.kind)),
        }
    }

    fn zero(&mut self, kind: &Kind) -> Result<(), String> {
        match kind {
            Kind::Message(nested) => self.message(&Json::Map(Vec::new()), nested),
            Kind::Primitive(primitive @ (Primitive::Text | Primitive::WideText)) => {
                self.text("", *primitive, 0)
            }
            Kind::Primitive(Primitive::Bool) => {
                self.bytes.push(0);
                Ok(())
            }
            Kind::Primitive(primitive) => self.number(&Json::Int(0), *primitive),
        }
    }
}

/// Converts a literal of a type to a value.
pub(crate) fn from_literal(value: &Literal) -> Json {
    match value {
        Literal::Bool(value) => Json::Bool(*value),
        Literal::Int(value) => Json::Int(*value),
        Literal::Float(value) => Json::Float(*value),
        Literal::Text(text) => Json::Text(text.clone()),
        Literal::List(values) => Json::List(values.iter().map(from_literal).collect()),
    }
}

/// The number in `bytes`, whose length fits `code`.
fn number(code: char, bytes: &[u8]) -> Json {
    let mut wide = [0; 8];
    let start = if cfg!(target_endian = "little") { 0 } else { 8 - bytes.len() };
    wide[start..start + bytes.len()].copy_from_slice(bytes);
    let bits = u64::from_ne_bytes(wide);
    let unused = 64 - 8 * bytes.len() as u32;
    match code {
        'f' => Json::Float(f64::from(f32::from_bits(bits as u32))),
        'd' => Json::Float(f64::from_bits(bits)),
        'b' | 'h' | 'i' | 'q' => Json::Int(i128::from((bits << unused).cast_signed() >> unused)),
        _ => Json::Int(i128::from(bits)),
    }
}

fn shown(value: &Json) -> String {
    match value {
        Json::Text(text) => format!("a text (`{}`)", text.chars().take(40).collect::<String>()),
        Json::List(_) | Json::Array { .. } => "a list".to_owned(),
        Json::Map(_) => "a dict".to_owned(),
        Json::Null => "None".to_owned(),
        Json::Bool(value) => if *value { "True" } else { "False" }.to_owned(),
        Json::Int(value) => value.to_string(),
        Json::Float(value) => value.to_string(),
    }
}
