//! Storage from outside: machines of every layout, random machines, and machines exchanged with the reference.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its files has failed")]

mod arbitrary;
mod begun;
mod compare;
mod corrupt;
mod folders;
mod journal;
mod kill;
mod layouts;
mod libraries;
mod load;
mod moments;
mod outline;
mod packs;
mod random;
mod reader;
mod reference;
mod replica;
mod save;
mod statistics;
