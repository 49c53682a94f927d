//! Files of large values. Whoever makes a value writes its file; before an event that names it is safe, the file is.

use super::error::{Doing, JournalError};
use super::folder::{VALUES_FOLDER, sync_folder};
use super::record::{Content, Stored, ValueNumber};
use std::fs::File;
use std::io;
use std::path::Path;

/// Makes the files of `values` safe from a power cut. A value whose file is not there has no content.
pub(super) fn settle(
    folder: &Path,
    values: &mut [(ValueNumber, Stored)],
) -> Result<(), JournalError> {
    let folder = folder.join(VALUES_FOLDER);
    let mut any = false;
    for (_, stored) in values {
        let Content::File { hash, .. } = &stored.content else { continue };
        let path = folder.join(hash);
        match File::open(&path).and_then(|file| file.sync_all()) {
            Ok(()) => any = true,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                stored.content = Content::Nothing("its file is gone".to_owned());
            }
            Err(source) => return Err(JournalError::io(&path, Doing::Sync, source)),
        }
    }
    if any { sync_folder(&folder) } else { Ok(()) }
}
