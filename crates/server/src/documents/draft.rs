//! What was done to an open machine since it was read, written before it is answered, so that a server that dies loses nothing,
//! and synced a moment later, so that a power cut loses that moment at most.
//! Knows lines and files, but not what an edit means.
//!
//! A draft is a folder: `operations.jsonl` says what was read, what was done and when it was saved; beside it lie machines as
//! documents, named after their content: the one that was read, and those that replaced it.

use super::group_sync::GroupSync;
use super::operation::{EditRequest, RecordedOperation};
use crate::Failure;
use crate::access::{PrivateError, private};
use rafcon_locks::Mutex;
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const OPERATIONS: &str = "operations.jsonl";
/// The format of the lines.
const FORMAT: u32 = 1;

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
    shelf: DraftFolder,
}

/// The lines on disk.
#[derive(Debug)]
struct DraftFile {
    file: File,
    length: u64,
    sync: GroupSync,
}

/// Where a document of a draft belongs for a writer beside other work: nowhere, once the draft was given up.
#[derive(Debug, Clone)]
pub(super) struct DraftFolder(Arc<Mutex<Option<PathBuf>>>);

/// A draft that an earlier server left behind.
#[derive(Debug)]
pub(super) struct FoundDraft {
    pub(super) head: DraftHeader,
    pub(super) lines: Vec<DraftLine>,
    /// The length of the valid lines; what follows was never answered.
    length: u64,
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
    if head.format != FORMAT {
        let newer = io::Error::other("another version of this program wrote it: use that one");
        return Err(PrivateError::new("read", &path, newer));
    }
    let lines = whole.map(serde_json::from_str).collect::<Result<_, _>>().map_err(damaged)?;
    Ok(Some(FoundDraft { head, lines, length }))
}

impl DraftFile {
    /// The lines in a draft's folder, up to this length. They are synced together with the folders that contain them.
    fn open(place: &Path, length: u64) -> io::Result<Self> {
        let file = private::open(&place.join(OPERATIONS)).map_err(io::Error::other)?;
        file.set_len(length)?;
        let mut synced = vec![file.try_clone()?, File::open(place)?];
        synced.extend(place.parent().map(File::open).transpose()?);
        let sync = GroupSync::begin(move || synced.iter().try_for_each(File::sync_all))?;
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
        Self { shelf: DraftFolder::at(&place), place, head, file: None }
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
        let file = DraftFile::open(&place, text.len() as u64).map_err(failed)?;
        Ok(Self { shelf: DraftFolder::at(&place), place, head, file: Some(file) })
    }

    /// Continues a draft that an earlier server left behind.
    pub(super) fn go_on(place: PathBuf, found: &FoundDraft) -> Result<Self, PrivateError> {
        let path = place.join(OPERATIONS);
        let failed = |source| PrivateError::new("write", &path, source);
        let file = DraftFile::open(&place, found.length).map_err(failed)?;
        // The server that wrote it may have died before it was synced.
        file.sync.written();
        let (shelf, head) = (DraftFolder::at(&place), found.head.clone());
        Ok(Self { place, head, file: Some(file), shelf })
    }

    /// Whether there is something on disk.
    pub(super) fn is_begun(&self) -> bool {
        self.file.is_some()
    }

    /// The name of the content that it begins with.
    pub(super) fn base(&self) -> &str {
        &self.head.base
    }

    /// Its folder.
    pub(super) fn place(&self) -> &Path {
        &self.place
    }

    /// Where documents belong that are written later, wherever it lies then.
    pub(super) fn shelf(&self) -> DraftFolder {
        self.shelf.clone()
    }

    /// Writes a line. If that fails, nothing of it stays.
    pub(super) fn append(&mut self, line: &DraftLine) -> Result<(), PrivateError> {
        let path = self.place.join(OPERATIONS);
        let failed = |source: io::Error| PrivateError::new("write", &path, source);
        let text = as_line(line).map_err(failed)?;
        if let Some(file) = &mut self.file {
            return file.append(&text).map_err(failed);
        }
        private::folder(&self.place)?;
        let head = as_line(&self.head).map_err(failed)?;
        let mut file = DraftFile::open(&self.place, 0).map_err(failed)?;
        file.append(&(head + &text)).map_err(failed)?;
        self.file = Some(file);
        Ok(())
    }

    /// Moves to the folder of a machine that lies elsewhere from now on.
    pub(super) fn move_to(&mut self, place: PathBuf) -> Result<(), PrivateError> {
        let mut shelf = self.shelf.0.lock();
        if let Some(file) = &self.file {
            let failed = |source| PrivateError::new("move the draft to", &place, source);
            fs::rename(&self.place, &place).map_err(failed)?;
            file.sync.written();
        }
        *shelf = Some(place.clone());
        drop(shelf);
        self.place = place;
        Ok(())
    }

    /// Discards everything.
    pub(super) fn discard(&mut self) -> Result<(), PrivateError> {
        self.file = None;
        let mut shelf = self.shelf.0.lock();
        discard(&self.place)?;
        *shelf = None;
        Ok(())
    }
}

impl DraftFolder {
    fn at(place: &Path) -> Self {
        Self(Arc::new(Mutex::new(Some(place.to_owned()))))
    }

    /// Keeps a document under the name of its content, unless the draft was discarded.
    pub(super) fn keep(&self, hash: &str, document: &[u8]) -> Result<(), PrivateError> {
        let place = self.0.lock();
        place.as_ref().map_or(Ok(()), |place| keep(place, hash, document))
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
    private::write(&place.join(format!("{hash}.json")), document)
}

/// A document that was kept.
pub(super) fn kept(place: &Path, hash: &str) -> Result<Option<String>, PrivateError> {
    private::read(&place.join(format!("{hash}.json")))
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

    fn draft(place: &Path) -> Draft {
        Draft::new(place.join("draft"), DraftHeader::new(Path::new("/m"), "abc", 5))
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
        let mut draft = draft(place.path());
        assert!(!draft.is_begun());
        let saved = DraftLine::Saved { revision: 6, hash: "def".into() };
        draft.append(&undo("1")).unwrap();
        draft.append(&saved).unwrap();
        let found = found(place.path()).unwrap();
        assert_eq!((found.head, found.lines), (draft.head.clone(), vec![undo("1"), saved]));
        draft.discard().unwrap();
        assert!(find(&place.path().join("draft")).unwrap().is_none());
    }

    /// What a draft begins with is written while people continue: save elsewhere, or close.
    #[test]
    fn a_document_that_comes_late_comes_to_where_the_draft_is() {
        let place = tempfile::tempdir().unwrap();
        let path = |name: &str| place.path().join(name);
        let mut draft = draft(place.path());
        let shelf = draft.shelf();
        draft.append(&undo("1")).unwrap();
        draft.move_to(path("moved")).unwrap();
        shelf.keep("abc", b"{}").unwrap();
        assert_eq!(kept(&path("moved"), "abc").unwrap().as_deref(), Some("{}"));
        draft.discard().unwrap();
        shelf.keep("abc", b"{}").unwrap();
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
        let mut draft = Draft::go_on(place.path().join("draft"), &left).unwrap();
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
