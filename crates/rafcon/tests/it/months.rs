//! Months of use of one server, a day at a time: runs start and end, people come and go, machines are edited and saved, and
//! once a week the disk fills. Memory, descriptors, threads and disk stay flat.

use crate::harness::{self, Place};
use crate::served::{Door, Line, Served};
use crate::torture::number;
use rafcon_protocol::api::RunPhase;
use rafcon_protocol::socket::{ToClient, ToServer, Topic};
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::fs;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The number of days; `cargo xtask soak --months` sets it.
const DAYS: &str = "RAFCON_TEST_DAYS";
/// The number of runs of a day.
const RUNS: &str = "RAFCON_TEST_RUNS";
/// Runs that a night's clean-up keeps.
const KEPT: u32 = 5;
/// Edits of a day.
const EDITS: usize = 5;
/// Size of the disk of runs and state.
const DISK_MB: u32 = 768;
/// Days before the server has reached its usual size.
const WARM_UP: u64 = 3;

/// What a server uses at the end of a day.
#[derive(Debug, Clone, Copy)]
struct Usage {
    memory_kb: u64,
    descriptors: u64,
    threads: u64,
    disk_kb: u64,
}

/// Growth over the days after the warm-up that is not a leak: noise of allocator and kernel.
const NOISE: Usage =
    Usage { memory_kb: 24 * 1024, descriptors: 16, threads: 12, disk_kb: 24 * 1024 };

/// Scripts of a day in turn: one succeeds, one raises, one waits until it is stopped.
const SCRIPTS: [(&str, &str); 3] = [
    (
        "short",
        "def execute(self, inputs, outputs, gvm):\n    print('done')\n    return 'success'\n",
    ),
    ("fails", "def execute(self, inputs, outputs, gvm):\n    raise ValueError('no grip')\n"),
    (
        "waits",
        "def execute(self, inputs, outputs, gvm):\n    self.preemptive_wait()\n    return 'success'\n",
    ),
];

/// A server whose runs and state lie on a small disk of their own.
struct Site {
    place: Place,
    served: Served,
    project: String,
    file: Value,
}

impl Site {
    fn new() -> Self {
        let place = Place::empty();
        for (name, script) in SCRIPTS {
            let machine = notation::parse(&harness::one_script(script)).unwrap();
            save(&machine, &place.path("project").join(name), None, Naming::default()).unwrap();
        }
        fs::create_dir(place.path("disk")).unwrap();
        let served = Served::start(on_small_disk(&place)).unwrap();
        let projects = served.door().ask("GET", "/api/v1/projects", None).unwrap();
        let project = projects[0]["id"].as_str().unwrap().to_owned();
        let file = json!({ "file": { "project": project, "path": "short" } });
        Self { place, served, project, file }
    }

    fn ask(&self, method: &str, path: &str, body: Option<&Value>) -> Value {
        self.served.door().ask(method, &format!("/api/v1{path}"), body).unwrap()
    }

    /// A path as the server sees it: its disk is not mounted here.
    fn inside(&self, name: &str) -> PathBuf {
        let path = self.place.path(name);
        Path::new("/proc")
            .join(self.served.pid().to_string())
            .join("root")
            .join(path.strip_prefix("/").unwrap())
    }

    fn start(&self, id: &str, machine: &str) -> Result<String, String> {
        let start = json!({ "id": id, "machine": { "project": self.project, "path": machine } });
        let (status, text) =
            self.served.door().answer("POST", "/api/v1/runs", Some(&start)).unwrap();
        let answer: Value = serde_json::from_str(&text).unwrap();
        let run = answer["id"].as_str().filter(|_| (200..300).contains(&status));
        run.map(str::to_owned).ok_or(text)
    }

    /// A run with two viewers: one leaves at once, the other stays to the end.
    fn run(&self, id: &str, machine: &str) -> String {
        let run = self.start(id, machine).unwrap();
        drop(subscribed(self.served.door(), &run));
        let viewer = subscribed(self.served.door(), &run);
        if machine == "waits" {
            let command = json!({ "id": "stop", "command": { "type": "stop" } });
            self.ask("POST", &format!("/runs/{run}/commands"), Some(&command));
        }
        read_to_the_end(viewer);
        run
    }

    /// Reads an ended run in the ways that the page does.
    fn look_back(&self, run: &str) {
        for part in ["events?values=true", "log", "machine", "statistics", "moments", "output"] {
            self.ask("GET", &format!("/runs/{run}/{part}"), None);
        }
    }

    /// Opens a machine, edits it, saves and closes it.
    fn edit(&self, day: u64) {
        let opened = self.ask("POST", "/machines/open", Some(&self.file));
        let machine = format!("/machines/{}", opened["id"].as_str().unwrap());
        for number in 0..EDITS {
            let edit = json!({ "edit": "set_description", "path": "LONELY", "description": format!("day {day}, {number}") });
            let edit = json!({ "id": format!("{day} {number}"), "name": "Describe", "edit": edit });
            self.ask("POST", &format!("{machine}/edits"), Some(&edit));
        }
        self.ask("POST", &format!("{machine}/save"), Some(&json!({})));
        self.ask("POST", &format!("{machine}/close"), Some(&json!({})));
    }

