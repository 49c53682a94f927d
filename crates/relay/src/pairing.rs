//! Pairing of a robot and a station: a line that is pasted from one to the other.

use crate::rights::PairingRights;
use rafcon_link::{KeyId, PairingKey};
use rafcon_protocol::{AT_ROBOT, AT_STATION};
use rafcon_storage::journal::{JournalError, folder::replace_file, make_folder};
use std::fmt;
use std::fs;
use std::path::PathBuf;
use std::str::FromStr;

const WORD: &str = "rafcon-pairing-1";
/// The word with the rights, if they are not the usual ones, begins like this.
const RIGHTS: &str = "rights:";

/// A robot and a station that share a key.
#[derive(Debug, Clone)]
pub struct Pairing {
    /// The name of the robot.
    pub robot: String,
    /// The name of the station, if the robot has several.
    pub station: Option<String>,
    /// The number of the key.
    pub key_id: KeyId,
    /// The key.
    pub key: PairingKey,
    /// Rights of the station. The robot enforces its own copy.
    pub rights: PairingRights,
}

/// Text that is no pairing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "this is no pairing ({0}): paste the whole line that the robot printed, which begins with `{WORD}`"
)]
pub struct BadPairing(&'static str);

impl Pairing {
    /// Creates a pairing. `None` without randomness or with an invalid name. A name has 1 to 64 letters, digits, `-`, `_` and
    /// `.`.
    pub fn generate(robot: &str, station: Option<&str>) -> Option<Self> {
        let is_usable = is_name(robot) && station.is_none_or(is_station);
        let key = is_usable.then(PairingKey::generate)??;
        let station = station.map(str::to_owned);
        let (key_id, rights) = (KeyId(key.bytes()[0]), PairingRights::default());
        Some(Self { robot: robot.to_owned(), station, key_id, key, rights })
    }

    /// Creates another key for this pairing. `None` without randomness.
    pub fn renewed(&self) -> Option<Self> {
        loop {
            let next = Self::generate(&self.robot, self.station.as_deref())?;
            let next = Self { rights: self.rights, ..next };
            // The number differs from the previous one, in its last bits too.
            if next.key_id.0 % 4 != self.key_id.0 % 4 {
                return Some(next);
            }
        }
    }

    /// Distinguishes pairings of one robot in files, without the key.
    pub(crate) fn tag(&self) -> String {
        let hash = blake3::derive_key("rafcon 2026 tag of a pairing", self.key.bytes());
        hash[..8].iter().fold(String::new(), |tag, byte| format!("{tag}{byte:02x}"))
    }

    /// Suffix of the names of the station's users at the robot.
    pub(crate) fn station_name(&self) -> &str {
        self.station.as_deref().unwrap_or(AT_STATION.trim_start_matches('@'))
    }
}

/// A pairing with the files that keep it.
#[derive(Debug, Clone)]
pub struct Paired {
    /// The pairing.
    pub pairing: Pairing,
    /// Its file.
    pub file: PathBuf,
    /// File of the next pairing: offered by the robot, or accepted by the station.
    pub next: PathBuf,
}

impl Paired {
    /// The pairing that is to replace this one.
    pub(crate) fn read_next(&self) -> Option<Pairing> {
        let next: Pairing = fs::read_to_string(&self.next).ok()?.parse().ok()?;
        (next.robot == self.pairing.robot).then_some(next)
    }

    /// Keeps the pairing that is to replace this one.
    pub fn keep_next(&self, next: &Pairing) -> Result<(), JournalError> {
        if let Some(folder) = self.next.parent() {
            make_folder(folder)?;
        }
        replace_file(&self.next, format!("{next}\n").as_bytes())
    }

    /// Replaces the pairing.
    pub(crate) fn replace(&self, next: &Pairing) -> Result<(), JournalError> {
        replace_file(&self.file, format!("{next}\n").as_bytes())?;
        // A file that remains equals the pairing and is ignored.
        drop(fs::remove_file(&self.next));
        Ok(())
    }
}

/// True if this is a valid name of a station. It separates the station's users from those of the robot.
fn is_station(name: &str) -> bool {
    is_name(name) && name != AT_ROBOT.trim_start_matches('@')
}

fn is_name(name: &str) -> bool {
    let is_usable = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
    (1..=64).contains(&name.len()) && name.chars().all(is_usable)
}

impl fmt::Display for Pairing {
    /// The line to paste. It holds the key.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{WORD} {} {} ", self.robot, self.key_id.0)?;
        self.key.bytes().iter().try_for_each(|byte| write!(f, "{byte:02x}"))?;
        self.station.iter().try_for_each(|station| write!(f, " {station}"))?;
        match self.rights {
            PairingRights::Command => Ok(()),
            rights => write!(f, " {RIGHTS}{rights}"),
        }
    }
}

