//! Makes the record safe, group by group, on a thread of its own. While the disk fails, the run is paused. This module
//! knows the consequences of a failure, but not the journal's format.

use crate::Scripts;
use crate::drive::driver::Driver;
use crate::drive::error::CommitError;
use crate::record::recorder::Recorder;
use crate::record::safety::{CommitterWork, RunAction};
use crate::record::tell;
use rafcon_engine::{Input, Status};
use rafcon_protocol::{Event, LogLevel};
use rafcon_storage::journal::{Journal, JournalError};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::{self, Scope};

/// Starts the threads of the journal, if the run has one.
pub(crate) fn start<'scope, S: Scripts>(
    scope: &'scope Scope<'scope, '_>,
    driver: &'scope Arc<Driver<S>>,
) -> io::Result<()> {
    if driver.recorder().has_journal() {
        let named = |name: &str| thread::Builder::new().name(name.to_owned());
        named("committer").spawn_scoped(scope, || serve(driver.recorder()))?;
        named("journal").spawn_scoped(scope, || attend(driver))?;
        named("roots").spawn_scoped(scope, || driver.roots().serve(driver.record()))?;
    }
    Ok(())
}

/// Commits until the record is closed. Needs no lock that a branch may hold while it waits for a commit.
fn serve(recorder: &Recorder) {
    let Some(journal) = recorder.journal() else { return };
    let safety = recorder.safety();
    loop {
        let work = safety.next_work();
        let bytes = safety.backlog();
        match attempt(|| journal.commit()) {
            Ok(committed) => {
                safety.committed(committed.sequence, bytes);
                recorder.safe_until(committed.sequence);
                if let Some(before) = committed.thinned {
                    safety.thinned(before);
                }
            }
            Err(problem) => safety.failed(&problem.to_string()),
        }
        if work == CommitterWork::Last {
            break;
        }
    }
    safety.over();
    recorder.leave_journal();
    let close = |journal| attempt(|| Journal::close(journal));
    if let Some(Err(problem)) = Arc::into_inner(journal).map(close) {
        let message = format!("the journal could not be finished: {problem}");
        recorder.push(0, [tell::log(String::new(), LogLevel::Warning, message)]);
    }
    recorder.closed();
}

/// Accesses the journal. A panic of RAFCON counts as an error of the journal, so that the run does not wait for ever.
fn attempt<T>(act: impl FnOnce() -> Result<T, JournalError>) -> Result<T, CommitError> {
    match catch_unwind(AssertUnwindSafe(act)) {
        Ok(done) => done.map_err(|error| CommitError::Journal(Box::new(error))),
        Err(_panic) => Err(CommitError::Defect),
    }
}

/// Pauses the run while nothing can be made safe, until the record is closed.
pub(crate) fn attend<S: Scripts>(driver: &Arc<Driver<S>>) {
    let attendant = DiskReporter { driver };
    let mut was = false;
    while let Some(turn) = driver.recorder().safety().next_turn(was) {
        match turn {
            RunAction::Fails(problem) => {
                was = true;
                attendant.fails(&problem);
            }
            RunAction::Works => {
                was = false;
                attendant.works_again();
            }
            RunAction::Thinned(before) => {
                driver.record().note_until_over(tell::told(Event::Thinned { before }));
            }
        }
    }
}

struct DiskReporter<'d, S: Scripts> {
    driver: &'d Arc<Driver<S>>,
}

impl<S: Scripts> DiskReporter<'_, S> {
    /// Pauses the run, so that everything that happens is kept.
    fn fails(&self, problem: &str) {
        let mut pauses = self.driver.journal_pauses().lock();
        *pauses = self.is(Status::Running) && self.driver.command(Input::Pause).is_ok();
        let rest = if *pauses { "; the run is paused until it can be" } else { "" };
        self.say(LogLevel::Error, format!("the journal cannot be written: {problem}{rest}"));
    }

    fn works_again(&self) {
        self.say(LogLevel::Info, "the journal is written again".to_owned());
        let mut pauses = self.driver.journal_pauses().lock();
        if std::mem::take(&mut *pauses)
            && self.is(Status::Paused)
            && let Err(refusal) = self.driver.command(Input::Resume(None))
        {
            self.say(LogLevel::Warning, format!("the run stays paused: {refusal}"));
        }
    }

    fn is(&self, status: Status) -> bool {
        self.driver.with_core(|core| core.engine.status() == status).unwrap_or_default()
    }

    fn say(&self, level: LogLevel, message: String) {
        self.driver.record().note_until_over(tell::log(String::new(), level, message));
    }
}

#[cfg(test)]
mod tests {
    use super::{CommitError, attempt};
    use rafcon_storage::journal::JournalError;

    #[test]
    fn a_panic_in_the_journal_is_a_problem_that_is_named() {
        let problem = attempt(|| -> Result<(), JournalError> { panic!("as the test wants it") });
        assert!(matches!(problem, Err(CommitError::Defect)));
    }
}
