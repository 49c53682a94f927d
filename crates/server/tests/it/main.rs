//! The server as its clients meet it: over HTTP, in a process of its own kind.

mod access;
mod harness;
mod history;
mod leftovers;
mod past;
mod socket;
mod socket_client;
mod socket_runs;
