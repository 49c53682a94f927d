//! Passwords and their hashes. Slow on purpose: call only from blocking threads.

use crate::settings::HashCost;
use argon2::password_hash::PasswordHasher as _;
use argon2::password_hash::phc::{Output, PasswordHash};
use argon2::{Algorithm, Argon2, Block, Params, Version};
use rafcon_locks::Mutex;

/// The minimum length of a password, in characters.
pub(super) const LENGTH_MIN: usize = 10;
/// The maximum length in bytes; it limits the work of hashing.
pub(super) const BYTES_MAX: usize = 1024;

/// A secret cannot be generated or hashed.
#[derive(Debug, thiserror::Error)]
#[error("cannot make or hash a secret: {0}")]
pub struct HashError(String);

impl HashError {
    pub(super) fn new(error: &dyn std::error::Error) -> Self {
        Self(error.to_string())
    }
}

/// The hash of a password.
pub(super) fn hash(password: &str, cost: HashCost) -> Result<String, HashError> {
    let params = Params::new(cost.memory_kib, cost.passes, 1, None);
    let params = params.map_err(|error| HashError::new(&error))?;
    let hasher = Argon2::new(Algorithm::Argon2id, Version::V0x13, params);
    let hash = hasher.hash_password(password.as_bytes());
    let hash = hash.map_err(|error| HashError::new(&error))?;
    Ok(hash.to_string())
}

/// Reusable memory for password checks. If it were freed, the allocator would keep some per thread.
#[derive(Debug, Default)]
pub(super) struct HashMemory {
    spare: Mutex<Vec<Vec<Block>>>,
}

impl HashMemory {
    /// True if the password has the hash `kept`. Without a hash, the check takes as long and fails.
    pub(super) fn is_right(&self, password: &str, kept: Option<&str>, cost: HashCost) -> bool {
        let kept = kept.and_then(|kept| PasswordHash::new(kept).ok());
        let none = || Params::new(cost.memory_kib, cost.passes, 1, None).unwrap_or_default();
        let (params, salt, expected) = match kept.as_ref().and_then(parts) {
            Some((params, salt, hash)) => (params, salt, Some(hash)),
            None => (none(), &[0; 16][..], None),
        };
        let length = expected.map_or(Params::DEFAULT_OUTPUT_LEN, Output::len);
        let output = self.output(password, params, salt, length);
        output.is_some_and(|output| expected == Some(&output))
    }

    fn output(&self, password: &str, params: Params, salt: &[u8], length: usize) -> Option<Output> {
        let mut memory = self.spare.lock().pop().unwrap_or_default();
        memory.resize(params.block_count(), Block::default());
        let mut output = [0; Output::MAX_LENGTH];
        let output = output.get_mut(..length)?;
        let hasher = Argon2::new(Algorithm::Argon2id, Version::V0x13, params);
        let hashed =
            hasher.hash_password_into_with_memory(password.as_bytes(), salt, output, &mut memory);
        self.spare.lock().push(memory);
        hashed.ok().and_then(|()| Output::new(output).ok())
    }
}

/// Parameters, salt and hash, if it is a hash made by [`hash`].
fn parts(kept: &PasswordHash) -> Option<(Params, &[u8], &Output)> {
    let is_ours =
        kept.algorithm.as_str() == "argon2id" && kept.version == Some(Version::V0x13.into());
    let params = Params::try_from(kept).ok().filter(|_| is_ours)?;
    Some((params, kept.salt.as_ref()?.as_ref(), kept.hash.as_ref()?))
}

/// True if the hash was made at this cost.
pub(super) fn is_of(kept: &str, cost: HashCost) -> bool {
    let head = format!("$argon2id$v=19$m={},t={},p=1$", cost.memory_kib, cost.passes);
    kept.starts_with(&head)
}

#[cfg(test)]
mod tests {
    use super::{HashMemory, hash, is_of};
    use crate::settings::HashCost;

    const CHEAP: HashCost = HashCost { memory_kib: 8, passes: 1 };

    #[test]
    fn a_password_is_known_again() {
        let (kept, memory) = (hash("correct horse", CHEAP).unwrap(), HashMemory::default());
        let is_right = |password, kept| memory.is_right(password, kept, CHEAP);
        assert!(is_right("correct horse", Some(&*kept)));
        assert!(!is_right("wrong horse", Some(&kept)));
        assert!(!is_right("correct horse", None));
        assert!(!is_right("correct horse", Some("$broken")));
        assert!(!is_right("correct horse", Some(&kept.replace("argon2id", "argon2i"))));
    }

    #[test]
    fn the_memory_of_one_comparison_serves_the_next() {
        let (kept, memory) = (hash("correct horse", CHEAP).unwrap(), HashMemory::default());
        for kept in [Some(&*kept), None, Some("$broken"), Some(&kept)] {
            memory.is_right("wrong horse", kept, CHEAP);
            assert_eq!(memory.spare.lock().len(), 1);
        }
    }

    #[test]
    fn what_was_kept_cheaply_is_told_apart() {
        let kept = hash("correct horse", CHEAP).unwrap();
        assert!(is_of(&kept, CHEAP));
        assert!(!is_of(&kept, HashCost { memory_kib: 16, passes: 1 }));
    }
}
