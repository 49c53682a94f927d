//! `rafcon pair`, and the threads of `rafcon serve --station` and `rafcon station` that carry runs over the link.

use super::serve::state;
use super::station_address::{StationTls, station_address};
use crate::cli::{self, LinkProfile};
use crate::environment::Environment;
use crate::failure::complain;
use anyhow::{Context as _, Result, bail};
use rafcon_link::Profile;
use rafcon_protocol::api::{
    Control, ControlMove, ListRequest, ResumeRequest, Right, RobotAnswer, RobotMachines,
    RobotRequest, StartRequest, ValueFetch,
};
use rafcon_protocol::{Command, CommandList, ContactPlan, ListedCommand};
use rafcon_relay::{
    Answered, Authority, CommandListError, CommandListFileError, CommandListStore, ContactStore,
    ContactsNotSet, MachineLists, MachinesUnknown, Paired, Pairing, PairingList, PairingRights,
    Projects, RequestBroker, RobotSettings, StationSettings, Stopper, ValueCost, ValueFetchBroker,
    relay_robot, relay_station,
};
use rafcon_server::{
    CommandListFault, ContactsFault, MachinesFault, NotTaken, Robots, RunAuthority, RunValue,
    Settings,
};
use std::fs::{self, OpenOptions};
use std::io::{self, IsTerminal as _, Write as _};
use std::net::SocketAddr;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

/// Makes and prints a pairing, or reads one.
pub(super) fn pair(raw: &cli::Pair, environment: &Environment) -> Result<ExitCode> {
    let state = state(&raw.state, environment)?;
    let folder = pairings_folder(&state);
    if raw.renew {
        return renew(raw, &state);
    }
    let pairing = match &raw.robot {
        Some(robot) => Pairing::generate(robot, raw.station.as_deref()).with_context(|| {
            let what = match &raw.station {
                Some(station) => format!("`{robot}` and `{station}` cannot name a robot and a station"),
                None => format!("`{robot}` cannot name a robot"),
            };
            format!("{what}: use 1 to 64 letters, digits, `.`, `-` and `_`; no station is called `robot`")
        })?,
        None => pasted()?.parse()?,
    };
    let rights = if raw.paste { pairing.rights } else { raw.rights };
    let pairing = Pairing { rights, ..pairing };
    fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let file = match &pairing.station {
        // At a station, a robot has one name.
        Some(station) if !raw.paste => folder.join(format!("{}@{station}", pairing.robot)),
        _ => folder.join(&pairing.robot),
    };
    let written = OpenOptions::new().write(true).create_new(true).mode(0o600).open(&file);
    if let (Ok(_), Some(name)) = (&written, file.file_name()) {
        // Keys from an earlier pairing are void.
        for new in ["offered", "taken"] {
            drop(fs::remove_file(state.join("link/new-keys").join(new).join(name)));
        }
    }
    let written = written.and_then(|mut file| writeln!(file, "{pairing}"));
    written.with_context(|| {
        let file = file.display();
        format!("cannot write {file}: to pair `{}` again, remove that file first", pairing.robot)
    })?;
    if raw.paste {
        writeln!(io::stdout(), "robot `{}` is paired with this station", pairing.robot)?;
    } else {
        writeln!(io::stdout(), "{pairing}")?;
        let allowed = match rights {
            PairingRights::Observe => "can see its runs",
            PairingRights::Command => "can command the robot",
            PairingRights::Change => "can run any code on the robot",
        };
        complain(&format!(
            "paste this line at the station after `rafcon pair --paste`; anyone who has it {allowed}"
        ));
    }
    Ok(ExitCode::SUCCESS)
}

