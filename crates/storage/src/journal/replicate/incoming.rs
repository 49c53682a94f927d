//! A large value that is being received into the folder of a replica. Its parts arrive in any order, possibly over several program
//! starts. It becomes valid when its hash is correct.

use crate::journal::folder::{
    ContentHash, VALUES_FOLDER, fresh_name, make_folder, replace_file, sync_folder,
};
use std::fs::{self, File, OpenOptions};
use std::io;
use std::os::unix::fs::{FileExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};

/// A value that is not complete yet.
#[derive(Debug)]
pub struct IncomingContent {
    hash: ContentHash,
    length: u64,
    run: PathBuf,
    file: File,
}

impl IncomingContent {
    /// Starts or resumes receiving a value of `length` bytes in the folder of a run. Also returns the ranges of bytes recorded as
    /// received: the first and the last byte of each, counted from 1.
    pub fn open(run: &Path, hash: ContentHash, length: u64) -> io::Result<(Self, Vec<(u64, u64)>)> {
        make_folder(&run.join(VALUES_FOLDER)).map_err(io::Error::other)?;
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false).mode(0o600);
        let file = options.open(part_file(run, hash))?;
        let is_old = file.metadata()?.len() == length;
        file.set_len(length)?;
        let noted = if is_old { read_noted(run, hash, length) } else { Vec::new() };
        Ok((Self { hash, length, run: run.to_owned(), file }, noted))
    }

    /// Returns the total number of bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Writes a part of the value.
    pub fn write(&self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        let end = offset.saturating_add(bytes.len() as u64);
        if end > self.length {
            return Err(io::Error::other("a part reaches beyond the value"));
        }
        self.file.write_all_at(bytes, offset)
    }

    /// Syncs the received bytes and then records their ranges.
    pub fn note(&self, here: impl Iterator<Item = (u64, u64)>) -> io::Result<()> {
        self.file.sync_data()?;
        let lines: Vec<_> = here.map(|(first, last)| format!("{first} {last}")).collect();
        let here = self.place("here");
        replace_file(&here, lines.join("\n").as_bytes()).map_err(io::Error::other)
    }

    /// Checks the hash after all bytes have arrived. If it is correct, the value's file is durable; otherwise all data is removed.
    /// Returns true if it is correct.
    pub fn finish(self) -> io::Result<bool> {
        let is_right = self.hash_of_file()? == self.hash;
        if is_right {
            self.file.sync_all()?;
            // Removed before the value becomes visible, because nothing would remove the record after a crash.
            self.remove_notes();
            fs::rename(part_file(&self.run, self.hash), self.hash.file_in(&self.run))?;
            sync_folder(&self.run.join(VALUES_FOLDER)).map_err(io::Error::other)?;
        } else {
            self.remove();
        }
        Ok(is_right)
    }

    /// Cancels the reception and removes its data.
    pub fn remove(self) {
        self.remove_notes();
        // Missing files need no removal.
        drop(fs::remove_file(part_file(&self.run, self.hash)));
    }

    fn remove_notes(&self) {
        let here = self.place("here");
        for file in [fresh_name(&here), here] {
            drop(fs::remove_file(file));
        }
    }

    fn place(&self, what: &str) -> PathBuf {
        beside(&self.run, self.hash, what)
    }

    fn hash_of_file(&self) -> io::Result<ContentHash> {
        File::open(part_file(&self.run, self.hash)).and_then(ContentHash::of_reader)
    }
}

fn part_file(run: &Path, hash: ContentHash) -> PathBuf {
    beside(run, hash, "part")
}

fn beside(run: &Path, hash: ContentHash, what: &str) -> PathBuf {
    run.join(VALUES_FOLDER).join(format!(".{}.{what}", hash.name()))
}

/// Returns the recorded ranges. Empty if the record is invalid.
fn read_noted(run: &Path, hash: ContentHash, length: u64) -> Vec<(u64, u64)> {
    let text = fs::read_to_string(beside(run, hash, "here")).unwrap_or_default();
    let range = |line: &str| {
        let (first, last) = line.split_once(' ')?;
        let (first, last) = (first.parse().ok()?, last.parse().ok()?);
        (first > 0 && first <= last && last <= length).then_some((first, last))
    };
    text.lines().map(range).collect::<Option<Vec<_>>>().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::IncomingContent;
    use crate::journal::folder::{ContentHash, VALUES_FOLDER, is_content_here};
    use std::fs;

    #[test]
    fn a_value_counts_once_it_is_whole_and_right() {
        let run = tempfile::tempdir().expect("a folder");
        let bytes: Vec<u8> = (0..200).collect();
        let hash = ContentHash::of(&bytes);
        let is_here = || is_content_here(run.path(), &hash.name(), 200);
        let (first, noted) = IncomingContent::open(run.path(), hash, 200).expect("a file");
        assert!(noted.is_empty());
        first.write(150, &bytes[150..]).expect("written");
        first.note([(151, 200)].into_iter()).expect("noted");
        drop(first);
        let (second, noted) = IncomingContent::open(run.path(), hash, 200).expect("a file");
        assert_eq!(noted, [(151, 200)]);
        assert!(second.write(190, &[0; 11]).is_err(), "beyond its end");
        second.write(0, &bytes[..150]).expect("written");
        assert!(!is_here());
        assert!(second.finish().expect("a disk"));
        assert!(is_here());
        assert_eq!(fs::read_dir(run.path().join(VALUES_FOLDER)).expect("a folder").count(), 1);
    }

    #[test]
    fn whoever_sees_the_value_sees_nothing_else_of_it() {
        let run = tempfile::tempdir().expect("a folder");
        let hash = ContentHash::of(b"right");
        let (value, _) = IncomingContent::open(run.path(), hash, 5).expect("a file");
        value.write(0, b"right").expect("written");
        value.note([(1, 5)].into_iter()).expect("noted");
        let files = std::thread::scope(|scope| {
            let watcher = scope.spawn(|| {
                while !is_content_here(run.path(), &hash.name(), 5) {
                    std::thread::yield_now();
                }
                fs::read_dir(run.path().join(VALUES_FOLDER)).expect("a folder").count()
            });
            assert!(value.finish().expect("a disk"));
            watcher.join().expect("a count")
        });
        assert_eq!(files, 1);
    }

    #[test]
    fn of_bytes_that_are_not_the_value_nothing_is_left() {
        let run = tempfile::tempdir().expect("a folder");
        let hash = ContentHash::of(b"right");
        let (value, _) = IncomingContent::open(run.path(), hash, 5).expect("a file");
        value.write(0, b"wrong").expect("written");
        value.note([(1, 5)].into_iter()).expect("noted");
        assert!(!value.finish().expect("a disk"));
        assert_eq!(fs::read_dir(run.path().join(VALUES_FOLDER)).expect("a folder").count(), 0);
        let (_, noted) = IncomingContent::open(run.path(), hash, 5).expect("a file");
        assert!(noted.is_empty());
    }
}
