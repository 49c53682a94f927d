//! The files of one side of a link: which start of it this is, and what it heard before.

use crate::error::RelayError;
use crate::pairing::Pairing;
use rafcon_link::{Generation, Horizon, Identity, KeyId};
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
    pub(crate) generation: Generation,
    /// With which key, and what.
    heard: Option<(KeyId, Horizon)>,
}

impl Start {
    /// The next start of the side whose files lie in `folder`. Its number is safe on the disk when this returns.
    pub(crate) fn begin(folder: &Path) -> Result<Self, RelayError> {
        fs::create_dir_all(folder)
            .map_err(|source| RelayError::Folder { path: folder.to_owned(), source })?;
        let [before] = numbers(&folder.join(START_FILE))?.unwrap_or([0]);
        let next = u32::try_from(before + 1)
            .map_err(|_many| RelayError::Damaged { path: folder.join(START_FILE) })?;
        write(&folder.join(START_FILE), &[u64::from(next)])?;
        let heard = numbers(&folder.join(HEARD_FILE))?.and_then(|[generation, number, key]| {
            let generation = Generation(u32::try_from(generation).ok()?);
            Some((KeyId(u8::try_from(key).ok()?), Horizon { generation, number }))
        });
        Ok(Self { folder: folder.to_owned(), generation: Generation(next), heard })
    }

    /// Where its files lie.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn identity<'k>(&self, pairing: &'k Pairing) -> Identity<'k> {
        Identity {
            key_id: pairing.key_id,
            key: &pairing.key,
            robot: &pairing.robot,
            start: self.generation,
            heard: self.heard.filter(|(key, _)| *key == pairing.key_id).map(|(_, heard)| heard),
        }
    }

    /// Keeps what was heard last, for the next start.
    pub(crate) fn keep_heard(
        &mut self,
        key: KeyId,
        heard: Option<Horizon>,
    ) -> Result<(), RelayError> {
        let heard = heard.map(|heard| (key, heard));
        let Some((_, Horizon { generation, number })) = heard.filter(|_| heard != self.heard)
        else {
            return Ok(());
        };
        let numbers = [u64::from(generation.0), number, u64::from(key.0)];
        write(&self.folder.join(HEARD_FILE), &numbers)?;
        self.heard = heard;
        Ok(())
    }
}

fn numbers<const N: usize>(path: &Path) -> Result<Option<[u64; N]>, RelayError> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(RelayError::Folder { path: path.to_owned(), source }),
    };
    let numbers: Option<Vec<u64>> =
        text.split_whitespace().map(|number| number.parse().ok()).collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.map(Some).ok_or_else(|| RelayError::Damaged { path: path.to_owned() })
}

fn write(path: &Path, numbers: &[u64]) -> Result<(), RelayError> {
    let text = numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(" ");
    replace_file(path, text.as_bytes()).map_err(RelayError::from)
}
