//! What a runner and its scripts wrote past the capture of script output. Knows one file; reads a bounded piece of its end.

use super::launch::OUTPUT_FILE;
use crate::Failure;
use axum::http::StatusCode;
use rafcon_protocol::api::RunOutput;
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;

/// So much is read if nobody says how much.
pub(super) const USUAL_BYTES: u64 = 64 * 1024;
/// So much is read at most.
pub(super) const BYTES_MAX: u64 = 1 << 20;

/// The last `bytes` of what the run in `folder` wrote; nothing if it wrote nothing.
pub(super) fn tail(folder: &Path, bytes: u64) -> Result<RunOutput, Failure> {
    match read(&folder.join(OUTPUT_FILE), bytes.min(BYTES_MAX)) {
        Ok(output) => Ok(output),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(RunOutput::default()),
        Err(error) => {
            let message = format!("the output of this run cannot be read: {error}");
            Err(Failure::new(StatusCode::SERVICE_UNAVAILABLE, "output_unreadable", message))
        }
    }
}

/// The last line of a file that says something; empty if there is none.
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

#[cfg(test)]
mod tests {
    use super::{last_line, last_lines, tail};

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
}
