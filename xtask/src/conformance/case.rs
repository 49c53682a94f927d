//! The machines for the comparison: those that the reference ships, and our own, one for each rule.
//!
//! The shipped ones are copied below the target folder and their sleeps are shortened there, so that both engines run
//! identical files and no one waits for 99 bottles.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};

use super::expectations::{Expectations, Expected};
use crate::reference::Reference;
use crate::{process, python, workspace};

/// Factor for the sleeps in scripts.
const TIME_SCALE: &str = "0.02";
/// The folder of the conformance tests, relative to the repository.
const HERE: &str = "tests/conformance";
/// Folders that the generator writes there.
const GENERATED: [&str; 2] = [OWN, OWN_LIBRARIES];
/// Folder of our own machines.
const OWN: &str = "machines";
/// The libraries of our own machines.
const OWN_LIBRARIES: &str = "libraries";

/// One machine to run in both engines.
#[derive(Debug)]
pub(crate) struct Case {
    /// Its folder below the reference's `share`, or `own/` and its name.
    pub(crate) name: String,
    /// Folder of the machine, for both engines.
    pub(crate) folder: PathBuf,
    /// Library roots as `name=folder`.
    pub(crate) libraries: Vec<String>,
    /// Expectations for this machine.
    pub(crate) expected: Expected,
}

/// All machines, sorted by name.
pub(crate) fn all(reference: &Reference, expectations: &Expectations) -> Result<Vec<Case>> {
    let share = workspace::target()?.join("conformance/share");
    remove(&share)?;
    copy(&reference.share, &share)?;
    let libraries = libraries(&share);
    let mut cases = Vec::new();
    for (prefix, root) in [("", share), ("own/", workspace::path(HERE).join(OWN))] {
        for folder in machines(&root)? {
            let name =
                format!("{prefix}{}", folder.strip_prefix(&root).unwrap_or(&folder).display());
            let expected = expectations.of(&name);
            replace(&folder, &expected.replace)?;
            cases.push(Case { name, folder, libraries: libraries.clone(), expected });
        }
    }
    let names = cases.iter().map(|case| case.name.clone()).collect::<Vec<_>>();
    if let Some(name) = expectations.unknown(&names).next() {
        bail!(
            "expectations.json names `{name}`, which the reference does not ship and which is none of ours"
        );
    }
    Ok(cases)
}

/// Fails if our own machines differ from the output of their generator.
pub(crate) fn check_generated() -> Result<()> {
    let fresh = workspace::target()?.join("conformance/generated");
    remove(&fresh)?;
    let python = python::default()?;
    process::run(
        python::command(&python.program).arg(format!("{HERE}/generate_machines.py")).arg(&fresh),
    )?;
    for folder in GENERATED {
        let mut diff = process::command("diff");
        diff.args(["--recursive", "--exclude=__pycache__"])
            .arg(fresh.join(folder))
            .arg(format!("{HERE}/{folder}"));
        process::run(&mut diff).context("run `python3 tests/conformance/generate_machines.py`")?;
    }
    Ok(())
}

pub(super) fn remove(folder: &Path) -> Result<()> {
    if folder.exists() {
        std::fs::remove_dir_all(folder)
            .with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    Ok(())
}

fn libraries(share: &Path) -> Vec<String> {
    let roots = [
        ("generic", share.join("libraries/generic")),
        ("tutorials", share.join("examples/tutorials")),
        ("own", workspace::path(HERE).join(OWN_LIBRARIES)),
    ];
    roots.map(|(name, folder)| format!("{name}={}", folder.display())).to_vec()
}

/// The folders below `root` that contain a machine; a machine contains no other machine.
fn machines(root: &Path) -> Result<Vec<PathBuf>> {
    if root.join("statemachine.json").exists() {
        return Ok(vec![root.to_path_buf()]);
    }
    let mut found = Vec::new();
    for entry in entries(root)?.into_iter().filter(|entry| entry.is_dir()) {
        found.extend(machines(&entry)?);
    }
    Ok(found)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let read =
        std::fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let mut entries = read.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    entries.sort();
    Ok(entries)
}

/// Copies a folder, and shortens the sleeps in its scripts.
pub(super) fn copy(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to).with_context(|| format!("cannot create {}", to.display()))?;
    for entry in entries(from)? {
        let target = to.join(entry.file_name().unwrap_or_default());
        if entry.is_dir() {
            copy(&entry, &target)?;
        } else if entry.ends_with("script.py") {
            edit(&entry, &target, shorten)?;
        } else {
            std::fs::copy(&entry, &target)
                .with_context(|| format!("cannot copy {}", entry.display()))?;
        }
    }
    Ok(())
}

fn shorten(script: &str) -> String {
    script.replace("time.sleep(", &format!("time.sleep({TIME_SCALE} * "))
}

/// Replaces text in every script of a machine.
fn replace(machine: &Path, replacements: &[(String, String)]) -> Result<()> {
    if replacements.is_empty() {
        return Ok(());
    }
    for entry in entries(machine)? {
        if entry.is_dir() {
            replace(&entry, replacements)?;
        } else if entry.ends_with("script.py") {
            let all = |script: &str| {
                replacements
                    .iter()
                    .fold(script.to_owned(), |text, (from, to)| text.replace(from, to))
            };
            edit(&entry, &entry, all)?;
        }
    }
    Ok(())
}

fn edit(from: &Path, to: &Path, change: impl Fn(&str) -> String) -> Result<()> {
    let text =
        std::fs::read_to_string(from).with_context(|| format!("cannot read {}", from.display()))?;
    std::fs::write(to, change(&text)).with_context(|| format!("cannot write {}", to.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sleep_is_shortened_wherever_it_stands() {
        assert_eq!(shorten("    time.sleep(1.0)\n"), "    time.sleep(0.02 * 1.0)\n");
        assert_eq!(shorten("self.preemptive_wait(1)"), "self.preemptive_wait(1)");
    }
}
