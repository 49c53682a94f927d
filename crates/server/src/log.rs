//! Log lines of the server on the error output. Never pass a secret.

use std::io::{self, Write as _};

/// Logs one line. Ignores a closed error output.
pub(crate) fn say(text: &str) {
    io::stderr().write_all(format!("rafcon serve: {text}\n").as_bytes()).unwrap_or_default();
}
