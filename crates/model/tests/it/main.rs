//! The model from outside: machines in the notation in, what becomes of them out.

mod diff;
mod edits;
mod history;
mod problems;
