//! Passwords and what is kept of them. Slow on purpose: never call this where others wait.

use crate::settings::HashCost;
use argon2::password_hash::phc::PasswordHash;
use argon2::password_hash::{PasswordHasher as _, PasswordVerifier as _};
use argon2::{Algorithm, Argon2, Params, Version};

/// How many characters a password has at least.
pub(super) const LENGTH_MIN: usize = 10;
/// How many bytes it has at most: hashing more is work for nothing.
pub(super) const BYTES_MAX: usize = 1024;

/// Why a secret cannot be made or kept.
#[derive(Debug, thiserror::Error)]
#[error("cannot make or hash a secret: {0}")]
pub struct HashError(String);

impl HashError {
    pub(super) fn new(error: &dyn std::error::Error) -> Self {
        Self(error.to_string())
    }
}

/// What is kept of a password.
pub(super) fn hash(password: &str, cost: HashCost) -> Result<String, HashError> {
    let params = Params::new(cost.memory_kib, cost.passes, 1, None);
    let params = params.map_err(|error| HashError::new(&error))?;
    let hasher = Argon2::new(Algorithm::Argon2id, Version::V0x13, params);
    let hash = hasher.hash_password(password.as_bytes());
    let hash = hash.map_err(|error| HashError::new(&error))?;
    Ok(hash.to_string())
}

/// Whether this is the password of which `kept` was kept. Where nothing was, it takes as long to say no.
pub(super) fn is_right(password: &str, kept: Option<&str>, cost: HashCost) -> bool {
    match kept.map(PasswordHash::new) {
        Some(Ok(kept)) => Argon2::default().verify_password(password.as_bytes(), &kept).is_ok(),
        Some(Err(_)) | None => hash(password, cost).is_err(),
    }
}

/// Whether it was kept at this cost.
pub(super) fn is_of(kept: &str, cost: HashCost) -> bool {
    let head = format!("$argon2id$v=19$m={},t={},p=1$", cost.memory_kib, cost.passes);
    kept.starts_with(&head)
}

#[cfg(test)]
mod tests {
    use super::{hash, is_of, is_right};
    use crate::settings::HashCost;

    const CHEAP: HashCost = HashCost { memory_kib: 8, passes: 1 };

    #[test]
    fn a_password_is_known_again() {
        let kept = hash("correct horse", CHEAP).unwrap();
        assert!(is_right("correct horse", Some(&kept), CHEAP));
        assert!(!is_right("wrong horse", Some(&kept), CHEAP));
        assert!(!is_right("correct horse", None, CHEAP));
        assert!(!is_right("correct horse", Some("$broken"), CHEAP));
    }

    #[test]
    fn what_was_kept_cheaply_is_told_apart() {
        let kept = hash("correct horse", CHEAP).unwrap();
        assert!(is_of(&kept, CHEAP));
        assert!(!is_of(&kept, HashCost { memory_kib: 16, passes: 1 }));
    }
}
