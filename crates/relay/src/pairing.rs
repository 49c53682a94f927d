//! What a robot and a station know of each other: a line that is pasted from one to the other.

use rafcon_link::{KeyId, PairingKey};
use std::fmt;
use std::str::FromStr;

const WORD: &str = "rafcon-pairing-1";

/// A robot and a station that share a key.
#[derive(Debug, Clone)]
pub struct Pairing {
    /// The name of the robot.
    pub robot: String,
    /// The number of the key.
    pub key_id: KeyId,
    /// The key.
    pub key: PairingKey,
}

/// Text that is no pairing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "this is no pairing ({0}): paste the whole line that the robot printed, which begins with `{WORD}`"
)]
pub struct BadPairing(&'static str);

impl Pairing {
    /// A new one; nothing if the system gives no randomness or the name is not usable: 1 to 64 letters, digits, `-`, `_` and `.`.
    pub fn generate(robot: &str) -> Option<Self> {
        let key = is_name(robot).then(PairingKey::generate)??;
        Some(Self { robot: robot.to_owned(), key_id: KeyId(key.bytes()[0]), key })
    }
}

fn is_name(name: &str) -> bool {
    let is_usable = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
    (1..=64).contains(&name.len()) && name.chars().all(is_usable)
}

impl fmt::Display for Pairing {
    /// The line to paste. It holds the key.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{WORD} {} {} ", self.robot, self.key_id.0)?;
        self.key.bytes().iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl FromStr for Pairing {
    type Err = BadPairing;

    fn from_str(text: &str) -> Result<Self, BadPairing> {
        let words: Vec<_> = text.split_whitespace().collect();
        let [word, robot, key_id, key] = words[..] else {
            return Err(BadPairing("it has not four words"));
        };
        if word != WORD {
            return Err(BadPairing("it begins otherwise"));
        }
        if !is_name(robot) {
            return Err(BadPairing("the robot's name is none"));
        }
        let key_id = key_id.parse().map_err(|_number| BadPairing("the key has no number"))?;
        let key = hex(key).ok_or(BadPairing("the key is cut or changed"))?;
        Ok(Self {
            robot: robot.to_owned(),
            key_id: KeyId(key_id),
            key: PairingKey::from_bytes(key),
        })
    }
}

fn hex(text: &str) -> Option<[u8; 32]> {
    let digits = text.as_bytes().as_chunks::<2>();
    let (pairs, []) = digits else { return None };
    let byte = |pair: &[u8; 2]| u8::from_str_radix(str::from_utf8(pair).ok()?, 16).ok();
    let bytes: Option<Vec<u8>> = pairs.iter().map(byte).collect();
    bytes?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::Pairing;
    use expect_test::expect;
    use rafcon_link::{KeyId, PairingKey};

    #[test]
    fn a_pairing_is_a_line_that_is_pasted() {
        let key = PairingKey::from_bytes([0xa5; 32]);
        let pairing = Pairing { robot: "scout-1".to_owned(), key_id: KeyId(7), key };
        let line = pairing.to_string();
        expect!["rafcon-pairing-1 scout-1 7 a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5"]
            .assert_eq(&line);
        let pasted: Pairing = format!("  {line}\n").parse().unwrap();
        assert_eq!(pasted.to_string(), line);
        assert!(!format!("{pairing:?}").contains("a5a5"));
    }

    #[test]
    fn a_damaged_line_says_what_is_wrong_with_it() {
        let line = Pairing::generate("scout").unwrap().to_string();
        let cases = [
            String::new(),
            line.replace("rafcon", "raf"),
            line.replace("scout", "../scout"),
            line[..line.len() - 2].to_owned(),
            line.replace(' ', "  x"),
        ];
        let said: Vec<_> =
            cases.iter().map(|case| case.parse::<Pairing>().unwrap_err().to_string()).collect();
        expect![[r"
            this is no pairing (it has not four words): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (it begins otherwise): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (the robot's name is none): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (the key is cut or changed): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (the key has no number): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`"]].assert_eq(&said.join("\n"));
        assert!(Pairing::generate("no spaces").is_none());
    }
}
