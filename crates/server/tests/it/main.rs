//! The server over HTTP, as its clients use it.

#![expect(clippy::unwrap_used, reason = "a test ends where it goes wrong")]

mod access;
mod attacks;
mod command_lists;
mod contacts;
mod drafts;
mod harness;
mod history;
mod leftovers;
mod linked;
mod machines;
mod page;
mod past;
mod plans;
mod proxy;
mod raw;
mod rights;
mod saving;
mod scripts;
mod socket;
mod socket_client;
mod socket_machines;
mod socket_runs;
mod spellings;
mod tls;
mod together;
mod usages;
mod versions;
