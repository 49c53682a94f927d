//! Short programs that the server runs for an answer, with a limit on time and output. Does not know the question.

use std::io;
use std::process::{ExitStatus, Stdio};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt as _, AsyncWriteExt as _};
use tokio::process::Command;

/// Limit on the kept bytes of a program's error output.
const ERROR_BYTES: u64 = 4096;

/// Limits on a program's time and output.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChildLimits {
    /// Timeout of the whole run.
    pub(crate) patience: Duration,
    /// Limit on the output, in bytes.
    pub(crate) output: u64,
}

/// Exit status and output of a program.
#[derive(Debug)]
pub(crate) struct ChildOutput {
    pub(crate) status: ExitStatus,
    pub(crate) output: Vec<u8>,
    /// The beginning of its error output.
    pub(crate) error: String,
}

/// Reason why a program returned no result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ChildError {
    /// It does not exist, or cannot be started.
    #[error("it cannot be started")]
    NotStarted(#[source] io::Error),
    /// It exceeded the timeout and was killed.
    #[error("it took longer than {} ms", .0.as_millis())]
    TooLong(Duration),
    /// It exceeded the output limit and was killed.
    #[error("it printed more than {0} bytes")]
    TooMuch(u64),
    /// Its pipes or its exit status cannot be read.
    #[error("it cannot be talked with")]
    Lost(#[source] io::Error),
}

/// Runs a program to its end with this input. Kills it if the future is dropped.
pub(crate) async fn ask(
    mut command: Command,
    input: Vec<u8>,
    bounds: ChildLimits,
) -> Result<ChildOutput, ChildError> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).kill_on_drop(true);
    let mut child = command.spawn().map_err(ChildError::NotStarted)?;
    let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let talk = async {
        let give = async {
            let Some(mut stdin) = stdin else { return };
            // A program that stops reading reports the reason in its output.
            stdin.write_all(&input).await.unwrap_or_default();
        };
        let ((), output, error) =
            tokio::join!(give, heard(stdout, bounds.output + 1), heard(stderr, ERROR_BYTES));
        let output = output.map_err(ChildError::Lost)?;
        if output.len() as u64 > bounds.output {
            return Err(ChildError::TooMuch(bounds.output));
        }
        let error = String::from_utf8_lossy(&error.unwrap_or_default()).trim().to_owned();
        let status = child.wait().await.map_err(ChildError::Lost)?;
        Ok(ChildOutput { status, output, error })
    };
    let said = tokio::time::timeout(bounds.patience, talk).await;
    said.unwrap_or(Err(ChildError::TooLong(bounds.patience)))
}

/// Reads at most `most` bytes and leaves the rest unread: the program then ends, or is killed.
async fn heard(from: Option<impl AsyncRead + Unpin>, most: u64) -> io::Result<Vec<u8>> {
    let mut heard = Vec::new();
    if let Some(from) = from {
        from.take(most).read_to_end(&mut heard).await?;
    }
    Ok(heard)
}

#[cfg(test)]
mod tests {
    use super::{ChildLimits, ask};
    use expect_test::{Expect, expect};
    use std::time::Duration;
    use tokio::process::Command;

    async fn check(patience_ms: u64, script: &str, input: &str, expect: Expect) {
        let mut shell = Command::new("sh");
        shell.args(["-c", script]);
        let bounds = ChildLimits { patience: Duration::from_millis(patience_ms), output: 10 };
        let said = match ask(shell, input.as_bytes().to_vec(), bounds).await {
            Ok(said) => {
                let output = String::from_utf8_lossy(&said.output).into_owned();
                format!("{:?} {output:?} {:?}", said.status.code(), said.error)
            }
            Err(error) => error.to_string(),
        };
        expect.assert_eq(&said);
    }

    #[tokio::test]
    async fn a_program_is_heard_to_its_end_and_no_longer() {
        check(60_000, "cat; echo no >&2; exit 3", "hello", expect![[r#"Some(3) "hello" "no""#]])
            .await;
        check(60_000, "exit 0", &"x".repeat(1 << 20), expect![[r#"Some(0) "" """#]]).await;
        check(60_000, "echo 0123456789", "", expect!["it printed more than 10 bytes"]).await;
        check(60_000, "exec cat /dev/zero", "", expect!["it printed more than 10 bytes"]).await;
        check(50, "exec tail -f /dev/null", "", expect!["it took longer than 50 ms"]).await;
    }
}
