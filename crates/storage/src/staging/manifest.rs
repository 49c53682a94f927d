//! List of the last steps of a save, after all data is prepared. Encodes and decodes the list, but does not execute it.

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt as _;
use std::path::{Component, Path, PathBuf};

const FIRST_LINE: &[u8] = b"rafcon save 1\n";
const END: &[u8] = b"end";

/// The last steps of a save, in this order. All paths are relative to the machine's folder. The steps are idempotent.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct SaveManifest {
    /// Files and folders to move from the first path to the second; done if the first does not exist.
    pub(crate) moves: Vec<(PathBuf, PathBuf)>,
    /// Files to remove after the moves.
    pub(crate) removed: Vec<PathBuf>,
    /// Folders to remove if they contain no foreign files, inner ones first.
    pub(crate) emptied: Vec<PathBuf>,
}

impl SaveManifest {
    /// Returns true if there are no steps.
    pub(crate) fn is_empty(&self) -> bool {
        self.moves.is_empty() && self.removed.is_empty() && self.emptied.is_empty()
    }

    /// Returns true if the only step is one move.
    pub(crate) fn is_single_move(&self) -> bool {
        self.moves.len() == 1 && self.removed.is_empty() && self.emptied.is_empty()
    }

    /// Encodes the list. A zero byte ends each path, because a path may contain any other byte.
    pub(crate) fn encode(&self) -> Vec<u8> {
        let mut bytes = FIRST_LINE.to_vec();
        for (from, to) in &self.moves {
            entry(&mut bytes, b'm', from);
            entry(&mut bytes, b't', to);
        }
        for path in &self.removed {
            entry(&mut bytes, b'r', path);
        }
        for path in &self.emptied {
            entry(&mut bytes, b'e', path);
        }
        bytes.extend_from_slice(END);
        bytes
    }

    /// Decodes the list. `None` if it is incomplete or leads out of the machine's folder.
    pub(crate) fn decode(bytes: &[u8]) -> Option<Self> {
        let body = bytes.strip_prefix(FIRST_LINE)?.strip_suffix(END)?;
        let mut manifest = Self::default();
        let mut entries = body.split(|byte| *byte == 0);
        loop {
            let entry = entries.next()?;
            let Some((kind, path)) = entry.split_first() else {
                return entries.next().is_none().then_some(manifest);
            };
            let path = inside(path)?;
            match kind {
                b'm' => {
                    let to = entries.next()?.strip_prefix(b"t").and_then(inside)?;
                    manifest.moves.push((path, to));
                }
                b'r' => manifest.removed.push(path),
                b'e' => manifest.emptied.push(path),
                _ => return None,
            }
        }
    }
}

fn entry(bytes: &mut Vec<u8>, kind: u8, path: &Path) {
    bytes.push(kind);
    bytes.extend_from_slice(path.as_os_str().as_bytes());
    bytes.push(0);
}

fn inside(bytes: &[u8]) -> Option<PathBuf> {
    let path = PathBuf::from(OsStr::from_bytes(bytes));
    let is_inside = path.components().all(|part| matches!(part, Component::Normal(_)));
    (is_inside && !bytes.is_empty()).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::SaveManifest;

    fn manifest() -> SaveManifest {
        SaveManifest {
            moves: vec![("a".into(), "b/c d\n".into()), ("e".into(), "f".into())],
            removed: vec!["g".into()],
            emptied: vec!["h".into()],
        }
    }

    #[test]
    fn what_is_written_is_read() {
        for manifest in [manifest(), SaveManifest::default()] {
            assert_eq!(SaveManifest::decode(&manifest.encode()), Some(manifest));
        }
    }

    #[test]
    fn a_part_of_it_is_nothing() {
        let bytes = manifest().encode();
        for length in 0..bytes.len() {
            assert_eq!(SaveManifest::decode(&bytes[..length]), None);
        }
    }

    #[test]
    fn paths_that_lead_out_are_refused() {
        for path in ["/etc/passwd", "../a", "a/../../b", "."] {
            let manifest = SaveManifest { removed: vec![path.into()], ..SaveManifest::default() };
            assert_eq!(SaveManifest::decode(&manifest.encode()), None, "{path}");
        }
    }
}
