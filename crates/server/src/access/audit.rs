//! `audit.jsonl`: a record of logins, refusals, changes of rights, and takeovers of control. Its size is limited, and only the
//! server's owner can read it. It never contains secrets. A separate thread writes it, so that requests do not wait for the disk.

use super::private::{self, PrivateError};
use super::recent_notes::RecentNotes;
use crate::log;
use rafcon_locks::Mutex;
use rafcon_supervisor::clock::since_1970_ms;
use serde::Serialize;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Size limit of a file. Beyond it, a new file begins.
const BYTES_MAX: u64 = 10_000_000;
/// Number of old files kept.
const OLD_MAX: u32 = 3;
/// Limit on the bytes of a text. Some texts come from unauthenticated clients.
const TEXT_MAX: usize = 200;
/// Capacity of the queue of lines.
const WAITING_MAX: usize = 4096;
/// Timeout for writing the queued lines at shutdown.
const FLUSH_TIMEOUT: Duration = Duration::from_secs(5);

/// The record of access. When it is dropped, all queued lines are on disk.
#[derive(Debug)]
pub struct Audit {
    /// Sending half of the queue. `None` while the record is dropped.
    words: Option<SyncSender<Word>>,
    writer: Option<JoinHandle<()>>,
    recent_notes: Mutex<RecentNotes>,
    /// Lines that were dropped because the queue was full.
    missed: Arc<AtomicU64>,
}

/// The files, owned by the thread that writes them.
struct Record {
    folder: PathBuf,
    /// `None` until it can be opened.
    file: Option<File>,
    bytes: u64,
    /// Lines that could not be written since the last successful write.
    lost: u64,
}

/// Message to the writer thread.
enum Word {
    /// A line to write.
    Line(Vec<u8>),
    /// A request to acknowledge once all earlier lines are written.
    Settle(SyncSender<()>),
}

/// A line of the record.
#[derive(Debug, Serialize)]
struct Note<'a> {
    at_ms: u64,
    user: &'a str,
    what: &'a str,
    about: &'a str,
}

impl Audit {
    /// Continues the record in the folder.
    pub(crate) fn open(folder: &Path) -> Result<Self, PrivateError> {
        let record = Record::new(folder);
        let (words, waiting) = sync_channel(WAITING_MAX);
        let missed = Arc::new(AtomicU64::new(0));
        let theirs = Arc::clone(&missed);
        let write = move || record.write_all(&waiting, &theirs);
        let writer = thread::Builder::new().name("audit".to_owned()).spawn(write);
        let writer =
            writer.map_err(|source| PrivateError::new("write", &file(folder, 0), source))?;
        Ok(Self {
            words: Some(words),
            writer: Some(writer),
            recent_notes: Mutex::default(),
            missed,
        })
    }

    /// Records an action of a user: `what` is a stable code, `about` adds details for people.
    pub fn note(&self, user: &str, what: &str, about: &str) {
        self.note_at(since_1970_ms(), user, what, about);
    }

    /// Records an action that `of` can repeat at will. Repetitions beyond a rate are only counted, and the next line includes the count.
    pub(super) fn note_often(&self, of: &str, user: &str, what: &str, about: &str) {
        let now_ms = since_1970_ms();
        match self.recent_notes.lock().may(&format!("{what} {of}"), now_ms) {
            Some(0) => self.note_at(now_ms, user, what, about),
            Some(before) => {
                self.note_at(now_ms, user, what, &format!("{about}, and {before} times before"));
            }
            None => {}
        }
    }

