//! Loads and saves machines, and hashes their contents. Knows folders, but not the sessions that use them.

use crate::Failure;
use crate::document_text::document_text;
use crate::failure::reason;
use rafcon_model::{Header, Kind, Machine, Outcome, OutcomeId, State, StateId};
use rafcon_storage::config::Naming;
use rafcon_storage::{Libraries, LoadError, LoadProblem, SaveError, Saved, load, remedy, save};
use std::path::Path;
use std::sync::Arc;

/// A machine loaded from its files.
#[derive(Debug)]
pub(super) struct OnDisk {
    pub(super) machine: Machine,
    pub(super) saved: Saved,
    /// Faults of its files.
    pub(super) problems: Vec<LoadProblem>,
    /// Hash of its content.
    pub(super) hash: String,
    /// Its content: a [`rafcon_protocol::document::Document`] as JSON.
    pub(super) document: Vec<u8>,
}

/// Loads the machine in a folder. `None` if it no longer exists.
pub(super) fn read(folder: &Path, libraries: &Libraries) -> Result<Option<OnDisk>, Failure> {
    let loaded = match load(folder, libraries) {
        Ok(loaded) => loaded,
        Err(LoadError::NotFound { .. } | LoadError::NotAMachine { .. }) => return Ok(None),
        Err(error) => return Err(unreadable(&error)),
    };
    let (hash, document) = content(&loaded.machine)?;
    let (machine, saved, problems) = (loaded.machine, loaded.saved, loaded.problems);
    Ok(Some(OnDisk { machine, saved, problems, hash, document }))
}

/// The hash of a machine's content, and the content as JSON.
pub(super) fn content(machine: &Machine) -> Result<(String, Vec<u8>), Failure> {
    let document = document_text(machine).map_err(|error| {
        let message = format!("the machine cannot be put into JSON, which is a defect: {error}");
        Failure::defect("no_json", message)
    })?;
    Ok((blake3::hash(&document).to_hex().to_string(), document))
}

/// Writes the parts of a machine that differ from its files.
pub(super) fn write(
    machine: &Machine,
    folder: &Path,
    previous: Option<&Saved>,
    naming: Naming,
) -> Result<Saved, Failure> {
    save(machine, folder, previous, naming).map_err(|error| match &error {
        SaveError::Io { source, .. } => {
            let message =
                format!("{}; {}; the files there are unchanged", reason(&error), remedy(source));
            Failure::unavailable("not_saved", message)
        }
        SaveError::Linked { .. } => Failure::conflict("linked_files", error.to_string()),
        SaveError::Occupied { .. } => Failure::conflict("occupied", reason(&error)),
    })
}

/// A machine with one outcome and no states.
pub(super) fn empty(name: &str, id: StateId, creation_time: &str) -> Machine {
    let kind = Kind::Hierarchy(rafcon_model::Container::default());
    let mut root = State::new(id, name, kind);
    root.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
    let header = Header { creation_time: creation_time.into(), ..Header::default() };
    Machine { header, root: Arc::new(root) }
}

fn unreadable(error: &LoadError) -> Failure {
    if let LoadError::Outside { .. } = error {
        return Failure::forbidden("outside_project", error.to_string());
    }
    Failure::unprocessable("unreadable_machine", reason(error))
}

#[cfg(test)]
mod tests {
    use super::{empty, write};
    use rafcon_model::StateId;
    use rafcon_storage::config::Naming;
    use std::path::Path;

    #[test]
    fn a_refused_save_names_its_cause() {
        let machine = empty("Any", StateId::new("ROOT"), "");
        // No computer allows folders there. A container mounts it read-only.
        let folder = Path::new("/sys/kernel/rafcon-machine");
        let failure = write(&machine, folder, None, Naming::default()).unwrap_err();
        let message = failure.to_string();
        let is_named = message.contains("there is no permission") || message.contains("read-only:");
        assert!(is_named && !message.contains("room"), "{message}");
    }
}
