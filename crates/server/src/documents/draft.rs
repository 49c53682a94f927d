//! What was done to an open machine since it was read, written before it is answered, so that a server that dies loses nothing,
//! and synced a moment later, so that a power cut loses that moment at most.
//! Knows lines and files, but not what an edit means.
//!
//! A draft is a folder: `operations.jsonl` says what was read, what was done and when it was saved; beside it lie machines as
//! documents, named after their content: the one that was read, and those that replaced it. The one that was read is written
//! before the first line, so that the lines mean something whatever becomes of the machine's files.

use super::group_sync::GroupSync;
use super::operation::{EditRequest, RecordedOperation};
use crate::Failure;
use crate::access::{PrivateError, private};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// The file of the lines.
pub(super) const OPERATIONS: &str = "operations.jsonl";
/// The format of the lines; the first one had no `saving`.
const FORMAT: u32 = 2;

/// The first line of a draft.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct DraftHeader {
    /// The format of the lines.
    format: u32,
    /// Where the machine lies.
    pub(super) folder: PathBuf,
    /// The content that was read.
    pub(super) base: String,
    /// Its revision.
    pub(super) revision: u64,
    /// What was done before, the last of it last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) answered: Vec<RecordedAnswer>,
}

/// An operation that was done and answered, of which nothing else is known.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct RecordedAnswer {
    #[serde(flatten)]
    pub(super) request: EditRequest,
    /// The revision that it made.
    pub(super) revision: u64,
}

/// A later line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "line", rename_all = "snake_case")]
pub(super) enum DraftLine {
    /// An operation was done.
    Done(Box<RecordedOperation>),
    /// The machine is about to be saved.
    Saving {
        /// At this revision.
        revision: u64,
        /// The content of its files afterwards.
        hash: String,
    },
    /// The machine was saved.
    Saved {
        /// At this revision.
        revision: u64,
        /// The content of its files.
        hash: String,
    },
}

/// The draft of an open machine. Nothing is on disk until there is something to lose.
#[derive(Debug)]
pub(super) struct Draft {
    place: PathBuf,
    head: DraftHeader,
    file: Option<DraftFile>,
}

/// The lines on disk.
#[derive(Debug)]
struct DraftFile {
    file: File,
    length: u64,
    sync: GroupSync,
}

/// A draft that an earlier server left behind.
#[derive(Debug)]
pub(super) struct FoundDraft {
    pub(super) head: DraftHeader,
    pub(super) lines: Vec<DraftLine>,
    /// The length of the valid lines; what follows was never answered.
    length: u64,
}

impl FoundDraft {
    /// The revision that was saved last, and the content of its files.
    pub(super) fn saved(&self) -> (u64, &str) {
        let saved = self.lines.iter().rev().find_map(|line| match line {
            DraftLine::Saved { revision, hash } => Some((*revision, hash.as_str())),
            DraftLine::Done(_) | DraftLine::Saving { .. } => None,
        });
        saved.unwrap_or((self.head.revision, &self.head.base))
    }

    /// Number of its operations that are saved.
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

/// The draft in `place`. One that cannot be read is not touched.
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
    /// The lines in a draft's folder, up to this length. They are synced together with the document that they begin with and
    /// with the folders that contain them.
    fn open(place: &Path, base: &str, length: u64) -> io::Result<Self> {
        let file = private::open(&place.join(OPERATIONS))?;
        file.set_len(length)?;
        let mut base = Some(File::open(document_in(place, base))?);
        let mut synced = vec![file.try_clone()?, File::open(place)?];
        synced.extend(place.parent().map(File::open).transpose()?);
        let sync = GroupSync::begin(move || {
            // It never changes, so that once is enough.
            if let Some(document) = &base {
                document.sync_all()?;
                base = None;
            }
            synced.iter().try_for_each(File::sync_all)
        })?;
        Ok(Self { file, length, sync })
    }

    /// Appends to it. If that fails, nothing of it stays.
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
    /// A draft that has nothing to keep yet.
    pub(super) fn new(place: PathBuf, head: DraftHeader) -> Self {
        Self { place, head, file: None }
    }

    /// A draft that replaces one whose edits are all saved, but whose answered ids are to stay known.
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

    /// Continues a draft that an earlier server left behind. `document` is what the draft begins with, if the files hold it.
    pub(super) fn go_on(
        place: PathBuf,
        found: &FoundDraft,
        document: Option<&[u8]>,
    ) -> Result<Self, PrivateError> {
        let head = found.head.clone();
        // Earlier versions of the server relied on the files for it.
        if let Some(document) = document
            && !document_in(&place, &head.base).exists()
        {
            keep(&place, &head.base, document)?;
        }
        let path = place.join(OPERATIONS);
        let failed = |source| PrivateError::new("write", &path, source);
        let file = DraftFile::open(&place, &head.base, found.length).map_err(failed)?;
        // The server that wrote it may have died before it was synced.
        file.sync.written();
        Ok(Self { place, head, file: Some(file) })
    }

    /// Whether there is something on disk.
    pub(super) fn is_begun(&self) -> bool {
        self.file.is_some()
    }

    /// Its folder.
    pub(super) fn place(&self) -> &Path {
        &self.place
    }

    /// Puts it on disk: `document` is what it begins with. Does not wait for the disk.
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

    /// Writes a line of a draft that is begun. If that fails, nothing of it stays.
    pub(super) fn append(&mut self, line: &DraftLine) -> Result<(), PrivateError> {
        let path = self.place.join(OPERATIONS);
        let failed = |source: io::Error| PrivateError::new("write", &path, source);
        let text = as_line(line).map_err(failed)?;
        let file = self.file.as_mut().ok_or_else(|| failed(io::Error::other("it is not begun")))?;
        file.append(&text).map_err(failed)
    }

    /// Moves to the folder of a machine that lies elsewhere from now on.
    pub(super) fn move_to(&mut self, place: PathBuf) -> Result<(), PrivateError> {
        if let Some(file) = &self.file {
            let failed = |source| PrivateError::new("move the draft to", &place, source);
            fs::rename(&self.place, &place).map_err(failed)?;
            file.sync.written();
        }
        self.place = place;
        Ok(())
    }

    /// Discards everything.
    pub(super) fn discard(&mut self) -> Result<(), PrivateError> {
        self.file = None;
        discard(&self.place)
    }
}

/// Removes a draft.
pub(super) fn discard(place: &Path) -> Result<(), PrivateError> {
    match fs::remove_dir_all(place) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(PrivateError::new("remove", place, source))
        }
        _ => Ok(()),
    }
}

/// Keeps a document under the name of its content.
pub(super) fn keep(place: &Path, hash: &str, document: &[u8]) -> Result<(), PrivateError> {
    private::folder(place)?;
    private::write(&document_in(place, hash), document)
}

/// A document that was kept.
pub(super) fn kept(place: &Path, hash: &str) -> Result<Option<String>, PrivateError> {
    private::read(&document_in(place, hash))
}

/// The file of a document.
fn document_in(place: &Path, hash: &str) -> PathBuf {
    place.join(format!("{hash}.json"))
}

/// A draft that cannot be read stays where it is.
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

    /// Without the document no line can be made again once the machine's files are others.
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

    /// A line that was cut off was never answered: it is removed.
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
