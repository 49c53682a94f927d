//! What fifty clients that follow a run cost its runner: how long it takes from the end of a script to the begin of the next,
//! at 1,000 states a second, with them and without them, by turns in one run.
//!
//! The clients are a process of their own: this program, started again.

use crate::bench_server::{BenchServer, is_over, until};
use crate::clock::pass;
use crate::served::{Door, Line};
use crate::{clock, percentile, print};
use anyhow::{Context as _, Result, ensure};
use rafcon_protocol::socket::{ToServer, Topic};
use rustix::event::{PollFd, PollFlags, poll};
use serde_json::Value;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _, stdin, stdout};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// The argument by which the bench starts itself again.
const CHILD: &str = "--followers";
/// How many clients follow.
const FOLLOWERS: usize = 50;
/// How often it is measured without and with them.
const TURNS: usize = 6;
/// How long each time.
const TURN: Duration = Duration::from_secs(2);
/// Who has just come or gone is not measured.
const BETWEEN: Duration = Duration::from_millis(500);
/// A tick a millisecond, until there is a file that says it is enough; then the times are written down.
const MACHINE: &str = r#"
hierarchy ROOT "Ticks"
  outcome success
  var n: int = 0
  start -> TICKXX
  TICKXX.more -> TICKXX ; TICKXX.enough -> .success
  flow .n -> TICKXX.n
  flow TICKXX.n -> .n
  execution TICKXX "Tick"
    outcome more
    outcome enough
    in n: int = 0
    out n: int
    script |
      import json, os, sys, time
      def execute(self, inputs, outputs, gvm):
          now = time.time_ns()
          ticks = getattr(sys, "bench_ticks", None)
          if ticks is None:
              ticks = sys.bench_ticks = {"next": now, "end": now, "times": []}
          ticks["times"].append((now, now - ticks["end"]))
          outputs["n"] = inputs["n"] + 1
          if inputs["n"] % 100 == 0 and os.path.exists("ENOUGH"):
              with open("TIMES", "w") as file:
                  json.dump(ticks["times"], file)
              return "enough"
          ticks["next"] = max(ticks["next"] + 1_000_000, now)
          time.sleep(max(0, ticks["next"] - time.time_ns()) / 1e9)
          ticks["end"] = time.time_ns()
          return "more"
"#;

/// What the clients' process was started for: address, token, run.
pub(crate) fn asked_for() -> Option<Vec<String>> {
    let mut words = std::env::args().skip_while(|word| word != CHILD);
    words.next().map(|_| words.collect())
}

/// Follows with all clients until the input ends.
pub(crate) fn follow(words: &[String]) -> Result<()> {
    let [address, token, run] = words else { anyhow::bail!("address, token, run") };
    let door = Door { address: address.parse()?, token: token.clone() };
    let about = door.ask("GET", &format!("/api/v1/runs/{run}"), None)?;
    let from = about["run"]["events"].as_u64().context("a run without events")? + 1;
    let lines: Vec<_> =
        (0..FOLLOWERS).map(|_| subscribed(&door, run, from)).collect::<Result<_>>()?;
    writeln!(stdout(), "ready")?;
    let mut bytes = vec![0; lines.len()];
    let mut buffer = vec![0; 1 << 20];
    while let Some(ready) = ready(&lines)? {
        for number in ready {
            bytes[number] += lines[number].socket.get_ref().read(&mut buffer)?;
        }
    }
    ensure!(bytes.iter().all(|bytes| *bytes > 100_000), "somebody was told too little: {bytes:?}");
    Ok(())
}

fn subscribed(door: &Door, run: &str, from: u64) -> Result<Line> {
    let mut line = door.line()?;
    let topic = Topic::RunHistory { run: run.to_owned(), from, values: true };
    line.say(&ToServer::Subscribe { subscription: 1, topic })?;
    Ok(line)
}

/// Waits until someone is told something, and says who; no one when the input has ended.
fn ready(lines: &[Line]) -> Result<Option<Vec<usize>>> {
    let input = stdin();
    let mut wanted = vec![PollFd::new(&input, PollFlags::IN)];
    let sockets = lines.iter().map(|line| line.socket.get_ref());
    wanted.extend(sockets.map(|socket| PollFd::new(socket, PollFlags::IN)));
    poll(&mut wanted, None)?;
    let is_ready = |fd: &PollFd<'_>| !fd.revents().is_empty();
    let ready = wanted[1..].iter().enumerate().filter(|(_, fd)| is_ready(fd));
    Ok((!is_ready(&wanted[0])).then(|| ready.map(|(number, _)| number).collect()))
}

pub(crate) fn measure(server: &BenchServer) -> Result<()> {
    let (enough, times) = (server.path("enough"), server.path("times"));
    let text = MACHINE.replace("ENOUGH", &enough.to_string_lossy());
    server.machine("ticks", &text.replace("TIMES", &times.to_string_lossy()))?;
    let run = server.start("ticks")?;
    let mut line = server.follow(&run)?;
    pass(BETWEEN);
    let (mut alone, mut followed) = (Vec::new(), Vec::new());
    for _ in 0..TURNS {
        alone.push(turn());
        let mut clients = clients(server.door(), &run)?;
        pass(BETWEEN);
        followed.push(turn());
        drop(clients.stdin.take());
        ensure!(clients.wait()?.success(), "the clients failed");
        pass(BETWEEN);
    }
    fs::write(&enough, "")?;
    until(&mut line, |_, heard| Ok(is_over(&heard).then_some(())))?;
    let times: Vec<(i64, i64)> = serde_json::from_value(read(&times)?)?;
    let (alone, followed) = (late(&times, &alone)?, late(&times, &followed)?);
    print("server_followers_p99_ratio", followed / alone, "ratio");
    Ok(())
}

fn read(file: &std::path::Path) -> Result<Value> {
    Ok(serde_json::from_str(&fs::read_to_string(file)?)?)
}

/// Lets the run continue; gives begin and end of that time.
fn turn() -> (f64, f64) {
    let begun = clock::now_ms();
    pass(TURN);
    (begun, clock::now_ms())
}

/// The clients, once all of them follow.
fn clients(door: &Door, run: &str) -> Result<Child> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args([CHILD, &door.address.to_string(), &door.token, run]);
    let mut clients = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let mut said = String::new();
    let stdout = clients.stdout.take().context("no output")?;
    BufReader::new(stdout).read_line(&mut said)?;
    ensure!(said == "ready\n", "the clients said {said:?}");
    Ok(clients)
}

/// The 99th percentile of what states took to follow each other in some stretches of time, in ms.
fn late(times: &[(i64, i64)], turns: &[(f64, f64)]) -> Result<f64> {
    let inside = |at: f64| turns.iter().any(|(begun, ended)| (*begun..*ended).contains(&at));
    let times = times.iter().filter(|(at, _)| inside(clock::noted_ms(*at)));
    let times: Vec<_> = times.map(|(_, took)| clock::noted_ms(*took)).collect();
    ensure!(times.len() > 9 * TURNS * 200, "only {} states ran", times.len());
    percentile(times, 99)
}
