//! Marks the running scripts in memory that outlives a crash of this process. [`rafcon_protocol::active`] describes the
//! files. A script's mark is one store.

use crate::Place;
use memmap2::MmapMut;
use rafcon_protocol::active::{PATHS_FILE, SLOTS, SLOTS_FILE};
use std::fs::{File, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::sync::atomic::Ordering;

/// The two files; `None` if the run has no folder, or its disk fails.
#[derive(Debug, Default)]
pub(crate) struct Active {
    files: Option<Files>,
}

#[derive(Debug)]
struct Files {
    slots: MmapMut,
    paths: File,
    lines: u32,
}

impl Active {
    /// Creates the files in `folder`.
    pub(crate) fn open(folder: &Path) -> io::Result<Self> {
        let file = create(&folder.join(SLOTS_FILE))?;
        // Writes the zeros, because on a full disk the first mark in a hole would end the process.
        (&file).write_all(&vec![0; SLOTS * 4])?;
        Ok(Self {
            files: Some(Files {
                slots: map(&file)?,
                paths: create(&folder.join(PATHS_FILE))?,
                lines: 0,
            }),
        })
    }

    /// Marks that the script at `place` runs in `slot`.
    pub(crate) fn begin(&mut self, slot: usize, place: &Place) {
        let Some(files) = &mut self.files else { return };
        let line = match place.line.load(Ordering::Relaxed) {
            0 => match files.append(&place.text) {
                Ok(line) => {
                    place.line.store(line, Ordering::Relaxed);
                    line
                }
                Err(_full_disk) => return self.files = None,
            },
            line => line,
        };
        files.mark(slot, line);
    }

    /// Marks that no script runs in `slot`.
    pub(crate) fn end(&mut self, slot: usize) {
        if let Some(files) = &mut self.files {
            files.mark(slot, 0);
        }
    }
}

impl Files {
    fn append(&mut self, text: &str) -> io::Result<u32> {
        let line = format!("{}\n", text.replace('\n', " "));
        self.paths.write_all(line.as_bytes())?;
        self.lines += 1;
        Ok(self.lines)
    }

    fn mark(&mut self, slot: usize, line: u32) {
        if let Some(bytes) = self.slots.get_mut(slot * 4..slot * 4 + 4) {
            bytes.copy_from_slice(&line.to_le_bytes());
        }
    }
}

fn create(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(true).mode(0o600).open(path)
}

#[expect(unsafe_code, reason = "memory that is also a file has no safe door")]
fn map(file: &File) -> io::Result<MmapMut> {
    // SAFETY: the file was just made by this run in a folder of its own and no one shortens it; readers only read.
    unsafe { MmapMut::map_mut(file) }
}

#[cfg(test)]
mod tests {
    use super::Active;
    use crate::Place;
    use expect_test::expect;
    use rafcon_engine::{NodeId, PathId};
    use rafcon_protocol::active::{PATHS_FILE, SLOTS_FILE, running};
    use std::os::unix::fs::MetadataExt as _;

    #[test]
    fn what_runs_can_be_read_from_outside() {
        let folder = tempfile::tempdir().unwrap();
        let mut active = Active::open(folder.path()).unwrap();
        let place = |text: &str| Place::new(PathId(7), NodeId(3), None, text.into());
        let (one, two) = (place("A/B"), place("A/C"));
        active.begin(0, &one);
        active.begin(2, &two);
        active.begin(1, &one);
        active.end(0);
        let slots = std::fs::read(folder.path().join(SLOTS_FILE)).unwrap();
        let paths = std::fs::read_to_string(folder.path().join(PATHS_FILE)).unwrap();
        expect![[r#"["A/B", "A/C"]"#]].assert_eq(&format!("{:?}", running(&slots, &paths)));
    }

    #[test]
    fn marks_have_their_space_on_disk_before_they_are_made() {
        let folder = tempfile::tempdir().unwrap();
        let _active = Active::open(folder.path()).unwrap();
        let file = std::fs::metadata(folder.path().join(SLOTS_FILE)).unwrap();
        assert!(file.blocks() * 512 >= file.len(), "{} blocks of {}", file.blocks(), file.len());
    }
}
