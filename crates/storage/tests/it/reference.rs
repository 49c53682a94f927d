//! Machines survive saving by us and loading by the reference, and the reverse. Needs an interpreter with the PyPI package `rafcon`
//! in `RAFCON_REFERENCE_PYTHON`; `cargo xtask test` sets it.

use crate::folders::{copy, files, libraries, read, repository};
use rafcon_model::{Json, Machine, json, notation};
use rafcon_storage::{Libraries, Naming, Root, save};
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Loads the machine at the first path in the reference and saves it to the second. Further arguments are library roots,
/// `name=folder`.
const PROGRAM: &str = r#"
import logging, os, sys, tempfile
folder = tempfile.mkdtemp()
os.environ["HOME"] = folder
from rafcon.core.config import global_config
from rafcon.core.singleton import library_manager
from rafcon.core.storage import storage
source, target, *roots = sys.argv[1:]
with open(os.path.join(folder, "config.yaml"), "w") as file:
    file.write("TYPE: SM_CONFIG\nLIBRARY_PATHS:\n")
    for root in roots:
        file.write("    {}: {}\n".format(*root.split("=", 1)))
global_config.load(config_file="config.yaml", path=folder)
library_manager.show_dialog = False
library_manager.initialize()
machine = storage.load_state_machine_from_path(source)
if machine is None:
    sys.exit("the reference cannot load it")
storage.save_state_machine_to_path(machine, target, as_copy=True)
"#;

/// Returns the interpreter. Prints a line with the reason if it is missing.
#[expect(clippy::print_stdout, reason = "who runs the tests should see that one was skipped")]
fn python() -> Option<PathBuf> {
    let python = env::var_os("RAFCON_REFERENCE_PYTHON").map(PathBuf::from);
    if python.is_none() {
        println!("skipped: RAFCON_REFERENCE_PYTHON is not set; run `cargo xtask test`");
    }
    python
}

/// Lets the reference load `from` and save it to `to`.
fn through_the_reference(python: &Path, from: &Path, to: &Path, roots: &[String]) {
    let mut command = Command::new(python);
    command.args(["-c", PROGRAM]).args([from, to]).args(roots);
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let said = text(&output.stdout) + &text(&output.stderr);
    assert!(output.status.success(), "{}: {said}", from.display());
}

/// Returns the machine without layout, which the reference's core does not write, and with the reference as its writer.
fn core_of(machine: &Machine) -> String {
    let mut machine = machine.clone();
    machine.header.used_rafcon_version = None;
    let shown = notation::Shown { layout: false, scripts: true, contents: true };
    notation::print_with(&machine, shown)
}

/// Saves the machine in `dir`, copies it with the reference, and compares.
fn check(python: &Path, dir: &Path, libraries: &Libraries, roots: &[String]) {
    let work = tempfile::tempdir().unwrap();
    let (ours, theirs) = (work.path().join("ours"), work.path().join("theirs"));
    let loaded = read(dir, libraries);
    save(&loaded.machine, &ours, None, Naming::default()).unwrap();
    through_the_reference(python, &ours, &theirs, roots);
    let back = read(&theirs, libraries);
    assert_eq!(core_of(&back.machine), core_of(&loaded.machine), "{}", dir.display());
    compare_bytes(&ours, &theirs);
}

/// Checks that both wrote equal sets of files, and that files of states are identical byte for byte.
fn compare_bytes(ours: &Path, theirs: &Path) {
    let (ours, theirs) = (files(ours), files(theirs));
    for (path, bytes) in &theirs {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let same = ours.get(path).map(|bytes| String::from_utf8_lossy(bytes));
        match name {
            "statemachine.json" => assert!(same.is_some()),
            _ => assert_eq!(
                same.as_deref(),
                Some(&*String::from_utf8_lossy(bytes)),
                "{}",
                path.display()
            ),
        }
    }
}

#[test]
fn the_reference_reads_what_we_save_of_our_examples() {
    let Some(python) = python() else { return };
    let dir = repository("examples/libraries").canonicalize().unwrap();
    let roots = [format!("examples={}", dir.display())];
    let libraries = Libraries::new(vec![Root { name: "examples".into(), dir }]);
    let mut count = 0;
    for entry in std::fs::read_dir(repository("examples")).unwrap() {
        let dir = entry.unwrap().path();
        if dir.join("statemachine.json").exists() {
            check(&python, &dir, &libraries, &roots);
            count += 1;
        }
    }
    assert!(count > 5, "{count} examples");
}

#[test]
fn the_reference_reads_what_we_save_of_every_layout() {
    let Some(python) = python() else { return };
    let fixtures = repository("tests/fixtures/layouts").canonicalize().unwrap();
    let roots = [format!("questions={}", fixtures.join("libraries/questions").display())];
    for version in ["0.7.12", "0.7.13", "0.8", "1.0", "2.2"] {
        let dir = fixtures.join(version).join("machine");
        check(&python, &dir, &libraries(&fixtures.join("libraries")), &roots);
    }
}

#[test]
fn machines_of_the_reference_keep_every_byte() {
    let Some(python) = python() else { return };
    let share = python.parent().unwrap().join("../lib");
    let libraries = Libraries::default();
    let mut count = 0;
    for dir in machines_below(&share) {
        let work = tempfile::tempdir().unwrap();
        copy(&dir, work.path());
        let before = files(work.path());
        let loaded = read(work.path(), &libraries);
        save(&loaded.machine, work.path(), Some(&loaded.saved), Naming::default()).unwrap();
        assert_eq!(files(work.path()), before);
        let target = work.path().join("copy");
        save(&loaded.machine, &target, None, Naming::default()).unwrap();
        for (path, bytes) in
            files(&target).iter().filter(|(path, _)| path.ends_with("core_data.json"))
        {
            if let Some(theirs) = before.get(path) {
                assert_eq!(known(bytes), known(theirs), "{}: {}", dir.display(), path.display());
            }
        }
        count += 1;
    }
    assert!(count > 10, "{count} machines");
}

/// Returns the document in `bytes`, without parts that older releases omitted.
fn known(bytes: &[u8]) -> Json {
    let mut document = json::parse(&String::from_utf8_lossy(bytes)).unwrap();
    for key in ["income", "description"] {
        document.remove(key);
    }
    json::parse(&json::write(&document)).unwrap()
}

fn machines_below(dir: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut waiting = vec![dir.to_owned()];
    while let Some(folder) = waiting.pop() {
        if folder.join("statemachine.json").exists() {
            found.push(folder);
            continue;
        }
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        waiting.extend(
            entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| path.is_dir()),
        );
    }
    found
}
