//! Operations on an open machine, from the request to the draft and the revision. Knows how they are stored and what they
//! refer to, but not their effect.

use super::draft;
use crate::Failure;
use rafcon_model::Machine;
use rafcon_protocol::api::EditMachine;
use rafcon_protocol::document::Document;
use rafcon_protocol::edit::Edit;
use rafcon_storage::{Libraries, fill_library};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A change of an open machine. The type parameters distinguish the requested form from the loaded one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub(crate) enum Operation<E = Box<Edit>, M = String> {
    /// An edit with a name for people.
    Edit {
        /// Name for people, such as "Rename state".
        name: String,
        /// Requested or loaded form of the edit.
        edit: E,
    },
    /// The author's own last undo.
    Undo,
    /// The author's own last redo.
    Redo,
    /// The files were reloaded: the machine becomes the document that the draft stores under this name.
    Replace {
        /// The machine, or its hash.
        document: M,
    },
    /// The machine returns to its content at a revision.
    Jump {
        /// Revision to return to.
        revision: u64,
        /// True to revert steps of other users, too.
        #[serde(skip)]
        over_others: bool,
    },
}

/// An operation that can be applied.
pub(super) type ReadOperation = Operation<rafcon_model::edit::Edit, Machine>;

/// Author and id of a request. A repeated request is performed once.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct EditRequest {
    pub(crate) author: String,
    pub(crate) id: String,
}

/// An operation as it is stored in a draft.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RecordedOperation {
    #[serde(flatten)]
    pub(super) request: EditRequest,
    /// Time of the operation: ms since 1970, UTC.
    pub(super) at_ms: u64,
    #[serde(rename = "what")]
    pub(super) operation: Operation,
}

impl Operation {
    /// The edit that a client requests.
    pub(crate) fn edit(wish: EditMachine) -> Self {
        Self::Edit { name: wish.name, edit: Box::new(wish.edit) }
    }

    /// Loads what the operation refers to: the current content of libraries, and documents of the draft in `place`.
    pub(super) fn read(
        &self,
        libraries: &Libraries,
        place: &Path,
    ) -> Result<ReadOperation, Failure> {
        Ok(match self {
            Self::Edit { name, edit } => {
                let mut look_up = |state: &mut _| drop(fill_library(state, libraries));
                let edit = edit.read(&mut look_up);
                let edit = edit.map_err(|error| Failure::bad("bad_edit", error.to_string()))?;
                Operation::Edit { name: name.clone(), edit }
            }
            Self::Undo => Operation::Undo,
            Self::Redo => Operation::Redo,
            Self::Replace { document } => {
                Operation::Replace { document: kept_machine(place, document, libraries)? }
            }
            &Self::Jump { revision, over_others } => Operation::Jump { revision, over_others },
        })
    }
}

/// Loads a machine that is stored beside the draft in `place`.
pub(super) fn kept_machine(
    place: &Path,
    hash: &str,
    libraries: &Libraries,
) -> Result<Machine, Failure> {
    let lost = |what: String| {
        let message = format!("the draft in {} cannot be read: {what}", place.display());
        Failure::unprocessable("unreadable_draft", message)
    };
    let text = draft::kept(place, hash).map_err(|error| draft::unreadable(&error))?;
    let text = text.ok_or_else(|| lost(format!("{hash}.json is missing")))?;
    let document: Document =
        serde_json::from_str(&text).map_err(|error| lost(error.to_string()))?;
    let mut look_up = |state: &mut _| drop(fill_library(state, libraries));
    document.read(&mut look_up).map_err(|error| lost(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::{EditRequest, Operation, RecordedOperation};
    use crate::documents::draft::DraftLine;

    /// Earlier versions of the server wrote lines like these.
    #[test]
    fn lines_of_earlier_versions_are_read_and_written_as_they_were() {
        let head = r#"{"line":"done","author":"ann","id":"1","at_ms":7,"what":"#;
        let rename =
            r#"{"what":"edit","name":"Rename","edit":{"edit":"set_name","path":"R","name":"Two"}}"#;
        let edit = serde_json::from_str(r#"{"edit":"set_name","path":"R","name":"Two"}"#).unwrap();
        let edit = Operation::Edit { name: "Rename".to_owned(), edit: Box::new(edit) };
        let lines = [
            (rename, edit),
            (r#"{"what":"undo"}"#, Operation::Undo),
            (r#"{"what":"redo"}"#, Operation::Redo),
            (
                r#"{"what":"replace","document":"abc"}"#,
                Operation::Replace { document: "abc".to_owned() },
            ),
            (
                r#"{"what":"jump","revision":3}"#,
                Operation::Jump { revision: 3, over_others: false },
            ),
        ];
        for (text, operation) in lines {
            let line = format!("{head}{text}}}");
            let request = EditRequest { author: "ann".to_owned(), id: "1".to_owned() };
            let record = RecordedOperation { request, at_ms: 7, operation };
            let done = DraftLine::Done(Box::new(record));
            assert_eq!(serde_json::from_str::<DraftLine>(&line).unwrap(), done);
            assert_eq!(serde_json::to_string(&done).unwrap(), line);
        }
    }
}
