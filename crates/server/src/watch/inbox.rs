//! Collects file events until they are processed. Knows paths and kinds of events; does not access the disk.

use notify::event::{AccessKind, AccessMode, CreateKind, ModifyKind, RenameMode};
use notify::{Event, EventKind};
use rafcon_locks::Mutex;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use tokio::sync::Notify;

/// Maximum number of paths that are recorded one by one.
const MOST: usize = 10_000;

/// Changes since the last time they were taken.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Changes {
    /// Files and folders that are new, different or deleted.
    pub(super) touched: BTreeSet<PathBuf>,
    /// Those that were deleted, at least for a moment.
    pub(super) gone: BTreeSet<PathBuf>,
    /// True if events were lost, so that any file may have changed.
    pub(super) is_lost: bool,
}

impl Changes {
    /// True if the content of this folder may have changed.
    pub(super) fn concern(&self, folder: &Path) -> bool {
        let on_the_way = |path: &PathBuf| path.starts_with(folder) || folder.starts_with(path);
        self.is_lost || self.touched.iter().any(on_the_way)
    }

    /// True if no change is recorded.
    pub(super) fn is_empty(&self) -> bool {
        !self.is_lost && self.touched.is_empty()
    }

    /// Adds an event. Returns `true` if it is relevant.
    fn add(&mut self, event: Event) -> bool {
        if event.need_rescan() {
            self.is_lost = true;
        }
        let Some(change) = change_of(event.kind) else { return self.is_lost };
        let paths = event.paths.into_iter().filter(|path| is_somebodys(path)).collect::<Vec<_>>();
        if change == Change::Gone {
            self.gone.extend(paths.iter().cloned());
        }
        let matters = !paths.is_empty();
        self.touched.extend(paths);
        self.is_lost |= self.touched.len() > MOST;
        if self.is_lost {
            self.touched.clear();
            self.gone.clear();
        }
        matters || self.is_lost
    }
}

/// Effect of an event on a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Change {
    Different,
    Gone,
}

/// The effect of an event. `None` if it has no effect, or if another event reports it.
fn change_of(kind: EventKind) -> Option<Change> {
    match kind {
        EventKind::Remove(_) | EventKind::Modify(ModifyKind::Name(RenameMode::From)) => {
            Some(Change::Gone)
        }
        // A new file causes another event once it is written.
        EventKind::Create(CreateKind::File)
        | EventKind::Modify(ModifyKind::Metadata(_) | ModifyKind::Name(RenameMode::Both))
        | EventKind::Other => None,
        EventKind::Access(AccessKind::Close(AccessMode::Write))
        | EventKind::Create(_)
        | EventKind::Modify(_)
        | EventKind::Any => Some(Change::Different),
        EventKind::Access(_) => None,
    }
}

/// True if the file or folder is neither hidden nor made by another program for itself.
fn is_somebodys(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    !crate::projects::is_foreign(&name)
}

/// Queue of collected changes.
#[derive(Debug, Default)]
pub(super) struct Inbox {
    changes: Mutex<Changes>,
    bell: Notify,
}

impl Inbox {
    /// Adds an event of the system. An error means that events were lost.
    pub(super) fn put(&self, told: notify::Result<Event>) {
        let mut changes = self.changes.lock();
        let matters = match told {
            Ok(event) => changes.add(event),
            Err(_untold) => {
                changes.is_lost = true;
                true
            }
        };
        if matters {
            self.bell.notify_one();
        }
    }

    /// Waits for a change.
    pub(super) async fn something(&self) {
        self.bell.notified().await;
    }

    /// Takes all collected changes.
    pub(super) fn take(&self) -> Changes {
        std::mem::take(&mut self.changes.lock())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use expect_test::{Expect, expect};
    use notify::event::{DataChange, Flag, MetadataKind, RemoveKind};

    fn check(events: &[(EventKind, &str)], expected: &Expect) {
        let mut changes = Changes::default();
        for (kind, path) in events {
            changes.add(Event::new(*kind).add_path(PathBuf::from(path)));
        }
        let shown = |paths: &BTreeSet<PathBuf>| {
            paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" ")
        };
        expected.assert_eq(&format!("{} | {}", shown(&changes.touched), shown(&changes.gone)));
    }

    const WRITTEN: EventKind = EventKind::Access(AccessKind::Close(AccessMode::Write));
    const READ: EventKind = EventKind::Access(AccessKind::Open(AccessMode::Any));
    const CHANGED: EventKind = EventKind::Modify(ModifyKind::Data(DataChange::Any));
    const TOUCHED: EventKind = EventKind::Modify(ModifyKind::Metadata(MetadataKind::Any));
    const FROM: EventKind = EventKind::Modify(ModifyKind::Name(RenameMode::From));
    const TO: EventKind = EventKind::Modify(ModifyKind::Name(RenameMode::To));

    #[test]
    fn what_is_read_is_no_change() {
        check(
            &[(READ, "/p/a"), (TOUCHED, "/p/b"), (WRITTEN, "/p/c"), (CHANGED, "/p/d")],
            &expect!["/p/c /p/d | "],
        );
    }

    #[test]
    fn what_was_renamed_or_removed_is_gone() {
        let removed = EventKind::Remove(RemoveKind::File);
        check(
            &[(FROM, "/p/a"), (TO, "/p/b"), (removed, "/p/c")],
            &expect!["/p/a /p/b /p/c | /p/a /p/c"],
        );
    }

    #[test]
    fn what_programs_keep_for_themselves_is_no_change() {
        check(
            &[(WRITTEN, "/p/.git"), (TO, "/p/__pycache__"), (WRITTEN, "/p/.a.swp")],
            &expect![" | "],
        );
    }

    #[test]
    fn a_folder_is_concerned_by_what_lies_in_it_and_by_those_around_it() {
        let mut changes = Changes::default();
        changes.add(Event::new(TO).add_path("/p/a".into()));
        let concerned = ["/p", "/p/a", "/p/a/b", "/p/b", "/p/ab"]
            .map(|folder| changes.concern(Path::new(folder)));
        assert_eq!(concerned, [true, true, true, false, false]);
    }

    #[test]
    fn more_than_can_be_told_concerns_everybody() {
        let mut changes = Changes::default();
        assert!(changes.add(Event::new(EventKind::Other).set_flag(Flag::Rescan)));
        assert!(changes.concern(Path::new("/anywhere")));
        let mut changes = Changes::default();
        for number in 0..=MOST {
            changes.add(Event::new(WRITTEN).add_path(format!("/p/{number}").into()));
        }
        assert!(changes.is_lost && changes.touched.is_empty());
    }
}
