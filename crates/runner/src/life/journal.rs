//! Opens the record of a run, as its launch specifies. This module knows folders, but not the contents.

use crate::Clock;
use crate::record::recorder::Recorder;
use rafcon_model::Machine;
use rafcon_protocol::{Keeping, Launch, OnCrash};
use rafcon_storage::journal::{About, Journal, JournalError, Options};
use std::path::Path;

/// Key in the root's semantic data for the recovery of interrupted scripts.
const ON_CRASH: &str = "on_crash";

/// The record of a new run, with a journal if the launch has a folder and keeps events.
pub(crate) fn begin(
    launch: &Launch,
    machine: &Machine,
    clock: Clock,
) -> Result<Recorder, JournalError> {
    match &launch.run_folder {
        Some(folder) if launch.keeping != Keeping::Off => {
            let about = about(launch, folder, machine, clock);
            let journal = Journal::create(folder, &about, &options(launch.size_max))?;
            Ok(Recorder::with_journal(journal, None, launch.keeping, launch.strict))
        }
        _ => Ok(Recorder::default()),
    }
}

/// Options for a journal with this size limit.
pub(crate) fn options(size_max: Option<u64>) -> Options {
    let usual = Options::default();
    Options { size_max: size_max.unwrap_or(usual.size_max), ..usual }
}

fn about(launch: &Launch, folder: &Path, machine: &Machine, clock: Clock) -> About {
    About {
        id: folder.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        name: machine.root.name.to_string(),
        machine: std::path::absolute(&launch.machine).unwrap_or_else(|_| launch.machine.clone()),
        started_ms: Clock::epoch_ms().saturating_sub(clock.now_ms()),
        keeping: launch.keeping,
        strict: launch.strict,
        states: machine.count() as u64,
        program: format!("rafcon {}", env!("CARGO_PKG_VERSION")),
        on_crash: launch.on_crash.or_else(|| on_crash(machine)),
        libraries: launch.libraries.clone(),
        config: launch.config.clone(),
        size_max: launch.size_max,
        homes: launch.homes.clone(),
        beginning: launch.beginning(),
        ..About::default()
    }
}

fn on_crash(machine: &Machine) -> Option<OnCrash> {
    match machine.root.semantic_data.as_ref()?.get(ON_CRASH)?.as_str()? {
        "ask" => Some(OnCrash::Ask),
        "abort" => Some(OnCrash::Abort),
        "restart" => Some(OnCrash::Restart),
        _ => None,
    }
}
