//! CPython as a host of RAFCON's scripts: the extension module `rafcon._native`.
//!
//! Knows Python objects, script states and the Python package `rafcon`. Knows nothing of servers, or of the decisions of a
//! run, which are the engine's.

mod array;
mod build;
mod build_files;
mod build_run;
mod build_value;
mod class;
mod code_cache;
mod codes;
mod condition;
mod config;
mod copy;
mod current;
mod describe;
mod early;
mod edit;
mod edit_run;
mod entry;
mod fork;
mod functions;
mod globals;
mod graveyard;
mod handle;
mod literals;
mod module;
mod package;
mod persistent;
mod planning;
mod polled_events;
mod process;
mod process_output;
mod questions;
mod restore;
mod returned;
mod run;
mod run_messages;
mod runtime;
mod script;
mod scripts;
mod signals;
mod state_objects;
mod state_table;
mod status;
mod thread;
mod value_serializer;
mod view;
