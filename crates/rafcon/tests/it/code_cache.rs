//! The compiled modules of the package are kept between starts, and nothing but time depends on them.

use crate::harness::Place;
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt as _;
use std::path::PathBuf;

/// Versions that are kept.
const VERSIONS_MAX: usize = 8;
/// Mode of a folder that everybody can write to.
const EVERYBODY: u32 = 0o777;

fn place() -> Place {
    Place::with_script("def execute(self, inputs, outputs, gvm):\n    return 0")
}

fn versions(place: &Place) -> PathBuf {
    place.path(".cache/rafcon/code")
}

/// Runs the machine; its exit code.
fn run(place: &Place) -> Option<i32> {
    let mut command = place.command("run MACHINE --keep off");
    command.env_remove("PYTHONDONTWRITEBYTECODE").env_remove("XDG_CACHE_HOME");
    place.answer(&command.output().unwrap()).code
}

/// The files of the version that a run has written.
fn written(place: &Place) -> Vec<PathBuf> {
    assert_eq!(run(place), Some(0));
    let version = fs::read_dir(versions(place)).unwrap().next().unwrap().unwrap().path();
    fs::read_dir(version).unwrap().map(|entry| entry.unwrap().path()).collect()
}

/// Puts the code of an empty module into all files.
fn replace_code(files: &[PathBuf]) {
    let empty = files.iter().find(|file| file.ends_with("rafcon.core")).unwrap();
    let code = fs::read(empty).unwrap();
    for file in files {
        fs::write(file, &code).unwrap();
    }
}

#[test]
fn the_next_start_takes_the_code_that_was_kept() {
    let place = place();
    let files = written(&place);
    assert!(files.len() > 20, "{files:?}");
    replace_code(&files);
    assert_ne!(run(&place), Some(0));
}

#[test]
fn damaged_files_are_written_anew() {
    let place = place();
    let files = written(&place);
    let before: Vec<_> = files.iter().map(|file| fs::read(file).unwrap()).collect();
    for (index, (file, bytes)) in files.iter().zip(&before).enumerate() {
        let mut bytes = bytes.clone();
        let at = index * 7919 % bytes.len();
        match index % 3 {
            0 => bytes[at] ^= 1,
            1 => bytes.truncate(at),
            _ => bytes.clear(),
        }
        fs::write(file, bytes).unwrap();
    }
    assert_eq!(run(&place), Some(0));
    for (file, bytes) in files.iter().zip(&before) {
        assert!(fs::read(file).unwrap() == *bytes, "{}", file.display());
    }
}

#[test]
fn code_from_a_folder_that_others_can_write_to_is_not_executed() {
    let place = place();
    let files = written(&place);
    replace_code(&files);
    let version = files[0].parent().unwrap();
    fs::set_permissions(version, Permissions::from_mode(EVERYBODY)).unwrap();
    assert_eq!(run(&place), Some(0));
    fs::set_permissions(version, Permissions::from_mode(0o700)).unwrap();
    fs::set_permissions(versions(&place), Permissions::from_mode(EVERYBODY)).unwrap();
    assert_eq!(run(&place), Some(0));
}

#[test]
fn only_the_newest_versions_are_kept() {
    let place = place();
    for version in 0..3 * VERSIONS_MAX {
        fs::create_dir_all(versions(&place).join(format!("old-{version}"))).unwrap();
    }
    assert_eq!(run(&place), Some(0));
    let kept = fs::read_dir(versions(&place)).unwrap().map(|entry| entry.unwrap().path());
    let kept: Vec<_> = kept.collect();
    assert_eq!(kept.len(), VERSIONS_MAX);
    let used = |version: &&PathBuf| fs::read_dir(version).unwrap().next().is_some();
    assert_eq!(kept.iter().filter(used).count(), 1);
}

#[test]
fn a_run_needs_no_place_for_the_code() {
    let place = place();
    fs::write(place.path(".cache"), "no folder\n").unwrap();
    assert_eq!(run(&place), Some(0));
}

#[test]
fn who_wants_no_bytecode_gets_none() {
    let place = place();
    assert_eq!(place.call("run MACHINE --keep off").code, Some(0));
    let version = fs::read_dir(versions(&place)).unwrap().next().unwrap().unwrap().path();
    assert_eq!(fs::read_dir(version).unwrap().count(), 0);
}
