//! Decodes a library instance, in the current and the older form. Handles the reference, not the content of the library.

use super::decode::{Decoder, wrong_type};
use super::elements::{UnmodelledContent, port};
use rafcon_model::{Json, Library, LibraryContent, PortId, RuntimeValue, RuntimeValues, Value};
use smol_str::SmolStr;

/// Keys of a library state in addition to those of every state.
pub(crate) const KEYS: [&str; 7] = [
    "library_path",
    "library_name",
    "version",
    "input_data_port_runtime_values",
    "use_runtime_value_input_data_ports",
    "output_data_port_runtime_values",
    "use_runtime_value_output_data_ports",
];

/// The two maps of one side, and the map of ports in older files.
struct PortMaps {
    values: &'static str,
    flags: &'static str,
    legacy: &'static str,
}

const INPUTS: PortMaps = PortMaps { values: KEYS[3], flags: KEYS[4], legacy: "input_data_ports" };
const OUTPUTS: PortMaps = PortMaps { values: KEYS[5], flags: KEYS[6], legacy: "output_data_ports" };

/// Decodes the library reference in `document`. The content is added later.
pub(crate) fn decode(
    decoder: &mut Decoder,
    document: &Json,
    aside: &mut UnmodelledContent,
) -> Library {
    Library {
        path: decoder.required_text(document, "library_path").unwrap_or_default(),
        name: decoder.required_text(document, "library_name").unwrap_or_default(),
        version: version(document.get("version")),
        inputs: runtime_values(decoder, document, &INPUTS, aside),
        outputs: runtime_values(decoder, document, &OUTPUTS, aside),
        content: LibraryContent::Missing { reason: SmolStr::new_static("not resolved yet") },
    }
}

/// A version as text; the reference writes an unset one as `"None"`.
pub(crate) fn version(json: Option<&Json>) -> Option<SmolStr> {
    match json? {
        Json::Null => None,
        Json::Str(text) if text == "None" => None,
        Json::Str(text) => Some(text.clone()),
        other => Some(rafcon_model::json::write_compact(other).into()),
    }
}

fn runtime_values(
    decoder: &mut Decoder,
    document: &Json,
    side: &PortMaps,
    aside: &mut UnmodelledContent,
) -> RuntimeValues {
    let has_maps = document.get(side.values).is_some() || document.get(side.flags).is_some();
    match document.get(side.legacy) {
        Some(_) if !has_maps => {
            let ports = decoder.map(document, side.legacy, aside, port);
            let used = |value| RuntimeValue { value, used: true };
            return ports.into_iter().map(|port| (port.id, used(port.default))).collect();
        }
        // An entry of the older form without effect. It is preserved.
        Some(rest) => aside.whole(side.legacy, rest),
        None => {}
    }
    let members = map(decoder, document, side.values, aside);
    let flags = map(decoder, document, side.flags, aside);
    let mut values = RuntimeValues::new();
    for (key, json) in members {
        let flag = flags.iter().find(|(flag, _)| flag == key);
        let used = !matches!(flag, Some((_, Json::Bool(false))));
        match key.trim().parse() {
            Ok(id) => {
                values.insert(PortId(id), RuntimeValue { value: Value::from_json(json), used });
            }
            Err(_) => aside.member(side.values, key, json),
        }
    }
    values
}

fn map<'d>(
    decoder: &mut Decoder,
    document: &'d Json,
    key: &'static str,
    aside: &mut UnmodelledContent,
) -> &'d [(SmolStr, Json)] {
    match document.get(key) {
        Some(Json::Object(members)) => members,
        Some(other) => {
            decoder.faults.push(wrong_type(key, "an object", other));
            aside.whole(key, other);
            &[]
        }
        None => &[],
    }
}
