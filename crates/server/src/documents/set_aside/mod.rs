//! Drafts whose edits can no longer be applied: stored beside the others, listed with descriptions of their edits, exported as a whole,
//! and removed only on request. Knows drafts, but not the reason that an edit does not fit.

mod routes;
mod words;

pub(super) use routes::routes;

use super::documents::Documents;
use super::draft::{self, DraftLine, FoundDraft};
use crate::access::{PrivateError, private};
use crate::{Failure, ServerState, log};
use rafcon_protocol::api::{SetAsideDraft, SetAsideEdit};
use rafcon_supervisor::clock::since_1970_ms;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

const ABOUT: &str = "set_aside.json";
/// Maximum number of listed edits.
const EDITS_MAX: usize = 1000;

/// Reason and time of setting a draft aside.
#[derive(Debug, Serialize, Deserialize)]
struct About {
    at_ms: u64,
    reason: String,
}

/// Sets the draft in `place` aside, under a unique number.
pub(super) fn set_aside(place: &Path, number: u64, reason: &Failure) -> Result<(), PrivateError> {
    let about = About { at_ms: since_1970_ms(), reason: reason.to_string() };
    let failed = |source| PrivateError::new("set aside", place, source);
    let text = serde_json::to_string(&about).map_err(|error| failed(error.into()))?;
    private::write(&place.join(ABOUT), text.as_bytes())?;
    let aside = folder_of(place, &number.to_string());
    fs::rename(place, &aside).map_err(failed)?;
    log::say(&format!("{reason}; the edits are set aside in {}", aside.display()));
    Ok(())
}

/// The folder of a draft of `place` that was set aside.
fn folder_of(place: &Path, id: &str) -> PathBuf {
    place.with_extension(format!("unfit-{id}"))
}

/// The ids of the drafts of `place` that were set aside, oldest first.
fn ids(place: &Path) -> Vec<String> {
    let name = place.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let begin = format!("{name}.unfit-");
    let entries = place.parent().map(fs::read_dir).into_iter().flatten().flatten().flatten();
    let id =
        |entry: fs::DirEntry| Some(entry.file_name().to_str()?.strip_prefix(&begin)?.to_owned());
    let mut ids: Vec<_> = entries.filter_map(id).filter(|id| is_id(id)).collect();
    ids.sort_by_key(|id| (id.len(), id.clone()));
    ids
}

fn is_id(id: &str) -> bool {
    !id.is_empty() && id.bytes().all(|byte| byte.is_ascii_digit())
}

/// Number of drafts of `place` that are set aside.
pub(super) fn count(place: &Path) -> u64 {
    ids(place).len() as u64
}

fn about(folder: &Path) -> About {
    let text = private::read(&folder.join(ABOUT)).ok().flatten();
    text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_else(|| About {
        at_ms: 0,
        reason: "an earlier version of the server could not apply its edits".to_owned(),
    })
}

/// A draft with its unsaved edits.
fn listed(place: &Path, id: String) -> SetAsideDraft {
    let folder = folder_of(place, &id);
    let About { at_ms, mut reason } = about(&folder);
    let mut edits = match draft::find(&folder) {
        Ok(found) => found.map(|found| edits(&found)).unwrap_or_default(),
        Err(error) => {
            reason = format!("{reason}; {error}");
            Vec::new()
        }
    };
    let count = edits.len() as u64;
    edits.truncate(EDITS_MAX);
    SetAsideDraft { id, at_ms, reason, count, edits }
}

fn edits(found: &FoundDraft) -> Vec<SetAsideEdit> {
    let done = found.lines.iter().filter_map(|line| match line {
        DraftLine::Done(operation) => Some(&**operation),
        DraftLine::Saving { .. } | DraftLine::Saved { .. } => None,
    });
    let saved = usize::try_from(found.saved_steps()).unwrap_or(usize::MAX);
    done.skip(saved).map(words::of_operation).collect()
}

