//! One command, from a client to its effect: a script that waits, is preempted, and notes when it continues.

use crate::bench_server::{BenchServer, Heard, noted, until};
use crate::clock::now_ms;
use crate::served::Line;
use crate::{percentile, print};
use anyhow::{Result, ensure};
use rafcon_protocol::socket::ToServer;
use rafcon_protocol::{Command, Envelope, Event};

/// Where it waits.
const STATE: &str = "ROOT/WAITXX";
/// Half of the commands go over HTTP, half over the WebSocket.
const MACHINE: &str = r#"
hierarchy ROOT "Commanded"
  outcome success
  start -> WAITXX
  WAITXX.success -> TALLYX ; WAITXX.preempted -> TALLYX
  TALLYX.again -> WAITXX ; TALLYX.enough -> .success
  execution WAITXX "Wait"
    outcome success
    script |
      import time
      def execute(self, inputs, outputs, gvm):
          self.preemptive_wait(20)
          woken = time.time_ns()
          gvm.set_variable("woken", gvm.get_variable("woken", default=[]) + [woken])
          return 0
  execution TALLYX "Tally"
    outcome again
    outcome enough
    script |
      def execute(self, inputs, outputs, gvm):
          return "again" if len(gvm.get_variable("woken")) < 120 else "enough"
"#;

pub(crate) fn measure(server: &BenchServer) -> Result<()> {
    server.machine("commanded", MACHINE)?;
    let run = server.start("commanded")?;
    let mut sent = Vec::new();
    let woken = until(&mut server.follow(&run)?, |line, heard| {
        let Heard::Event(entry) = heard else { return Ok(None) };
        if matches!(&entry.event, Event::Entered { path, .. } if path == STATE) {
            sent.push(now_ms());
            preempt(server, &run, line, sent.len())?;
        }
        noted(&entry.event, "woken")
    })?;
    ensure!(woken.len() == sent.len(), "{} commands had {} effects", sent.len(), woken.len());
    let times: Vec<f64> = woken.iter().zip(&sent).map(|(woken, sent)| woken - sent).collect();
    let way = |odd| times.iter().skip(odd).step_by(2).copied().collect();
    print("server_command_ms", percentile(way(0), 50)?.max(percentile(way(1), 50)?), "ms");
    Ok(())
}

fn preempt(server: &BenchServer, run: &str, line: &mut Line, number: usize) -> Result<()> {
    let command = Command::Preempt { path: STATE.to_owned() };
    let envelope = Envelope::new(number.to_string(), "", command);
    if number.is_multiple_of(2) {
        return line.say(&ToServer::Command { run: run.to_owned(), envelope });
    }
    let path = format!("/api/v1/runs/{run}/commands");
    server.door().ask("POST", &path, Some(&serde_json::to_value(envelope)?))?;
    Ok(())
}