/// Makes a new key, which the robot's server offers to the station.
fn renew(raw: &cli::Pair, state: &Path) -> Result<ExitCode> {
    let paired = robots_own(state, raw.robot.as_deref(), raw.station.as_deref())?;
    if !robot_folder(state, paired.pairing.station.as_deref()).is_dir() {
        bail!("the server of this robot has never run here: keys are renewed on the robot");
    }
    if paired.next.exists() {
        bail!(
            "a new key is offered already: `rafcon link` says whether the station uses it; to take the offer back, end the server \
             and remove {}",
            paired.next.display()
        );
    }
    let next = paired.pairing.renewed().context("the system gives no random numbers")?;
    paired.keep_next(&next)?;
    writeln!(
        io::stdout(),
        "a new key is offered to the station; both sides use the one they have until the station uses the new one"
    )?;
    Ok(ExitCode::SUCCESS)
}

/// The pasted or piped line.
fn pasted() -> Result<String> {
    if io::stdin().is_terminal() {
        complain("paste the line that `rafcon pair NAME` printed on the robot, and press Enter:");
    }
    let mut lines =
        io::stdin().lines().skip_while(|line| line.as_ref().is_ok_and(String::is_empty));
    Ok(lines.next().transpose()?.unwrap_or_default())
}

/// Lets the robot's server decide who may command its runs, once it has started.
#[derive(Debug, Default)]
pub(super) struct ServerAuthority(OnceLock<RunAuthority>);

impl ServerAuthority {
    /// Connects the server after its start.
    pub(super) fn set(&self, authority: RunAuthority) {
        self.0.get_or_init(|| authority);
    }

    fn server(&self) -> Result<&RunAuthority, String> {
        let starting = "the robot's server is starting: repeat the command in a moment";
        self.0.get().ok_or_else(|| starting.to_owned())
    }
}

fn unknown(reason: String) -> RobotAnswer {
    RobotAnswer::Unknown { reason }
}

impl Authority for ServerAuthority {
    fn command(&self, run: &str, user: &str, id: &str, epoch: u64) -> Result<(), String> {
        self.server()?.command(run, user, id, epoch)
    }

    fn refused(&self, run: &str, id: &str) {
        if let Ok(server) = self.server() {
            server.refused(run, id);
        }
    }

    fn right_of(&self, command: &Command) -> Right {
        RunAuthority::right_of(command)
    }

    fn move_control(&self, run: &str, user: &str, wanted: &ControlMove) -> Result<(), String> {
        self.server()?.move_control(run, user, wanted)
    }

    fn is_ready(&self) -> bool {
        self.server().is_ok_and(RunAuthority::is_ready)
    }

    fn resume(&self, request: ResumeRequest, answered: Answered) -> Result<(), String> {
        self.server()?.resume(request, answered)
    }

    fn fate_of_resume(&self, run: &str, user: &str, id: &str) -> RobotAnswer {
        self.server().map_or_else(unknown, |server| server.fate_of_resume(run, user, id))
    }

    fn start(&self, request: StartRequest, answered: Answered) -> Result<(), String> {
        self.server()?.start(request, answered)
    }

