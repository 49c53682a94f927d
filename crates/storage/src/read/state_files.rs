//! Decodes one state from its files, whatever their source: core data, script, notes, layout, and their faults. Knows
//! which files a state has; opens none, and makes no tree.

use super::bounds::Unread;
use super::compact::compact;
use super::decode::{Decoder, stand_in};
use super::script_text;
use crate::files::{Oddities, Part};
use crate::problem::Fault;
use rafcon_model::{Json, Kind, Layout, State, conflict_line, json};
use smol_str::SmolStr;
use std::ffi::{OsStr, OsString};
use std::sync::Arc;

/// The files of one state.
pub(crate) trait StateFiles {
    /// The bytes of a file; `None` if it does not exist.
    fn read(&mut self, part: Part) -> Result<Option<&[u8]>, Unread>;
}

/// A state from its folder, without its children.
#[derive(Debug)]
pub(crate) struct Node {
    /// Parents have lower numbers than their children.
    pub(crate) number: usize,
    pub(crate) parent: Option<usize>,
    pub(crate) folder: OsString,
    pub(crate) state: State,
    pub(crate) faults: Vec<(Part, Fault)>,
    pub(crate) oddities: Oddities,
    /// True if a link led to the state, so that its files may also belong to another state.
    pub(crate) linked: bool,
}

/// A decoded state with its faults.
#[derive(Debug)]
pub(crate) struct ReadState {
    state: State,
    faults: Vec<(Part, Fault)>,
    oddities: Oddities,
}

impl ReadState {
    /// Adds the state's position in the tree.
    pub(crate) fn node(
        self,
        number: usize,
        parent: Option<usize>,
        folder: OsString,
        linked: bool,
    ) -> Node {
        let Self { state, faults, oddities } = self;
        Node { number, parent, folder, state, faults, oddities, linked }
    }
}

/// Decodes states, and shares repeated parts.
#[derive(Debug, Default)]
pub(crate) struct StateReader {
    decoder: Decoder,
    text: String,
}

impl StateReader {
    /// The state in these files, if they are those of a state; `folder` is the name of its folder.
    pub(crate) fn read(
        &mut self,
        folder: &OsStr,
        files: &mut impl StateFiles,
    ) -> Result<Option<ReadState>, Unread> {
        let mut faults = Vec::new();
        let mut oddities = Oddities::default();
        let core = self.core(folder, files, &mut faults, &mut oddities)?;
        let Some(mut state) = core else { return Ok(None) };
        if let Kind::Execution(script) | Kind::Decider(script) = &mut state.kind {
            script.text = self.script(files, &mut faults, &mut oddities)?;
        }
        state.layout = self.layout(files, &mut faults, &mut oddities)?;
        state.semantic_data = semantic(files, &mut faults, &mut oddities)?;
        Ok(Some(ReadState { state, faults, oddities }))
    }

    fn core(
        &mut self,
        folder: &OsStr,
        files: &mut impl StateFiles,
        faults: &mut Vec<(Part, Fault)>,
        oddities: &mut Oddities,
    ) -> Result<Option<State>, Unread> {
        let Some(bytes) = files.read(Part::Core)? else { return Ok(None) };
        let folder = folder.to_string_lossy();
        let decoded = parse(bytes).and_then(|document| self.decoder.state(&document, &folder));
        faults.extend(self.decoder.faults.drain(..).map(|fault| (Part::Core, fault)));
        let fault = match decoded {
            Ok(state) => {
                let lost = faults.iter().find(|(_, fault)| fault.is_damage());
                let damage = lost.map(|(_, fault)| damage(fault));
                return Ok(Some(State { damage, ..state }));
            }
            Err(fault) => fault,
        };
        oddities.verbatim.insert(Part::Core, bytes.into());
        let damage = Some(damage(&fault));
        faults.push((Part::Core, fault));
        let has_script = files.read(Part::Script)?.is_some();
        Ok(Some(State { damage, ..stand_in(&folder, has_script) }))
    }

    fn script(
        &mut self,
        files: &mut impl StateFiles,
        faults: &mut Vec<(Part, Fault)>,
        oddities: &mut Oddities,
    ) -> Result<Option<Arc<str>>, Unread> {
        let Some(bytes) = files.read(Part::Script)? else { return Ok(None) };
        if let Some((text, is_other)) = script_text::decode(bytes) {
            if is_other {
                oddities.verbatim.insert(Part::Script, bytes.into());
            }
            return Ok(Some(self.decoder.interner.text(&text)));
        }
        faults.push((Part::Script, Fault::NotUtf8));
        oddities.verbatim.insert(Part::Script, bytes.into());
        Ok(Some(String::from_utf8_lossy(bytes).into()))
    }

    fn layout(
        &mut self,
        files: &mut impl StateFiles,
        faults: &mut Vec<(Part, Fault)>,
        oddities: &mut Oddities,
    ) -> Result<Layout, Unread> {
        let Some(bytes) = files.read(Part::Layout)? else { return Ok(Layout::default()) };
        match compact_layout(bytes, &mut self.text) {
            Ok(layout) => Ok(layout),
            Err(fault) => {
                faults.push((Part::Layout, fault));
                oddities.verbatim.insert(Part::Layout, bytes.into());
                Ok(Layout::default())
            }
        }
    }
}

fn semantic(
    files: &mut impl StateFiles,
    faults: &mut Vec<(Part, Fault)>,
    oddities: &mut Oddities,
) -> Result<Option<Arc<Json>>, Unread> {
    let Some(bytes) = files.read(Part::Semantic)? else { return Ok(None) };
    match parse(bytes) {
        Ok(Json::Object(members)) if members.is_empty() => Ok(None),
        Ok(document @ Json::Object(_)) => Ok(Some(Arc::new(document))),
        other => {
            let wrong = |found: Json| Fault::Wrong(crate::Wrong::NotAnObject(found.kind()));
            faults.push((Part::Semantic, other.map_or_else(|fault| fault, wrong)));
            oddities.verbatim.insert(Part::Semantic, bytes.into());
            Ok(None)
        }
    }
}

/// Damage of a state, with the remedy.
fn damage(fault: &Fault) -> SmolStr {
    let file = Part::Core.file_name();
    smol_str::format_smolstr!("{file}: {fault}; correct the file, or restore it")
}

/// The document in a file.
pub(crate) fn parse(bytes: &[u8]) -> Result<Json, Fault> {
    document(std::str::from_utf8(bytes).map_err(|_at| Fault::NotUtf8)?)
}

/// The document in a text.
pub(crate) fn document(text: &str) -> Result<Json, Fault> {
    let fault = |error| conflict_line(text).map_or(Fault::Malformed(error), Fault::Conflict);
    json::parse(text).map_err(fault)
}

/// The layout in a file; `text` is scratch space.
pub(crate) fn compact_layout(bytes: &[u8], text: &mut String) -> Result<Layout, Fault> {
    let layout = std::str::from_utf8(bytes).map_err(|_at| Fault::NotUtf8)?;
    text.clear();
    if layout.trim_start().starts_with('{') && compact(layout, text).is_some() {
        return Ok(if text == "{}" { Layout::default() } else { Layout::from_text(text) });
    }
    let document = document(layout)?;
    Err(Fault::Wrong(crate::Wrong::NotAnObject(document.kind())))
}
