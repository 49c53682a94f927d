//! Error output for a run that did not finish.

use crate::failure::complain;
use crate::follow::End;
use crate::view::Names;
use rafcon_supervisor::{RunnerDeath, crash_artifacts};
use std::collections::BTreeMap;
use std::path::Path;

/// Reports the end to the user; a finished run has already been shown. `run` is its name in commands, if it can be resumed.
/// `folder` is its folder, if it is on this computer.
pub(super) fn end(
    end: &End,
    run: Option<&str>,
    folder: Option<&Path>,
    names: impl FnOnce() -> Names,
) {
    if matches!(end, End::Finished { timed_out: false, .. }) {
        return;
    }
    let mut names = names();
    let logged = end
        .active()
        .zip(folder)
        .map(|(active, folder)| crash_artifacts::last_logged(folder, active));
    complain(&(text(end, &mut names) + &said(&logged.unwrap_or_default(), &mut names)));
    if let (End::Died(_) | End::Killed { .. }, Some(run)) = (end, run) {
        complain(&way_out(run));
    }
}

fn said(logged: &BTreeMap<String, String>, names: &mut Names) -> String {
    let line = |(path, message): (&String, &String)| {
        format!("{}: {}", names.path(path), message.lines().last().unwrap_or_default())
    };
    block("last log lines of these states:", &logged.iter().map(line).collect::<Vec<_>>())
}

/// Hint for resuming an interrupted run; `run` is its name in commands.
fn way_out(run: &str) -> String {
    format!(
        "  the run is recorded up to this point; resume it:\n    rafcon resume {run} --policy abort   (abort the interrupted states; recovery transitions take over)\n    rafcon resume {run}                  (wait until you decide)"
    )
}

/// Text of an end.
fn text(end: &End, names: &mut Names) -> String {
    match end {
        End::Finished { timed_out: false, .. } | End::Left => String::new(),
        End::Finished { timed_out: true, .. } => {
            "error: the time limit of --timeout expired; the machine was stopped".to_owned()
        }
        End::OnlyWaited { awaited } => {
            format!("error: the run could only wait for {awaited}: add it to the machine")
        }
        End::LoadFailed { reason } => format!("error: {reason}"),
        End::NotStarted { reason, said } => format!(
            "error: the Python interpreter did not become a runner: {reason}{}",
            block("last output:", said)
        ),
        End::Killed { timed_out: true, has_begun: false, .. } => {
            "error: the time limit of --timeout expired before the Python process answered; it was killed, and no state has run"
                .to_owned()
        }
        End::Killed { timed_out: true, active, .. } => format!(
            "error: the time limit of --timeout expired and the machine did not stop; the run was killed{}",
            block("states that did not end:", &named(active, names))
        ),
        End::Killed { timed_out: false, has_begun: false, .. } => {
            "error: killed before the run began".to_owned()
        }
        End::Killed { timed_out: false, active, .. } => format!(
            "error: killed; the machine's recovery did not run{}",
            block("active states:", &named(active, names))
        ),
        End::Died(RunnerDeath { reason, active, said, .. }) => format!(
            "error: the Python process that ran the machine died: {reason}{}{}",
            block("active states:", &named(active, names)),
            block("last output:", said)
        ),
    }
}

fn named(paths: &[String], names: &mut Names) -> Vec<String> {
    let named = |path: &String| {
        let name = names.path(path);
        if *name == **path { path.clone() } else { format!("{name} ({path})") }
    };
    paths.iter().map(named).collect()
}

fn block(head: &str, lines: &[String]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let lines = lines.iter().map(|line| format!("\n    {line}"));
    format!("\n  {head}{}", lines.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::text;
    use crate::follow::End;
    use crate::view::Names;
    use expect_test::{Expect, expect};
    use rafcon_supervisor::RunnerDeath;
    use rafcon_testkit::notation;

    fn check(end: &End, expect: &Expect) {
        let machine = "hierarchy ROOT \"Mission\"\n  execution SCANID \"Scan\"\n";
        let mut names = Names::new(move || notation::parse(machine).ok());
        expect.assert_eq(&text(end, &mut names));
    }

    #[test]
    fn a_death_names_the_signal_the_states_and_the_last_words() {
        let death = RunnerDeath {
            reason: "killed by signal 11 (SIGSEGV)".to_owned(),
            active: vec!["ROOT/SCANID".to_owned(), "ROOT/X".to_owned()],
            said: vec!["Fatal Python error: Segmentation fault".to_owned()],
            ..RunnerDeath::default()
        };
        check(
            &End::Died(death),
            &expect![[r"
            error: the Python process that ran the machine died: killed by signal 11 (SIGSEGV)
              active states:
                Mission/Scan (ROOT/SCANID)
                ROOT/X
              last output:
                Fatal Python error: Segmentation fault"]],
        );
    }

    #[test]
    fn a_machine_that_did_not_stop_is_named() {
        let active = vec!["ROOT/SCANID".to_owned()];
        let end = End::Killed { timed_out: true, has_begun: true, active };
        check(
            &end,
            &expect![[r"
            error: the time limit of --timeout expired and the machine did not stop; the run was killed
              states that did not end:
                Mission/Scan (ROOT/SCANID)"]],
        );
    }
}
