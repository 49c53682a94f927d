//! Writes a machine: only what changed, in one step that is never half done. Knows the current layout; the older ones are
//! only read.

mod commit;
mod deep;
mod disk;
mod encode;
mod format;
mod lock;
mod manifest;
mod naming;
mod parts;
mod plan;
mod save;

pub use encode::core as core_data;
pub(crate) use encode::{header as header_text, machine_layout as layout_text};
pub use format::{FormatError, Formatted, format};
pub(crate) use lock::settle_before_reading;
pub(crate) use naming::{folder_name, free_name};
pub(crate) use parts::{Old, bytes as file_bytes};
pub use save::{SaveError, save};

#[cfg(test)]
mod kill_tests;
#[cfg(test)]
mod tests;
