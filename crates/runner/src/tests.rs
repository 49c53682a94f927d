//! Whole runs on real threads, with scripts in plain Rust. The first word of a state's name selects its script.

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
