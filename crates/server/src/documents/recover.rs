//! Recovers a machine from its files and the draft of a server that crashed. Knows drafts and the replay of operations, but not the client.

use super::disk::{OnDisk, content};
use super::draft::{
    Draft, DraftHeader, DraftLine, FoundDraft, RecordedAnswer, discard, find, unreadable,
};
use super::machine::OpenMachine;
use super::operation::{RecordedOperation, kept_machine};
use super::session::FileLocation;
use super::set_aside::set_aside;
use crate::Failure;
use rafcon_model::Machine;
use rafcon_storage::Libraries;
use std::path::{Path, PathBuf};

/// Capacity of the ids of saved operations.
const ANSWERED_MAX: usize = 10_000;

/// A recovered machine with its draft.
#[derive(Debug)]
pub(super) struct Recovered {
    pub(super) machine: OpenMachine,
    pub(super) draft: Draft,
    /// The revision that is on disk.
    pub(super) saved_revision: u64,
    /// True if the draft has unsaved edits.
    pub(super) has_edits: bool,
    /// Hash of the files when they were last read or written.
    pub(super) hash: String,
}

/// The machine of a folder with the edits of its draft. Without a draft, it begins at `revision`. Edits that no longer fit are
/// set aside, but only for a user who may edit.
pub(super) fn recover(
    location: &FileLocation,
    on_disk: &OnDisk,
    revision: u64,
    libraries: &Libraries,
    may_edit: bool,
) -> Result<Recovered, Failure> {
    let (folder, place) = (&*location.folder, location.draft.clone());
    let Some(mut found) = find(&place).map_err(|error| unreadable(&error))? else {
        discard(&place).map_err(|error| unreadable(&error))?;
        return Ok(fresh(folder, place, on_disk, revision));
    };
    let own_save = interrupted_save(&found, &on_disk.hash);
    found.lines.extend(own_save.clone());
    if unsaved(&found) == 0 {
        return known(folder, place, on_disk, revision, &found);
    }
    let (saved_revision, expected) = found.saved();
    let expected = expected.to_owned();
    let machine = match replayed(&found, &place, on_disk, libraries) {
        Ok(machine) => machine,
        Err(failure) if !may_edit => return Err(left_alone(&failure)),
        Err(failure) => {
            let unfit = unfit(folder, &failure);
            set_aside(&place, revision, &unfit).map_err(|error| unreadable(&error))?;
            return Ok(fresh(folder, place, on_disk, revision));
        }
    };
    let mut recovered = Recovered {
        has_edits: has_edits(&machine, on_disk, &expected)?,
        draft: go_on(place, &found, on_disk)?,
        machine,
        saved_revision,
        hash: expected,
    };
    own_save
        .map_or(Ok(()), |line| recovered.draft.append(&line))
        .map_err(|error| unreadable(&error))?;
    recovered.adopt(on_disk)?;
    Ok(recovered)
}

impl Recovered {
    /// Records the machine as saved if its files already contain it: the last server crashed before it recorded the load.
    fn adopt(&mut self, on_disk: &OnDisk) -> Result<(), Failure> {
        if self.hash == on_disk.hash || *self.machine.machine() != on_disk.machine {
            return Ok(());
        }
        (self.saved_revision, self.hash) = (self.machine.revision(), on_disk.hash.clone());
        let line = DraftLine::Saved { revision: self.saved_revision, hash: self.hash.clone() };
        self.draft.append(&line).map_err(|error| unreadable(&error))
    }
}

/// A save that the last server completed but did not record. The files have the announced hash.
fn interrupted_save(found: &FoundDraft, on_disk: &str) -> Option<DraftLine> {
    let since = found.lines.iter().rev();
    let mut since = since.take_while(|line| !matches!(line, DraftLine::Saved { .. }));
    since.find_map(|line| match line {
        DraftLine::Saving { revision, hash } if hash == on_disk => {
            Some(DraftLine::Saved { revision: *revision, hash: hash.clone() })
        }
        DraftLine::Saving { .. } | DraftLine::Saved { .. } | DraftLine::Done(_) => None,
    })
}

/// True if the machine differs from the last saved one. Edits may have been undone.
fn has_edits(machine: &OpenMachine, on_disk: &OnDisk, expected: &str) -> Result<bool, Failure> {
    if *machine.machine() == on_disk.machine {
        return Ok(false);
    }
    Ok(on_disk.hash == expected || content(machine.machine())?.0 != expected)
}

/// Continues the draft and stores its base document if only the files contain it.
fn go_on(place: PathBuf, found: &FoundDraft, on_disk: &OnDisk) -> Result<Draft, Failure> {
    let document = (found.head.base == on_disk.hash).then_some(&*on_disk.document);
    Draft::go_on(place, found, document).map_err(|error| unreadable(&error))
}

