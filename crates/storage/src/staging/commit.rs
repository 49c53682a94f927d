//! Executes a plan so that a kill at any moment leaves the old or the new machine: prepare in a separate folder, sync, list the
//! last steps, execute them. Handles files, not machines.

use super::disk::Disk;
use super::manifest::SaveManifest;
use crate::files::STAGING;
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

const MANIFEST: &str = "manifest";
const UNFINISHED: &str = "manifest.unfinished";

/// The operations of a save. Paths are relative to the machine's folder.
#[derive(Debug, Default)]
pub(crate) struct Plan {
    /// Folders to prepare, outer ones first.
    pub(crate) folders: Vec<PathBuf>,
    /// Files to write into the staging folder.
    pub(crate) files: Vec<NewFile>,
    /// The last steps, which the manifest lists.
    pub(crate) manifest: SaveManifest,
    /// Changed files and folders, for people.
    pub(crate) changed: Vec<PathBuf>,
}

/// A file in the staging folder.
#[derive(Debug)]
pub(crate) struct NewFile {
    pub(crate) path: PathBuf,
    pub(crate) bytes: Vec<u8>,
    /// The file that it replaces, and from which it takes the permissions.
    pub(crate) like: Option<PathBuf>,
}

/// Executes the plan in the machine's folder `dir`.
pub(crate) fn commit(disk: &dyn Disk, dir: &Path, plan: &Plan) -> io::Result<()> {
    if plan.manifest.is_empty() {
        return Ok(());
    }
    let staging = dir.join(STAGING);
    let prepared = prepare(disk, dir, &staging, plan);
    if prepared.is_err() {
        // Reports the first error; the next load or save removes the rest.
        drop(disk.remove_tree(&staging));
        return prepared;
    }
    finish(disk, dir, &plan.manifest)
}

/// Writes everything into the staging folder, and at the end the manifest, complete and durable. A single move needs
/// no manifest, because it is atomic.
fn prepare(disk: &dyn Disk, dir: &Path, staging: &Path, plan: &Plan) -> io::Result<()> {
    disk.create_dir(staging)?;
    let mut durable = Vec::with_capacity(plan.files.len() + plan.folders.len() + 1);
    for folder in &plan.folders {
        let path = dir.join(folder);
        disk.create_dir(&path)?;
        durable.push(path);
    }
    for file in &plan.files {
        let path = dir.join(&file.path);
        let like = file.like.as_ref().map(|like| dir.join(like));
        disk.write(&path, &file.bytes, like.as_deref())?;
        durable.push(path);
    }
    if plan.manifest.is_single_move() {
        return disk.sync(&durable);
    }
    let unfinished = staging.join(UNFINISHED);
    disk.write(&unfinished, &plan.manifest.encode(), None)?;
    durable.push(unfinished.clone());
    durable.push(staging.to_owned());
    disk.sync(&durable)?;
    disk.rename(&unfinished, &staging.join(MANIFEST))?;
    disk.sync(&[staging.to_owned()])
}

/// Executes the remaining steps of a manifest, makes them durable, and removes the staging folder.
fn finish(disk: &dyn Disk, dir: &Path, manifest: &SaveManifest) -> io::Result<()> {
    let mut touched = BTreeSet::new();
    for (from, to) in &manifest.moves {
        let (from, to) = (dir.join(from), dir.join(to));
        if disk.exists(&from) {
            disk.rename(&from, &to)?;
        }
        touched.insert(parent(&from));
        touched.insert(parent(&to));
    }
    for path in &manifest.removed {
        disk.remove_file(&dir.join(path))?;
        touched.insert(parent(&dir.join(path)));
    }
    for path in &manifest.emptied {
        disk.remove_dir(&dir.join(path))?;
        touched.insert(parent(&dir.join(path)));
    }
    let staging = dir.join(STAGING);
    touched.remove(&staging);
    let touched: Vec<PathBuf> = touched.into_iter().filter(|path| disk.exists(path)).collect();
    disk.sync(&touched)?;
    disk.remove_file(&staging.join(MANIFEST))?;
    // All steps are done; the next load or save removes an empty folder that stays.
    drop(disk.remove_tree(&staging));
    Ok(())
}

fn parent(path: &Path) -> PathBuf {
    path.parent().unwrap_or(path).to_owned()
}

/// Returns true if a save of this machine was interrupted.
pub(crate) fn is_interrupted(disk: &dyn Disk, dir: &Path) -> bool {
    disk.exists(&dir.join(STAGING))
}

/// Finishes the interrupted save if it was prepared, or else discards it. Returns true if the machine on disk changed.
pub(crate) fn recover(disk: &dyn Disk, dir: &Path) -> io::Result<bool> {
    let staging = dir.join(STAGING);
    let manifest = disk.read(&staging.join(MANIFEST))?;
    match manifest.as_deref().and_then(SaveManifest::decode) {
        Some(manifest) => finish(disk, dir, &manifest).map(|()| true),
        None => disk.remove_tree(&staging).map(|()| false),
    }
}