    fn fate_of_start(&self, user: &str, id: &str) -> RobotAnswer {
        self.server().map_or_else(unknown, |server| server.fate_of_start(user, id))
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

/// Forwards requests of the station's server for its robots to the station.
#[derive(Debug, Clone)]
pub(super) struct StationBroker {
    values: ValueFetchBroker,
    requests: RequestBroker,
    contacts: ContactStore,
    lists: CommandListStore,
    machines: MachineLists,
}

impl Default for StationBroker {
    fn default() -> Self {
        Self {
            values: ValueFetchBroker::default(),
            requests: RequestBroker::default(),
            contacts: ContactStore::default(),
            lists: CommandListStore::new(RunAuthority::right_of),
            machines: MachineLists::default(),
        }
    }
}

#[expect(clippy::needless_pass_by_value, reason = "it maps the error of a result")]
fn list_fault(why: CommandListError) -> CommandListFault {
    let words = why.to_string();
    match why {
        CommandListError::NotReceived => CommandListFault::NotReceived(words),
        CommandListError::Stale | CommandListError::File(CommandListFileError::Changed) => {
            CommandListFault::Changed(words)
        }
        CommandListError::Empty | CommandListError::Faults(_) => CommandListFault::Faulty(words),
        CommandListError::File(_)
        | CommandListError::Busy
        | CommandListError::NoAnswer
        | CommandListError::Lost
        | CommandListError::NotMarked(_)
        | CommandListError::StaysMarked(_) => CommandListFault::Unavailable(words),
    }
}

impl Robots for StationBroker {
    fn fetch(&self, robot: &str, value: RunValue<'_>, length: u64, budget: u64) -> bool {
        self.values.fetch(robot, (value.run.to_owned(), value.number), length, budget)
    }

    fn cancel(&self, robot: &str, value: RunValue<'_>) {
        self.values.cancel(robot, (value.run.to_owned(), value.number));
    }

    fn progress(&self, value: RunValue<'_>) -> Option<ValueFetch> {
        self.values.progress(value.run, value.number)
    }

    fn cost(&self, robot: &str, bytes: u64) -> Option<(u64, Option<u64>)> {
        let ValueCost { link_bytes, takes_ms } = self.values.cost(robot, bytes)?;
        Some((link_bytes, takes_ms))
    }

    fn request(
        &self,
        robot: &str,
        request: RobotRequest,
        answered: Answered,
    ) -> Result<(), NotTaken> {
        self.requests.ask(robot, request, answered).map_err(|why| match why {
            rafcon_relay::NotTaken::NotReceived => NotTaken::NotReceived(why.to_string()),
            rafcon_relay::NotTaken::Full => NotTaken::Full(why.to_string()),
        })
    }

    fn names(&self) -> Vec<String> {
        self.machines.robots()
    }

    fn machines(&self, robot: &str) -> Result<RobotMachines, MachinesFault> {
        self.machines.of(robot).map_err(|why| match why {
            MachinesUnknown::NotReceived => MachinesFault::NotReceived(why.to_string()),
            MachinesUnknown::NotArrived => MachinesFault::NotArrived(why.to_string()),
        })
    }

    fn contacts(&self, robot: &str) -> Result<ContactPlan, ContactsFault> {
        let known = self.contacts.known(robot).ok_or(ContactsNotSet::NotReceived);
        let known = known.map_err(|why| ContactsFault::NotReceived(why.to_string()))?;
        match known.problem {
            Some(problem) => Err(ContactsFault::Storage(problem)),
            None => Ok(ContactPlan::clone(&known.plan)),
        }
    }

    fn set_contacts(&self, robot: &str, plan: ContactPlan) -> Result<(), ContactsFault> {
        self.contacts.set(robot, plan).map_err(|why| match why {
            ContactsNotSet::NotReceived => ContactsFault::NotReceived(why.to_string()),
            ContactsNotSet::Disk(_) => ContactsFault::Storage(why.to_string()),
        })
    }

    fn command_list(&self, robot: &str) -> Result<CommandList, CommandListFault> {
        self.lists.list(robot).map_err(list_fault)
    }

    fn set_command_list(
        &self,
        robot: &str,
        commands: Vec<ListedCommand>,
        revision: Option<&str>,
    ) -> Result<CommandList, CommandListFault> {
        self.lists.set(robot, commands, revision).map_err(list_fault)
    }

    fn release_command_list(
        &self,
        robot: &str,
        request: &ListRequest,
    ) -> Result<CommandList, CommandListFault> {
        self.lists.release(robot, request).map_err(list_fault)
    }
}

/// Folders of a robot that sends its runs to stations.
pub(super) struct RobotFolders<'f> {
    /// State of the server, with the pairings.
    pub(super) state: &'f Path,
    /// The runs to send.
    pub(super) runs: &'f Path,
    /// The machines that a station can request.
    pub(super) projects: &'f Projects,
}

/// The threads that carry runs over the link while a server runs.
#[derive(Default)]
pub(super) struct Relays {
    stopper: Stopper,
    threads: Vec<JoinHandle<()>>,
}

impl Relays {
    /// Sends the runs of this robot to the stations that the options name, to each over a link of its own.
    pub(super) fn robot(
        &mut self,
        raw: &cli::Link,
        folders: &RobotFolders<'_>,
        authority: &Arc<ServerAuthority>,
        environment: &Environment,
    ) -> Result<()> {
        let RobotFolders { state, runs, projects } = *folders;
        let mut all: Vec<RobotSettings> = Vec::new();
        let mut fingerprints = raw.station_fingerprints.iter();
        for spoken in &raw.stations {
            let (name, station) = spoken
                .split_once('=')
                .map_or((None, spoken.as_str()), |(name, station)| (Some(name), station));
            let paired = robots_own(state, raw.robot.as_deref(), name)?;
            let pairing = &paired.pairing;
            if let Some(other) = all.iter().find(|other| other.paired.pairing.key == pairing.key) {
                bail!(
                    "two stations would share the pairing of `{}`: make another one with `rafcon pair {} --station NAME`, and name \
                     it with `--station NAME=ADDRESS`",
                    other.paired.pairing.robot,
                    pairing.robot
                );
            }
            all.push(RobotSettings {
                folder: robot_folder(state, pairing.station.as_deref()),
                runs: runs.to_owned(),
                projects: projects.clone(),
                paired,
                station: station_address(station, &mut fingerprints, environment)?,
                profile: profile(raw.profile),
                authority: Arc::clone(authority) as Arc<dyn Authority>,
                tell: complain,
            });
        }
        if let Some(text) = fingerprints.next() {
            bail!("--station-fingerprint {text}: there is no station at `wss://` for it");
        }
        for settings in all {
            let stopper = self.stopper.clone();
            let name = settings.paired.pairing.station.clone();
            let name = name.map_or_else(|| "link".to_owned(), |name| format!("link to {name}"));
            self.begin(&name, move || relay_robot(&settings, &stopper))?;
        }
        Ok(())
    }

