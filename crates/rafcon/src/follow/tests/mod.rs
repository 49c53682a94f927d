//! Runs that are followed, from cause to action.

mod owner;
mod visitor;
