//! A compact text for machines that people read and write: for tests, `rafcon show` and bug reports. Knows every part of
//! a [`Machine`](crate::Machine); never the files of RAFCON's own format. The syntax stands in `docs/notation.md`.
//!
//! ```
//! use rafcon_model::notation;
//!
//! let text = r#"
//! hierarchy ROOT "Root"
//!   outcome success
//!   var n: int = 3
//!   start -> AAAAAA
//!   AAAAAA.success -> .success
//!   flow .n -> AAAAAA.x
//!   execution AAAAAA "First"
//!     outcome success
//!     in x: int = 1
//!     script |
//!       def execute(self, inputs, outputs, gvm):
//!           return 0
//! "#;
//! let machine = notation::parse(text)?;
//! assert_eq!(machine.count(), 2);
//! assert_eq!(notation::print(&machine).trim(), text.trim());
//! # Ok::<(), notation::NotationError>(())
//! ```

mod block;
mod connect;
mod draft;
mod parse;
mod print;
mod scan;
mod shared;

pub use parse::{NotationError, parse};
pub use print::{Shown, print, print_state, print_with};

/// Words that begin a line, so that a state with such an id is written in quotes.
const KEYWORDS: &[&str] = &[
    "machine",
    "define",
    "content",
    "execution",
    "decider",
    "hierarchy",
    "barrier",
    "preemptive",
    "library",
    "outcome",
    "without",
    "in",
    "out",
    "var",
    "set",
    "interface",
    "missing",
    "description",
    "semantic",
    "layout",
    "extra",
    "script",
    "flow",
    "start",
    "nowhere",
];

/// Whether a name or id can stand without quotes.
fn is_bare(text: &str) -> bool {
    let mut bytes = text.bytes();
    bytes.next().is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
        && bytes.all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

#[cfg(test)]
mod tests;
