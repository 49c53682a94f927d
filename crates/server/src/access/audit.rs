//! `audit.jsonl`: who came in, who was refused, who changed whose rights, and who took control. Bounded; readable by the
//! server's owner only. Secrets never come here.

use super::private::{self, PrivateError};
use crate::log;
use parking_lot::Mutex;
use rafcon_supervisor::clock::since_1970_ms;
use serde::Serialize;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// The size from which a new file is begun.
const BYTES_MAX: u64 = 10_000_000;
/// How many old files are kept.
const OLD_MAX: u32 = 3;
/// How much of a text is kept: some of it is said by strangers.
const TEXT_MAX: usize = 200;

/// The record of who did what about access.
#[derive(Debug)]
pub struct Audit {
    folder: PathBuf,
    open: Mutex<Open>,
}

#[derive(Debug)]
struct Open {
    file: File,
    bytes: u64,
    is_broken: bool,
}

/// One line.
#[derive(Debug, Serialize)]
struct Note<'a> {
    at_ms: u64,
    user: &'a str,
    what: &'a str,
    about: &'a str,
}

impl Audit {
    /// Goes on in the folder's record.
    pub(crate) fn open(folder: &Path) -> Result<Self, PrivateError> {
        let path = file(folder, 0);
        let file = private::open(&path)?;
        let about = file.metadata().map_err(|source| PrivateError::new("read", &path, source))?;
        let open = Mutex::new(Open { file, bytes: about.len(), is_broken: false });
        Ok(Self { folder: folder.to_owned(), open })
    }

    /// Notes what a user did: `what` is a stable word, `about` says more to people.
    pub fn note(&self, user: &str, what: &str, about: &str) {
        self.note_at(since_1970_ms(), user, what, about);
    }

    fn note_at(&self, at_ms: u64, user: &str, what: &str, about: &str) {
        let note = Note { at_ms, user: cut(user), what, about: cut(about) };
        let mut open = self.open.lock();
        let written = self.write(&mut open, &note);
        if let Err(error) = &written
            && !open.is_broken
        {
            log::say(&format!("the record of access cannot be written: {error}"));
        }
        open.is_broken = written.is_err();
    }

    fn write(&self, open: &mut Open, note: &Note<'_>) -> io::Result<()> {
        let mut line = serde_json::to_vec(note)?;
        line.push(b'\n');
        if open.bytes + line.len() as u64 > BYTES_MAX {
            self.turn(open)?;
        }
        open.file.write_all(&line)?;
        open.bytes += line.len() as u64;
        Ok(())
    }

    /// Begins a new file.
    fn turn(&self, open: &mut Open) -> io::Result<()> {
        for age in (0..OLD_MAX).rev() {
            match fs::rename(file(&self.folder, age), file(&self.folder, age + 1)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                Ok(()) | Err(_) => {}
            }
        }
        open.file = private::open(&file(&self.folder, 0)).map_err(io::Error::other)?;
        open.bytes = 0;
        Ok(())
    }
}

/// The record of this age.
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
    use super::{Audit, BYTES_MAX, cut};
    use expect_test::expect;
    use std::fs;

    #[test]
    fn a_note_is_a_line_whatever_strangers_say() {
        let place = tempfile::tempdir().unwrap();
        let audit = Audit::open(place.path()).unwrap();
        audit.note_at(7, "anna", "login", "from 10.0.0.1");
        Audit::open(place.path()).unwrap().note_at(8, "x\n{\"", "wrong_login", "from 10.0.0.2");
        expect![[r#"
            {"at_ms":7,"user":"anna","what":"login","about":"from 10.0.0.1"}
            {"at_ms":8,"user":"x\n{\"","what":"wrong_login","about":"from 10.0.0.2"}
        "#]]
        .assert_eq(&fs::read_to_string(place.path().join("audit.jsonl")).unwrap());
        assert_eq!(cut(&"ä".repeat(150)).len(), 200);
    }

    #[test]
    fn the_record_is_bounded() {
        let place = tempfile::tempdir().unwrap();
        let audit = Audit::open(place.path()).unwrap();
        for round in 0..6 {
            audit.open.lock().bytes = BYTES_MAX;
            audit.note_at(round, "anna", "login", "");
        }
        let mut files = fs::read_dir(place.path()).unwrap();
        let mut names = files.by_ref().map(|file| file.unwrap().file_name()).collect::<Vec<_>>();
        names.sort();
        assert_eq!(names, ["audit.1.jsonl", "audit.2.jsonl", "audit.3.jsonl", "audit.jsonl"]);
        let last = fs::read_to_string(place.path().join("audit.3.jsonl")).unwrap();
        assert!(last.contains("\"at_ms\":2"), "{last}");
    }
}
