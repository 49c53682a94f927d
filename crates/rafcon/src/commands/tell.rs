//! `rafcon tell`: sends one command to an active run, for scripts and for people without a live view.

use crate::cli;
use crate::client::{Fault, Server};
use crate::clock::Clock;
use crate::commands::kept::find_run;
use crate::commands::remote;
use crate::environment::Environment;
use crate::event_queue::line_to;
use crate::failure::{Usage, complain};
use crate::follow::envelope;
use anyhow::{Result, bail};
use rafcon_protocol::api::CommandAnswer;
use rafcon_protocol::{
    Answer, Command, Envelope, Expiry, FrameKind, Hello, Join, ToRunner, ToViewer, decode, encode,
    read_frame,
};
use rafcon_supervisor::{clock, connect_once_listening};
use serde_json::{Map, Value};
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::process::ExitCode;

/// Exit code for a command with an unknown result.
const UNKNOWN: u8 = 9;

/// Sends the command, and waits for the answer.
pub(super) fn tell(raw: &cli::Tell, environment: &Environment) -> Result<ExitCode> {
    let command = command(&raw.command, &raw.fields)?;
    if let Some(server) = remote::server(&raw.remote, environment)? {
        remote::refuse_runs(&raw.runs, environment)?;
        let run = remote::run(&server, &raw.run)?.id;
        let envelope = envelope(remote::command_id()?, &environment.user, command);
        let waiting = Clock::start();
        let now = server.now(&run)?;
        let waited_ms = u64::try_from(waiting.now().as_millis()).unwrap_or(u64::MAX);
        let now_ms = now.now_ms.saturating_sub(waited_ms);
        let link = now.robot.and_then(|robot| robot.lifetime());
        let envelope = timed(envelope, raw, now_ms).dated(now_ms, link);
        // A stop does not expire, and is sent once.
        let expires_ms = envelope.expiry.map_or(0, |Expiry(until)| until);
        let is_wanted = || {
            let passed_ms = u64::try_from(waiting.now().as_millis()).unwrap_or(u64::MAX);
            now_ms.saturating_add(passed_ms) < expires_ms
        };
        return said(answer(&server, &run, &envelope, is_wanted)?);
    }
    let folder = find_run(&raw.runs, environment, &raw.run)?;
    let mut control = connect_once_listening(&folder)?;
    let mut runner = BufReader::new(control.try_clone()?);
    control.write_all(&encode(&Hello::ours())?)?;
    let mut hello = String::new();
    runner.read_line(&mut hello)?;
    decode::<Hello>(&hello)?.check()?;
    // In the format of a server.
    let id = format!("{}/{}", environment.user, remote::command_id()?);
    control.write_all(&encode(&ToRunner::Join(Join::default()))?)?;
    let told = envelope(id.clone(), &environment.user, command);
    let told = ToRunner::Command(timed(told, raw, clock::since_1970_ms()));
    line_to(&folder, control).say(&told)?;
    let mut content = Vec::new();
    while let Some(kind) = read_frame(&mut runner, &mut content)? {
        if kind != FrameKind::Message {
            continue;
        }
        match decode(&String::from_utf8_lossy(&content))? {
            ToViewer::Answer { id: about, answer } if about == id => return said(answer),
            ToViewer::LoadFailed { reason } => bail!(reason),
            _ => {}
        }
    }
    bail!("the runner ended before it answered")
}

/// The answer of a server. Repeats the request with its id until it is answered or the command expires.
fn answer(
    server: &Server,
    run: &str,
    envelope: &Envelope,
    is_wanted: impl Fn() -> bool,
) -> Result<Answer> {
    loop {
        match server.command(run, envelope) {
            Ok(CommandAnswer { answer, .. }) => return Ok(answer),
            Err(Fault::Refused { refusal, .. }) if refusal.code == "no_answer" => {
                if !is_wanted() {
                    return Ok(Answer::Unknown { reason: refusal.message });
                }
            }
            Err(fault) => return Err(fault.into()),
        }
    }
}

/// Adds the times from the options; `now_ms` is the time by the clock of the run.
fn timed(envelope: Envelope, raw: &cli::Tell, now_ms: u64) -> Envelope {
    let at = |seconds: u64| now_ms.saturating_add(seconds.saturating_mul(1_000));
    let expiry = raw.expires_in_s.map(|seconds| Expiry(at(seconds)));
    Envelope { not_before: raw.wait_s.map(at), expiry, ..envelope }
}

fn said(answer: Answer) -> Result<ExitCode> {
    match answer {
        Answer::Applied => {
            writeln!(io::stdout(), "applied")?;
            Ok(ExitCode::SUCCESS)
        }
        Answer::Refused { reason } => {
            complain(&format!("refused: {reason}"));
            Ok(ExitCode::FAILURE)
        }
        Answer::Expired => {
            complain("the command arrived too late");
            Ok(ExitCode::FAILURE)
        }
        Answer::Unknown { reason } => {
            complain(&format!("it is not known whether the command was carried out: {reason}"));
            Ok(ExitCode::from(UNKNOWN))
        }
    }
}

/// A command from its name and its fields.
fn command(name: &str, fields: &[String]) -> Result<Command> {
    let mut members = Map::from_iter([("type".to_owned(), Value::String(name.replace('-', "_")))]);
    for field in fields {
        let Some((name, text)) = field.split_once('=') else {
            return Err(Usage(format!("{field}: write NAME=JSON, such as outcome=0")).into());
        };
        let value =
            serde_json::from_str(text).unwrap_or_else(|_text| Value::String(text.to_owned()));
        members.insert(name.to_owned(), value);
    }
    serde_json::from_value(Value::Object(members)).map_err(|error| {
        Usage(format!(
            "`{name}` is not a command of a run ({error}); docs/protocol.md lists the commands"
        ))
        .into()
    })
}

#[cfg(test)]
mod tests {
    use super::command;
    use expect_test::{Expect, expect};

    fn check(words: &str, expect: &Expect) {
        let mut words = words.split(' ').map(str::to_owned);
        let name = words.next().unwrap();
        let told = command(&name, &words.collect::<Vec<_>>());
        expect.assert_eq(&match told {
            Ok(command) => format!("{command:?}"),
            Err(error) => error.to_string(),
        });
    }

    #[test]
    fn words_become_a_command() {
        check("pause", &expect!["Pause"]);
        check("step-over branch=R/A", &expect![[r#"StepOver { branch: Some("R/A") }"#]]);
        check(
            "force_outcome path=R/A outcome=-1",
            &expect![[r#"ForceOutcome { path: "R/A", outcome: -1 }"#]],
        );
        check(
            r#"answer_question question=1 value={"button":0}"#,
            &expect![[r#"AnswerQuestion { question: 1, value: Object {"button": Number(0)} }"#]],
        );
    }

    #[test]
    fn what_is_no_command_is_refused() {
        check(
            "dance",
            &expect![
                "`dance` is not a command of a run (unknown variant `dance`, expected one of `start`, `pause`, `resume`, `stop`, `kill`, `step_mode`, `step_into`, `step_over`, `step_out`, `step_back`, `run_to`, `run_selected`, `run_only_selected`, `start_from_history`, `force_outcome`, `preempt`, `set_breakpoint`, `remove_breakpoint`, `answer_question`, `recover`, `reload`, `edit_script`, `control`); docs/protocol.md lists the commands"
            ],
        );
        check("run_to R/A", &expect!["R/A: write NAME=JSON, such as outcome=0"]);
        check(
            "run_to",
            &expect![
                "`run_to` is not a command of a run (missing field `path`); docs/protocol.md lists the commands"
            ],
        );
    }
}
