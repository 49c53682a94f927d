//! `rafcon serve`: converts the options to the settings of a server. `rafcon-server` does the rest.

use super::kept::runs_folder;
use super::link::{Relays, RobotFolders, ServerAuthority, StationBroker};
use super::ros;
use crate::cli;
use crate::environment::{self, Environment};
use crate::failure::complain;
use crate::machine;
use anyhow::{Context as _, Result, bail};
use rafcon_relay::{ProjectFolder, Projects};
use rafcon_server::{RunAuthority, Server, Settings, project_ids};
use rafcon_storage::{config, roots};
use std::io::{self, Write as _};
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Serves until a request to stop; a station also receives robots.
pub(super) fn serve(
    raw: &cli::Serve,
    robots: Option<SocketAddr>,
    environment: &Environment,
) -> Result<ExitCode> {
    let mut settings = settings(raw, environment)?;
    let (state, runs) = (state(&raw.state, environment)?, settings.runs.clone());
    let mut relays = Relays::default();
    let authority = Arc::new(ServerAuthority::default());
    let projects = projects(&settings);
    let folders = RobotFolders { state: &state, runs: &runs, projects: &projects };
    relays.robot(&raw.link, &folders, &authority, environment)?;
    if let Some(listen) = robots {
        let broker = StationBroker::default();
        relays.station(&raw.link, listen, &settings, &broker)?;
        settings.robots = Some(Arc::new(broker));
    }
    let mut bridge = None;
    let served = rafcon_server::serve(settings, |server| {
        authority.set(RunAuthority::new(server.state()));
        // A station needs no machines of its own: it receives those of its robots.
        if raw.projects.is_empty() && robots.is_none() {
            complain(
                "warning: the command names no folder with machines; the server offers only runs",
            );
        }
        greet(server);
        let namespace = raw.ros.as_deref();
        bridge = namespace.and_then(|namespace| ros::bridge(server, namespace, &raw.ros_frame));
    });
    drop(bridge);
    relays.stop();
    served?;
    Ok(ExitCode::SUCCESS)
}

/// Folders and libraries of the server's machines. The server itself reports problems of the configuration.
fn projects(settings: &Settings) -> Projects {
    let found = config::find(settings.config.as_deref(), &environment::variable);
    let config = found.map(|(config, _file)| config).unwrap_or_default();
    let (libraries, _notes) = roots(&config, &environment::variable, &settings.libraries);
    let folders = project_ids(&settings.projects).into_iter();
    let folders = folders.map(|(id, folder)| ProjectFolder { id, folder }).collect();
    Projects { folders, libraries }
}

fn settings(raw: &cli::Serve, environment: &Environment) -> Result<Settings> {
    let runs = runs_folder(&raw.runs, environment)?.folder().to_owned();
    let mut settings = Settings::new(state(&raw.state, environment)?, runs);
    settings.projects = raw.projects.iter().map(|folder| project(folder)).collect::<Result<_>>()?;
    settings.libraries = machine::library_roots(&raw.libraries)?;
    settings.config = raw.libraries.config.as_deref().map(std::path::absolute).transpose()?;
    settings.variable = environment::variable;
    settings.python.clone_from(&raw.python.python);
    settings.environment = environment.locations.clone();
    settings.access.keep_token = raw.keep_token;
    settings.listen.address = raw.bind;
    settings.listen.hosts.clone_from(&raw.hosts);
    settings.listen.proxies = raw.proxies.iter().map(IpAddr::to_canonical).collect();
    settings.listen.base_path = raw.base_path.clone();
    settings.listen.certificate = raw.certificate.clone().zip(raw.key.clone());
    Ok(settings)
}

/// The server's own folder: from the user, or the default.
pub(super) fn state(named: &cli::State, environment: &Environment) -> Result<PathBuf> {
    let locations = &environment.locations;
    let usual = || {
        let state = locations.state_home.clone();
        let state = state.or_else(|| Some(locations.home.as_ref()?.join(".local/state")));
        Some(state?.join("rafcon/server"))
    };
    let folder = named.folder.clone().or_else(usual);
    let folder = folder
        .context("no folder for the server's files: set HOME, or name a folder with --state")?;
    Ok(std::path::absolute(folder)?)
}

fn project(folder: &Path) -> Result<PathBuf> {
    let real = folder.canonicalize();
    let real = real.with_context(|| format!("the folder {} does not exist", folder.display()))?;
    if !real.is_dir() {
        bail!("{} is not a folder: name a folder with machines", folder.display());
    }
    Ok(real)
}

/// Prints the address of the server. A closed output does not stop the server.
fn greet(server: &Server) {
    let fingerprint = server.fingerprint().map(|fingerprint| {
        let port = server.address().port();
        format!("Other users log in at port {port}. The certificate's SHA-256 fingerprint is\n{fingerprint}\n")
    });
    let link = server.link();
    let fingerprint = fingerprint.unwrap_or_default();
    let text = format!("{link}\n{fingerprint}Ctrl-C ends the server; runs continue.\n");
    io::stdout().write_all(text.as_bytes()).unwrap_or_default();
    io::stdout().flush().unwrap_or_default();
}
