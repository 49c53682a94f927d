//! A journal of the changes of an open machine since it was loaded. Each change is written before it is acknowledged, so that a
//! crash of the server loses nothing. It is synced a moment later, so that a power cut loses at most that moment.
//! Knows lines and files, but not the meaning of an edit.
//!
//! A draft is a folder. `operations.jsonl` records the load, the operations and the saves. Machines are stored beside it as
//! documents, named by their content: the loaded one, and those that replaced it. The loaded machine is written before the first
//! line, so that the lines can be replayed even if the machine's files change.

use super::group_sync::GroupSync;
use super::operation::{EditRequest, RecordedOperation};
use crate::Failure;
use crate::access::{PrivateError, private};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Name of the file with the lines.
pub(super) const OPERATIONS: &str = "operations.jsonl";
/// The format of the lines. The first format had no `saving`.
const FORMAT: u32 = 2;

/// The first line of a draft.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct DraftHeader {
    /// The format of the lines.
    format: u32,
    /// Folder of the machine.
    pub(super) folder: PathBuf,
    /// Hash of the loaded content.
    pub(super) base: String,
    /// Revision of the loaded content.
    pub(super) revision: u64,
    /// Earlier acknowledged operations, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) answered: Vec<RecordedAnswer>,
}

/// The id and the revision of an acknowledged operation; its content is no longer stored.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct RecordedAnswer {
    #[serde(flatten)]
    pub(super) request: EditRequest,
    /// The revision that the operation made.
    pub(super) revision: u64,
}

/// A line after the header.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "line", rename_all = "snake_case")]
pub(super) enum DraftLine {
    /// An operation was performed.
    Done(Box<RecordedOperation>),
    /// The machine is about to be saved.
    Saving {
        /// Revision that is being saved.
        revision: u64,
        /// Hash of its files after the save.
        hash: String,
    },
    /// The machine was saved.
    Saved {
        /// Revision that was saved.
        revision: u64,
        /// Hash of its files.
        hash: String,
    },
}

/// The draft of an open machine. It is not on disk until the first change.
#[derive(Debug)]
pub(super) struct Draft {
    place: PathBuf,
    head: DraftHeader,
    file: Option<DraftFile>,
}

/// The file with the lines.
#[derive(Debug)]
struct DraftFile {
    file: File,
    length: u64,
    sync: GroupSync,
}

/// A draft of an earlier server.
#[derive(Debug)]
pub(super) struct FoundDraft {
    pub(super) head: DraftHeader,
    pub(super) lines: Vec<DraftLine>,
    /// Length of the complete lines. The rest was never acknowledged.
    length: u64,
}

impl FoundDraft {
    /// The last saved revision, and the hash of its files.
    pub(super) fn saved(&self) -> (u64, &str) {
        let saved = self.lines.iter().rev().find_map(|line| match line {
            DraftLine::Saved { revision, hash } => Some((*revision, hash.as_str())),
            DraftLine::Done(_) | DraftLine::Saving { .. } => None,
        });
        saved.unwrap_or((self.head.revision, &self.head.base))
    }

    /// Number of saved operations.
    pub(super) fn saved_steps(&self) -> u64 {
        self.saved().0.saturating_sub(self.head.revision)
    }
}

impl DraftHeader {
    pub(super) fn new(folder: &Path, base: &str, revision: u64) -> Self {
        let (folder, base) = (folder.to_owned(), base.to_owned());
        Self { format: FORMAT, folder, base, revision, answered: Vec::new() }
    }
}

