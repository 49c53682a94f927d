//! Storage from outside: machines of every layout, random machines, and the reference reading what we write.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its files has failed")]

mod arbitrary;
mod folders;
mod journal;
mod kill;
mod layouts;
mod packs;
mod random;
mod reference;
