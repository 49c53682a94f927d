//! Loads the skills of a pool from the libraries on disk.

use rafcon_model::{Kind, Library, LibraryContent, State, StateId};
use rafcon_planner::pddl::Name;
use rafcon_planner::{Finding, Pool, Severity, read_skill};
use rafcon_protocol::api::PlanPool;
use rafcon_storage::libraries::{EntryKind, LibraryEntry};
use rafcon_storage::{Libraries, fill_library};
use smol_str::SmolStr;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Loads all skills of a pool. An unreadable library becomes a finding and is skipped.
pub(super) fn read(pool: &PlanPool, libraries: &Libraries) -> Pool {
    let mut paths = BTreeSet::new();
    let tree = libraries.tree();
    let mut findings = Vec::new();
    for wanted in &pool.libraries {
        let wanted = wanted.trim_matches('/');
        let before = paths.len();
        for entry in &tree {
            collect(entry, wanted, &mut paths);
        }
        if paths.len() == before {
            findings.push(error(&[], format!("there are no libraries in `{wanted}`: name a library root, or a folder below one")));
        }
    }
    let mut skills = Vec::new();
    for path in paths {
        let found = library(&path, libraries).map_err(|reason| error(&[&path], reason));
        match found.and_then(|root| read_skill(&path, &root)) {
            Ok(skill) => skills.extend(skill),
            Err(finding) => findings.push(finding),
        }
    }
    let types: Vec<(Name, Name)> =
        pool.types.iter().map(|(child, parent)| (child.into(), parent.into())).collect();
    let mut pool = Pool::new("skills", skills, &types);
    pool.findings.splice(0..0, findings);
    pool
}

fn error(libraries: &[&SmolStr], text: String) -> Finding {
    Finding {
        severity: Severity::Error,
        libraries: libraries.iter().map(|&path| path.clone()).collect(),
        text,
    }
}

fn collect(entry: &LibraryEntry, wanted: &str, into: &mut BTreeSet<SmolStr>) {
    let is_inside = entry.path == wanted
        || entry.path.strip_prefix(wanted).is_some_and(|rest| rest.starts_with('/'));
    match &entry.kind {
        EntryKind::Library if is_inside => drop(into.insert(entry.path.clone())),
        EntryKind::Library => {}
        EntryKind::Folder(inside) => inside.iter().for_each(|entry| collect(entry, wanted, into)),
    }
}

/// The root state of a library.
pub(super) fn library(path: &str, libraries: &Libraries) -> Result<Arc<State>, String> {
    let (folder, name) = path
        .rsplit_once('/')
        .ok_or_else(|| format!("`{path}` is no library: write `root/name`"))?;
    let library = Library {
        path: folder.into(),
        name: name.into(),
        version: None,
        inputs: std::collections::BTreeMap::default(),
        outputs: std::collections::BTreeMap::default(),
        content: LibraryContent::Missing { reason: SmolStr::default() },
    };
    let mut state = State::new(StateId::new("LIBRAR"), name, Kind::Library(library));
    let _differences = fill_library(&mut state, libraries);
    match state.kind {
        Kind::Library(Library { content: LibraryContent::Found(root), .. }) => Ok(root),
        Kind::Library(Library { content: LibraryContent::Missing { reason }, .. }) => {
            Err(reason.into())
        }
        _ => Err("it is no library".to_owned()),
    }
}
