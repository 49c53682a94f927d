//! The programs, each ended with what holds it.

use rcgen::{BasicConstraints, CertificateParams, IsCa, Issuer, KeyPair, KeyUsagePurpose};
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use tempfile::TempDir;
use tokio::runtime::Runtime;
use zenoh::{Config, Session};

/// Certificates of one authority.
pub(crate) struct Certificates {
    folder: TempDir,
}

impl Certificates {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut authority = CertificateParams::new(Vec::new()).unwrap();
        authority.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        authority.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
        let key = KeyPair::generate().unwrap();
        let own = authority.self_signed(&key).unwrap();
        fs::write(folder.path().join("ca.pem"), own.pem()).unwrap();
        let authority = Issuer::new(authority, key);
        let names = ["localhost".to_owned(), "127.0.0.1".to_owned()];
        let key = KeyPair::generate().unwrap();
        let made = CertificateParams::new(names).unwrap().signed_by(&key, &authority).unwrap();
        fs::write(folder.path().join("own.pem"), made.pem()).unwrap();
        fs::write(folder.path().join("key.pem"), key.serialize_pem()).unwrap();
        Self { folder }
    }

    /// The part of a configuration of someone who trusts this authority, and shows the certificate of another one.
    fn config(&self, shown: &Self) -> String {
        let file = |of: &Self, name: &str| format!("{:?}", of.folder.path().join(name));
        let ca = file(self, "ca.pem");
        let (own, key) = (file(shown, "own.pem"), file(shown, "key.pem"));
        format!(
            "transport: {{ link: {{ tls: {{ enable_mtls: true, root_ca_certificate: {ca},
              listen_certificate: {own}, listen_private_key: {key},
              connect_certificate: {own}, connect_private_key: {key} }} }} }},"
        )
    }
}

/// Zenoh's own router, in this process.
pub(crate) struct Network {
    endpoint: String,
    /// For clients.
    config: String,
    _router: Session,
    _runtime: Runtime,
}

impl Network {
    pub(crate) fn with_tls(certificates: &Certificates) -> Self {
        Self::new("tls/localhost:0", &certificates.config(certificates))
    }

    pub(crate) fn open() -> Self {
        Self::new("tcp/127.0.0.1:0", "")
    }

    fn new(listen: &str, more: &str) -> Self {
        let runtime = Runtime::new().unwrap();
        let config = format!(
            "{{ mode: \"router\", listen: {{ endpoints: [{listen:?}] }}, {more}
              scouting: {{ multicast: {{ enabled: false }} }} }}"
        );
        let open = async {
            let router = zenoh::open(Config::from_json5(&config).unwrap()).await.unwrap();
            let locator = router.info().locators().await.remove(0);
            (router, locator)
        };
        let (router, locator) = runtime.block_on(open);
        // A certificate is for a name.
        let port = locator.address().to_string().rsplit_once(':').unwrap().1.to_owned();
        let endpoint = format!("{}:{port}", listen.rsplit_once(':').unwrap().0);
        let config = client(&endpoint, more);
        Self { endpoint, config, _router: router, _runtime: runtime }
    }

    /// The configuration of a client that trusts this authority, and shows the certificate of another one.
    pub(crate) fn config_with(&self, trusted: &Certificates, shown: &Certificates) -> String {
        client(&self.endpoint, &trusted.config(shown))
    }
}

fn client(endpoint: &str, more: &str) -> String {
    format!(
        "{{ mode: \"client\", connect: {{ endpoints: [{endpoint:?}] }}, {more}
          scouting: {{ multicast: {{ enabled: false }} }} }}"
    )
}

/// A program that is killed when it is dropped.
pub(crate) struct Program {
    child: Child,
    first_line: String,
}

impl Program {
    fn start(mut command: Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut says = BufReader::new(child.stdout.take().unwrap());
        let mut first_line = String::new();
        says.read_line(&mut first_line).unwrap();
        thread::Builder::new().spawn(move || says.lines().for_each(drop)).unwrap();
        Self { child, first_line }
    }

    /// The address that its first line ends with.
    pub(crate) fn says(&self) -> &str {
        self.first_line.trim().rsplit_once(' ').unwrap().1
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        self.child.kill().unwrap_or_default();
        self.child.wait().unwrap();
    }
}

/// A robot with a mission and its station, in one folder.
pub(crate) struct Mission {
    folder: TempDir,
    station: u16,
    robot: std::sync::Mutex<Vec<Program>>,
    _station: Program,
}

fn from_xtask(name: &str) -> PathBuf {
    let found = std::env::var_os(name);
    found.unwrap_or_else(|| panic!("{name} is not set: run `cargo xtask zenoh`")).into()
}

