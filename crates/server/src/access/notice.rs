//! Detects when another program (the command line) changes users or tokens, so that revocation also reaches idle connections.
//! Knows the roster's file, but not its content.

use super::register::FILE;
use crate::{ServerState, log};
use notify::{Event, RecommendedWatcher, RecursiveMode, Watcher as _};
use std::sync::{Arc, Weak};

/// Watches the roster's file until dropped. Without the watch, a change takes effect at the next request.
pub(crate) fn notice(server: &Arc<ServerState>) -> Option<RecommendedWatcher> {
    let watched = watch(server);
    if let Err(error) = &watched {
        log::say(&format!(
            "changes of users by `rafcon user` are seen with the next request only: {error}"
        ));
    }
    watched.ok()
}

fn watch(server: &Arc<ServerState>) -> notify::Result<RecommendedWatcher> {
    let weak = Arc::downgrade(server);
    let mut watcher = notify::recommended_watcher(move |event| seen(&weak, event))?;
    watcher.watch(&server.settings().state, RecursiveMode::NonRecursive)?;
    Ok(watcher)
}

fn seen(server: &Weak<ServerState>, event: notify::Result<Event>) {
    let is_ours = event.is_ok_and(|event| {
        !event.kind.is_access() && event.paths.iter().any(|path| path.ends_with(FILE))
    });
    if let Some(server) = server.upgrade().filter(|_server| is_ours) {
        server.people().look();
    }
}
