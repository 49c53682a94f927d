//! Any edits on any machine.
