//! Storage from outside: machines of every layout, random machines, and the reference reading what we write.

mod arbitrary;
mod folders;
mod layouts;
mod random;
mod reference;
