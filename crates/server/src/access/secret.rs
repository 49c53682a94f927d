//! Secrets: 256 random bits that authenticate a client, and the digest by which the server recognizes them.

use rustix::io::Errno;
use rustix::rand::{GetRandomFlags, getrandom};
use std::fmt;
use std::io;

/// Length of a secret in random bytes.
const BYTES: usize = 32;

/// A secret's text. It is sent once and never appears in debug output.
#[derive(Clone)]
pub(crate) struct Secret(String);

/// The digest of a secret. Two digests are compared in constant time.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Digest(blake3::Hash);

impl Secret {
    /// A new random secret.
    pub(crate) fn new() -> io::Result<Self> {
        Ok(Self(hex(&random::<BYTES>()?)))
    }

    /// The secret in a file. `None` if the text is not valid.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        let fits = text.len() == 2 * BYTES && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        fits.then(|| Self(text.to_owned()))
    }

    pub(crate) fn text(&self) -> &str {
        &self.0
    }

    pub(crate) fn digest(&self) -> Digest {
        Digest::of(&self.0)
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret")
    }
}

impl Digest {
    /// Digest of a claimed secret.
    pub(crate) fn of(text: &str) -> Self {
        Self(blake3::hash(text.as_bytes()))
    }

    /// Its text, as in files.
    pub(crate) fn text(&self) -> String {
        self.0.to_hex().to_string()
    }

    /// Parses the text from a file.
    pub(crate) fn read(text: &str) -> Option<Self> {
        blake3::Hash::from_hex(text).ok().map(Self)
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Digest")
    }
}

/// Random bytes from the system.
pub(crate) fn random<const N: usize>() -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    let mut filled = 0;
    while filled < N {
        match getrandom(&mut bytes[filled..], GetRandomFlags::empty()) {
            Ok(count) => filled += count,
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(bytes)
}

/// Bytes in lower-case hexadecimal.
pub(crate) fn hex(bytes: &[u8]) -> String {
    let digit = |nibble: u8| char::from_digit(u32::from(nibble), 16).unwrap_or('0');
    bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

#[cfg(test)]
mod tests {
    use super::{Digest, Secret};

    #[test]
    fn a_secret_is_known_again_by_its_digest_alone() {
        let (one, other) = (Secret::new().unwrap(), Secret::new().unwrap());
        assert_eq!(one.text().len(), 64);
        assert_eq!(Digest::read(&one.digest().text()), Some(one.digest()));
        assert_ne!(one.digest(), other.digest());
        assert_eq!(format!("{one:?} {:?}", one.digest()), "Secret Digest");
    }

    #[test]
    fn what_cannot_be_a_secret_is_not_read_as_one() {
        assert!(Secret::read("").is_none());
        assert!(Secret::read(&"g".repeat(64)).is_none());
        assert!(Secret::read(&format!("{}\n", "a".repeat(64))).is_some());
    }
}
