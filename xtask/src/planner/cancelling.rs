//! Time from the cancellation of a plan until all processes of its engine have ended. Finds processes by a mark in their
//! environment.

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::{Context as _, Result, bail, ensure};
use serde_json::json;

use super::figures::Measured;
use super::{PlannerBench, now, pool, problems, since};

/// An engine that plans forever with a helper, and ignores all signals that can be ignored.
const DEAF: &str = "trap '' INT TERM HUP\ntail -f /dev/null &\nexec tail -f /dev/null";
/// Minimum number of processes while an engine plans: the requester, the engine, its helper, and the process that ends the
/// engine with the requester.
const PROCESSES: usize = 4;
/// Environment variable that all started processes inherit.
const MARK: &str = "RAFCON_PLANNER_MARK";
/// Timeout of waiting for processes, in ms.
const PATIENCE_MS: f64 = 20_000.0;

/// Measures both kinds of cancellation: a signal, and a closed request.
pub(super) fn measure(bench: &PlannerBench, measured: &mut Measured) -> Result<()> {
    let python = pool::engine(&bench.folder.join("deaf"), DEAF)?;
    let facts = bench.facts("cancelled", &problems::blocks(10, false))?;
    let mut plan = bench.plan("blocks", &facts, &bench.folder.join("never"))?;
    plan.env("RAFCON_PYTHON", &python).env(MARK, "ctrl-c").stdout(Stdio::null());
    let mut program = Killed(plan.spawn().context("rafcon does not start")?);
    wait("ctrl-c", |left| left.len() >= PROCESSES)?;
    let begin = now();
    let signalled = Command::new("kill").args(["-INT", &program.0.id().to_string()]).status()?;
    ensure!(signalled.success(), "no signal could be sent");
    program.0.wait()?;
    wait("ctrl-c", <[u32]>::is_empty)?;
    measured.note("cancel_ctrl_c_ms", since(begin));

    let mut serve = bench.rafcon();
    serve.arg("serve").arg(&bench.folder).args(["--bind", "127.0.0.1:0", "--library-path"]);
    serve.arg(format!("blocks={}", bench.folder.join("blocks").display()));
    serve.arg("--state").arg(bench.folder.join("state"));
    serve.arg("--runs").arg(bench.folder.join("server_runs"));
    serve.env("RAFCON_PYTHON", &python).env(MARK, "request").stdout(Stdio::piped());
    let mut server = Killed(serve.spawn().context("the server does not start")?);
    let out = server.0.stdout.take().context("the server's output is not piped")?;
    let link = BufReader::new(out).lines().next().context("the server has ended")??;
    let body = json!({"pool": {"libraries": ["blocks"]}, "facts": problems::blocks(10, false), "time_limit_ms": 600_000});
    let asking = ask(&link, &body.to_string())?;
    wait("request", |left| left.len() >= PROCESSES)?;
    let begin = now();
    drop(asking);
    wait("request", |left| left == [server.0.id()])?;
    measured.note("cancel_request_ms", since(begin));
    Ok(())
}

/// A program that is killed on drop.
struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        // The program may have ended already.
        self.0.kill().unwrap_or_default();
        self.0.wait().map(drop).unwrap_or_default();
    }
}

/// Requests a plan; closing the connection cancels it.
fn ask(link: &str, body: &str) -> Result<TcpStream> {
    let (address, token) = link
        .trim()
        .strip_prefix("http://")
        .and_then(|rest| rest.split_once("/?token="))
        .with_context(|| format!("the server printed `{link}`, not its link"))?;
    let mut stream = TcpStream::connect(address)?;
    write!(
        stream,
        "POST /api/v1/plans HTTP/1.1\r\nHost: {address}\r\nAuthorization: Bearer {token}\r\n\
         Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    )?;
    let mut head = [0; 12];
    stream.read_exact(&mut head)?;
    ensure!(head.ends_with(b"200"), "the server responded with {}", String::from_utf8_lossy(&head));
    Ok(stream)
}

/// Waits for the expected set of marked processes.
#[expect(clippy::disallowed_methods, reason = "the end of a stranger's process is no event")]
fn wait(mark: &str, is_so: impl Fn(&[u32]) -> bool) -> Result<()> {
    let begin = now();
    loop {
        let left = marked(mark)?;
        if is_so(&left) {
            return Ok(());
        }
        if since(begin) > PATIENCE_MS {
            bail!("the processes with {MARK}={mark} are {left:?}");
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Ids of all processes with this mark.
fn marked(mark: &str) -> Result<Vec<u32>> {
    let wanted = format!("{MARK}={mark}");
    let mut found = Vec::new();
    for entry in fs::read_dir("/proc")? {
        let path = entry?.path();
        let id: Option<u32> = path.file_name().and_then(|name| name.to_str()?.parse().ok());
        // A process that has just ended has no environment.
        let environment = fs::read(path.join("environ")).unwrap_or_default();
        let has_mark = environment.split(|byte| *byte == 0).any(|one| one == wanted.as_bytes());
        found.extend(id.filter(|_| has_mark));
    }
    Ok(found)
}
