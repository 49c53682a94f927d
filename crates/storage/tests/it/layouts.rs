//! One machine in every layout, from `tests/fixtures/layouts`.

use crate::folders::{copy, files, libraries, read, repository};
use rafcon_model::{Machine, notation};
use rafcon_storage::{Libraries, Naming, format, save};
use std::path::PathBuf;

const VERSIONS: [&str; 5] = ["0.7.12", "0.7.13", "0.8", "1.0", "2.2"];

fn fixture(version: &str) -> PathBuf {
    repository("tests/fixtures/layouts").join(version).join("machine")
}

fn libraries_of_fixtures() -> Libraries {
    libraries(&repository("tests/fixtures/layouts/libraries"))
}

/// Returns the machine without data that differs between versions.
fn shown(machine: &Machine) -> String {
    let mut machine = machine.clone();
    machine.header.used_rafcon_version = None;
    notation::print(&machine)
}

#[test]
fn every_layout_gives_the_same_machine() {
    let libraries = libraries_of_fixtures();
    let newest = read(&fixture("2.2"), &libraries);
    assert_eq!(newest.machine.count(), 7);
    for version in VERSIONS {
        let loaded = read(&fixture(version), &libraries);
        assert_eq!(shown(&loaded.machine), shown(&newest.machine), "{version}");
        let problems: Vec<_> = loaded.problems.iter().map(ToString::to_string).collect();
        assert_eq!(problems, Vec::<String>::new(), "{version}");
    }
}

#[test]
fn an_untouched_machine_keeps_every_byte() {
    let dir = tempfile::tempdir().unwrap();
    copy(&fixture("2.2"), dir.path());
    let before = files(dir.path());
    let loaded = read(dir.path(), &libraries_of_fixtures());
    save(&loaded.machine, dir.path(), Some(&loaded.saved), Naming::default()).unwrap();
    assert_eq!(files(dir.path()), before);
    assert_eq!(
        format(dir.path(), Naming::default(), false).unwrap().changed,
        Vec::<PathBuf>::new()
    );
    let other = tempfile::tempdir().unwrap();
    save(&loaded.machine, other.path(), Some(&loaded.saved), Naming::default()).unwrap();
    assert_eq!(files(other.path()), before);
}

#[test]
fn every_layout_is_saved_in_the_current_one() {
    let expected = files(&fixture("2.2"));
    for version in VERSIONS {
        let dir = tempfile::tempdir().unwrap();
        copy(&fixture(version), dir.path());
        let loaded = read(dir.path(), &libraries_of_fixtures());
        save(&loaded.machine, dir.path(), Some(&loaded.saved), Naming::default()).unwrap();
        let formatted = tempfile::tempdir().unwrap();
        copy(&fixture(version), formatted.path());
        assert_eq!(format(formatted.path(), Naming::default(), false).unwrap().problems, []);
        assert_eq!(files(formatted.path()), files(dir.path()), "{version}");
        let mut found = files(dir.path());
        let header = PathBuf::from("statemachine.json");
        found.insert(header.clone(), expected[&header].clone());
        assert_eq!(
            found.keys().collect::<Vec<_>>(),
            expected.keys().collect::<Vec<_>>(),
            "{version}"
        );
        for (path, bytes) in &expected {
            let found = String::from_utf8_lossy(&found[path]);
            assert_eq!(found, String::from_utf8_lossy(bytes), "{version}: {}", path.display());
        }
    }
}
