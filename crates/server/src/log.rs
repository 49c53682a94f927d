//! What the server has to say to whoever runs it: a line on the error output. Secrets never come here.

use std::io::{self, Write as _};

/// Says it; if no one listens there is no one to tell.
pub(crate) fn say(text: &str) {
    io::stderr().write_all(format!("rafcon serve: {text}\n").as_bytes()).unwrap_or_default();
}
