//! Asks Python about scripts, all in one process; none of them runs.

use anyhow::{Context as _, Result, bail};
use rafcon_check::{Facts, SCRIPT_READER, read_facts, request};
use rafcon_supervisor::Interpreter;
use std::io::Write as _;
use std::process::{Command, Stdio};

/// What Python says about each text. Fails if Python cannot be asked.
pub(super) fn read(texts: &[&str], interpreter: &Interpreter) -> Result<Vec<Facts>> {
    if texts.is_empty() {
        return Ok(Vec::new());
    }
    let mut child = Command::new(&interpreter.program)
        .args(["-I", "-c", SCRIPT_READER])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| {
            format!(
                "cannot start the Python interpreter `{interpreter}`: {}",
                interpreter.way_out()
            )
        })?;
    if let Some(mut stdin) = child.stdin.take() {
        // An interpreter that ends before it has read all says why on its error output.
        stdin.write_all(&request(texts)?).unwrap_or_default();
    }
    let output = child.wait_with_output()?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!(
            "the Python interpreter `{interpreter}` cannot read scripts ({}): {}\n{}",
            output.status,
            interpreter.way_out(),
            said.trim_end()
        );
    }
    read_facts(&output.stdout, texts.len())
        .with_context(|| format!("the Python interpreter `{interpreter}`"))
}
