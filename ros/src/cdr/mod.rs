//! Messages on the wire: CDR (XCDR version 1), as ROS uses it.
//!
//! Values are converted from and to JSON by types that are loaded at run time.

pub(crate) mod read;
pub(crate) mod write;

/// Bytes of a UTF-16 unit in a wide text.
const WIDE_UNIT: usize = 4;

/// The smallest multiple of `width`, a power of two, that is at least `at`.
fn aligned(at: usize, width: usize) -> usize {
    (at + width - 1) & !(width - 1)
}

#[cfg(test)]
mod recorded;
#[cfg(test)]
mod tests;
