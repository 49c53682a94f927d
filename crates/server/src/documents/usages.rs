//! Usages of a library: in open machines, and in the files of all others. Knows the open machines.

use super::documents::Documents;
use crate::ServerState;
use crate::projects::Search;
use rafcon_model::{Kind, Machine, State, StatePath};
use rafcon_protocol::api::{LibraryName, LibraryUsage, LibraryUsages, MachineFile, UsagesOf};
use std::collections::BTreeSet;
use std::path::Path;

/// Capacity of the list of usages.
const USAGES_MAX: usize = 1000;

impl Documents {
    /// Finds all usages of a library, up to the capacity.
    pub(crate) fn usages(&self, server: &ServerState, of: &UsagesOf) -> LibraryUsages {
        let libraries = server.projects.libraries();
        let name = |folder: &Path| {
            let (path, name) = libraries.reference(folder)?;
            Some(LibraryName { path: path.into(), name: name.into() })
        };
        let mut hidden =
            BTreeSet::from([server.settings.runs.clone(), server.settings.state.clone()]);
        let mut usages = Vec::new();
        for session in self.all() {
            let (folder, (_, machine)) = (session.folder(), session.machine());
            let (file, library) = (server.projects.file_of(&folder), name(&folder));
            for states in used(&machine, of) {
                let id = Some(session.id().to_owned());
                usages.push(usage(states, id, file.clone(), library.clone()));
            }
            hidden.insert(folder);
        }
        let most = USAGES_MAX.saturating_sub(usages.len());
        let mut search = Search::new(&of.path, &of.name, &hidden, most);
        server.projects.folders().iter().for_each(|folder| search.look(folder));
        let is_cut = search.is_full();
        usages.extend(search.found.into_iter().map(|used| {
            usage(used.states, None, server.projects.file_of(&used.machine), name(&used.machine))
        }));
        usages.truncate(USAGES_MAX);
        LibraryUsages { usages, is_cut }
    }
}

fn usage(
    states: Vec<(String, String)>,
    machine: Option<String>,
    file: Option<MachineFile>,
    library: Option<LibraryName>,
) -> LibraryUsage {
    let (ids, names): (Vec<_>, Vec<_>) = states.into_iter().unzip();
    LibraryUsage { machine, file, library, path: ids.join("/"), names }
}

/// Paths of the states that use a library: ids and names from the root on.
fn used(machine: &Machine, of: &UsagesOf) -> Vec<Vec<(String, String)>> {
    let mut found = Vec::new();
    let mut open = vec![(StatePath::root(machine.root.id.clone()), &*machine.root)];
    while let Some((path, state)) = open.pop() {
        if is_use(state, of) {
            found.push(named(machine, &path));
        }
        let children = state.container().into_iter().flat_map(|inside| inside.states.iter());
        open.extend(children.map(|(id, child)| (path.child(id.clone()), &**child)));
    }
    found.sort();
    found
}

fn is_use(state: &State, of: &UsagesOf) -> bool {
    matches!(&state.kind, Kind::Library(library) if library.path == of.path && library.name == of.name)
}

/// Ids and names of the states from the root to this one.
fn named(machine: &Machine, path: &StatePath) -> Vec<(String, String)> {
    let way = (1..=path.0.len()).map(|length| StatePath(path.0[..length].to_vec()));
    let named = |path: StatePath| {
        let state = machine.state(&path)?;
        Some((state.id.to_string(), state.name.to_string()))
    };
    way.filter_map(named).collect()
}