    fn note_at(&self, at_ms: u64, user: &str, what: &str, about: &str) {
        let line = line(&Note { at_ms, user: cut(user), what, about: cut(about) });
        // Never blocks: a disk that hangs must not delay the caller.
        if self.words.as_ref().is_some_and(|words| words.try_send(Word::Line(line)).is_err()) {
            self.missed.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Waits until all queued lines are written, but not beyond the timeout.
    pub(crate) fn settle(&self) {
        let (done, settled) = sync_channel(1);
        let asked = self.words.as_ref().map(|words| words.try_send(Word::Settle(done)));
        if asked.is_none_or(|asked| asked.is_err()) || settled.recv_timeout(FLUSH_TIMEOUT).is_err()
        {
            log::say("the disk is slow: the record of access may lack its last lines");
        }
    }
}

impl Drop for Audit {
    fn drop(&mut self) {
        drop(self.words.take());
        if let Some(Err(_panic)) = self.writer.take().map(JoinHandle::join) {
            log::say("the record of access ended with a fault of this program");
        }
    }
}

fn line(note: &Note<'_>) -> Vec<u8> {
    // Strings and a number always serialize as JSON.
    let mut line = serde_json::to_vec(note).unwrap_or_default();
    line.push(b'\n');
    line
}

impl Record {
    fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), file: None, bytes: 0, lost: 0 }
    }

    /// The current file, opened if it is not yet.
    fn current(&mut self) -> io::Result<&mut File> {
        let file = if let Some(file) = self.file.take() {
            file
        } else {
            let file = private::open(&file(&self.folder, 0)).map_err(io::Error::other)?;
            self.bytes = file.metadata()?.len();
            file
        };
        Ok(self.file.insert(file))
    }

    /// Writes lines until all senders are dropped.
    fn write_all(mut self, waiting: &Receiver<Word>, missed: &AtomicU64) {
        for word in waiting {
            match word {
                Word::Line(line) => self.write_or_say(&line),
                // The caller may have timed out.
                Word::Settle(done) => done.send(()).unwrap_or_default(),
            }
            let count = missed.swap(0, Ordering::Relaxed);
            self.note_missed(count, "while the disk was too slow");
        }
    }

    fn note_missed(&mut self, count: u64, why: &str) {
        if count > 0 {
            let (at_ms, about) = (since_1970_ms(), format!("{count} notes, {why}"));
            let missed = Note { at_ms, user: "", what: "notes_missed", about: &about };
            self.write_or_say(&line(&missed));
        }
    }

    fn write_or_say(&mut self, line: &[u8]) {
        match self.write(line) {
            Ok(()) => {
                let lost = std::mem::take(&mut self.lost);
                self.note_missed(lost, "while the disk was full");
            }
            Err(error) => {
                if self.lost == 0 {
                    log::say(&format!("the record of access cannot be written: {error}"));
                }
                self.lost += 1;
            }
        }
    }

    fn write(&mut self, line: &[u8]) -> io::Result<()> {
        self.current()?;
        if self.bytes + line.len() as u64 > BYTES_MAX {
            self.turn()?;
        }
        let written = self.current()?.write_all(line);
        if written.is_err() {
            // Removes a partly written line.
            let bytes = self.bytes;
            self.current()?.set_len(bytes)?;
        }
        self.bytes += if written.is_ok() { line.len() as u64 } else { 0 };
        written
    }

    /// Rotates the files, so that the next line begins a new one.
    fn turn(&mut self) -> io::Result<()> {
        for age in (0..OLD_MAX).rev() {
            match fs::rename(file(&self.folder, age), file(&self.folder, age + 1)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                Ok(()) | Err(_) => {}
            }
        }
        (self.file, self.bytes) = (None, 0);
        Ok(())
    }
}

/// File of an age; 0 is the current one.
fn file(folder: &Path, age: u32) -> PathBuf {
    match age {
        0 => folder.join("audit.jsonl"),
        age => folder.join(format!("audit.{age}.jsonl")),
    }
}

fn cut(text: &str) -> &str {
    &text[..text.floor_char_boundary(TEXT_MAX)]
}

