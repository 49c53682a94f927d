//! Who is connected to a run: each is sent what it wants, and may command. Must never know how a run begins or ends.

pub(crate) mod commands;
pub(crate) mod connection;
pub(crate) mod listener;
pub(crate) mod viewer;
pub(crate) mod viewer_reader;
pub(crate) mod viewer_set;