fn fresh(folder: &Path, place: PathBuf, on_disk: &OnDisk, revision: u64) -> Recovered {
    Recovered {
        machine: OpenMachine::new(on_disk.machine.clone(), revision),
        draft: Draft::new(place, DraftHeader::new(folder, &on_disk.hash, revision)),
        saved_revision: revision,
        has_edits: false,
        hash: on_disk.hash.clone(),
    }
}

/// Keeps the ids of operations of a draft that is completely saved, so that no request is performed twice.
fn known(
    folder: &Path,
    place: PathBuf,
    on_disk: &OnDisk,
    revision: u64,
    found: &FoundDraft,
) -> Result<Recovered, Failure> {
    let mut head = DraftHeader::new(folder, &on_disk.hash, revision);
    head.answered = answered(found);
    let mut recovered = fresh(folder, place.clone(), on_disk, revision);
    know(&mut recovered.machine, &head.answered);
    recovered.draft =
        Draft::anew(place, head, &on_disk.document).map_err(|error| unreadable(&error))?;
    Ok(recovered)
}

/// The draft's acknowledged operations with their revisions.
fn answered(found: &FoundDraft) -> Vec<RecordedAnswer> {
    let done = found.lines.iter().filter_map(|line| match line {
        DraftLine::Done(operation) => Some(operation),
        DraftLine::Saving { .. } | DraftLine::Saved { .. } => None,
    });
    let done = done.zip(found.head.revision + 1..).map(|(operation, revision)| RecordedAnswer {
        request: operation.request.clone(),
        revision,
    });
    let mut answered: Vec<_> = found.head.answered.iter().cloned().chain(done).collect();
    answered.drain(..answered.len().saturating_sub(ANSWERED_MAX));
    answered
}

fn know(machine: &mut OpenMachine, answered: &[RecordedAnswer]) {
    for RecordedAnswer { request, revision } in answered {
        machine.knows(request.clone(), *revision);
    }
}

/// Number of unsaved operations.
fn unsaved(found: &FoundDraft) -> u64 {
    let done = found.lines.iter().filter(|line| matches!(line, DraftLine::Done(_))).count() as u64;
    done.saturating_sub(found.saved_steps())
}

/// The machine with which the draft began.
fn base(
    found: &FoundDraft,
    place: &Path,
    on_disk: &OnDisk,
    libraries: &Libraries,
) -> Result<Machine, Failure> {
    if found.head.base == on_disk.hash {
        return Ok(on_disk.machine.clone());
    }
    kept_machine(place, &found.head.base, libraries)
}

/// The base machine with all operations of the draft.
fn replayed(
    found: &FoundDraft,
    place: &Path,
    on_disk: &OnDisk,
    libraries: &Libraries,
) -> Result<OpenMachine, Failure> {
    let base = base(found, place, on_disk, libraries)?;
    let mut machine = OpenMachine::new(base, found.head.revision);
    know(&mut machine, &found.head.answered);
    for line in &found.lines {
        let DraftLine::Done(operation) = line else { continue };
        let RecordedOperation { request, at_ms, operation } = &**operation;
        let operation = operation.read(libraries, place)?;
        let prepared = machine.prepare_again(request.clone(), *at_ms, operation)?;
        machine.commit(prepared);
    }
    Ok(machine)
}

fn unfit(folder: &Path, failure: &Failure) -> Failure {
    let message = format!("unsaved edits of {} cannot be applied: {failure}", folder.display());
    Failure::unprocessable("unfit_draft", message)
}

fn left_alone(failure: &Failure) -> Failure {
    let message = format!(
        "edits of it that were not saved cannot be made again ({failure}): whoever may edit opens it without them, and they \
         are set aside"
    );
    Failure::unprocessable("unfit_draft", message)
}

#[cfg(test)]
mod tests {
    use super::{ANSWERED_MAX, RecordedAnswer, answered};
    use crate::documents::draft::{DraftHeader, find};
    use crate::documents::operation::EditRequest;
    use std::path::Path;

    #[test]
    fn of_the_ids_in_a_draft_the_newest_stay_known() {
        let place = tempfile::tempdir().unwrap();
        let mut head = DraftHeader::new(Path::new("/m"), "hash", 3);
        let request = |id: usize| EditRequest { author: "ann".to_owned(), id: id.to_string() };
        let known = |id: usize| RecordedAnswer { request: request(id), revision: id as u64 };
        head.answered = (0..ANSWERED_MAX).map(known).collect();
        let done = r#"{"line":"done","author":"ann","id":"new","at_ms":0,"what":{"what":"undo"}}"#;
        let lines = format!("{}\n{done}\n", serde_json::to_string(&head).unwrap());
        std::fs::write(place.path().join("operations.jsonl"), lines).unwrap();
        let answers = answered(&find(place.path()).unwrap().unwrap());
        assert_eq!(answers.len(), ANSWERED_MAX);
        assert_eq!(answers[0].request, request(1));
        let last = answers.last().unwrap();
        assert_eq!((last.request.id.as_str(), last.revision), ("new", 4));
    }
}
