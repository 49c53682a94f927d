//! The fingerprint of a certificate: SHA-256 of all of it. Pure.

use std::fmt;

const BYTES: usize = 32;

/// SHA-256 hash that identifies a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Fingerprint([u8; BYTES]);

impl Fingerprint {
    /// The fingerprint of a certificate in DER form.
    pub(crate) fn of(certificate: &[u8]) -> Self {
        let digest = ring::digest::digest(&ring::digest::SHA256, certificate);
        let mut bytes = [0; BYTES];
        bytes.copy_from_slice(digest.as_ref());
        Self(bytes)
    }

    /// Parses the form that people write: 64 hexadecimal digits, with or without colons between.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let text = text.strip_prefix("SHA256:").or(text.strip_prefix("sha256:")).unwrap_or(text);
        let digits: Vec<u8> = text
            .chars()
            .filter(|c| *c != ':')
            .map(|c| c.to_digit(16).and_then(|digit| u8::try_from(digit).ok()))
            .collect::<Option<_>>()?;
        let bytes: Vec<u8> = digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect();
        (digits.len() == 2 * BYTES).then(|| bytes.try_into().ok())?.map(Self)
    }

    /// Lower-case hexadecimal digits without colons.
    pub(crate) fn hex(&self) -> String {
        let bytes: Vec<String> = self.0.iter().map(|byte| format!("{byte:02x}")).collect();
        bytes.concat()
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes: Vec<String> = self.0.iter().map(|byte| format!("{byte:02X}")).collect();
        write!(f, "SHA256 {}", bytes.join(":"))
    }
}

#[cfg(test)]
mod tests {
    use super::Fingerprint;

    #[test]
    fn it_is_read_as_it_is_written() {
        let print = Fingerprint::of(b"certificate");
        assert_eq!(Fingerprint::parse(&print.hex()), Some(print));
        let shown = print.to_string();
        let bytes = shown.strip_prefix("SHA256 ").unwrap();
        assert_eq!(Fingerprint::parse(bytes), Some(print));
        assert_eq!(Fingerprint::parse(&format!("sha256:{}", print.hex())), Some(print));
        assert_eq!(shown.len(), 7 + 32 * 3 - 1);
    }

    #[test]
    fn anything_else_is_none() {
        for text in ["", "ab", "xyz", &"a".repeat(63), &"a".repeat(66), &"ä".repeat(64)] {
            assert_eq!(Fingerprint::parse(text), None, "{text}");
        }
    }
}
