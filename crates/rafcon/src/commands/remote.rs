//! Shared parts of the commands for servers: the server, the run, and the names of its machine.

use super::serve;
use crate::cli;
use crate::client::{CredentialStore, Fault, Server, TrustDecision};
use crate::environment::Environment;
use crate::failure::Usage;
use crate::view::Names;
use anyhow::{Context as _, Result};
use rafcon_model::Machine;
use rafcon_protocol::api::RunSummary;
use rafcon_supervisor::meant;
use rustix::rand::{GetRandomFlags, getrandom};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Maximum number of requests for the machine of a new run.
const MACHINE_TRIES: u32 = 20;
/// Delay between these requests.
const MACHINE_PAUSE: Duration = Duration::from_millis(100);

/// The server from the options, if any.
pub(super) fn server(raw: &cli::Remote, environment: &Environment) -> Result<Option<Arc<Server>>> {
    let url = raw.server.as_deref();
    url.map(|url| Ok(Arc::new(meet(url, &raw.access, environment)?))).transpose()
}

/// The server at this address.
pub(super) fn meet(url: &str, raw: &cli::Access, environment: &Environment) -> Result<Server> {
    let notebook = notebook(environment)?;
    let state = serve::state(&raw.state, environment).ok();
    let meeting = TrustDecision {
        url,
        token_file: raw.token_file.as_deref(),
        token: environment.token.as_ref().map(|token| token.0.as_str()),
        fingerprint: raw.fingerprint.as_deref(),
        notebook: &notebook,
        state: state.as_deref(),
    };
    meeting.meet()
}

/// The saved credentials of this user for servers.
pub(super) fn notebook(environment: &Environment) -> Result<CredentialStore> {
    let folder = environment.config_home.as_ref().map(|folder| folder.join("rafcon"));
    let folder =
        folder.context("cannot save the server: set HOME or XDG_CONFIG_HOME to a folder")?;
    Ok(CredentialStore::new(folder))
}

/// Refuses a folder of runs: a server has its own.
pub(super) fn refuse_runs(raw: &cli::Runs, environment: &Environment) -> Result<()> {
    let [_, in_environment] = &environment.options;
    refuse(
        raw.runs.is_some() && raw.runs != *in_environment,
        "--runs",
        "the server has its own runs",
    )
}

/// Refuses an option without a meaning at a server.
pub(super) fn refuse(is_given: bool, option: &str, why: &str) -> Result<()> {
    if !is_given {
        return Ok(());
    }
    Err(Usage(format!("{option} does not work with --server: {why}; leave it out")).into())
}

/// The run with this id, start of an id, or `last`.
pub(super) fn run(server: &Server, text: &str) -> Result<RunSummary> {
    let mut runs = server.runs()?;
    runs.sort_by(|a, b| a.id.cmp(&b.id));
    let ids: Vec<String> = runs.iter().map(|run| run.id.clone()).collect();
    let found = match meant(&ids, text).as_slice() {
        [one] => (*one).clone(),
        [] => {
            let address = &server.address;
            let words = format!(
                "there is no run `{text}` at {address}: `rafcon runs --server {address}` lists them"
            );
            return Err(Usage(words).into());
        }
        many => {
            let ids: Vec<&str> = many.iter().map(|id| id.as_str()).collect();
            let words = format!("`{text}` could mean {}: write more of the id", ids.join(" or "));
            return Err(Usage(words).into());
        }
    };
    runs.into_iter().find(|run| run.id == found).context("the run was deleted")
}

/// The names of a run's states.
pub(super) fn names(server: &Arc<Server>, run: &str) -> Names {
    let (begins, id) = (Arc::clone(server), run.to_owned());
    let (later, run) = (Arc::clone(server), run.to_owned());
    Names::new(move || {
        let now = begins.moment_of_run(&id).ok().and_then(|moment| moment.root);
        machine(&begins, &id, now.as_deref())
    })
    .following(move |hash| machine(&later, &run, Some(hash)))
}

/// The machine of a run with this hash, or else at its start. A new run saves its machine after a short delay.
fn machine(server: &Server, run: &str, hash: Option<&str>) -> Option<Machine> {
    for _try in 0..MACHINE_TRIES {
        match server.machine_of_run(run, hash) {
            Ok(machine) => return Some(machine),
            Err(error) if is_kept_later(&error) => thread::park_timeout(MACHINE_PAUSE),
            Err(_other) => return None,
        }
    }
    None
}

fn is_kept_later(error: &anyhow::Error) -> bool {
    let fault = error.downcast_ref();
    matches!(fault, Some(Fault::Refused { refusal, .. }) if refusal.code == "no_such_machine")
}

/// Unique prefix of ids.
pub(super) fn unique(what: &str) -> Result<String> {
    Ok(format!("{what}-{:016x}", random()?))
}

/// Unique id of a command, of the length that takes the fewest bytes on a link.
pub(super) fn command_id() -> Result<String> {
    Ok(format!("{:012x}", random()? >> 16))
}

fn random() -> Result<u64> {
    let mut bytes = [0; 8];
    getrandom(&mut bytes, GetRandomFlags::empty()).context("there is no randomness")?;
    Ok(u64::from_ne_bytes(bytes))
}
