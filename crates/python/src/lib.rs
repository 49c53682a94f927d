//! CPython as a host of RAFCON's scripts: the extension module `rafcon._native`.
//!
//! Knows Python objects, script states and the Python package `rafcon`. Must never know servers, nor what a run decides:
//! that is the engine's.

mod array;
mod build;
mod build_files;
mod build_run;
mod build_value;
mod class;
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
mod keeper;
mod literals;
mod module;
mod orders;
mod package;
mod persistent;
mod process;
mod questions;
mod restore;
mod returned;
mod run;
mod runtime;
mod script;
mod scripts;
mod seat;
mod seating;
mod signals;
mod status;
mod thread;
mod view;
