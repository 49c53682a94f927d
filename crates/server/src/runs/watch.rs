//! Watches the folder of all runs for new and deleted folders, and for runs that begin or are resumed. It detects runs of the
//! command line without polling. Knows names of files.

use super::supervise;
use crate::ServerState;
use crate::failure::reason;
use notify::event::{EventKind, ModifyKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};
use rafcon_protocol::api::RunPhase;
use rafcon_storage::journal::folder::{ABOUT_FILE, DIVERGED_FILE, SOCKET_FILE};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio::sync::mpsc;

/// Capacity of the queue of changes.
const CHANGES: usize = 1024;
/// The extension of a folder that is being deleted.
const GONE: &str = "gone";

/// A change in the folder of runs.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Noticed {
    /// A change in the folder of a run.
    In(PathBuf),
    /// Events were lost, so any folder may have changed.
    Anything,
}

/// Watches the folders of runs until dropped.
#[derive(Debug)]
pub(super) struct RunFolderWatch {
    watcher: RecommendedWatcher,
    /// Watched folders of runs.
    watched: BTreeSet<PathBuf>,
}

/// Starts to watch for changes. Without the watch, the server only knows the runs that it started.
pub(super) fn begin(server: &Arc<ServerState>) -> mpsc::Receiver<Noticed> {
    let (changes, noticed) = mpsc::channel(CHANGES);
    let all = server.runs.folder.folder().to_path_buf();
    let tell = move |event: notify::Result<notify::Event>| {
        for change in noticed_of(&all, event) {
            // The receiver is dropped when the server ends.
            changes.blocking_send(change).unwrap_or_default();
        }
    };
    let all = server.runs.folder.folder();
    let watcher = notify::recommended_watcher(tell).and_then(|mut watcher| {
        server.runs.folder.make_folder()?;
        watcher.watch(all, RecursiveMode::NonRecursive)?;
        Ok(watcher)
    });
    match watcher {
        Ok(watcher) => {
            *server.runs.watch.lock() = Some(RunFolderWatch { watcher, watched: BTreeSet::new() });
        }
        Err(error) => {
            let (all, why) = (all.display(), reason(&error));
            (server.settings.tell)(&format!("runs that begin in {all} are not noticed: {why}"));
        }
    }
    noticed
}

/// Processes changes in order.
pub(super) async fn serve(server: &Arc<ServerState>, mut noticed: mpsc::Receiver<Noticed>) {
    for folder in folders(server.runs.folder.folder()) {
        keep_an_eye_on(server, &folder);
        // The runner or the station may have opened its socket between the first read of the run and the watch.
        if folder.join(SOCKET_FILE).exists() {
            look(server, folder).await;
        }
    }
    while let Some(change) = noticed.recv().await {
        match change {
            Noticed::In(folder) => look(server, folder).await,
            Noticed::Anything => {
                let mut all: BTreeSet<_> =
                    folders(server.runs.folder.folder()).into_iter().collect();
                all.extend(server.runs.folders());
                for folder in all {
                    look(server, folder).await;
                }
            }
        }
    }
}

async fn look(server: &Arc<ServerState>, folder: PathBuf) {
    keep_an_eye_on(server, &folder);
    if let Some(run) = supervise::look(server, folder).await
        && run.summary().phase == RunPhase::Live
    {
        supervise::follow(server, &run);
    }
}

/// Watches the folder of a run, or ends the watch if the folder no longer exists.
fn keep_an_eye_on(server: &ServerState, folder: &Path) {
    let mut watch = server.runs.watch.lock();
    let Some(watch) = watch.as_mut() else { return };
    if !folder.is_dir() {
        if watch.watched.remove(folder) {
            // The system ends the watch of a deleted folder by itself.
            watch.watcher.unwatch(folder).unwrap_or_default();
        }
    } else if watch.watched.insert(folder.to_path_buf())
        && let Err(error) = watch.watcher.watch(folder, RecursiveMode::NonRecursive)
        && folder.is_dir()
    {
        let (folder, why) = (folder.display(), reason(&error));
        (server.settings.tell)(&format!("what changes in {folder} is not noticed: {why}"));
    }
}

/// The folders of all runs, oldest first.
pub(super) fn folders(all: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(all).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| path.is_dir() && !is_going(path)).collect();
    folders.sort();
    folders
}

