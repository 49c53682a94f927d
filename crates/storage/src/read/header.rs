//! `statemachine.json`: the machine as a whole, and in which layout its states lie. Knows keys, not files.

use super::elements::UnmodelledContent;
use super::library_state::version;
use crate::problem::{Fault, Wrong};
use rafcon_model::{Header, Json, Layout};
use smol_str::SmolStr;

/// Keys that are understood; all others are kept.
const KNOWN: [&str; 7] = [
    "creation_time",
    "state_machine_version",
    "version",
    "used_rafcon_version",
    "last_update",
    "root_state_storage_id",
    "root_state_id",
];

/// The folder of the root state, if an older layout gives it one.
pub(crate) fn root_folder(document: &Json) -> Option<SmolStr> {
    let named = document.get("root_state_storage_id").or_else(|| document.get("root_state_id"));
    let folder = named?.as_str()?;
    let is_plain = !folder.is_empty() && folder != "." && folder != ".." && !folder.contains('/');
    is_plain.then(|| folder.into())
}

/// Whether the document is of a layout that is no longer written.
pub(crate) fn is_outdated(document: &Json) -> bool {
    ["root_state_storage_id", "root_state_id", "version", "last_update"]
        .iter()
        .any(|key| document.get(key).is_some())
}

/// The header that `document` describes.
pub(crate) fn decode(document: &Json, layout: Layout, faults: &mut Vec<Fault>) -> Header {
    let Some(members) = document.as_object() else {
        faults.push(Fault::Wrong(Wrong::NotAnObject(document.kind())));
        return Header { layout, ..Header::default() };
    };
    let creation_time = document.get("creation_time").and_then(Json::as_str);
    if creation_time.is_none() {
        faults.push(Fault::Wrong(Wrong::Missing("creation_time")));
    }
    let own_version = document.get("version").or_else(|| document.get("state_machine_version"));
    let writer = document.get("used_rafcon_version").and_then(Json::as_str);
    Header {
        creation_time: creation_time.map(SmolStr::new).unwrap_or_default(),
        version: version(own_version),
        used_rafcon_version: writer.map(SmolStr::new),
        layout,
        extra: UnmodelledContent::default().into_extra(members, |key| KNOWN.contains(&key)),
    }
}
