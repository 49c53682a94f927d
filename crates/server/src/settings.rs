//! Settings of a server, parsed by its program from the command line and the environment.

use crate::page_files::PageFiles;
use rafcon_protocol::api::{ListRequest, RobotAnswer, RobotMachines, RobotRequest, ValueFetch};
use rafcon_protocol::{CommandList, ContactPlan, ListedCommand};
use rafcon_supervisor::ProgramEnvironment;
use std::fmt;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Default port of a server.
pub const USUAL_PORT: u16 = 4747;

/// Configuration of a server.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Folders with machines. Requests may read and write only there.
    pub projects: Vec<PathBuf>,
    /// The server's own folder: token, users, certificate, drafts.
    pub state: PathBuf,
    /// The folder that contains one folder per run.
    pub runs: PathBuf,
    /// Library roots by name, which precede those of the configuration.
    pub libraries: Vec<(String, PathBuf)>,
    /// The reference's `config.yaml`, or a folder with it. `None`: the default location of the reference.
    pub config: Option<PathBuf>,
    /// The interpreter of runs. `None`: selected by [`rafcon_supervisor::Interpreter::choose`].
    pub python: Option<PathBuf>,
    /// Environment in which interpreter and extension are searched.
    pub environment: ProgramEnvironment,
    /// Silence of a holder of control after which another user may take over.
    pub control_silence: Duration,
    /// Looks up a variable of the environment, for paths in the configuration.
    pub variable: fn(&str) -> Option<String>,
    /// Reports a line to the operator of the server, usually an error outside a request. Never a secret.
    pub tell: fn(&str),
    /// Source of the page's files.
    pub page: PageFiles,
    /// Carries requests to the robots, if this is a station.
    pub robots: Option<Arc<dyn Robots>>,
    /// Address, names and limits of the listener.
    pub listen: Listen,
    /// Settings of tokens and passwords.
    pub access: Access,
}

/// Reason why a request to a robot was not accepted, as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotTaken {
    /// The station does not receive this robot.
    NotReceived(String),
    /// Too many requests wait for the robot.
    Full(String),
}

/// Reason why the machines of a robot are unknown, as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MachinesFault {
    /// The station does not receive this robot.
    NotReceived(String),
    /// The robot has sent no list.
    NotArrived(String),
}

/// Reason why the planned contacts with a robot are unavailable or not stored, as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ContactsFault {
    /// The station does not receive this robot.
    NotReceived(String),
    /// The file cannot be read or written.
    Storage(String),
}

/// Reason why the command list of a robot is unavailable, not stored or not released, as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CommandListFault {
    /// The station does not receive this robot.
    NotReceived(String),
    /// The file cannot be used, or the station does not answer.
    Unavailable(String),
    /// The list has changed since it was reviewed.
    Changed(String),
    /// The list is empty, or commands have faults. None was sent.
    Faulty(String),
}

/// Name of a stored value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunValue<'v> {
    /// Id of the run that the value belongs to.
    pub run: &'v str,
    /// Number of the value in the run's journal.
    pub number: u64,
}

