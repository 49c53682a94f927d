//! What a server costs while nothing happens: a machine is open, a run waits, five clients look on.

use crate::bench_server::{BenchServer, HISTORY, until};
use crate::clock::pass;
use crate::{mission, print};
use anyhow::{Context as _, Result};
use rafcon_protocol::socket::{ToServer, Topic};
use std::fs;
use std::time::Duration;

/// How long is looked on.
const TIME: Duration = Duration::from_secs(5);
/// After how long everything has come to rest.
const SETTLE_TIME: Duration = Duration::from_secs(2);
const MACHINE: &str = r#"
execution WAITXX "Wait"
  outcome success
  script |
    def execute(self, inputs, outputs, gvm):
        self.preemptive_wait(600)
        return 0
"#;

pub(crate) fn measure(server: &BenchServer) -> Result<()> {
    server.mission("mission", 750)?;
    server.machine("waits", MACHINE)?;
    mission::open(server, "mission")?;
    let run = server.start("waits")?;
    let mut clients = Vec::new();
    for _ in 0..5 {
        let mut line = server.follow(&run)?;
        let status = Topic::RunStatus { run: run.clone() };
        line.say(&ToServer::Subscribe { subscription: HISTORY + 1, topic: status })?;
        let all = Topic::ServerStatus;
        line.say(&ToServer::Subscribe { subscription: HISTORY + 2, topic: all })?;
        until(&mut line, |_, _| Ok(Some(())))?;
        clients.push(line);
    }
    pass(SETTLE_TIME);
    let before = spent_ns(server.pid())?;
    pass(TIME);
    let spent = spent_ns(server.pid())? - before;
    print("server_idle_cpu_percent", spent / 1e9 / TIME.as_secs_f64() * 100.0, "%");
    Ok(())
}

/// What the threads of a process have computed so far.
fn spent_ns(pid: u32) -> Result<f64> {
    let mut spent = 0.0;
    for task in fs::read_dir(format!("/proc/{pid}/task"))? {
        let text = fs::read_to_string(task?.path().join("schedstat"))?;
        let first = text.split_whitespace().next().context("no time")?;
        spent += first.parse::<f64>()?;
    }
    Ok(spent)
}