impl FromStr for Pairing {
    type Err = BadPairing;

    fn from_str(text: &str) -> Result<Self, BadPairing> {
        let mut words: Vec<_> = text.split_whitespace().collect();
        let rights = words.last().and_then(|word| word.strip_prefix(RIGHTS)).map(str::parse);
        if rights.is_some() {
            words.pop();
        }
        let rights = rights.unwrap_or(Ok(PairingRights::default()));
        let rights = rights.map_err(|_bad| BadPairing("it names unknown rights"))?;
        let ([word, robot, key_id, key], station) = match words[..] {
            [word, robot, key_id, key] => ([word, robot, key_id, key], None),
            [word, robot, key_id, key, station] => ([word, robot, key_id, key], Some(station)),
            _ => return Err(BadPairing("it has neither four nor five words")),
        };
        if word != WORD {
            return Err(BadPairing("it begins otherwise"));
        }
        if !is_name(robot) {
            return Err(BadPairing("the robot's name is none"));
        }
        if !station.is_none_or(is_station) {
            return Err(BadPairing("the station's name is none"));
        }
        let key_id = key_id.parse().map_err(|_number| BadPairing("the key has no number"))?;
        let key = hex(key).ok_or(BadPairing("the key is cut or changed"))?;
        Ok(Self {
            robot: robot.to_owned(),
            station: station.map(str::to_owned),
            key_id: KeyId(key_id),
            key: PairingKey::from_bytes(key),
            rights,
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
    use crate::rights::PairingRights;
    use expect_test::expect;
    use rafcon_link::{KeyId, PairingKey};

    #[test]
    fn a_pairing_is_a_line_that_is_pasted() {
        let key = PairingKey::from_bytes([0xa5; 32]);
        let (robot, key_id) = ("scout-1".to_owned(), KeyId(7));
        let rights = PairingRights::default();
        let pairing = Pairing { robot, station: None, key_id, key, rights };
        let line = pairing.to_string();
        expect!["rafcon-pairing-1 scout-1 7 a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5"]
            .assert_eq(&line);
        let pasted: Pairing = format!("  {line}\n").parse().unwrap();
        assert_eq!(pasted.to_string(), line);
        assert!(!format!("{pairing:?}").contains("a5a5"));
        let named = Pairing { station: Some("base".to_owned()), ..pairing };
        assert_eq!(named.to_string(), format!("{line} base"));
        assert_eq!(named.to_string().parse::<Pairing>().unwrap().to_string(), named.to_string());
        let observing = Pairing { rights: PairingRights::Observe, ..named };
        assert_eq!(observing.to_string(), format!("{line} base rights:observe"));
        let read: Pairing = observing.to_string().parse().unwrap();
        assert_eq!((read.rights, read.station.as_deref()), (PairingRights::Observe, Some("base")));
        assert_eq!(read.renewed().unwrap().rights, PairingRights::Observe);
    }

    #[test]
    fn a_damaged_line_says_what_is_wrong_with_it() {
        let line = Pairing::generate("scout", None).unwrap().to_string();
        let cases = [
            String::new(),
            line.replace("rafcon", "raf"),
            line.replace("scout", "../scout"),
            line[..line.len() - 2].to_owned(),
            line.replace(' ', "  x"),
            format!("{line} robot"),
            format!("{line} base 2"),
        ];
        let said: Vec<_> =
            cases.iter().map(|case| case.parse::<Pairing>().unwrap_err().to_string()).collect();
        expect![[r"
            this is no pairing (it has neither four nor five words): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (it begins otherwise): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (the robot's name is none): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (the key is cut or changed): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (the key has no number): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (the station's name is none): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`
            this is no pairing (it has neither four nor five words): paste the whole line that the robot printed, which begins with `rafcon-pairing-1`"]].assert_eq(&said.join("\n"));
        assert!(Pairing::generate("no spaces", None).is_none());
        assert!(Pairing::generate("scout", Some("robot")).is_none());
    }
}
