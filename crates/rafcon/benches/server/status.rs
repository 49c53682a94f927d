//! A single change of a run, from the script that begins to a client's status frame that says so. The change is not safe on
//! disk before some milliseconds of this have passed, so that the figure is more than what it takes from then on.

use crate::bench_server::{BenchServer, Heard, noted, until};
use crate::clock::now_ms;
use crate::{percentile, print};
use anyhow::{Result, ensure};
use rafcon_protocol::api::RunNow;
use rafcon_protocol::socket::{ToClient, ToServer, Topic};

/// Changes four times a second, so that none waits for the one before it.
const MACHINE: &str = r#"
hierarchy ROOT "Changes"
  outcome success
  start -> LEFTXX
  LEFTXX.more -> RIGHTX ; RIGHTX.more -> LEFTXX
  LEFTXX.enough -> .success ; RIGHTX.enough -> .success
  execution LEFTXX "Left"
    outcome more
    outcome enough
    script |
      import time
      def execute(self, inputs, outputs, gvm):
          began = gvm.get_variable("began", default=[]) + [time.time_ns()]
          self.preemptive_wait(0.25)
          gvm.set_variable("began", began)
          return "more" if len(began) < 24 else "enough"
  execution RIGHTX "Right"
    outcome more
    outcome enough
    script |
      import time
      def execute(self, inputs, outputs, gvm):
          began = gvm.get_variable("began", default=[]) + [time.time_ns()]
          self.preemptive_wait(0.25)
          gvm.set_variable("began", began)
          return "more" if len(began) < 24 else "enough"
"#;

pub(crate) fn measure(server: &BenchServer) -> Result<()> {
    server.machine("changes", MACHINE)?;
    let run = server.start("changes")?;
    let mut line = server.follow(&run)?;
    let topic = Topic::RunStatus { run };
    line.say(&ToServer::Subscribe { subscription: 2, topic })?;
    let (mut told, mut last) = (Vec::new(), String::new());
    let began = until(&mut line, |_, heard| match heard {
        Heard::Event(entry) => noted(&entry.event, "began"),
        Heard::Other(ToClient::RunStatus { status, .. }) => {
            let state = active(status);
            if !state.is_empty() && state != last {
                told.push(now_ms());
                last = state;
            }
            Ok(None)
        }
        Heard::Other(_) => Ok(None),
    })?;
    ensure!(told.len() == began.len(), "{} of {} changes were told", told.len(), began.len());
    // The first was over before anyone asked.
    let times = told.iter().zip(&began).skip(1).map(|(told, began)| told - began).collect();
    print("server_status_ms", percentile(times, 50)?, "ms");
    Ok(())
}

/// The state whose script runs.
fn active(status: &RunNow) -> String {
    let active = status.snapshot.iter().flat_map(|snapshot| &snapshot.active);
    active.map(|state| &state.path).find(|path| path.contains('/')).cloned().unwrap_or_default()
}