    /// The disk is full and a run is refused or ends; then there is room again and a run succeeds.
    fn fill_disk(&self, day: u64) {
        let ballast = self.inside("disk/ballast");
        let mut file = fs::File::create(&ballast).unwrap();
        let block = vec![0; 1 << 20];
        let error =
            std::iter::repeat_with(|| file.write_all(&block)).find_map(Result::err).unwrap();
        assert_eq!(error.kind(), ErrorKind::StorageFull, "{error}");
        let refused = self.start(&format!("full {day}"), "short");
        assert!(refused.is_err(), "a run was started on a full disk: {refused:?}");
        self.ask("GET", "/status", None);
        drop(file);
        fs::remove_file(ballast).unwrap();
        self.run(&format!("room {day}"), "short");
    }

    fn usage(&self) -> Usage {
        let process = Path::new("/proc").join(self.served.pid().to_string());
        let status = fs::read_to_string(process.join("status")).unwrap();
        let figure = |name: &str| -> u64 {
            let line = status.lines().find_map(|line| line.strip_prefix(name)).unwrap();
            line.split_whitespace().next().unwrap().parse().unwrap()
        };
        let descriptors = fs::read_dir(process.join("fd")).unwrap().count();
        Usage {
            memory_kb: figure("VmRSS:"),
            descriptors: u64::try_from(descriptors).unwrap(),
            threads: figure("Threads:"),
            disk_kb: used_kb(&self.inside("disk")),
        }
    }

    fn day(&self, day: u64, runs: u64) -> Usage {
        let token = self.ask(
            "POST",
            "/tokens",
            Some(&json!({ "name": format!("day {day}"), "role": "viewer" })),
        );
        for number in 0..runs {
            let (machine, _) = SCRIPTS[usize::try_from(number).unwrap() % SCRIPTS.len()];
            let run = self.run(&format!("{day} {number}"), machine);
            self.look_back(&run);
        }
        self.edit(day);
        if day % 7 == 1 {
            self.fill_disk(day);
        }
        self.ask("DELETE", &format!("/tokens/{}", token["id"].as_str().unwrap()), None);
        self.ask("POST", "/runs/prune", Some(&json!({ "count": KEPT })));
        self.ask("GET", "/runs", None);
        self.usage()
    }
}

/// The server behind a mount of its own, so that its disk can fill.
fn on_small_disk(place: &Place) -> Command {
    let serve =
        place.command("serve project --bind 127.0.0.1:0 --state disk/state --runs disk/runs");
    let mut command = Command::new("unshare");
    command.arg("--mount");
    if !rustix::process::geteuid().is_root() {
        command.arg("--map-root-user");
    }
    let mount = format!("mount -t tmpfs -o size={DISK_MB}m disk disk && exec \"$@\"");
    command.args(["sh", "-c", &mount, "sh"]).arg(serve.get_program()).args(serve.get_args());
    command.current_dir(place.path("")).stdin(Stdio::null());
    for (name, value) in serve.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command
}

fn subscribed(door: &Door, run: &str) -> Line {
    let mut line = door.line().unwrap();
    let topic = Topic::RunStatus { run: run.to_owned() };
    line.say(&ToServer::Subscribe { subscription: 1, topic }).unwrap();
    line
}

fn read_to_the_end(mut line: Line) {
    loop {
        let ToClient::RunStatus { status, .. } = line.hear().unwrap() else { continue };
        match status.run.phase {
            RunPhase::Finished { .. } => return,
            RunPhase::Starting | RunPhase::Live => {}
            phase => panic!("{phase:?}"),
        }
    }
}

fn used_kb(folder: &Path) -> u64 {
    let output =
        Command::new("du").args(["--summarize", "--block-size=1K"]).arg(folder).output().unwrap();
    String::from_utf8(output.stdout).unwrap().split_whitespace().next().unwrap().parse().unwrap()
}

/// The days after the warm-up, in two halves: the later one has no higher peak than the earlier one, but for noise.
fn check_flat(days: &[Usage]) {
    let (earlier, later) = days.split_at(days.len() / 2);
    let peak = |days: &[Usage], figure: fn(&Usage) -> u64| days.iter().map(figure).max().unwrap();
    for (name, figure) in [
        ("memory_kb", (|usage: &Usage| usage.memory_kb) as fn(&Usage) -> u64),
        ("descriptors", |usage: &Usage| usage.descriptors),
        ("threads", |usage: &Usage| usage.threads),
        ("disk_kb", |usage: &Usage| usage.disk_kb),
    ] {
        let (before, after) = (peak(earlier, figure), peak(later, figure));
        assert!(after <= before + figure(&NOISE), "{name} grew from {before} to {after}");
    }
}

#[test]
fn months_of_use_leave_memory_descriptors_and_disk_flat() {
    harness::assert_extension();
    let days = number(DAYS).unwrap_or(8).max(WARM_UP + 2);
    let runs = number(RUNS).unwrap_or(3);
    let site = Site::new();
    let mut used = Vec::new();
    for day in 0..days {
        used.push(site.day(day, runs));
        let mut line = String::new();
        writeln!(line, "day {day}: {:?}", used[used.len() - 1]).unwrap();
        std::io::stdout().write_all(line.as_bytes()).unwrap();
    }
    check_flat(&used[usize::try_from(WARM_UP).unwrap()..]);
}