/// The draft in `place`. An unreadable draft stays untouched.
pub(super) fn find(place: &Path) -> Result<Option<FoundDraft>, PrivateError> {
    let path = place.join(OPERATIONS);
    let Some(text) = private::read(&path)? else { return Ok(None) };
    let damaged = |error: serde_json::Error| PrivateError::new("read", &path, error.into());
    let mut length = 0;
    let mut whole =
        text.split_inclusive('\n').filter(|line| line.ends_with('\n')).inspect(|line| {
            length += line.len() as u64;
        });
    let Some(first) = whole.next() else { return Ok(None) };
    let head: DraftHeader = serde_json::from_str(first).map_err(damaged)?;
    if !(1..=FORMAT).contains(&head.format) {
        let newer = io::Error::other("another version of this program wrote it: use that one");
        return Err(PrivateError::new("read", &path, newer));
    }
    let lines = whole.map(serde_json::from_str).collect::<Result<_, _>>().map_err(damaged)?;
    Ok(Some(FoundDraft { head, lines, length }))
}

impl DraftFile {
    /// Opens the lines of a draft, cut to this length. Each sync includes the folders that contain them; the first one also
    /// includes the base document.
    fn open(place: &Path, base: &str, length: u64) -> io::Result<Self> {
        let file = private::open(&place.join(OPERATIONS))?;
        file.set_len(length)?;
        let mut base = Some(File::open(document_in(place, base))?);
        let mut synced = vec![file.try_clone()?, File::open(place)?];
        synced.extend(place.parent().map(File::open).transpose()?);
        let sync = GroupSync::begin(move || {
            // The document never changes, so one sync suffices.
            if let Some(document) = &base {
                document.sync_all()?;
                base = None;
            }
            synced.iter().try_for_each(File::sync_all)
        })?;
        Ok(Self { file, length, sync })
    }

    /// Appends text. If that fails, no part of it remains.
    fn append(&mut self, text: &str) -> io::Result<()> {
        if let Err(error) = self.file.write_all(text.as_bytes()) {
            self.file.set_len(self.length)?;
            return Err(error);
        }
        self.length += text.len() as u64;
        self.sync.written();
        Ok(())
    }
}

impl Draft {
    /// A draft that is not yet on disk.
    pub(super) fn new(place: PathBuf, head: DraftHeader) -> Self {
        Self { place, head, file: None }
    }

    /// Replaces a draft whose edits are all saved. The ids of acknowledged operations stay known.
    pub(super) fn anew(
        place: PathBuf,
        head: DraftHeader,
        document: &[u8],
    ) -> Result<Self, PrivateError> {
        let path = place.join(OPERATIONS);
        let failed = |source| PrivateError::new("write", &path, source);
        keep(&place, &head.base, document)?;
        let text = as_line(&head).map_err(failed)?;
        private::write(&path, text.as_bytes())?;
        let file = DraftFile::open(&place, &head.base, text.len() as u64).map_err(failed)?;
        Ok(Self { place, head, file: Some(file) })
    }

    /// Continues a draft of an earlier server. `document` is the base document if the machine's files still contain it.
    pub(super) fn go_on(
        place: PathBuf,
        found: &FoundDraft,
        document: Option<&[u8]>,
    ) -> Result<Self, PrivateError> {
        let head = found.head.clone();
        // Earlier versions of the server did not store the base document.
        if let Some(document) = document
            && !document_in(&place, &head.base).exists()
        {
            keep(&place, &head.base, document)?;
        }
        let path = place.join(OPERATIONS);
        let failed = |source| PrivateError::new("write", &path, source);
        let file = DraftFile::open(&place, &head.base, found.length).map_err(failed)?;
        // The earlier server may have crashed before the sync.
        file.sync.written();
        Ok(Self { place, head, file: Some(file) })
    }

    /// True if the draft is on disk.
    pub(super) fn is_begun(&self) -> bool {
        self.file.is_some()
    }

    /// Folder of the draft.
    pub(super) fn place(&self) -> &Path {
        &self.place
    }

    /// Creates the draft on disk, with `document` as its base. Does not wait for the disk.
    pub(super) fn begin(&mut self, document: &[u8]) -> Result<(), PrivateError> {
        let path = self.place.join(OPERATIONS);
        let failed = |source: io::Error| PrivateError::new("write", &path, source);
        private::folder(&self.place)?;
        private::write_soon(&document_in(&self.place, &self.head.base), document)?;
        let head = as_line(&self.head).map_err(failed)?;
        let mut file = DraftFile::open(&self.place, &self.head.base, 0).map_err(failed)?;
        file.append(&head).map_err(failed)?;
        self.file = Some(file);
        Ok(())
    }