/// Requests of a station's server to its robots.
pub trait Robots: fmt::Debug + Send + Sync {
    /// Requests a value of `length` bytes of a robot's run, with a limit of `budget` bytes to send. Returns `false` if impossible.
    fn fetch(&self, robot: &str, value: RunValue<'_>, length: u64, budget: u64) -> bool;

    /// Cancels the fetch of a value.
    fn cancel(&self, robot: &str, value: RunValue<'_>);

    /// Progress of the current or last fetch of a value.
    fn progress(&self, value: RunValue<'_>) -> Option<ValueFetch>;

    /// Sends a request to a robot, once for each id. `answered` receives the robot's answer, or is called once it is overdue.
    fn request(
        &self,
        robot: &str,
        request: RobotRequest,
        answered: Box<dyn FnOnce(RobotAnswer) + Send>,
    ) -> Result<(), NotTaken>;

    /// Names of the robots that the station receives.
    fn names(&self) -> Vec<String>;

    /// The machines in the projects of a robot, as its last list has them.
    fn machines(&self, robot: &str) -> Result<RobotMachines, MachinesFault>;

    /// The planned contacts with a robot.
    fn contacts(&self, robot: &str) -> Result<ContactPlan, ContactsFault>;

    /// Replaces the planned contacts with a robot; blocks until they are on the disk.
    fn set_contacts(&self, robot: &str, plan: ContactPlan) -> Result<(), ContactsFault>;

    /// The command list of a robot, with the state of each command; blocks until the station responds.
    fn command_list(&self, robot: &str) -> Result<CommandList, CommandListFault>;

    /// Replaces the command list of a robot; with a `revision`, only that revision. Blocks until the list is on the disk and the
    /// station responds.
    fn set_command_list(
        &self,
        robot: &str,
        commands: Vec<ListedCommand>,
        revision: Option<&str>,
    ) -> Result<CommandList, CommandListFault>;

    /// Releases the whole command list of a robot or none of it; blocks until the commands are queued.
    fn release_command_list(
        &self,
        robot: &str,
        request: &ListRequest,
    ) -> Result<CommandList, CommandListFault>;

    /// Cost of `bytes` bytes on the link to a robot: bytes, and the time in ms if the robot is in contact. `None` if it is not
    /// received here.
    fn cost(&self, robot: &str, bytes: u64) -> Option<(u64, Option<u64>)>;
}

/// Address, names and limits of a server's listener.
#[derive(Debug, Clone)]
pub struct Listen {
    /// Address and port; port 0 selects a free one.
    pub address: SocketAddr,
    /// Other names of this computer, besides its address. They are valid with every port.
    pub hosts: Vec<String>,
    /// Path of the server at a reverse proxy.
    pub base_path: BasePath,
    /// Reverse proxies whose headers about browsers are trusted.
    pub proxies: Vec<IpAddr>,
    /// Certificate and key as PEM files. `None`: the server makes its own where it needs one.
    pub certificate: Option<(PathBuf, PathBuf)>,
    /// Maximum number of connections.
    pub connections_max: usize,
    /// Time limit for the head of a request, TLS included: at 2 s of delay each way, that alone takes 10 s.
    pub head_patience: Duration,
    /// Maximum silence of a client within a body.
    pub body_patience: Duration,
    /// Time limit for a client that does not read the response.
    pub write_limit: Duration,
}

/// Path of the server at a reverse proxy: empty, or such as `/robot`, without a trailing slash.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BasePath(String);

impl BasePath {
    /// The maximum length in bytes.
    const MAX: usize = 200;

    /// Parses a text with or without slashes around it. `None` if it is not a valid path.
    pub fn parse(text: &str) -> Option<Self> {
        let path = text.strip_prefix('/').unwrap_or(text);
        let path = path.strip_suffix('/').unwrap_or(path);
        let is_sign = |sign: char| sign.is_ascii_alphanumeric() || "-_.~".contains(sign);
        let is_part =
            |part: &str| !part.is_empty() && !part.starts_with('.') && part.chars().all(is_sign);
        if path.is_empty() {
            return Some(Self::default());
        }
        let is_good = path.len() <= Self::MAX && path.split('/').all(is_part);
        is_good.then(|| Self(format!("/{path}")))
    }

    /// The path as text; empty for the root.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Settings of tokens and passwords.
#[derive(Debug, Clone)]
pub struct Access {
    /// True to keep the owner's token of the last start.
    pub keep_token: bool,
    /// Cost of hashing a password.
    pub cost: HashCost,
}

/// Cost of hashing a password: the parameters of argon2id.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HashCost {
    /// Memory per hash, in KiB.
    pub memory_kib: u32,
    /// Number of passes over the memory.
    pub passes: u32,
}

impl Settings {
    /// A server on the default port of the loopback, without projects.
    pub fn new(state: PathBuf, runs: PathBuf) -> Self {
        Self {
            projects: Vec::new(),
            state,
            runs,
            libraries: Vec::new(),
            config: None,
            python: None,
            environment: ProgramEnvironment::default(),
            control_silence: Duration::from_secs(30),
            variable: |_| None,
            tell: crate::log::say,
            page: PageFiles::default(),
            robots: None,
            listen: Listen::default(),
            access: Access::default(),
        }
    }
}

impl Default for Listen {
    fn default() -> Self {
        Self {
            address: SocketAddr::from((Ipv4Addr::LOCALHOST, USUAL_PORT)),
            hosts: Vec::new(),
            base_path: BasePath::default(),
            proxies: Vec::new(),
            certificate: None,
            connections_max: 1024,
            head_patience: Duration::from_secs(30),
            body_patience: Duration::from_secs(30),
            write_limit: Duration::from_mins(1),
        }
    }
}

impl Default for Access {
    fn default() -> Self {
        Self { keep_token: false, cost: HashCost::USUAL }
    }
}

impl HashCost {
    /// Cost of users' passwords: 19 MiB, two passes.
    pub const USUAL: Self = Self { memory_kib: 19 * 1024, passes: 2 };
}

#[cfg(test)]
mod tests {
    use super::BasePath;

    #[test]
    fn a_base_path_has_at_most_so_many_bytes() {
        let path = "a".repeat(BasePath::MAX);
        let parsed = BasePath::parse(&format!("/{path}/")).unwrap();
        assert_eq!(parsed.as_str(), format!("/{path}"));
        assert!(BasePath::parse(&format!("/{path}a")).is_none());
    }
}
