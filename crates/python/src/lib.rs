//! CPython as a host of RAFCON's scripts: the extension module `rafcon._native`.
//!
//! Knows Python objects, script states and the Python package `rafcon`. Must never know servers, nor what a run decides:
//! that is the engine's.

mod class;
mod codes;
mod config;
mod copy;
mod current;
mod describe;
mod entry;
mod fork;
mod functions;
mod graveyard;
mod handle;
mod literals;
mod module;
mod package;
mod process;
mod returned;
mod run;
mod runtime;
mod script;
mod scripts;
mod seat;
mod signals;
mod status;
mod thread;
