//! Whole runs on real threads, with scripts of plain Rust: what a state does is said by the first word of its name.

mod bounds;
mod changes;
mod ground;
mod holding;
mod keeping;
mod limits;
mod players;
mod pulse;
mod resuming;
mod runs;
mod served;
mod stress;
mod talks;
