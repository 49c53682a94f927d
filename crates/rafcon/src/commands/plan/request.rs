//! Conversion of the options to a plan request: pools by folder or library path, contents of files.

use crate::cli::{self, Then};
use crate::environment::variable;
use crate::failure::{Usage, complain};
use crate::machine::library_roots;
use anyhow::{Context as _, Result};
use rafcon_protocol::api::{MakePlan, PlanPool, PlanRecovery, PlanThen};
use rafcon_storage::{Libraries, Root, config, roots};
use serde::de::DeserializeOwned;
use std::fs;
use std::path::{Path, PathBuf};

/// A request, with the folders of its skills.
pub(super) struct Asked {
    pub(super) request: MakePlan,
    pub(super) libraries: Libraries,
    /// Library roots that a machine of the plan needs in addition to those of the configuration.
    pub(super) given: Vec<(String, PathBuf)>,
}

/// Reads options and files.
pub(super) fn read(raw: &cli::Plan) -> Result<Asked> {
    let (config, _file) = config::find(raw.libraries.config.as_deref(), &variable)?;
    let mut given = library_roots(&raw.libraries)?;
    let (mut all, notes) = roots(&config, &variable, &given);
    for note in notes {
        complain(&format!("warning: {note}"));
    }
    let mut pool = PlanPool::default();
    for wanted in &raw.pool {
        pool.libraries.push(library_path(wanted, &mut all, &mut given)?);
    }
    if let Some(file) = &raw.types {
        pool.types = json(file)?;
    }
    let facts = raw.facts.as_ref().map(|file| {
        fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))
    });
    if !(raw.time_limit > 0.0 && raw.time_limit <= 3600.0) {
        return Err(Usage("--time-limit: write seconds, at most 3600".to_owned()).into());
    }
    let then = match raw.then {
        Then::GiveUp => PlanThen::GiveUp,
        Then::Ask => PlanThen::Ask,
        Then::Replan => PlanThen::Replan,
    };
    let name = raw.out.as_ref().and_then(|out| Some(out.file_name()?.to_str()?.to_owned()));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most an hour")]
    let time_limit_ms = (raw.time_limit * 1000.0).ceil() as u64;
    let request = MakePlan {
        pool,
        facts: facts.transpose()?.unwrap_or_default(),
        goal: raw.goal.clone(),
        data: raw.data.as_deref().map(json).transpose()?.unwrap_or_default(),
        engine: Some(raw.engine.clone()),
        time_limit_ms: Some(time_limit_ms),
        anytime: raw.anytime,
        parallel: raw.parallel,
        recovery: PlanRecovery { retries: raw.retries, then },
        observe: raw.observe.clone(),
        replans_max: raw.replans_max,
        name,
    };
    Ok(Asked { request, libraries: Libraries::new(all), given })
}

fn json<T: DeserializeOwned>(file: &Path) -> Result<T> {
    let text =
        fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
    serde_json::from_str(&text)
        .with_context(|| format!("{} is not what is expected", file.display()))
}

/// The library path of a pool. A folder outside of all roots becomes a root.
fn library_path(
    wanted: &str,
    all: &mut Vec<Root>,
    given: &mut Vec<(String, PathBuf)>,
) -> Result<String> {
    let Ok(folder) = fs::canonicalize(wanted) else { return Ok(wanted.to_owned()) };
    let is_root = |root: &&Root| fs::canonicalize(&root.dir).is_ok_and(|dir| dir == folder);
    if let Some(root) = all.iter().find(is_root) {
        return Ok(root.name.to_string());
    }
    if let Some((path, name)) = Libraries::new(all.clone()).reference(&folder) {
        return Ok(format!("{path}/{name}"));
    }
    let name = folder.file_name().and_then(|name| name.to_str());
    let name =
        name.with_context(|| format!("the name of {wanted} is not UTF-8: rename the folder"))?;
    all.insert(0, Root { name: name.into(), dir: folder.clone() });
    given.push((name.to_owned(), folder.clone()));
    Ok(name.to_owned())
}
