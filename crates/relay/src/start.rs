//! Files of one side of a link: the number of its start, and the last state of the link.

use crate::error::RelayError;
use crate::pairing::Pairing;
use rafcon_link::{Generation, Horizon, Identity, KeyId, Salt, SenderStart};
use rafcon_storage::journal::folder::replace_file;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

const START_FILE: &str = "start";
const HEARD_FILE: &str = "heard";

/// One start of one side.
#[derive(Debug)]
pub(crate) struct Start {
    folder: PathBuf,
    pub(crate) sender: SenderStart,
    /// With which key, and what.
    heard: Option<(KeyId, Horizon)>,
}

impl Start {
    /// The next start of the side whose files lie in `folder`. Its number is safe on the disk when this returns.
    pub(crate) fn begin(folder: &Path) -> Result<Self, RelayError> {
        fs::create_dir_all(folder)
            .map_err(|source| RelayError::Folder { path: folder.to_owned(), source })?;
        let damaged = || RelayError::Damaged { path: folder.join(START_FILE) };
        let before = match numbers(&folder.join(START_FILE))?.as_deref() {
            None => 0,
            Some([before]) => *before,
            Some(_) => return Err(damaged()),
        };
        let next = before.checked_add(1).and_then(|next| u32::try_from(next).ok());
        let next = next.ok_or_else(damaged)?;
        write(&folder.join(START_FILE), &[u64::from(next)])?;
        let salt = Salt::generate().ok_or(RelayError::NoRandomness)?;
        let sender = SenderStart { generation: Generation(next), salt };
        Ok(Self { folder: folder.to_owned(), sender, heard: heard(&folder.join(HEARD_FILE))? })
    }

    /// Folder of its files.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn identity<'k>(&self, pairing: &'k Pairing) -> Identity<'k> {
        Identity {
            key_id: pairing.key_id,
            key: &pairing.key,
            robot: &pairing.robot,
            start: self.sender,
            heard: self.heard.filter(|(key, _)| *key == pairing.key_id).map(|(_, heard)| heard),
        }
    }

    /// Stores the state of the link for the next start.
    pub(crate) fn keep_heard(
        &mut self,
        key: KeyId,
        heard: Option<Horizon>,
    ) -> Result<(), RelayError> {
        let heard = heard.map(|heard| (key, heard));
        let Some((_, Horizon { start, number })) = heard.filter(|_| heard != self.heard) else {
            return Ok(());
        };
        let [generation, salt] = [start.generation.0, start.salt.0].map(u64::from);
        let numbers = [generation, number, u64::from(key.0), salt];
        write(&self.folder.join(HEARD_FILE), &numbers)?;
        self.heard = heard;
        Ok(())
    }
}

/// Last datagram that a start before this one opened, and its key.
fn heard(path: &Path) -> Result<Option<(KeyId, Horizon)>, RelayError> {
    let numbers = numbers(path)?.unwrap_or_default();
    let [generation, number, key, salt] = match numbers[..] {
        [] => return Ok(None),
        // Before version 4 of the link, starts had no salt.
        [generation, number, key] => [generation, number, key, 0],
        [generation, number, key, salt] => [generation, number, key, salt],
        _ => return Err(RelayError::Damaged { path: path.to_owned() }),
    };
    let [generation, salt] = [generation, salt].map(|number| u32::try_from(number).ok());
    let start = generation.zip(salt).map(|(generation, salt)| SenderStart::new(generation, salt));
    let key = u8::try_from(key).ok();
    Ok(start.zip(key).map(|(start, key)| (KeyId(key), Horizon { start, number })))
}

/// Numbers in a file; `None` without a file.
fn numbers(path: &Path) -> Result<Option<Vec<u64>>, RelayError> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(RelayError::Folder { path: path.to_owned(), source }),
    };
    let numbers: Option<Vec<u64>> =
        text.split_whitespace().map(|number| number.parse().ok()).collect();
    let numbers = numbers.filter(|numbers| !numbers.is_empty());
    numbers.map(Some).ok_or_else(|| RelayError::Damaged { path: path.to_owned() })
}

fn write(path: &Path, numbers: &[u64]) -> Result<(), RelayError> {
    let text = numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(" ");
    replace_file(path, text.as_bytes()).map_err(RelayError::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_start_has_a_higher_number_and_a_salt_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = [(); 2].map(|()| Start::begin(folder.path()).unwrap().sender);
        assert_eq!([first.generation, second.generation], [Generation(1), Generation(2)]);
        assert_ne!(first.salt, second.salt);
    }

    #[test]
    fn what_was_heard_is_known_to_the_next_start() {
        let folder = tempfile::tempdir().unwrap();
        let horizon = Horizon { start: SenderStart::new(7, 99), number: 3 };
        Start::begin(folder.path()).unwrap().keep_heard(KeyId(1), Some(horizon)).unwrap();
        let heard = || Start::begin(folder.path()).map(|start| start.heard);
        assert_eq!(heard().unwrap(), Some((KeyId(1), horizon)));
        fs::write(folder.path().join(HEARD_FILE), "7 3 1").unwrap();
        let unsalted = Horizon { start: SenderStart::new(7, 0), number: 3 };
        assert_eq!(heard().unwrap(), Some((KeyId(1), unsalted)));
        fs::write(folder.path().join(HEARD_FILE), "7 x").unwrap();
        assert!(matches!(heard(), Err(RelayError::Damaged { .. })));
    }
}
