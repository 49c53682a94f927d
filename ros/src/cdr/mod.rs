//! Messages on the wire: CDR (XCDR version 1), as ROS uses it.
//!
//! A value is read from and written to JSON by its type; nothing of it is known when this program is compiled.

pub(crate) mod read;
pub(crate) mod write;

/// Bytes of a unit of UTF-16 in a wide text.
const WIDE_UNIT: usize = 4;

/// The next place at or after `at` that is a multiple of `width`, which is a power of two.
fn aligned(at: usize, width: usize) -> usize {
    (at + width - 1) & !(width - 1)
}

#[cfg(test)]
mod recorded;
#[cfg(test)]
mod tests;