impl Mission {
    pub(crate) fn new(network: &Network) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("zenoh.json5"), &network.config).unwrap();
        let rafcon = |words: &str| rafcon(&folder, words);
        assert!(rafcon("new machine --template mission --states 300").status().unwrap().success());
        let pairing = rafcon("pair scout --state robot").output().unwrap().stdout;
        let mut paste =
            rafcon("pair --paste --state ground").stdin(Stdio::piped()).spawn().unwrap();
        paste.stdin.take().unwrap().write_all(&pairing).unwrap();
        assert!(paste.wait().unwrap().success());
        let words = "station --state ground --runs ground-runs --bind 127.0.0.1:0 --listen 127.0.0.1:0 --link wifi";
        let mut station = rafcon(words);
        let mut child = station.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
        let address = lines.find_map(|line| Some(line.split_once("udp://")?.1.to_owned()));
        let port = address.unwrap().rsplit_once(':').unwrap().1.parse().unwrap();
        thread::Builder::new().spawn(move || lines.for_each(drop)).unwrap();
        let _station = Program { child, first_line: String::new() };
        Self { folder, station: port, robot: std::sync::Mutex::default(), _station }
    }

    fn zenoh(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rafcon-zenoh"));
        command.args(["--config", "zenoh.json5"]).args(words.split_whitespace());
        command.current_dir(self.folder.path()).stderr(Stdio::null());
        command
    }

    pub(crate) fn zenoh_station(&self) -> Program {
        Program::start(self.zenoh(&format!("station --to 127.0.0.1:{}", self.station)))
    }

    pub(crate) fn zenoh_robot(&self) -> Program {
        let robot = Program::start(self.zenoh("robot scout --listen 127.0.0.1:0"));
        let address = robot.says().trim_start_matches("udp://");
        fs::write(self.folder.path().join("address"), address).unwrap();
        robot
    }

    /// Another at the same address.
    pub(crate) fn zenoh_robot_at(&self) -> Program {
        let address = fs::read_to_string(self.folder.path().join("address")).unwrap();
        Program::start(self.zenoh(&format!("robot scout --listen {address}")))
    }

    /// The robot serves and runs its mission.
    pub(crate) fn begin(&self, station: &str) {
        let serve = format!(
            "serve --state robot --runs robot-runs --bind 127.0.0.1:0 --station {station} --link wifi"
        );
        let mut serve = rafcon(&self.folder, &serve);
        serve.stderr(Stdio::null());
        let mut run = rafcon(&self.folder, "run machine --runs robot-runs --output json");
        run.stderr(Stdio::null());
        let mut robot = self.robot.lock().unwrap();
        robot.extend([Program::start(serve), Program::start(run)]);
    }

    pub(crate) fn wait_at_station(&self, words: &str) {
        let runs = || rafcon(&self.folder, "runs --runs ground-runs").output().unwrap().stdout;
        while !String::from_utf8(runs()).unwrap().contains(words) {
            thread::yield_now();
        }
    }

    pub(crate) fn tell(&self, command: &str) -> String {
        text(
            &rafcon(&self.folder, &format!("tell last {command} --runs ground-runs"))
                .output()
                .unwrap(),
        )
    }

    pub(crate) fn history(&self, runs: &str) -> String {
        let words = format!("history last --json --values --runs {runs}");
        text(&rafcon(&self.folder, &words).output().unwrap())
    }

    /// Waits until the robot is in the network.
    pub(crate) fn wait_listed(&self) {
        while self.list() != "scout\n" {
            thread::yield_now();
        }
    }

    pub(crate) fn list(&self) -> String {
        text(&self.zenoh("list").output().unwrap())
    }

    /// What a client with another configuration sees.
    pub(crate) fn list_with(&self, config: &str) -> String {
        fs::write(self.folder.path().join("other.json5"), config).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_rafcon-zenoh"));
        command.args(["--config", "other.json5", "list"]).current_dir(self.folder.path());
        let output = command.output().unwrap();
        assert!(!output.status.success());
        text(&output)
    }
}

fn rafcon(folder: &TempDir, words: &str) -> Command {
    let mut command = Command::new(from_xtask("RAFCON_BINARY"));
    command.args(words.split_whitespace()).current_dir(folder.path()).env("HOME", folder.path());
    command.env("PYTHONDONTWRITEBYTECODE", "1").stdin(Stdio::null());
    for name in ["RAFCON_RUNS", "XDG_STATE_HOME", "RAFCON_STATE", "VIRTUAL_ENV"] {
        command.env_remove(name);
    }
    command
}

fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A peer of the network that no one invited: `eclipse-zenoh`, as PyPI has it.
pub(crate) struct Stranger {
    child: Child,
}

/// What it did.
#[derive(Debug)]
pub(crate) struct Saw {
    /// Payloads from and to the robot.
    pub(crate) down: u64,
    pub(crate) up: u64,
    /// In so many of them it found a word of the mission.
    pub(crate) readable: u64,
    /// So many it sent itself.
    pub(crate) forged: u64,
}

impl Stranger {
    pub(crate) fn at(network: &Network) -> Self {
        let mut command = Command::new(from_xtask("RAFCON_ZENOH_PYTHON"));
        command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/stranger.py"));
        command.arg(&network.config).stdin(Stdio::piped()).stdout(Stdio::piped());
        Self { child: command.spawn().unwrap() }
    }

    pub(crate) fn end(mut self) -> Saw {
        drop(self.child.stdin.take());
        let said = text(&self.child.wait_with_output().unwrap());
        let said: serde_json::Value = serde_json::from_str(&said).unwrap();
        let number = |name: &str| said[name].as_u64().unwrap();
        Saw {
            down: number("down"),
            up: number("up"),
            readable: number("readable"),
            forged: number("forged"),
        }
    }
}
