//! How a runner ended, from what it left: whether a script was cut off, whether somebody killed it, what ran. Knows journals
//! and marks; decides nothing.

use super::launch::OUTPUT_FILE;
use super::output::last_lines;
use rafcon_protocol::{Answer, Command, Event};
use rafcon_storage::journal::{Reader, Record};
use rafcon_supervisor::{Exit, RunnerDeath, remains};
use std::path::Path;

/// So many of its last lines are kept.
const LINES: usize = 12;

/// How a runner ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct RunnerEnd {
    /// What is known of it.
    pub(super) death: RunnerDeath,
    /// Somebody wanted it to end at once.
    pub(super) is_killed: bool,
}

/// How the last runner of the run in `folder` ended; `exit` is known of a process of our own.
pub(super) fn of(folder: &Path, exit: Option<Exit>) -> RunnerEnd {
    let reason = exit
        .map_or_else(|| "its runner ended before the run did".to_owned(), |exit| exit.to_string());
    let last = Reader::open(folder).and_then(|reader| reader.tail()).unwrap_or_default();
    let last = last.iter().rev().filter_map(|entry| match &entry.record {
        Record::Told(event) => Some(&**event),
        _ => None,
    });
    let mut last = last.take_while(|event| !matches!(event, Event::Resumed { .. }));
    let by = last.find(|event| matches!(event, Event::CutOff { .. }) || is_kill(event));
    let is_cut_off = matches!(by, Some(Event::CutOff { .. })) || exit.is_some_and(Exit::is_cut_off);
    let is_killed = by.is_some_and(is_kill) || exit.is_some_and(Exit::is_stopped);
    let said = last_lines(&folder.join(OUTPUT_FILE), LINES);
    let death = RunnerDeath { reason, active: remains::running(folder), said, is_cut_off };
    RunnerEnd { death, is_killed }
}

fn is_kill(event: &Event) -> bool {
    let Event::Commanded { envelope, answer } = event else { return false };
    envelope.command == Command::Kill && *answer == Answer::Applied
}

#[cfg(test)]
mod tests {
    use super::of;
    use crate::runs::launch::OUTPUT_FILE;
    use expect_test::{Expect, expect};
    use rafcon_storage::journal::{About, Journal, Options, notation};
    use rafcon_supervisor::Exit;
    use std::os::unix::process::ExitStatusExt as _;
    use std::process::ExitStatus;

    const PLACE: &str = "place R \"Root\" outcome done\nenter R\n";
    const KILL: &str = r#"told {"type":"commanded","envelope":{"id":"1","command":{"type":"kill"}},"answer":{"answer":"applied"}}"#;

    fn check(run: &str, exit: Option<i32>, expect: &Expect) {
        let folder = tempfile::tempdir().unwrap();
        let journal =
            Journal::create(folder.path(), &About::default(), &Options::default()).unwrap();
        journal.append(&notation::batch(&format!("{PLACE}{run}"), 0).unwrap()).unwrap();
        drop(journal);
        std::fs::write(folder.path().join(OUTPUT_FILE), "one\ntwo\n").unwrap();
        let fate = of(folder.path(), exit.map(|raw| Exit(ExitStatus::from_raw(raw))));
        expect.assert_eq(&format!("{fate:?}"));
    }

    #[test]
    fn a_runner_that_died_by_itself_says_how_and_what_it_said_last() {
        check(
            "",
            Some(11),
            &expect![[
                r#"RunnerEnd { death: RunnerDeath { reason: "killed by signal 11 (SIGSEGV)", active: [], said: ["one", "two"], is_cut_off: false }, is_killed: false }"#
            ]],
        );
        check(
            "",
            None,
            &expect![[
                r#"RunnerEnd { death: RunnerDeath { reason: "its runner ended before the run did", active: [], said: ["one", "two"], is_cut_off: false }, is_killed: false }"#
            ]],
        );
    }

    #[test]
    fn who_killed_it_or_cut_a_script_off_stands_in_the_journal() {
        check(
            KILL,
            Some(137 << 8),
            &expect![[
                r#"RunnerEnd { death: RunnerDeath { reason: "exit status 137", active: [], said: ["one", "two"], is_cut_off: false }, is_killed: true }"#
            ]],
        );
        let resumed =
            r#"told {"type":"resumed","life":2,"crash":{"reason":"","active":[]},"policy":"ask"}"#;
        check(
            &format!("{KILL}\n{resumed}"),
            Some(9),
            &expect![[
                r#"RunnerEnd { death: RunnerDeath { reason: "killed by signal 9 (SIGKILL)", active: [], said: ["one", "two"], is_cut_off: false }, is_killed: false }"#
            ]],
        );
        check(
            r#"told {"type":"cut_off","path":"R","grace_ms":5}"#,
            None,
            &expect![[
                r#"RunnerEnd { death: RunnerDeath { reason: "its runner ended before the run did", active: [], said: ["one", "two"], is_cut_off: true }, is_killed: false }"#
            ]],
        );
    }
}
