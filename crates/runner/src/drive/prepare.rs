//! Prepares a machine for a launch. This module knows the sources of machines, libraries and the config.

use crate::drive::error::PrepareError;
use crate::places::limits;
use crate::{Built, Host, StateFiles};
use rafcon_engine::{Start, Then};
use rafcon_model::{BuiltinTypes, Machine, Severity, StatePath, problems};
use rafcon_protocol::{Afterwards, Launch};
use rafcon_storage::journal::Packed;
use rafcon_storage::{
    Config, Libraries, LoadError, Loaded, Saved, config, load, load_packed, roots,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Everything that a run starts with.
#[derive(Debug)]
pub(crate) struct Prepared<D> {
    pub(crate) machine: Machine,
    pub(crate) files: StateFiles,
    /// Faults that did not prevent loading, one line each.
    pub(crate) problems: Vec<String>,
    pub(crate) start: Start<D>,
    pub(crate) config: Config,
    /// The source for loading the machine again; `None` if it was not loaded from a folder.
    pub(crate) source: Option<Source>,
}

/// The folders of a machine and its libraries.
#[derive(Debug)]
pub(crate) struct Source {
    folder: PathBuf,
    libraries: Arc<Libraries>,
    /// The files that hosts use.
    files: StateFiles,
}

impl Source {
    /// Loads the machine from its folder again.
    pub(crate) fn read(&self) -> Result<Loaded, LoadError> {
        self.libraries.refresh();
        load(&self.folder, &self.libraries)
    }

    /// Notes the files of the machine that the run uses from now on, or as soon as possible.
    pub(crate) fn went_by(&self, saved: Saved) {
        self.files.read_again(saved);
    }
}

/// Loads config, libraries and machine. A packed machine that the run has kept takes precedence.
pub(crate) fn prepare<H: Host>(
    host: &mut H,
    launch: &Launch,
    packed: Option<Packed>,
) -> Result<Prepared<crate::HostValue<H>>, PrepareError> {
    let environment = |name: &str| std::env::var_os(name)?.into_string().ok();
    let (config, _file) = config::find(launch.config.as_deref(), &environment)
        .map_err(|error| PrepareError::Config(Box::new(error)))?;
    if let Some(built) = host.built().filter(|_| packed.is_none()) {
        is_readable(&built.machine)?;
        are_known(&built.machine, launch)?;
        return ready(host, launch, built, config);
    }
    let (roots, notes) = roots(&config, &environment, &launch.libraries);
    let folder = absolute(&launch.machine)?;
    let own = Arc::new(match &launch.homes {
        Some(homes) => Libraries::new(roots).within(homes.clone()),
        None => Libraries::new(roots),
    });
    let (loaded, libraries) = match packed.map(Arc::new) {
        Some(packed) => {
            let libraries = Libraries::new(own.roots().to_vec()).packed(Arc::clone(&packed));
            (load_packed(&packed, Packed::MACHINE, &folder, &libraries), Arc::new(libraries))
        }
        None => (load(&launch.machine, &own), Arc::clone(&own)),
    };
    let loaded = loaded.map_err(|error| PrepareError::Load(Box::new(error)))?;
    is_readable(&loaded.machine)?;
    are_known(&loaded.machine, launch)?;
    let problems = lines(&config.notes)
        .chain(lines(&notes))
        .chain(lines(&loaded.problems))
        .chain(faults(&loaded.machine))
        .chain(limits::faults(&loaded.machine))
        .collect();
    let start = start(host, launch)?;
    let files = StateFiles::new(Some(loaded.saved), libraries);
    let source = Some(Source { folder, libraries: own, files: files.clone() });
    Ok(Prepared { machine: loaded.machine, files, problems, start, config, source })
}

/// The absolute path of a machine's folder; empty for a machine without files.
fn absolute(folder: &Path) -> Result<PathBuf, PrepareError> {
    if folder.as_os_str().is_empty() {
        return Ok(PathBuf::new());
    }
    std::path::absolute(folder).map_err(PrepareError::Folder)
}

/// Prepares a machine that the host supplies.
fn ready<H: Host>(
    host: &mut H,
    launch: &Launch,
    built: Built,
    config: Config,
) -> Result<Prepared<crate::HostValue<H>>, PrepareError> {
    let Built { machine, saved, libraries } = built;
    let problems =
        lines(&config.notes).chain(faults(&machine)).chain(limits::faults(&machine)).collect();
    let (files, start) = (StateFiles::new(saved, libraries), start(host, launch)?);
    Ok(Prepared { machine, files, problems, start, config, source: None })
}

fn start<H: Host>(
    host: &mut H,
    launch: &Launch,
) -> Result<Start<crate::HostValue<H>>, PrepareError> {
    Ok(Start {
        inputs: inputs(host, launch)?,
        start_from: launch.start_from.as_deref().map(StatePath::parse),
        then: then(launch)?,
        hold: launch.hold,
        ..Start::default()
    })
}

/// Refuses a root whose file is damaged: it has no states, and would wait for ever.
fn is_readable(machine: &Machine) -> Result<(), PrepareError> {
    match &machine.root.damage {
        Some(damage) => Err(PrepareError::Damaged(damage.to_string())),
        None => Ok(()),
    }
}

/// Refuses unknown inputs, because a misspelt one would run with a default. A resumed run has passed this check before.
fn are_known(machine: &Machine, launch: &Launch) -> Result<(), PrepareError> {
    let known = &machine.root.inputs;
    let mut names = launch.inputs.iter().map(|(name, _)| name);
    match names.find(|name| known.by_name(name).is_none()) {
        Some(name) if launch.resume.is_none() => Err(PrepareError::NoSuchInput {
            name: name.clone(),
            inputs: known.iter().map(|port| port.name.to_string()).collect(),
        }),
        _ => Ok(()),
    }
}

/// The action after the state at which the run starts.
fn then(launch: &Launch) -> Result<Then, PrepareError> {
    if launch.afterwards != Afterwards::GoOn && launch.start_from.is_none() {
        return Err(PrepareError::NoFirstState);
    }
    Ok(behind(launch.afterwards))
}

/// The engine's form of the action after the start state.
pub(crate) fn behind(afterwards: Afterwards) -> Then {
    match afterwards {
        Afterwards::GoOn => Then::GoOn,
        Afterwards::Hold => Then::Hold,
        Afterwards::Stop => Then::Stop,
    }
}

/// The errors in the machine, one line each.
pub fn faults(machine: &Machine) -> impl Iterator<Item = String> {
    let problems = problems(machine, &BuiltinTypes).into_iter();
    let errors = problems.filter(|problem| problem.severity() == Severity::Error);
    errors.map(|problem| problem.to_string())
}

fn lines<T: ToString>(notes: &[T]) -> impl Iterator<Item = String> {
    notes.iter().map(ToString::to_string)
}

type Inputs<H> = Vec<(smol_str::SmolStr, crate::HostValue<H>)>;

fn inputs<H: Host>(host: &mut H, launch: &Launch) -> Result<Inputs<H>, PrepareError> {
    let mut given = host.inputs();
    let decode = |(name, json): &(String, serde_json::Value)| match host.value(json) {
        Ok(value) => Ok((name.as_str().into(), value)),
        Err(why) => Err(PrepareError::Input { name: name.clone(), why }),
    };
    given.extend(launch.inputs.iter().map(decode).collect::<Result<Vec<_>, _>>()?);
    Ok(given)
}
