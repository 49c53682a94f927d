//! What is made of a revision of a machine once, for all who ask for it meanwhile. Must never know what it is.

use crate::Failure;
use rafcon_locks::Mutex;

/// Something that was made of the revision that was asked for last.
#[derive(Debug)]
pub(super) struct RevisionCache<T>(Mutex<Option<(u64, T)>>);

impl<T: Clone> RevisionCache<T> {
    /// Perhaps it is there from the beginning.
    pub(super) fn new(kept: Option<(u64, T)>) -> Self {
        Self(Mutex::new(kept))
    }

    /// That of a revision. Who asks while it is made waits for it.
    pub(super) fn of(
        &self,
        revision: u64,
        make: impl FnOnce() -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let mut kept = self.0.lock();
        if let Some((of, value)) = &*kept
            && *of == revision
        {
            return Ok(value.clone());
        }
        let value = make()?;
        *kept = Some((revision, value.clone()));
        Ok(value)
    }
}
