//! A robot whose disk is full: a server begins there, a user logs in, sees the run and stops it.

use crate::harness::{Place, after, assert_extension};
use crate::served::Served;
use crate::server_runs::{CHEAP, Site, WAITS};
use rafcon_protocol::api::{Role, RunPhase};
use rafcon_server::access::Users;
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use serde_json::json;
use std::fs::{self, File};
use std::io::{PipeReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::Command;

const SERVE: &str = "serve project --bind 127.0.0.1:0 --state disk/state --runs disk/runs";

/// A small disk of its own in a folder, until dropped.
struct SmallDisk(PathBuf);

impl SmallDisk {
    /// Only root can mount one.
    fn mount(folder: &Path) -> Option<Self> {
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=48m", "none"])
            .arg(folder)
            .status();
        mounted.is_ok_and(|status| status.success()).then(|| Self(folder.to_owned()))
    }

    fn fill(&self) {
        let mut file = File::create(self.0.join("filler")).unwrap();
        for bytes in [1 << 20, 4096, 1] {
            while file.write_all(&vec![7; bytes]).is_ok() {}
        }
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        Command::new("umount").arg("-l").arg(&self.0).status().map(drop).unwrap_or_default();
    }
}

/// A site whose server has not begun.
fn site() -> Site {
    assert_extension();
    let place = Place::empty();
    let machine = notation::parse(WAITS).unwrap();
    save(&machine, &place.path("project/machine"), None, Naming::default()).unwrap();
    fs::create_dir(place.path("disk")).unwrap();
    Site { place, served: None }
}

/// Adds a user, and starts a run whose server is killed.
fn begin(site: &mut Site) -> String {
    let users = Users::open(&site.place.path("disk/state"), CHEAP).unwrap();
    users.add("anna", Role::Operator, "correct horse").unwrap();
    site.served = Some(Served::start(site.place.command(SERVE)).unwrap());
    let run = site.start("1", &json!({}));
    site.served = None;
    run["id"].as_str().unwrap().to_owned()
}

/// Asks with these lines in the head; gives the whole answer.
fn ask(address: SocketAddr, line: &str, head: &str, body: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    let length = body.len();
    let request = format!(
        "{line} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: close\r\n{head}\
         Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}"
    );
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// Logs in, looks, and stops the run.
fn stop_as_anna(site: &Site, run: &str) {
    let address = site.door().address;
    let login = json!({ "user": "anna", "password": "correct horse" }).to_string();
    let entered = ask(address, "POST /api/v1/session", "", &login);
    let cookie = entered.lines().find_map(|line| line.strip_prefix("set-cookie: "));
    let cookie = cookie.unwrap_or_else(|| panic!("{entered}")).split(';').next().unwrap();
    let head = format!("Cookie: {cookie}\r\n");
    let now = ask(address, &format!("GET /api/v1/runs/{run}"), &head, "");
    assert!(now.contains(r#""phase":"live""#), "{now}");
    let stop = json!({ "id": "2", "author": "", "command": { "type": "stop" } }).to_string();
    let stopped = ask(address, &format!("POST /api/v1/runs/{run}/commands"), &head, &stop);
    assert!(stopped.contains(r#""answer":"applied""#), "{stopped}");
    site.until(run, |now| !matches!(now.run.phase, RunPhase::Live | RunPhase::Starting));
}

/// Begins another server; gives what it reports in its log.
fn begin_again(site: &mut Site, mut serve: Command) -> PipeReader {
    let (reader, writer) = std::io::pipe().unwrap();
    serve.stderr(writer);
    site.served = Some(Served::start(serve).unwrap());
    reader
}

/// The log of the server, which is killed.
fn log_of(site: &mut Site, mut log: PipeReader) -> String {
    site.served = None;
    let mut text = String::new();
    log.read_to_string(&mut text).unwrap();
    assert!(text.contains("the login of anna ends with this server"), "{text}");
    text
}

#[test]
fn a_robot_with_a_full_disk_is_stopped_through_a_server_that_begins_there() {
    let mut site = site();
    let Some(disk) = SmallDisk::mount(&site.place.path("disk")) else {
        assert!(!rustix::process::geteuid().is_root(), "no disk could be mounted");
        return;
    };
    let run = begin(&mut site);
    disk.fill();
    let serve = site.place.command(SERVE);
    let log = begin_again(&mut site, serve);
    let url = format!("http://{}", site.door().address);
    let paused = site.place.call(&format!("tell {run} pause --server {url} --state disk/state"));
    assert_eq!((paused.code, paused.stdout.as_str()), (Some(0), "applied\n"), "{paused:?}");
    stop_as_anna(&site, &run);
    log_of(&mut site, log);
}

#[test]
fn a_robot_is_stopped_through_a_server_that_can_write_no_file() {
    let mut site = site();
    let run = begin(&mut site);
    let serve = after(&site.place.command(SERVE), "trap '' XFSZ; ulimit -f 0");
    let log = begin_again(&mut site, serve);
    stop_as_anna(&site, &run);
    let log = log_of(&mut site, log);
    for file in ["server.json", "token"] {
        assert!(log.contains(&format!("disk/state/{file}: ")), "{log}");
    }
    assert!(log.contains("the record of access cannot be written"), "{log}");
}