    /// Keeps replicas of what robots send to this address. The station shows the certificate of its server.
    pub(super) fn station(
        &mut self,
        raw: &cli::Link,
        listen: SocketAddr,
        server: &Settings,
        broker: &StationBroker,
    ) -> Result<()> {
        let (state, runs) = (&server.state, &server.runs);
        let (tls, fingerprint) = rafcon_server::tls_config(server)?;
        if pairings(state, "taken")?.is_empty() {
            bail!(
                "this station is paired with no robot: run `rafcon pair NAME` on the robot and `rafcon pair --paste` here"
            );
        }
        let settings = StationSettings {
            folder: station_folder(state),
            runs: runs.to_owned(),
            pairings: Arc::new(TakenPairings(state.to_owned())),
            bind: listen,
            tls: Some(Arc::new(StationTls(tls))),
            profile: profile(raw.profile),
            value_fetches: broker.values.clone(),
            server_requests: broker.requests.clone(),
            contacts: broker.contacts.clone(),
            lists: broker.lists.clone(),
            machines: broker.machines.clone(),
            tell: complain,
        };
        let stopper = self.stopper.clone();
        let greet = move |address| {
            complain(&format!("robots are received at udp://{address}"));
            complain(&format!(
                "where UDP is closed: wss://{address}, whose certificate has the SHA-256 fingerprint {fingerprint}"
            ));
        };
        self.begin("link", move || relay_station(&settings, &stopper, greet))
    }

    fn begin(
        &mut self,
        name: &str,
        relay: impl FnOnce() -> Result<(), rafcon_relay::RelayError> + Send + 'static,
    ) -> Result<()> {
        let link = name.to_owned();
        let run = move || {
            if let Err(error) = relay() {
                complain(&format!("the {link} has ended: {:#}", anyhow::Error::from(error)));
            }
        };
        self.threads.push(thread::Builder::new().name(name.to_owned()).spawn(run)?);
        Ok(())
    }