/// Removes a folder in which no run has begun or will begin. It was never published.
pub(super) async fn remove(server: &ServerState, folder: PathBuf) {
    let tell = server.settings.tell;
    let removed = tokio::task::spawn_blocking(move || {
        if let Err(error) = fs::remove_dir_all(&folder) {
            tell(&format!("cannot remove {}: {error}", folder.display()));
        }
    });
    removed.await.unwrap_or_default();
}

/// Changes according to an event of the system. An error means that events were lost.
fn noticed_of(all: &Path, told: notify::Result<notify::Event>) -> Vec<Noticed> {
    match told {
        Ok(event) if !event.need_rescan() => {
            folders_of(all, &event).into_iter().map(Noticed::In).collect()
        }
        _ => vec![Noticed::Anything],
    }
}

/// The folders of runs that an event concerns, if it is relevant.
fn folders_of(all: &Path, event: &notify::Event) -> Vec<PathBuf> {
    let comes_or_goes = matches!(
        event.kind,
        EventKind::Create(_) | EventKind::Remove(_) | EventKind::Modify(ModifyKind::Name(_))
    );
    let paths = event.paths.iter().filter(|_| comes_or_goes);
    let mut folders: Vec<PathBuf> = paths.filter_map(|path| folder_of(all, path)).collect();
    folders.dedup();
    folders
}

/// The folder of a run if the path is that folder, or a file in it that marks the start or a change of the run.
fn folder_of(all: &Path, path: &Path) -> Option<PathBuf> {
    let mut parts = path.strip_prefix(all).ok()?.components();
    let folder = all.join(parts.next()?);
    let telling = [ABOUT_FILE, SOCKET_FILE, DIVERGED_FILE];
    let tells =
        parts.next().is_none_or(|file| telling.iter().any(|name| file.as_os_str() == *name));
    (tells && parts.next().is_none() && !is_going(&folder)).then_some(folder)
}

fn is_going(folder: &Path) -> bool {
    folder.extension().is_some_and(|extension| extension == GONE)
}

#[cfg(test)]
mod tests {
    use super::{Noticed, folders_of, noticed_of};
    use expect_test::{Expect, expect};
    use notify::Event;
    use notify::event::{
        CreateKind, DataChange, EventKind, Flag, ModifyKind, RemoveKind, RenameMode,
    };
    use std::path::Path;

    fn check(kind: EventKind, paths: &[&str], expect: &Expect) {
        let event = paths
            .iter()
            .fold(Event::new(kind), |event, path| event.add_path(Path::new("/runs").join(path)));
        let folders = folders_of(Path::new("/runs"), &event);
        expect.assert_eq(&format!("{folders:?}"));
    }

    #[test]
    fn a_run_is_looked_at_when_it_comes_begins_or_goes() {
        let created = EventKind::Create(CreateKind::Any);
        check(created, &["a"], &expect![[r#"["/runs/a"]"#]]);
        check(created, &["a/socket"], &expect![[r#"["/runs/a"]"#]]);
        check(created, &["a/run.new"], &expect!["[]"]);
        let renamed = EventKind::Modify(ModifyKind::Name(RenameMode::Both));
        check(renamed, &["a/run.new", "a/run.json"], &expect![[r#"["/runs/a"]"#]]);
        check(renamed, &["a/diverged.new", "a/diverged"], &expect![[r#"["/runs/a"]"#]]);
        check(renamed, &["a", "a.gone"], &expect![[r#"["/runs/a"]"#]]);
        check(EventKind::Remove(RemoveKind::Any), &["a"], &expect![[r#"["/runs/a"]"#]]);
    }

    #[test]
    fn after_more_than_can_be_told_everything_is_looked_at() {
        let overflow = Event::new(EventKind::Other).set_flag(Flag::Rescan);
        assert_eq!(noticed_of(Path::new("/runs"), Ok(overflow)), [Noticed::Anything]);
        let nothing = notify::Error::generic("lost");
        assert_eq!(noticed_of(Path::new("/runs"), Err(nothing)), [Noticed::Anything]);
    }

    #[test]
    fn what_a_run_writes_while_it_goes_on_is_nobody_s_business() {
        let written = EventKind::Modify(ModifyKind::Data(DataChange::Any));
        check(written, &["a/journal.db-wal"], &expect!["[]"]);
        check(EventKind::Create(CreateKind::Any), &["a/values/1"], &expect!["[]"]);
        check(EventKind::Create(CreateKind::Any), &["a.gone/run.json"], &expect!["[]"]);
    }
}
