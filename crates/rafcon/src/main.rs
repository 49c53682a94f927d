//! The `rafcon` command.
fn main() {}
