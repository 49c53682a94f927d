//! Strangers who hold connections of a server that may open only the usual 1,024 files, while its owner works.

use crate::harness::{Place, after};
use crate::served::{Door, Served};
use crate::server_runs::{Site, WAITS};
use crate::torture::number;
use rafcon_storage::journal::writer_of;
use rafcon_storage::{Naming, save};
use rafcon_supervisor::descriptors;
use rafcon_testkit::notation;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io::Write as _;
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

/// How many strangers there are, where a few more than there are files are not enough.
const STRANGERS: &str = "RAFCON_TEST_STRANGERS";

/// Strangers connect again if fewer than these are left.
const CROWD: usize = 400;

/// Strangers who connect and say nothing.
struct Strangers {
    address: SocketAddr,
    all: Vec<Option<TcpStream>>,
}

impl Strangers {
    fn new(address: SocketAddr, count: u64) -> Self {
        Self { address, all: (0..count).map(|_| None).collect() }
    }

    /// Connects everyone whose connection was ended.
    fn connect(&mut self) {
        for stranger in self.all.iter_mut().filter(|stranger| !is_held(stranger.as_ref())) {
            *stranger = Some(TcpStream::connect(self.address).unwrap());
        }
    }

    fn held(&self) -> usize {
        self.all.iter().filter(|stranger| is_held(stranger.as_ref())).count()
    }
}

fn is_held(stranger: Option<&TcpStream>) -> bool {
    let Some(stranger) = stranger else { return false };
    stranger.set_nonblocking(true).unwrap();
    let peeked = stranger.peek(&mut [0; 1]);
    peeked.is_err_and(|error| error.kind() == std::io::ErrorKind::WouldBlock)
}

/// The owner, who asks while all strangers are there.
struct Owner<'d> {
    door: &'d Door,
    strangers: Strangers,
    longest: Duration,
}

impl Owner<'_> {
    #[expect(clippy::disallowed_methods, reason = "the figure that is printed is a time")]
    fn ask(&mut self, method: &str, path: &str, body: Option<&Value>) -> Value {
        if self.strangers.held() < CROWD {
            self.strangers.connect();
        }
        let began = Instant::now();
        let answer = self.door.ask(method, path, body).unwrap();
        self.longest = self.longest.max(began.elapsed());
        assert!(self.strangers.held() > 0, "no stranger is left");
        answer
    }
}

/// Limits of a process, soft and hard.
fn limits(process: u32) -> (String, String) {
    let text = fs::read_to_string(format!("/proc/{process}/limits")).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix("Max open files")).unwrap();
    let mut words = line.split_whitespace().map(str::to_owned);
    (words.next().unwrap(), words.next().unwrap())
}

#[test]
fn strangers_who_hold_every_file_of_a_server_delay_no_user_and_no_run() {
    descriptors::raise().unwrap();
    let mut site = Site { place: Place::empty(), served: None };
    let machine = notation::parse(WAITS).unwrap();
    save(&machine, &site.place.path("project/machine"), None, Naming::default()).unwrap();
    let log = site.place.path("log");
    let serve = "serve project --bind 127.0.0.1:0 --state state --runs runs";
    let mut serve = after(&site.place.command(serve), "ulimit -Sn 256; ulimit -Hn 1024");
    serve.stderr(File::create(&log).unwrap());
    let served = Served::start(serve).unwrap();
    assert_eq!(limits(served.pid()), ("1024".to_owned(), "1024".to_owned()));
    site.served = Some(served);
    let door = site.door();
    let strangers = Strangers::new(door.address, number(STRANGERS).unwrap_or(1_100));
    let mut owner = Owner { door, strangers, longest: Duration::ZERO };
    for path in ["/api/v1/status", "/api/v1/runs", "/api/v1/projects", "/api/v1/session"] {
        owner.ask("GET", path, None);
    }
    let start = json!({ "id": "1", "machine": { "project": "project", "path": "machine" } });
    let run = owner.ask("POST", "/api/v1/runs", Some(&start));
    let run = run["id"].as_str().unwrap();
    let runner = writer_of(&site.place.path("runs").join(run)).unwrap().unwrap();
    assert_eq!(limits(runner), ("256".to_owned(), "1024".to_owned()));
    let stop = json!({ "id": "2", "author": "", "command": { "type": "stop" } });
    let answer = owner.ask("POST", &format!("/api/v1/runs/{run}/commands"), Some(&stop));
    assert_eq!(answer["answer"], "applied", "{answer}");
    assert!(owner.strangers.held() < 1024, "nobody had to go");
    let said = fs::read_to_string(&log).unwrap();
    assert!(said.contains("too many connections ("), "{said}");
    let longest_s = owner.longest.as_secs_f64();
    let figure = json!({ "name": "owner_request_max_s", "value": longest_s });
    writeln!(std::io::stdout(), "{figure}").unwrap();
}
