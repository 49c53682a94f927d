//! Layouts in documents. The text of a `meta_data.json` is sent to clients unchanged, without being parsed.

use super::value::{decode_json, encode_json};
use rafcon_model::{Layout, json};
use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::RawValue;
use std::sync::Arc;

/// Layout of a state and its parts: the JSON of the reference's `meta_data.json` (see "layout" in `docs/format.md`).
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS), schema(value_type = Object))]
pub struct LayoutDocument(
    #[cfg_attr(feature = "schema", ts(type = "Record<string, unknown>"))] Arc<str>,
);

impl LayoutDocument {
    /// Creates the document of a layout. `None` if there is no layout.
    pub(crate) fn of(layout: &Layout) -> Option<Self> {
        let text = layout.text()?;
        if text.contains("NaN") || text.contains("Infinity") {
            return Some(Self(encode_json(&layout.json()).to_string().into()));
        }
        Some(Self(text.into()))
    }

    /// Converts the layout to the model. The error describes the fault.
    pub(crate) fn read(&self) -> Result<Layout, String> {
        let is_marked =
            ["\"__int__\"", "\"__float__\"", "\"__dict__\""].iter().any(|tag| self.0.contains(tag));
        if let Ok(document) = json::parse(&self.0)
            && !is_marked
        {
            return Ok(Layout::from_json(&document));
        }
        let wire = serde_json::from_str(&self.0).map_err(|error| error.to_string())?;
        Ok(Layout::from_json(&decode_json(&wire)?))
    }
}

impl Serialize for LayoutDocument {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let raw: &RawValue = serde_json::from_str(&self.0).map_err(S::Error::custom)?;
        raw.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for LayoutDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = serde_json::Value::deserialize(deserializer)?;
        if !value.is_object() {
            return Err(D::Error::custom("a layout is an object"));
        }
        Ok(Self(value.to_string().into()))
    }
}
