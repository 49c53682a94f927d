//! Maps errors of a journal to responses. Knows both vocabularies.

use crate::failure::reason;
use crate::{Failure, Reason};
use rafcon_storage::journal::JournalError;

impl From<JournalError> for Failure {
    fn from(error: JournalError) -> Self {
        let (why, code) = match &error {
            JournalError::NoRun { .. } => (Reason::NotFound, "no_journal"),
            JournalError::GivenUp { .. } => (Reason::NotFound, "given_up"),
            JournalError::NoMachine { .. } => (Reason::NotFound, "no_such_machine"),
            JournalError::Going { .. } => (Reason::Conflict, "run_goes_on"),
            JournalError::Exists { .. } => (Reason::Conflict, "run_exists"),
            JournalError::Damaged { .. } => (Reason::Unprocessable, "journal_damaged"),
            JournalError::Newer { .. } => (Reason::Unprocessable, "journal_too_new"),
            JournalError::DiskFull { .. }
            | JournalError::ReadOnly { .. }
            | JournalError::Io { .. }
            | JournalError::Database { .. } => (Reason::Unavailable, "journal_unreadable"),
        };
        Self::new(why, code, reason(&error))
    }
}

#[cfg(test)]
mod tests {
    use crate::Failure;
    use expect_test::{Expect, expect};
    use rafcon_storage::journal::{Doing, JournalError};
    use std::io;
    use std::path::PathBuf;

    fn check(error: JournalError, expect: &Expect) {
        let failure = Failure::from(error);
        let refusal = failure.refusal();
        expect.assert_eq(&format!("{} {}: {}", failure.status(), refusal.code, refusal.message));
    }

    #[test]
    fn a_journal_that_cannot_be_read_is_an_answer() {
        let path = PathBuf::from("r/journal.db");
        check(
            JournalError::NoRun { folder: "r".into(), file: "run.json" },
            &expect![
                "404 Not Found no_journal: there is no run in r: it has no run.json; `rafcon runs` lists all runs"
            ],
        );
        check(
            JournalError::Damaged { path: path.clone(), what: "event 3: a tag".to_owned() },
            &expect![
                "422 Unprocessable Entity journal_damaged: r/journal.db is damaged: event 3: a tag; `rafcon history` shows what can still be read"
            ],
        );
        let source = io::Error::from(io::ErrorKind::PermissionDenied);
        check(
            JournalError::Io { path, doing: Doing::Read, source },
            &expect![
                "503 Service Unavailable journal_unreadable: cannot read r/journal.db: check the disk and the permissions: permission denied"
            ],
        );
    }
}