    /// Stops all threads, and waits for them.
    pub(super) fn stop(self) {
        self.stopper.stop();
        for thread in self.threads {
            // A panicked thread has already reported its error.
            thread.join().unwrap_or_default();
        }
    }
}

/// The folder of the robot's side of the link to this station.
fn robot_folder(state: &Path, station: Option<&str>) -> PathBuf {
    let link = state.join("link");
    station.map_or_else(|| link.join("robot"), |station| link.join(format!("robot@{station}")))
}

/// The folders of the robot's side of all its links.
pub(super) fn robot_folders(state: &Path) -> Vec<PathBuf> {
    let all = fs::read_dir(state.join("link")).into_iter().flatten().flatten();
    let is_robots = |name: &str| name == "robot" || name.starts_with("robot@");
    let robots = all.filter(|entry| entry.file_name().to_str().is_some_and(is_robots));
    let mut folders: Vec<_> = robots.map(|entry| entry.path()).collect();
    folders.sort();
    folders
}

/// The folder of the station's side of the links.
pub(super) fn station_folder(state: &Path) -> PathBuf {
    state.join("link/station")
}

fn pairings_folder(state: &Path) -> PathBuf {
    state.join("link/pairings")
}

/// The pairings in the state folder of a station.
#[derive(Debug)]
struct TakenPairings(PathBuf);

impl PairingList for TakenPairings {
    fn read(&self) -> Result<Vec<Paired>, String> {
        pairings(&self.0, "taken").map_err(|error| format!("{error:#}"))
    }
}

/// The folder of a robot that is paired with the station of this state.
pub(super) fn folder_of_robot(state: &Path, robot: &str) -> Result<PathBuf> {
    let paired = pairings(state, "taken")?;
    if !paired.iter().any(|it| it.pairing.robot == robot) {
        bail!(
            "no robot `{robot}` is paired with this station: run `rafcon pair --paste` here, or name the server of the station with \
             --server"
        );
    }
    Ok(station_folder(state).join(robot))
}

/// All pairings, with the files for new keys that a robot has `offered`, or a station `taken`.
fn pairings(state: &Path, new: &str) -> Result<Vec<Paired>> {
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
    let next = state.join("link/new-keys").join(new);
    let read = |file: PathBuf| {
        let text = fs::read_to_string(&file)?;
        let pairing = text.parse::<Pairing>();
        if is_leftover(&file, pairing.as_ref().ok()) {
            return Ok(None);
        }
        let pairing = pairing.with_context(|| format!("cannot use {}", file.display()))?;
        let next = next.join(file.file_name().unwrap_or_default());
        Ok(Some(Paired { pairing, file, next }))
    };
    files.into_iter().filter_map(|file| read(file).transpose()).collect()
}

/// True for a leftover of an interrupted change of keys: a temporary file that is not the pairing's own.
fn is_leftover(file: &Path, pairing: Option<&Pairing>) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let is_its_own = |Pairing { robot, station, .. }: &Pairing| {
        let own = name.strip_prefix(robot.as_str());
        own.is_some_and(|rest| {
            rest.is_empty()
                || rest.strip_prefix('@').is_some_and(|at| Some(at) == station.as_deref())
        })
    };
    name.ends_with(".new") && !pairing.is_some_and(is_its_own)
}

/// The pairing of this robot with the station of this name, or with its only one.
fn robots_own(state: &Path, robot: Option<&str>, station: Option<&str>) -> Result<Paired> {
    let mut all = pairings(state, "offered")?;
    all.retain(|it| robot.is_none_or(|name| it.pairing.robot == name));
    if station.is_some() || all.iter().any(|it| it.pairing.station.is_none()) {
        all.retain(|it| it.pairing.station.as_deref() == station);
    }
    match (all.pop(), all.is_empty(), station) {
        (Some(paired), true, _) => Ok(paired),
        (None, _, None) => bail!(
            "this robot is not paired: run `rafcon pair NAME` here, and `rafcon pair --paste` at the station"
        ),
        (None, _, Some(station)) => bail!(
            "this robot is not paired with a station `{station}`: run `rafcon pair NAME --station {station}` here, and `rafcon \
             pair --paste` there"
        ),
        (Some(_), false, _) => bail!(
            "there are several pairings: choose one with `--robot NAME`, or name the station with `--station NAME=ADDRESS`"
        ),
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
