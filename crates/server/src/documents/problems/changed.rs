//! Notes about libraries that changed since the machine was loaded or made, with the edit that adopts the current version.
//! Knows the current libraries and those in the machine.

use rafcon_model::{Kind, LibraryContent, Machine, State, StatePath};
use rafcon_protocol::api::{MachineProblem, Repair, Severity};
use rafcon_protocol::document::StateDocument;
use rafcon_protocol::edit::Edit;
use rafcon_storage::{Fault, Libraries, fill_library};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A note for each library state whose library has changed. Libraries within libraries are not checked.
pub(in super::super) fn of_libraries(
    machine: &Machine,
    libraries: &Libraries,
) -> Vec<MachineProblem> {
    let mut found = Vec::new();
    let mut compared = Compared::default();
    let mut open = vec![(StatePath::root(machine.root.id.clone()), &machine.root)];
    while let Some((path, state)) = open.pop() {
        found.extend(note(&path, state, libraries, &mut compared));
        let children = state.container().into_iter().flat_map(|inside| inside.states.values());
        open.extend(children.rev().map(|child| (path.child(child.id.clone()), child)));
    }
    found
}

/// Results of earlier comparisons, by address.
#[derive(Debug, Default)]
struct Compared(BTreeMap<(*const State, *const State), bool>);

impl Compared {
    fn compare(&mut self, old: &Arc<State>, new: &Arc<State>) -> bool {
        let pair = (Arc::as_ptr(old), Arc::as_ptr(new));
        *self.0.entry(pair).or_insert_with(|| old == new)
    }
}

fn note(
    path: &StatePath,
    state: &State,
    libraries: &Libraries,
    compared: &mut Compared,
) -> Option<MachineProblem> {
    let Kind::Library(library) = &state.kind else { return None };
    let mut now = state.clone();
    let faults = fill_library(&mut now, libraries);
    let Kind::Library(fresh) = &now.kind else { return None };
    let LibraryContent::Found(new) = &fresh.content else { return None };
    let version = faults.iter().find_map(|fault| match fault {
        Fault::LibraryVersion { wanted, found, .. } => Some((wanted, found)),
        _ => None,
    });
    let mut what: Vec<String> = version
        .map(|(wanted, found)| {
            format!("the state was made with version {wanted}, found version {found}")
        })
        .into_iter()
        .collect();
    match &library.content {
        LibraryContent::Missing { .. } => what.push("it was missing, and now exists".to_owned()),
        LibraryContent::Found(old) if compared.compare(old, new) => {}
        LibraryContent::Found(_) => what.extend(differences(state, &now)),
    }
    if what.is_empty() {
        return None;
    }
    let label = format!("{}/{}", library.path, library.name);
    let repair = take_over(path, state, version.map(|(_, found)| found.to_string()));
    Some(MachineProblem {
        path: path.to_string(),
        part: "state".to_owned(),
        rule: "library_changed".to_owned(),
        severity: Severity::Note,
        message: format!(
            "{path}, state: its library {label} has changed: {}; take it over as it is now, or leave the state as it is until the machine is read again",
            what.join(", ")
        ),
        line: None,
        repairs: repair.into_iter().collect(),
    })
}

/// Names of new and removed ports and outcomes.
fn differences(old: &State, new: &State) -> Vec<String> {
    let outcomes = |state: &State| state.outcomes.iter().map(|one| one.name.to_string()).collect();
    let inputs = |state: &State| state.inputs.iter().map(typed).collect();
    let outputs = |state: &State| state.outputs.iter().map(typed).collect();
    let sides: [(&str, Vec<String>, Vec<String>); 3] = [
        ("outcome", outcomes(old), outcomes(new)),
        ("input", inputs(old), inputs(new)),
        ("output", outputs(old), outputs(new)),
    ];
    let mut found = Vec::new();
    for (what, old, new) in sides {
        let missing = |of: &[String], from: &[String], word: &str| {
            let missing = of.iter().filter(|name| !from.contains(name));
            missing.map(|name| format!("the {what} `{name}` is {word}")).collect::<Vec<_>>()
        };
        found.extend(missing(&old, &new, "gone"));
        found.extend(missing(&new, &old, "new"));
    }
    if found.is_empty() {
        found.push("its content is another one".to_owned());
    }
    found
}

fn typed(port: &rafcon_model::Port) -> String {
    format!("{}: {}", port.name, port.data_type)
}

/// Replaces the state by the current version of its library, keeping connections by name. `None` for the root state.
fn take_over(path: &StatePath, state: &State, version: Option<String>) -> Option<Repair> {
    let container = path.parent()?;
    let mut document = StateDocument::of(state.id.as_str(), state);
    if let Some(library) = &mut document.library {
        library.version = version.or(library.version.take());
        // Values follow their ports by name.
        library.inputs.clear();
        library.outputs.clear();
    }
    Some(Repair {
        name: "Take over the library as it is now".to_owned(),
        edit: Edit::SubstituteState {
            path: container.to_string(),
            state: state.id.to_string(),
            states: vec![document],
        },
    })
}
