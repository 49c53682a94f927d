//! Loading and saving, with a warm file cache.

use crate::{clock, machines, median, print};
use anyhow::{Context as _, Result};
use rafcon_model::{Machine, State};
use rafcon_storage::config::Naming;
use rafcon_storage::{Libraries, Loaded, load, save};
use std::path::Path;
use std::sync::Arc;

/// Measures below `folder`.
pub(crate) fn measure(folder: &Path) -> Result<()> {
    let small = machines::mission(folder, 750)?;
    let large = machines::mission(folder, 10_000)?;
    print("load_750_ms", load_ms(&small)?, "ms");
    print("load_10000_ms", load_ms(&large)?, "ms");
    print("save_one_edit_ms", save_one_edit_ms(&large)?, "ms");
    print("save_10000_ms", save_ms(&large, folder)?, "ms");
    Ok(())
}

fn load_ms(path: &Path) -> Result<f64> {
    read(path)?;
    median(|| {
        let (seconds, loaded) = clock::seconds(|| read(path));
        loaded?;
        Ok(seconds * 1e3)
    })
}

fn read(path: &Path) -> Result<Loaded> {
    Ok(load(path, &Libraries::default())?)
}

/// Into a new folder each time. None is removed before the last is written: some file systems give new files a place
/// slowly while they still look after those that were just deleted.
fn save_ms(path: &Path, folder: &Path) -> Result<f64> {
    let machine = read(path)?.machine;
    let mut number = 0;
    median(|| {
        number += 1;
        let target = folder.join(format!("saved_{number}"));
        let (seconds, saved) = clock::seconds(|| save(&machine, &target, None, Naming::default()));
        saved?;
        Ok(seconds * 1e3)
    })
}

/// After another description of the state that lies deepest.
fn save_one_edit_ms(path: &Path) -> Result<f64> {
    let Loaded { mut machine, mut saved, .. } = read(path)?;
    let mut edit = 0;
    median(|| {
        edit += 1;
        describe_deepest(&mut machine, &format!("edit {edit}"))?;
        let (seconds, next) =
            clock::seconds(|| save(&machine, path, Some(&saved), Naming::default()));
        saved = next?;
        Ok(seconds * 1e3)
    })
}

fn describe_deepest(machine: &mut Machine, text: &str) -> Result<()> {
    let mut state: &mut State = Arc::make_mut(&mut machine.root);
    while state.container().is_some_and(|inside| !inside.states.is_empty()) {
        let inside = state.container_mut().context("a container")?;
        let first = inside.states.keys().next().cloned().context("a child")?;
        state = Arc::make_mut(inside.states.get_mut(&first).context("a child")?);
    }
    state.description = Some(text.into());
    Ok(())
}
