//! Decoding: a message becomes the text of a JSON object, followed by its arrays of numbers as bytes.
//!
//! Any input gives a message or an error. A claimed length is accepted only up to the number of remaining bytes.

use std::fmt::Write as _;

use crate::json;
use crate::types::library::{Kind, Type, TypeField};
use crate::types::{Primitive, Shape};

use super::{WIDE_UNIT, aligned};

/// Output for the text and the arrays of a message, which are appended.
#[derive(Default)]
pub(crate) struct Decoded {
    pub(crate) text: String,
    pub(crate) arrays: Vec<u8>,
}

/// Reads a message of type `of` from `bytes`, which follow the header of the representation.
pub(crate) fn read(bytes: &[u8], little: bool, of: &Type, to: &mut Decoded) -> Result<(), String> {
    let mut reader = Reader { bytes, at: 0, little, to };
    reader.message(of).map_err(|why| format!("the {} bytes are no {}: {why}", bytes.len(), of.name))
}

struct Reader<'a, 'to> {
    bytes: &'a [u8],
    at: usize,
    little: bool,
    to: &'to mut Decoded,
}

impl<'a> Reader<'a, '_> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let end =
            end.ok_or_else(|| format!("they end before byte {}", self.at.saturating_add(count)))?;
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn unsigned(&mut self, width: usize) -> Result<u64, String> {
        self.at = aligned(self.at, width);
        let taken = self.take(width)?;
        let add = |value: u64, byte: &u8| (value << 8) | u64::from(*byte);
        Ok(if self.little { taken.iter().rev().fold(0, add) } else { taken.iter().fold(0, add) })
    }

    fn length(&mut self) -> Result<usize, String> {
        Ok(self.unsigned(4)? as usize)
    }

    fn message(&mut self, of: &Type) -> Result<(), String> {
        self.to.text.push('{');
        for (index, field) in of.fields.iter().enumerate() {
            if index > 0 {
                self.to.text.push(',');
            }
            json::write_text(&field.name, &mut self.to.text);
            self.to.text.push(':');
            self.field(field).map_err(|why| format!("{}: {why}", field.name))?;
        }
        self.to.text.push('}');
        // IDL has no empty structures. The dummy byte for one may be missing at the end of a message.
        if of.fields.is_empty() && self.at < self.bytes.len() {
            self.at += 1;
        }
        Ok(())
    }

    fn field(&mut self, field: &TypeField) -> Result<(), String> {
        let count = match field.shape {
            Shape::One => return self.value(&field.kind, field.text_max),
            Shape::Fixed(size) => size as usize,
            Shape::Bounded(most) => {
                let count = self.length()?;
                if count > most as usize {
                    return Err(format!("{count} values, of {most} at most"));
                }
                count
            }
            Shape::Unbounded => self.length()?,
        };
        if count.saturating_mul(field.kind.least_width())
            > self.bytes.len() - self.at.min(self.bytes.len())
        {
            return Err(format!("{count} values need more bytes than there are"));
        }
        if let Kind::Primitive(primitive) = field.kind
            && let Some(code) = primitive.code()
        {
            return self.numbers(primitive.width(), code, count);
        }
        self.to.text.push('[');
        for index in 0..count {
            if index > 0 {
                self.to.text.push(',');
            }
            self.value(&field.kind, field.text_max).map_err(|why| format!("[{index}]: {why}"))?;
        }
        self.to.text.push(']');
        Ok(())
    }

    /// Numbers are appended after the text, in the byte order of this computer.
    fn numbers(&mut self, width: usize, code: char, count: usize) -> Result<(), String> {
        if count > 0 {
            self.at = aligned(self.at, width);
        }
        let bytes = count * width;
        let taken = self.take(bytes)?;
        let start = self.to.arrays.len();
        self.to.arrays.extend_from_slice(taken);
        if self.little != cfg!(target_endian = "little") && width > 1 {
            self.to.arrays[start..].chunks_exact_mut(width).for_each(<[u8]>::reverse);
        }
        let _ = write!(self.to.text, r#"{{"$":["{code}",{start},{bytes}]}}"#);
        Ok(())
    }

    fn value(&mut self, kind: &Kind, text_max: u32) -> Result<(), String> {
        match kind {
            Kind::Message(nested) => self.message(nested),
            Kind::Primitive(primitive) => self.primitive(*primitive, text_max),
        }
    }

    fn primitive(&mut self, primitive: Primitive, text_max: u32) -> Result<(), String> {
        match primitive {
            Primitive::Text => return self.text(text_max),
            Primitive::WideText => return self.wide_text(text_max),
            _ => {}
        }
        let width = primitive.width();
        let bits = self.unsigned(width)?;
        let signed = (bits << (64 - 8 * width)).cast_signed() >> (64 - 8 * width);
        let text = &mut self.to.text;
        match primitive {
            Primitive::Bool => text.push_str(if bits == 0 { "false" } else { "true" }),
            Primitive::Float32 => json::write_float(f64::from(f32::from_bits(bits as u32)), text),
            Primitive::Float64 => json::write_float(f64::from_bits(bits), text),
            Primitive::Int8 | Primitive::Int16 | Primitive::Int32 | Primitive::Int64 => {
                let _ = write!(text, "{signed}");
            }
            _ => {
                let _ = write!(text, "{bits}");
            }
        }
        Ok(())
    }

    /// UTF-8 with a final NUL; invalid bytes become U+FFFD.
    fn text(&mut self, most: u32) -> Result<(), String> {
        let length = self.length()?;
        let taken = self.take(length)?;
        let taken = taken.strip_suffix(b"\0").unwrap_or(taken);
        let text = String::from_utf8_lossy(taken);
        bounded(&text, most)?;
        json::write_text(&text, &mut self.to.text);
        Ok(())
    }

    /// UTF-16 units of four bytes each, as Fast DDS writes them; unpaired surrogates become U+FFFD.
    fn wide_text(&mut self, most: u32) -> Result<(), String> {
        let length = self.length()?;
        let taken = self.take(length.saturating_mul(WIDE_UNIT))?;
        let units = taken.chunks_exact(WIDE_UNIT).map(|unit| self.wide_unit(unit));
        let text: String =
            char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        bounded(&text, most)?;
        json::write_text(&text, &mut self.to.text);
        Ok(())
    }

    /// A UTF-16 unit; an invalid number becomes U+FFFD.
    fn wide_unit(&self, bytes: &[u8]) -> u16 {
        let add = |value: u32, byte: &u8| (value << 8) | u32::from(*byte);
        let unit =
            if self.little { bytes.iter().rev().fold(0, add) } else { bytes.iter().fold(0, add) };
        u16::try_from(unit).unwrap_or(0xFFFD)
    }
}

fn bounded(text: &str, most: u32) -> Result<(), String> {
    if most > 0 && text.len() > most as usize && text.chars().count() > most as usize {
        return Err(format!("a text of {} characters, of {most} at most", text.chars().count()));
    }
    Ok(())
}
