//! Reads a machine from its folder: every layout of `docs/format.md`, faults as a list of problems.
//! Knows the way from files to the model; must never write, except to finish an interrupted save.

mod assemble;
mod bounds;
mod compact;
mod confine;
mod decode;
mod elements;
mod folder;
mod header;
mod intern;
mod library_content;
mod library_state;
mod load;
mod made;
mod packed;
mod queue;
mod state_files;
mod walk;

pub use decode::state_from_core_data;
pub use load::{LoadError, Loaded, load};
pub(crate) use load::{load_folder, load_locked, machine_folder};
pub use made::fill_library;
pub use packed::load_packed;
pub(crate) use packed::load_packed_folder;

#[cfg(test)]
mod tests;
