//! A compact text for machines that people read and tests write: for `rafcon show` and bug reports. Knows every part of a
//! [`Machine`](crate::Machine); never the files of RAFCON's own format. The syntax stands in `docs/notation.md`; only
//! tests read it.
//!
//! ```
//! use rafcon_testkit::notation;
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

mod print;
mod shared;
mod words;

pub use print::{Shown, print, print_with};
