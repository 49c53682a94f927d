//! Errors for people: problem, location and remedy on the first line, causes below. Knows the exit codes of errors.

use std::fmt;
use std::io::{self, Write as _};
use std::process::ExitCode;

/// Invalid options; the exit code is 2, as for those that clap refuses.
#[derive(Debug)]
pub(crate) struct Usage(pub(crate) String);

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}

/// Reports an error and returns the exit code. A closed output pipe is no failure.
pub(crate) fn show(error: &anyhow::Error) -> ExitCode {
    if is_broken_pipe(error) {
        return ExitCode::SUCCESS;
    }
    complain(&rendered(error));
    ExitCode::from(if error.is::<Usage>() { 2 } else { 1 })
}

/// Writes to the error output; ignores a closed one, because no other channel exists.
pub(crate) fn complain(text: &str) {
    io::stderr().write_all(format!("{}\n", text.trim_end()).as_bytes()).unwrap_or_default();
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kind = |cause: &(dyn std::error::Error + 'static)| {
        let error = cause.downcast_ref::<io::Error>()?;
        Some(error.kind())
    };
    error.chain().any(|cause| kind(cause) == Some(io::ErrorKind::BrokenPipe))
}

fn rendered(error: &anyhow::Error) -> String {
    let causes = error.chain().skip(1).map(|cause| format!("\n  because: {cause}"));
    let text = format!("error: {error}{}", causes.collect::<String>());
    if error.is::<Usage>() {
        return format!("{text}\n\nFor more information, try '--help'.");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{Usage, rendered};
    use anyhow::Context as _;
    use expect_test::expect;

    #[test]
    fn causes_stand_below_what_they_caused() {
        let result = std::fs::read("/nowhere/at/all").context("cannot read the mission");
        let error = result.context("nothing to show").unwrap_err();
        expect![[r"
            error: nothing to show
              because: cannot read the mission
              because: No such file or directory (os error 2)"]]
        .assert_eq(&rendered(&error));
    }

    #[test]
    fn wrong_usage_points_to_help() {
        expect![[r"
            error: --timeout must be more than 0

            For more information, try '--help'."]]
        .assert_eq(&rendered(&Usage("--timeout must be more than 0".to_owned()).into()));
    }
}
