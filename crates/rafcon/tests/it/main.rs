//! The `rafcon` program as a user has it: the real binary, the real extension, real machines in folders of their own.
//!
//! The extension must have been built: `cargo build --workspace`, or `cargo xtask test`, which does it.

#![expect(clippy::unwrap_used, reason = "a test ends where it goes wrong")]

mod bad_files;
mod bad_scripts;
mod code_cache;
mod commands;
mod corrupt;
mod crowd;
mod debugging;
mod edit_torture;
mod endings;
mod examples;
mod full_disk;
mod harness;
mod hostile_values;
mod kept_runs;
mod link_torture;
mod months;
mod process_output;
mod readme;
mod script_check;
mod served;
mod server_cli;
mod server_drafts;
mod server_runs;
mod server_soak;
mod server_socket;
mod server_torture;
mod server_twice;
mod signals;
mod starts;
mod station;
mod station_contacts;
mod station_lists;
mod station_machines;
mod station_restarts;
mod station_starts;
mod station_trouble;
mod station_values;
mod station_websocket;
mod strangers;
mod terminal;
mod torture;
mod users;
mod waiting;
mod wide;