#[cfg(test)]
mod tests {
    use super::{Audit, BYTES_MAX, Record, cut};
    use expect_test::expect;
    use rafcon_locks::Mutex;
    use std::fs;
    use std::sync::Arc;
    use std::sync::atomic::AtomicU64;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn a_note_is_a_line_whatever_strangers_say_and_none_is_lost_at_the_end() {
        let place = tempfile::tempdir().unwrap();
        let audit = Audit::open(place.path()).unwrap();
        audit.note_at(7, "anna", "login", "from 10.0.0.1");
        drop(audit);
        Audit::open(place.path()).unwrap().note_at(8, "x\n{\"", "wrong_login", "from 10.0.0.2");
        expect![[r#"
            {"at_ms":7,"user":"anna","what":"login","about":"from 10.0.0.1"}
            {"at_ms":8,"user":"x\n{\"","what":"wrong_login","about":"from 10.0.0.2"}
        "#]]
        .assert_eq(&fs::read_to_string(place.path().join("audit.jsonl")).unwrap());
        assert_eq!(cut(&"ä".repeat(150)).len(), 200);
    }

    #[test]
    fn nobody_fills_the_record_with_what_is_refused() {
        let place = tempfile::tempdir().unwrap();
        let audit = Audit::open(place.path()).unwrap();
        for _ in 0..2000 {
            audit.note_often("anna", "anna", "refused", "GET /api/v1/users");
        }
        audit.note("anna", "token_made", "x");
        audit.settle();
        let record = fs::read_to_string(place.path().join("audit.jsonl")).unwrap();
        assert!(record.lines().count() < 100, "{record}");
        assert!(record.contains("token_made"), "{record}");
    }

    #[test]
    fn notes_that_a_slow_disk_leaves_no_room_for_are_counted() {
        let place = tempfile::tempdir().unwrap();
        let (words, waiting) = sync_channel(1);
        let missed = Arc::new(AtomicU64::new(0));
        let (writer, theirs) = (None, Arc::clone(&missed));
        let audit = Audit { words: Some(words), writer, recent_notes: Mutex::default(), missed };
        for what in ["first", "second", "third"] {
            audit.note("anna", what, "");
        }
        drop(audit);
        Record::new(place.path()).write_all(&waiting, &theirs);
        let text = fs::read_to_string(place.path().join("audit.jsonl")).unwrap();
        assert!(text.contains("first") && !text.contains("second"), "{text}");
        assert!(text.contains("2 notes, while the disk was too slow"), "{text}");
    }

    #[test]
    fn a_full_disk_loses_whole_lines_and_their_number_is_written_later() {
        let place = tempfile::tempdir().unwrap();
        let mut record = Record::new(place.path());
        record.file = Some(fs::OpenOptions::new().write(true).open("/dev/full").unwrap());
        record.write_or_say(b"lost\n");
        record.write_or_say(b"lost\n");
        record.file = None;
        record.write_or_say(b"kept\n");
        let text = fs::read_to_string(place.path().join("audit.jsonl")).unwrap();
        assert!(text.starts_with("kept\n") && text.lines().count() == 2, "{text}");
        assert!(text.contains("2 notes, while the disk was full"), "{text}");
    }

    #[test]
    fn the_record_is_bounded() {
        let place = tempfile::tempdir().unwrap();
        let mut record = Record::new(place.path());
        for round in 0..6 {
            record.current().unwrap();
            record.bytes = BYTES_MAX;
            record.write_or_say(format!("{round}\n").as_bytes());
        }
        let mut files = fs::read_dir(place.path()).unwrap();
        let mut names = files.by_ref().map(|file| file.unwrap().file_name()).collect::<Vec<_>>();
        names.sort();
        assert_eq!(names, ["audit.1.jsonl", "audit.2.jsonl", "audit.3.jsonl", "audit.jsonl"]);
        let last = fs::read_to_string(place.path().join("audit.3.jsonl")).unwrap();
        assert_eq!(last, "2\n");
    }
}
