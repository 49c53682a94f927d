//! Changes that other programs make to machines and libraries: noticed, and told to whoever has them open. Knows which part
//! of the server a changed file concerns, but not what is in the files.
//!
//! The server's own saves come by here as well: whether a machine is really another one is decided by its content, by
//! whoever has it open.

mod folders;
mod inbox;

use crate::{ServerState, log};
use folders::{Folders, Plan};
use inbox::{Changes, Inbox};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Changes of so much time are told together.
const GATHERED: Duration = Duration::from_millis(100);

/// A machine is followed so long after it was opened: what its opener asks for next comes first.
const OPENED: Duration = Duration::from_secs(1);

/// What is followed, and for whom.
struct Watch {
    server: Arc<ServerState>,
    folders: Folders,
    /// The folders of open machines that are followed.
    open: Vec<PathBuf>,
}

/// Begins to follow the projects, libraries and open machines of a server, until it closes.
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
        // Until everything is followed for the first time, anything may have happened.
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

    /// Follows what is to be followed now, then tells what happened.
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

    /// A machine that is followed from now on may have changed since it was opened.
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

/// Leaves whoever opened a machine in peace for a while, but no one who waits for news of files. Always true.
async fn opened(inbox: &Inbox) -> bool {
    tokio::select! {
        () = inbox.something() => {}
        () = tokio::time::sleep(OPENED) => {}
    }
    true
}

#[cfg(test)]
mod tests;
