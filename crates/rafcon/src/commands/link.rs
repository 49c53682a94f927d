//! `rafcon pair`, and the threads of `rafcon serve --station` and `rafcon station` that carry runs over the link.

use super::serve::state;
use crate::cli::{self, LinkProfile};
use crate::environment::Environment;
use crate::failure::complain;
use anyhow::{Context as _, Result, bail};
use rafcon_link::Profile;
use rafcon_protocol::api::{Control, ControlMove};
use rafcon_relay::{
    Authority, Pairing, RobotSettings, StationSettings, Stopper, relay_robot, relay_station,
};
use rafcon_server::RunAuthority;
use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::net::{SocketAddr, ToSocketAddrs as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

/// Makes a pairing and prints it, or reads one.
pub(super) fn pair(raw: &cli::Pair, environment: &Environment) -> Result<ExitCode> {
    let folder = pairings_folder(&state(&raw.state, environment)?);
    let pairing = match &raw.robot {
        Some(robot) => Pairing::generate(robot).with_context(|| {
            format!("`{robot}` cannot name a robot: use 1 to 64 letters, digits, `.`, `-` and `_`")
        })?,
        None => io::read_to_string(io::stdin())?.parse()?,
    };
    fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let file = folder.join(&pairing.robot);
    let written = OpenOptions::new().write(true).create_new(true).mode(0o600).open(&file);
    let written = written.and_then(|mut file| writeln!(file, "{pairing}"));
    written.with_context(|| {
        let file = file.display();
        format!("cannot write {file}: to pair `{}` again, remove that file first", pairing.robot)
    })?;
    if raw.paste {
        writeln!(io::stdout(), "robot `{}` is paired with this station", pairing.robot)?;
    } else {
        writeln!(io::stdout(), "{pairing}")?;
        complain(
            "paste this line at the station after `rafcon pair --paste`; who has it can command the robot",
        );
    }
    Ok(ExitCode::SUCCESS)
}

/// Lets the robot's server decide who commands its runs, once it is there.
#[derive(Debug, Default)]
pub(super) struct ServerAuthority(OnceLock<RunAuthority>);

impl ServerAuthority {
    /// The server is there.
    pub(super) fn set(&self, authority: RunAuthority) {
        self.0.get_or_init(|| authority);
    }

    fn server(&self) -> Result<&RunAuthority, String> {
        let starting = "the robot's server is starting: repeat the command in a moment";
        self.0.get().ok_or_else(|| starting.to_owned())
    }
}

impl Authority for ServerAuthority {
    fn command(&self, run: &str, user: &str) -> Result<(), String> {
        self.server()?.command(run, user)
    }

    fn move_control(&self, run: &str, user: &str, wanted: &ControlMove) -> Result<(), String> {
        self.server()?.move_control(run, user, wanted)
    }

    fn present(&self, user: &str) {
        if let Ok(server) = self.server() {
            server.present(user);
        }
    }

    fn control(&self, run: &str) -> Option<Control> {
        self.server().ok()?.control(run)
    }
}

/// The threads that carry runs over the link while a server runs.
#[derive(Default)]
pub(super) struct Relays {
    stopper: Stopper,
    threads: Vec<JoinHandle<()>>,
}

impl Relays {
    /// Sends the runs in `runs` to the station that the options name, if they name one.
    pub(super) fn robot(
        &mut self,
        raw: &cli::Link,
        (state, runs): (&Path, &Path),
        authority: Arc<ServerAuthority>,
    ) -> Result<()> {
        let Some(station) = &raw.station else { return Ok(()) };
        let settings = RobotSettings {
            folder: robot_folder(state),
            runs: runs.to_owned(),
            pairing: robots_own(state, raw.robot.as_deref())?,
            station: address(station)?,
            bind: any_port(address(station)?),
            profile: profile(raw.profile),
            authority,
            tell: complain,
        };
        let stopper = self.stopper.clone();
        self.begin("link", move || relay_robot(&settings, &stopper))
    }

    /// Keeps replicas in `runs` of what robots send to this address.
    pub(super) fn station(
        &mut self,
        raw: &cli::Link,
        listen: SocketAddr,
        (state, runs): (&Path, &Path),
    ) -> Result<()> {
        let settings = StationSettings {
            folder: station_folder(state),
            runs: runs.to_owned(),
            pairings: pairings(state)?,
            bind: listen,
            profile: profile(raw.profile),
            tell: complain,
        };
        if settings.pairings.is_empty() {
            bail!(
                "this station is paired with no robot: run `rafcon pair NAME` on the robot and `rafcon pair --paste` here"
            );
        }
        let stopper = self.stopper.clone();
        let greet = |address| complain(&format!("robots are received at udp://{address}"));
        self.begin("link", move || relay_station(&settings, &stopper, greet))
    }

    fn begin(
        &mut self,
        name: &str,
        relay: impl FnOnce() -> Result<(), rafcon_relay::RelayError> + Send + 'static,
    ) -> Result<()> {
        let run = || {
            if let Err(error) = relay() {
                complain(&format!("the link has ended: {:#}", anyhow::Error::from(error)));
            }
        };
        self.threads.push(thread::Builder::new().name(name.to_owned()).spawn(run)?);
        Ok(())
    }

    /// Ends them.
    pub(super) fn stop(self) {
        self.stopper.stop();
        for thread in self.threads {
            // One that panicked has said so.
            thread.join().unwrap_or_default();
        }
    }
}

/// The folder of the robot's side of the link.
pub(super) fn robot_folder(state: &Path) -> PathBuf {
    state.join("link/robot")
}

/// The folder of the station's side of the links.
pub(super) fn station_folder(state: &Path) -> PathBuf {
    state.join("link/station")
}

fn pairings_folder(state: &Path) -> PathBuf {
    state.join("link/pairings")
}

fn pairings(state: &Path) -> Result<Vec<Pairing>> {
    let folder = pairings_folder(state);
    let files = match fs::read_dir(&folder) {
        Ok(files) => files,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(error).with_context(|| format!("cannot read {}", folder.display()));
        }
    };
    let mut files = files.map(|file| Ok(file?.path())).collect::<io::Result<Vec<_>>>()?;
    files.sort();
    let read = |file: &PathBuf| {
        let text = fs::read_to_string(file)?;
        text.parse().with_context(|| format!("cannot use {}", file.display()))
    };
    files.iter().map(read).collect()
}

