//! The keys of datagrams in Zenoh. Pure.

use std::fmt;
use std::str::FromStr;

/// A name that is one part of a key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fleet(String);

impl FromStr for Fleet {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        is_part(text).then(|| Self(text.to_owned())).ok_or_else(|| explain("fleet"))
    }
}

impl fmt::Display for Fleet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Description of valid names, for errors.
pub(crate) fn explain(what: &str) -> String {
    format!("a {what} is named by 1 to 64 letters, digits, `.`, `-` and `_`")
}

/// True for a valid name of a robot or a fleet.
pub(crate) fn is_part(name: &str) -> bool {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || ".-_".contains(letter);
    (1..=64).contains(&name.len()) && name.chars().all(fits)
}

impl Fleet {
    /// Datagrams from a robot.
    pub(crate) fn down(&self, robot: &str) -> String {
        format!("rafcon/{self}/{robot}/down")
    }

    /// Datagrams to a robot.
    pub(crate) fn up(&self, robot: &str) -> String {
        format!("rafcon/{self}/{robot}/up")
    }

    /// Announces a robot; only the list of robots uses it.
    pub(crate) fn presence(&self, robot: &str) -> String {
        format!("rafcon/{self}/{robot}")
    }

    /// The robot of this key.
    pub(crate) fn robot<'k>(&self, key: &'k str) -> Option<&'k str> {
        let mut parts = key.strip_prefix("rafcon/")?.split('/');
        let is_own = parts.next()? == self.0;
        parts.next().filter(|robot| is_own && is_part(robot))
    }
}

#[cfg(test)]
mod tests {
    use super::Fleet;

    #[test]
    fn a_key_names_fleet_robot_and_direction() {
        let fleet: Fleet = "mars".parse().unwrap();
        assert_eq!(fleet.down("scout"), "rafcon/mars/scout/down");
        assert_eq!(fleet.up("scout"), "rafcon/mars/scout/up");
        for key in [fleet.down("scout"), fleet.up("scout"), fleet.presence("scout")] {
            assert_eq!(fleet.robot(&key), Some("scout"));
        }
        for key in ["rafcon/moon/scout/down", "rafcon/mars", "rafcon/mars/**", "mars/scout"] {
            assert_eq!(fleet.robot(key), None, "{key}");
        }
        for name in ["", "a/b", "*", "$*", "ä"] {
            assert!(name.parse::<Fleet>().is_err(), "{name}");
        }
    }
}