    /// Appends a line to a draft on disk. If that fails, no part of it remains.
    pub(super) fn append(&mut self, line: &DraftLine) -> Result<(), PrivateError> {
        let path = self.place.join(OPERATIONS);
        let failed = |source: io::Error| PrivateError::new("write", &path, source);
        let text = as_line(line).map_err(failed)?;
        let file = self.file.as_mut().ok_or_else(|| failed(io::Error::other("it is not begun")))?;
        file.append(&text).map_err(failed)
    }

    /// Moves the draft to the folder for another location of the machine.
    pub(super) fn move_to(&mut self, place: PathBuf) -> Result<(), PrivateError> {
        if let Some(file) = &self.file {
            let failed = |source| PrivateError::new("move the draft to", &place, source);
            fs::rename(&self.place, &place).map_err(failed)?;
            file.sync.written();
        }
        self.place = place;
        Ok(())
    }

    /// Deletes the draft from disk.
    pub(super) fn discard(&mut self) -> Result<(), PrivateError> {
        self.file = None;
        discard(&self.place)
    }
}

/// Removes a draft's folder, if it exists.
pub(super) fn discard(place: &Path) -> Result<(), PrivateError> {
    match fs::remove_dir_all(place) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(PrivateError::new("remove", place, source))
        }
        _ => Ok(()),
    }
}

/// Stores a document under its hash.
pub(super) fn keep(place: &Path, hash: &str, document: &[u8]) -> Result<(), PrivateError> {
    private::folder(place)?;
    private::write(&document_in(place, hash), document)
}

/// Loads a stored document.
pub(super) fn kept(place: &Path, hash: &str) -> Result<Option<String>, PrivateError> {
    private::read(&document_in(place, hash))
}

/// Path of the document with this hash.
fn document_in(place: &Path, hash: &str) -> PathBuf {
    place.join(format!("{hash}.json"))
}

/// Refusal for an unreadable draft, which stays on disk.
pub(super) fn unreadable(error: &PrivateError) -> Failure {
    let message = format!(
        "{error}; edits that were not saved are in it: move the folder away to open the machine without them"
    );
    Failure::unprocessable("unreadable_draft", message)
}

fn as_line<T: Serialize>(value: &T) -> io::Result<String> {
    Ok(serde_json::to_string(value)? + "\n")
}

#[cfg(test)]
mod tests {
    use super::{Draft, DraftHeader, DraftLine, FoundDraft, OPERATIONS, find, kept};
    use crate::documents::group_sync::GroupSync;
    use crate::documents::operation::{EditRequest, Operation, RecordedOperation};
    use std::fs;
    use std::io::Write as _;
    use std::path::Path;
    use std::sync::mpsc::sync_channel;

    fn new(place: &Path) -> Draft {
        Draft::new(place.join("draft"), DraftHeader::new(Path::new("/m"), "abc", 5))
    }

    /// A draft on disk without a line.
    fn draft(place: &Path) -> Draft {
        let mut draft = new(place);
        draft.begin(b"{}").unwrap();
        draft
    }

    fn undo(id: &str) -> DraftLine {
        let request = EditRequest { author: "ann".to_owned(), id: id.to_owned() };
        let operation = Operation::Undo;
        DraftLine::Done(Box::new(RecordedOperation { request, at_ms: 1, operation }))
    }

    fn found(place: &Path) -> Option<FoundDraft> {
        find(&place.join("draft")).expect("readable")
    }

