//! Detects changes that other programs make to machines and libraries, and notifies the affected parts of the server. Knows which
//! part a changed file concerns, but not the content of files.
//!
//! The server's own saves cause events as well. The open machine compares contents to recognize real changes.

mod folders;
mod inbox;

use crate::{ServerState, log};
use folders::{Folders, Plan};
use inbox::{Changes, Inbox};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Interval in which changes are collected.
const GATHERED: Duration = Duration::from_millis(100);

/// Delay before a newly opened machine is watched, so that the first requests of its client are served first.
const OPENED: Duration = Duration::from_secs(1);

/// Watches files for the server.
struct Watch {
    server: Arc<ServerState>,
    folders: Folders,
    /// Folders of open machines that are watched.
    open: Vec<PathBuf>,
}

/// Starts to watch the projects, libraries and open machines of a server, until it closes.
pub(crate) fn begin(server: &Arc<ServerState>) {
    let inbox = Arc::new(Inbox::default());
    let told = Arc::clone(&inbox);
    match notify::recommended_watcher(move |event| told.put(event)) {
        Ok(watcher) => {
            let watch = Watch {
                server: Arc::clone(server),
                folders: Folders::new(watcher),
                open: Vec::new(),
            };
            tokio::spawn(watch.run(inbox));
        }
        Err(error) => log::say(&format!(
            "changes that other programs make to files are not noticed: {error}; raise fs.inotify.max_user_instances"
        )),
    }
}

impl Watch {
    async fn run(self, inbox: Arc<Inbox>) {
        let (mut machines, mut closing) = (self.server.news.of_machines(), self.server.closing());
        // Before the first watch, any file may have changed.
        let mut changes = Changes { is_lost: true, ..Changes::default() };
        let mut watch = self;
        loop {
            let turn = tokio::task::spawn_blocking(move || {
                watch.turn(&changes);
                watch
            });
            let Ok(turned) = turn.await else { return };
            watch = turned;
            let is_there = tokio::select! {
                () = inbox.something() => true,
                changed = machines.changed() => changed.is_ok() && opened(&inbox).await,
                _closed = closing.changed() => false,
            };
            if !is_there {
                return;
            }
            tokio::time::sleep(GATHERED).await;
            changes = inbox.take();
        }
    }

    /// Updates the watches, then reports the changes.
    fn turn(&mut self, changes: &Changes) {
        if changes.is_lost {
            self.folders.forget_all();
        }
        self.folders.forget(&changes.gone);
        let open = self.server.documents.folders();
        if open != self.open || changes.is_lost || self.is_new_folder(changes) {
            self.folders.follow(&self.plan(&open));
        }
        self.tell(changes, &open);
        self.open = open;
    }

    fn is_new_folder(&self, changes: &Changes) -> bool {
        changes.touched.iter().any(|path| !self.folders.knows(path) && path.is_dir())
    }

    fn plan(&self, open: &[PathBuf]) -> Plan {
        let projects = self.server.projects.all().iter();
        let settings = &self.server.settings;
        Plan {
            whole: open.iter().cloned().chain(self.server.projects.shelf().folders()).collect(),
            outside: projects.map(|project| PathBuf::from(&project.folder)).collect(),
            hidden: vec![settings.runs.clone(), settings.state.clone()],
        }
    }

    /// Reports changes. A newly watched machine may have changed since it was opened.
    fn tell(&self, changes: &Changes, open: &[PathBuf]) {
        if self.server.projects.shelf().folders().iter().any(|folder| changes.concern(folder)) {
            self.server.projects.shelf().refresh();
        }
        for folder in open {
            if changes.concern(folder) || !self.open.contains(folder) {
                self.server.documents.look(&self.server, folder);
            }
        }
        if !changes.is_empty() {
            self.server.news.files();
        }
    }
}

/// Waits after a machine was opened, but not longer than until the next change of files. Always returns `true`.
async fn opened(inbox: &Inbox) -> bool {
    tokio::select! {
        () = inbox.something() => {}
        () = tokio::time::sleep(OPENED) => {}
    }
    true
}

#[cfg(test)]
mod tests;
