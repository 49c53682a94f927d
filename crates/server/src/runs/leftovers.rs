//! Leftovers of a runner: its uncaptured output, and the cause of its end according to the journal and its marks. Reads a bounded
//! part of each; decides nothing.

use crate::Failure;
use rafcon_protocol::api::RunOutput;
use rafcon_protocol::{Answer, Command, Event};
use rafcon_storage::journal::{Reader, Record};
use rafcon_supervisor::{Exit, RunnerDeath, crash_artifacts};
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;

/// File in the run's folder with the output of a runner and its scripts that is not captured as script output.
pub(super) const OUTPUT_FILE: &str = "output";
/// Number of last lines in a report.
const LINES: usize = 12;
/// Default size of the part that is read, in bytes.
pub(super) const USUAL_BYTES: u64 = 64 * 1024;
/// Maximum size of the part that is read, in bytes.
pub(super) const BYTES_MAX: u64 = 1 << 20;

/// The last `bytes` of the output of the run in `folder`. Empty without output.
pub(super) fn tail(folder: &Path, bytes: u64) -> Result<RunOutput, Failure> {
    match read(&folder.join(OUTPUT_FILE), bytes.min(BYTES_MAX)) {
        Ok(output) => Ok(output),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(RunOutput::default()),
        Err(error) => {
            let message = format!("the output of this run cannot be read: {error}");
            Err(Failure::unavailable("output_unreadable", message))
        }
    }
}

/// The last non-blank line of a file. Empty if it has none.
pub(super) fn last_line(file: &Path) -> String {
    let text = read(file, USUAL_BYTES).map(|output| output.text).unwrap_or_default();
    text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default().to_owned()
}

/// The last lines of a file.
pub(super) fn last_lines(file: &Path, count: usize) -> Vec<String> {
    let text = read(file, USUAL_BYTES).map(|output| output.text).unwrap_or_default();
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(count)..].iter().map(|line| (*line).to_owned()).collect()
}

fn read(file: &Path, bytes: u64) -> io::Result<RunOutput> {
    let mut file = File::open(file)?;
    let length = file.metadata()?.len();
    let from = length.saturating_sub(bytes);
    file.seek(SeekFrom::Start(from))?;
    let mut text = Vec::new();
    file.take(bytes).read_to_end(&mut text)?;
    Ok(RunOutput { text: String::from_utf8_lossy(&text).into_owned(), from, bytes: length })
}

/// Cause of death of the last runner of the run in `folder`. `exit` is known only for the server's own process.
pub(super) fn death(folder: &Path, exit: Option<Exit>) -> RunnerDeath {
    let reason =
        exit.map_or_else(|| "the runner ended before the run".to_owned(), |exit| exit.to_string());
    let last = Reader::open(folder).and_then(|reader| reader.tail()).unwrap_or_default();
    let last = last.iter().rev().filter_map(|entry| match &entry.record {
        Record::Told(event) => Some(&**event),
        _ => None,
    });
    let mut last = last.take_while(|event| !matches!(event, Event::Resumed { .. }));
    let by = last.find(|event| matches!(event, Event::CutOff { .. }) || is_kill(event));
    let is_cut_off = matches!(by, Some(Event::CutOff { .. })) || exit.is_some_and(Exit::is_cut_off);
    let is_wanted = by.is_some_and(is_kill) || exit.is_some_and(Exit::is_stopped);
    let said = last_lines(&folder.join(OUTPUT_FILE), LINES);
    RunnerDeath { reason, active: crash_artifacts::running(folder), said, is_cut_off, is_wanted }
}

fn is_kill(event: &Event) -> bool {
    let Event::Commanded { envelope, answer } = event else { return false };
    envelope.command == Command::Kill && *answer == Answer::Applied
}

#[cfg(test)]
mod tests {
    use super::{OUTPUT_FILE, death, last_line, last_lines, tail};
    use expect_test::{Expect, expect};
    use rafcon_storage::journal::{About, Journal, Options};
    use rafcon_supervisor::Exit;
    use rafcon_testkit::journal_notation;
    use std::os::unix::process::ExitStatusExt as _;
    use std::process::ExitStatus;

    #[test]
    fn only_the_end_is_read() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(tail(folder.path(), 10).unwrap().bytes, 0);
        let file = folder.path().join("output");
        std::fs::write(&file, "one\ntwo\nthree\n\n").unwrap();
        let output = tail(folder.path(), 7).unwrap();
        assert_eq!((output.text.as_str(), output.from, output.bytes), ("three\n\n", 8, 15));
        assert_eq!(last_line(&file), "three");
        assert_eq!(last_lines(&file, 2), ["three", ""]);
        assert_eq!(last_line(&folder.path().join("none")), "");
    }

    const PLACE: &str = "place R \"Root\" outcome done\nenter R\n";
    const KILL: &str = r#"told {"type":"commanded","envelope":{"id":"1","command":{"type":"kill"}},"answer":{"answer":"applied"}}"#;

    fn check(run: &str, exit: Option<i32>, expect: &Expect) {
        let folder = tempfile::tempdir().unwrap();
        let journal =
            Journal::create(folder.path(), &About::default(), &Options::default()).unwrap();
        journal.append(&journal_notation::batch(&format!("{PLACE}{run}"), 0).unwrap()).unwrap();
        drop(journal);
        std::fs::write(folder.path().join(OUTPUT_FILE), "one\ntwo\n").unwrap();
        let death = death(folder.path(), exit.map(|raw| Exit(ExitStatus::from_raw(raw))));
        expect.assert_eq(&format!("{death:?}"));
    }

    #[test]
    fn a_runner_that_died_by_itself_says_how_and_what_it_said_last() {
        check(
            "",
            Some(11),
            &expect![[
                r#"RunnerDeath { reason: "killed by signal 11 (SIGSEGV)", active: [], said: ["one", "two"], is_cut_off: false, is_wanted: false }"#
            ]],
        );
        check(
            "",
            None,
            &expect![[
                r#"RunnerDeath { reason: "the runner ended before the run", active: [], said: ["one", "two"], is_cut_off: false, is_wanted: false }"#
            ]],
        );
    }

    #[test]
    fn who_killed_it_or_cut_a_script_off_stands_in_the_journal() {
        check(
            KILL,
            Some(137 << 8),
            &expect![[
                r#"RunnerDeath { reason: "exit status 137", active: [], said: ["one", "two"], is_cut_off: false, is_wanted: true }"#
            ]],
        );
        let resumed =
            r#"told {"type":"resumed","life":2,"crash":{"reason":"","active":[]},"policy":"ask"}"#;
        check(
            &format!("{KILL}\n{resumed}"),
            Some(9),
            &expect![[
                r#"RunnerDeath { reason: "killed by signal 9 (SIGKILL)", active: [], said: ["one", "two"], is_cut_off: false, is_wanted: false }"#
            ]],
        );
        check(
            r#"told {"type":"cut_off","path":"R","grace_ms":5}"#,
            None,
            &expect![[
                r#"RunnerDeath { reason: "the runner ended before the run", active: [], said: ["one", "two"], is_cut_off: true, is_wanted: false }"#
            ]],
        );
    }
}