    #[test]
    fn what_was_written_is_found() {
        let place = tempfile::tempdir().unwrap();
        assert!(found(place.path()).is_none());
        let mut draft = new(place.path());
        assert!(!draft.is_begun());
        draft.begin(b"{}").unwrap();
        let saved = DraftLine::Saved { revision: 6, hash: "def".into() };
        draft.append(&undo("1")).unwrap();
        draft.append(&saved).unwrap();
        let found = found(place.path()).unwrap();
        assert_eq!((found.head, found.lines), (draft.head.clone(), vec![undo("1"), saved]));
        draft.discard().unwrap();
        assert!(find(&place.path().join("draft")).unwrap().is_none());
    }

    /// Without the base document, no line can be replayed once the machine's files have changed.
    #[test]
    fn what_a_draft_begins_with_lies_there_before_its_first_line() {
        let place = tempfile::tempdir().unwrap();
        let draft = draft(place.path());
        assert_eq!(kept(&place.path().join("draft"), "abc").unwrap().as_deref(), Some("{}"));
        assert_eq!(found(place.path()).unwrap().lines, []);
        let mut left = found(place.path()).unwrap();
        left.head.base = "def".into();
        drop(draft);
        let path = place.path().join("draft");
        Draft::go_on(path.clone(), &left, None).unwrap_err();
        Draft::go_on(path.clone(), &left, Some(b"[]")).unwrap();
        assert_eq!(kept(&path, "def").unwrap().as_deref(), Some("[]"));
    }

    #[test]
    fn a_draft_moves_with_its_documents() {
        let place = tempfile::tempdir().unwrap();
        let path = |name: &str| place.path().join(name);
        let mut draft = draft(place.path());
        draft.append(&undo("1")).unwrap();
        draft.move_to(path("moved")).unwrap();
        draft.append(&undo("2")).unwrap();
        assert_eq!(kept(&path("moved"), "abc").unwrap().as_deref(), Some("{}"));
        assert_eq!(find(&path("moved")).unwrap().unwrap().lines, [undo("1"), undo("2")]);
        draft.discard().unwrap();
        assert_eq!((path("draft").exists(), path("moved").exists()), (false, false));
    }

    /// A truncated line was never acknowledged, so it is removed.
    #[test]
    fn a_cut_line_goes_and_the_next_one_is_whole() {
        let place = tempfile::tempdir().unwrap();
        draft(place.path()).append(&undo("1")).unwrap();
        let file = place.path().join("draft").join(OPERATIONS);
        fs::OpenOptions::new().append(true).open(file).unwrap().write_all(b"{\"li").unwrap();
        let left = found(place.path()).unwrap();
        assert_eq!(left.lines, [undo("1")]);
        let mut draft = Draft::go_on(place.path().join("draft"), &left, None).unwrap();
        draft.append(&undo("2")).unwrap();
        assert_eq!(found(place.path()).unwrap().lines, [undo("1"), undo("2")]);
    }

    /// An operation survives a power cut once its group is synced.
    #[test]
    fn every_line_is_synced_behind_its_answer() {
        let place = tempfile::tempdir().unwrap();
        let mut draft = draft(place.path());
        draft.append(&undo("1")).unwrap();
        let path = place.path().join("draft").join(OPERATIONS);
        let ours = fs::File::open(&path).unwrap();
        let (told, synced) = sync_channel(100);
        let sync = GroupSync::begin(move || {
            told.send(ours.metadata()?.len()).map_err(std::io::Error::other)
        });
        draft.file.as_mut().unwrap().sync = sync.unwrap();
        draft.append(&undo("2")).unwrap();
        draft.append(&undo("3")).unwrap();
        drop(draft);
        assert_eq!(synced.iter().last(), Some(fs::metadata(path).unwrap().len()));
    }

    #[test]
    fn a_draft_that_cannot_be_read_stays_as_it_is() {
        let place = tempfile::tempdir().unwrap();
        draft(place.path()).append(&undo("1")).unwrap();
        let file = place.path().join("draft").join(OPERATIONS);
        fs::write(&file, "{}\n").unwrap();
        find(&place.path().join("draft")).unwrap_err();
        assert_eq!(fs::read_to_string(file).unwrap(), "{}\n");
    }
}
