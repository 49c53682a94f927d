//! Runs at the limits of what viewers may send and scripts may ask.

use super::served::{RunFixture, Viewer};
use rafcon_protocol::{Command, Given, ToRunner, ToViewer};
use serde_json::json;
use std::os::unix::net::UnixListener;

const WAITS: &str = "
hierarchy ROOT
  outcome done
  in number: int = 4
  start -> A
  A.ok -> .done
  execution A \"wait\"
    outcome ok
";

/// The viewer if it was admitted, otherwise the reason.
fn admitted(mut viewer: Viewer) -> Result<Viewer, String> {
    let refused = viewer.until(|message| match message {
        ToViewer::Loaded { .. } => Some(None),
        ToViewer::LoadFailed { reason } => Some(Some(reason.clone())),
        _ => None,
    });
    refused.map_or(Ok(viewer), Err)
}

#[test]
fn a_run_has_so_many_viewers_and_a_further_one_is_told_so() {
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/A");
    let mut others: Vec<_> = (1..64)
        .map(|_| admitted(fixture.look_on()).unwrap_or_else(|why| panic!("{why}")))
        .collect();
    let refused = admitted(fixture.look_on()).err();
    assert_eq!(refused.as_deref(), Some("64 viewers are connected; let one of them leave"));
    drop(others.pop());
    // The runner sees the end of the connection on another thread.
    let mut next = std::iter::repeat_with(|| admitted(fixture.look_on()));
    let mut next = next.find_map(Result::ok).unwrap();
    assert_eq!(next.command("stop", Command::Stop), "applied");
    drop((first, others, next));
    runner.join().unwrap();
}

/// A command after `padding` spaces, which JSON allows.
fn padded(id: &str, length: usize) -> String {
    let command =
        format!("{{\"message\":\"command\",\"id\":\"{id}\",\"command\":{{\"type\":\"pause\"}}}}\n");
    format!("{}{command}", " ".repeat(length - command.len()))
}

#[test]
fn a_line_that_is_too_long_is_ignored_whole_and_the_next_is_heard() {
    const MOST: usize = 16 << 20;
    let fixture = RunFixture::new(WAITS);
    let (mut first, runner) = fixture.begin(fixture.launch());
    first.until_text("+ROOT/A");
    first.raw(&padded("longest", MOST));
    assert_eq!(first.answer("longest"), "applied");
    // The end of the line would be a command of its own.
    first.raw(&format!("{}{}", " ".repeat(MOST), padded("smuggled", 200)));
    first.raw(&padded("one byte too long", MOST + 1));
    first.send(&ToRunner::Inspect { id: "next".to_owned(), path: "ROOT".to_owned() });
    let mut answered = Vec::new();
    first.until(|message| match message {
        ToViewer::Answer { id, .. } => {
            answered.push(id.clone());
            None
        }
        ToViewer::Inspection { .. } => Some(()),
        _ => None,
    });
    assert_eq!(answered, [""; 0]);
    assert_eq!(first.command("stop", Command::Stop), "applied");
    let text = first.into_end();
    let complaint = "log : a viewer sent a line that is no text, or too long; it was ignored";
    assert_eq!(text.matches(complaint).count(), 2, "{text}");
    runner.join().unwrap();
}

#[test]
fn a_viewer_whose_messages_wait_is_not_read_until_one_is_carried_out() {
    for (waiting, is_read) in [(64, true), (65, false)] {
        let fixture = RunFixture::new(WAITS);
        let (mut first, runner) = fixture.begin(fixture.launch());
        first.until_text("+ROOT/A");
        let socket = fixture.machine().with_file_name("slow");
        let listener = UnixListener::bind(&socket).unwrap();
        let value = json!(format!("until closed: {}", socket.display()));
        let given = Given { path: "ROOT".to_owned(), name: "number".to_owned(), value };
        first.order("slow", Command::Start { from: None, data: vec![given] });
        let (under_way, _) = listener.accept().unwrap();
        for id in 0..waiting {
            first.send(&ToRunner::Inspect { id: id.to_string(), path: "ROOT".to_owned() });
        }
        first.send(&ToRunner::Ping { id: 7 });
        let mut held = is_read.then_some(under_way);
        let mut order = Vec::new();
        first.until(|message| {
            match message {
                ToViewer::Pong { .. } => {
                    order.push("pong");
                    held = None;
                }
                ToViewer::Answer { .. } => order.push("slow"),
                _ => {}
            }
            (order.len() == 2).then_some(())
        });
        drop(held);
        assert_eq!(order, if is_read { ["pong", "slow"] } else { ["slow", "pong"] });
        assert_eq!(first.command("stop", Command::Stop), "applied");
        drop(first);
        runner.join().unwrap();
    }
}

#[test]
fn a_script_that_asks_for_the_past_gets_so_many_events_of_it() {
    for (lines, past) in [(19_997, "+ROOT/A -ROOT/A=ok +ROOT/B"), (19_998, "-ROOT/A=ok +ROOT/B")] {
        let fixture = RunFixture::new(&format!(
            "
hierarchy ROOT
  outcome done
  start -> A
  A.ok -> B
  B.ok -> .done
  execution A \"chatter\"
    in number: int = {lines}
    outcome ok
  execution B \"recall\"
    outcome ok
"
        ));
        let (mut viewer, runner) = fixture.begin(fixture.launch());
        viewer.until_text(&format!("log ROOT/B: {past}"));
        assert!(viewer.into_end().ends_with("finished done\n"));
        runner.join().unwrap();
    }
}
