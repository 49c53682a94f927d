//! From what lies on disk and what a server that died had taken to the machine as people left it. Knows drafts and how an
//! operation is done, but not who asks.

use super::disk::OnDisk;
use super::draft::{
    Draft, DraftHeader, DraftLine, FoundDraft, RecordedAnswer, discard, find, unreadable,
};
use super::machine::OpenMachine;
use super::operation::{RecordedOperation, kept_machine};
use super::session::FileLocation;
use crate::Failure;
use crate::log::say;
use rafcon_model::Machine;
use rafcon_storage::Libraries;
use std::fs;
use std::path::{Path, PathBuf};

/// How many ids of operations that were done and saved stay known.
const ANSWERED_MAX: usize = 10_000;

/// A machine as users left it.
#[derive(Debug)]
pub(super) struct Recovered {
    pub(super) machine: OpenMachine,
    pub(super) draft: Draft,
    /// The revision that lies on disk.
    pub(super) saved_revision: u64,
    /// Whether edits were found that are not saved.
    pub(super) has_edits: bool,
    /// The content of the files as they were read or written last.
    pub(super) hash: String,
}

/// The machine of a folder with what its draft holds. `revision` is where one without a draft begins. What no longer fits is
/// set aside, but only for a user who may edit.
pub(super) fn recover(
    spot: &FileLocation,
    on_disk: &OnDisk,
    revision: u64,
    libraries: &Libraries,
    may_edit: bool,
) -> Result<Recovered, Failure> {
    let (folder, place) = (&*spot.folder, spot.draft.clone());
    let Some(found) = find(&place).map_err(|error| unreadable(&error))? else {
        discard(&place).map_err(|error| unreadable(&error))?;
        return Ok(fresh(folder, place, on_disk, revision));
    };
    if unsaved(&found) == 0 {
        return known(folder, place, on_disk, revision, &found);
    }
    let (saved_revision, expected) = saved(&found);
    let machine = match replayed(&found, &place, on_disk, libraries) {
        Ok(machine) => machine,
        Err(failure) if !may_edit => return Err(left_alone(&failure)),
        Err(failure) => {
            set_aside(&place, folder, revision, &failure);
            return Ok(fresh(folder, place, on_disk, revision));
        }
    };
    Ok(Recovered {
        machine,
        hash: expected,
        draft: Draft::go_on(place, &found).map_err(|error| unreadable(&error))?,
        saved_revision,
        has_edits: true,
    })
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

/// Everything is saved; the ids of operations stay known, so that none is done again.
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

/// What was done, by the draft.
fn answered(found: &FoundDraft) -> Vec<RecordedAnswer> {
    let done = found.lines.iter().filter_map(|line| match line {
        DraftLine::Done(operation) => Some(operation),
        DraftLine::Saved { .. } => None,
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

/// The revision that was saved last, and the content of its files.
fn saved(found: &FoundDraft) -> (u64, String) {
    let saved = |line: &DraftLine| match line {
        DraftLine::Saved { revision, hash } => Some((*revision, hash.clone())),
        DraftLine::Done(_) => None,
    };
    let last = found.lines.iter().rev().find_map(saved);
    last.unwrap_or_else(|| (found.head.revision, found.head.base.clone()))
}

/// How many operations are not saved.
fn unsaved(found: &FoundDraft) -> u64 {
    let done = found.lines.iter().filter(|line| matches!(line, DraftLine::Done(_))).count() as u64;
    (found.head.revision + done).saturating_sub(saved(found).0)
}

/// The machine that was read when the draft was begun.
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

/// The machine that was read, with everything that was done to it.
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

/// A draft that no longer fits is kept for people to inspect.
fn set_aside(place: &Path, folder: &Path, revision: u64, failure: &Failure) {
    let aside = place.with_extension(format!("unfit-{revision}"));
    let moved = match fs::rename(place, &aside) {
        Ok(()) => format!("they are kept in {}", aside.display()),
        Err(error) => format!("and cannot be kept in {}: {error}", aside.display()),
    };
    say(&format!("edits of {} cannot be made again: {failure}; {moved}", folder.display()));
}

fn left_alone(failure: &Failure) -> Failure {
    let message = format!(
        "edits of it that were not saved cannot be made again ({failure}): whoever may edit opens it without them, and they \
         are set aside"
    );
    Failure::unprocessable("unfit_draft", message)
}