/// A complete draft as one JSON object: its lines, and the documents that they refer to.
fn exported(folder: &Path) -> Result<Vec<u8>, PrivateError> {
    let about = about(folder);
    let reason = serde_json::to_string(&about.reason).unwrap_or_default();
    let mut text = format!(r#"{{"at_ms":{},"reason":{reason},"lines":["#, about.at_ms);
    let lines = private::read(&folder.join(draft::OPERATIONS))?.unwrap_or_default();
    text.push_str(&lines.trim_end().replace('\n', ",\n"));
    text.push_str("],\"documents\":{");
    let mut separator = "";
    for hash in documents(folder).map_err(|source| PrivateError::new("read", folder, source))? {
        if let Some(document) = draft::kept(folder, &hash)? {
            text.extend([separator, "\"", &hash, "\":", &document]);
            separator = ",\n";
        }
    }
    text.push_str("}}\n");
    Ok(text.into_bytes())
}

/// The names of the documents in a draft.
fn documents(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        let hash = name.strip_suffix(".json").filter(|hash| hash.len() == 64);
        names.extend(hash.map(str::to_owned));
    }
    names.sort();
    Ok(names)
}

impl Documents {
    /// The drafts of an open machine that are set aside.
    fn set_aside(&self, id: &str) -> Result<Vec<SetAsideDraft>, Failure> {
        let place = self.session(id)?.draft_place();
        Ok(ids(&place).into_iter().map(|id| listed(&place, id)).collect())
    }

    fn set_aside_folder(&self, machine: &str, id: &str) -> Result<PathBuf, Failure> {
        let place = self.session(machine)?.draft_place();
        let folder = is_id(id).then(|| folder_of(&place, id)).filter(|folder| folder.is_dir());
        if let Some(folder) = folder {
            return Ok(folder);
        }
        let message = format!(
            "no draft `{id}` of this machine is set aside: /api/v1/machines/{machine}/set_aside lists them"
        );
        Err(Failure::not_found("no_such_draft", message))
    }

    fn export_set_aside(&self, machine: &str, id: &str) -> Result<Vec<u8>, Failure> {
        let folder = self.set_aside_folder(machine, id)?;
        exported(&folder).map_err(|error| draft::unreadable(&error))
    }

    fn discard_set_aside(
        &self,
        server: &ServerState,
        machine: &str,
        id: &str,
    ) -> Result<(), Failure> {
        let folder = self.set_aside_folder(machine, id)?;
        draft::discard(&folder).map_err(|error| {
            let message = format!("{error}; {}", error.remedy());
            Failure::unavailable("not_removed", message)
        })?;
        self.session(machine)?.count_set_aside();
        server.news.machines();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{EDITS_MAX, draft, folder_of, listed};
    use crate::documents::draft::DraftHeader;
    use std::fs;
    use std::path::Path;

    #[test]
    fn of_many_edits_that_are_set_aside_the_first_are_listed_and_all_counted() {
        let state = tempfile::tempdir().unwrap();
        let place = state.path().join("m");
        let folder = folder_of(&place, "1");
        fs::create_dir(&folder).unwrap();
        let head = DraftHeader::new(Path::new("/m"), "hash", 1);
        let done = |id: usize| {
            format!(
                r#"{{"line":"done","author":"ann","id":"{id}","at_ms":{id},"what":{{"what":"undo"}}}}"#
            )
        };
        let list = |edits: usize| {
            let head = serde_json::to_string(&head).unwrap();
            let lines: Vec<_> = [head].into_iter().chain((0..edits).map(done)).collect();
            fs::write(folder.join(draft::OPERATIONS), lines.join("\n") + "\n").unwrap();
            let draft = listed(&place, "1".to_owned());
            (draft.count, draft.edits.len(), draft.edits.last().unwrap().at_ms)
        };
        let most = EDITS_MAX as u64;
        assert_eq!(list(EDITS_MAX), (most, EDITS_MAX, most - 1));
        assert_eq!(list(EDITS_MAX + 1), (most + 1, EDITS_MAX, most - 1));
    }
}
