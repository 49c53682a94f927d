//! The ids by which clients name what they ask for, so that it is done once. Must never know what is asked.

use crate::Failure;

/// An id is no longer, in bytes.
const LENGTH_MAX: usize = 128;

/// Refuses what is no id.
pub(crate) fn check(id: &str) -> Result<(), Failure> {
    if id.is_empty() || id.len() > LENGTH_MAX {
        let message =
            format!("an id has 1 to {LENGTH_MAX} bytes: a random one does for each request");
        return Err(Failure::bad("bad_id", message));
    }
    Ok(())
}