/// The pairing with the station of this robot.
fn robots_own(state: &Path, name: Option<&str>) -> Result<Pairing> {
    let mut pairings = pairings(state)?;
    pairings.retain(|pairing| name.is_none_or(|name| pairing.robot == name));
    match (pairings.pop(), pairings.is_empty()) {
        (Some(pairing), true) => Ok(pairing),
        (None, _) => bail!(
            "this robot is not paired: run `rafcon pair NAME` here, and `rafcon pair --paste` at the station"
        ),
        (Some(_), false) => bail!("there are several pairings: choose one with `--robot NAME`"),
    }
}

fn address(text: &str) -> Result<SocketAddr> {
    let plain = text.strip_prefix("udp://").unwrap_or(text);
    let mut found = plain.to_socket_addrs().with_context(|| {
        format!("`{text}` is no address of a station: it looks like `udp://ground.example:4748`")
    })?;
    found.next().with_context(|| format!("`{text}` has no address"))
}

/// Any port of this computer, in the same kind of network.
fn any_port(station: SocketAddr) -> SocketAddr {
    match (station, station.ip().is_loopback()) {
        (SocketAddr::V4(_), true) => ([127, 0, 0, 1], 0).into(),
        (SocketAddr::V4(_), false) => ([0, 0, 0, 0], 0).into(),
        (SocketAddr::V6(_), _) => ([0_u16; 8], 0).into(),
    }
}

fn profile(raw: LinkProfile) -> Profile {
    match raw {
        LinkProfile::Lan => Profile::LAN,
        LinkProfile::Wifi => Profile::WIFI,
        LinkProfile::Delay2s => Profile::DELAY_2S,
        LinkProfile::Deep => Profile::DEEP,
    }
}
