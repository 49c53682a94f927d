//! A machine to send to a receiver that has some of its files: the new files, and references to the parcels with the others.
//!
//! Handles manifests and bytes, not their transport or storage.

use super::{Hash, Manifest};
use crate::journal::record::binary::{BinaryReader, BinaryWriter, Broken};
use std::collections::BTreeMap;

/// A machine in the form in which it is sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parcel {
    /// Hash of the machine's manifest.
    pub machine: Hash,
    /// Name of the parcel with the base manifest, which is stored there completely.
    pub base: Option<Hash>,
    /// Names of all parcels with files that this one needs.
    pub needs: Vec<Hash>,
    /// The manifest, as changes of the base manifest.
    changes: Vec<u8>,
    /// Content of the files that no other parcel has.
    pub fresh: BTreeMap<Hash, Vec<u8>>,
}

impl Parcel {
    /// Creates the parcel of a machine with the files `fresh`. The parcels in `needs` have the others. `base` has a similar
    /// manifest.
    pub fn new(
        manifest: &Manifest,
        base: Option<(Hash, &Manifest)>,
        mut needs: Vec<Hash>,
        fresh: BTreeMap<Hash, Vec<u8>>,
    ) -> Self {
        let whole = manifest.changes(&Manifest::default());
        let changes = base.map(|(name, base)| (name, manifest.changes(base)));
        let (base, changes) = match changes.filter(|(_, changes)| changes.len() < whole.len()) {
            Some((name, changes)) => (Some(name), changes),
            None => (None, whole),
        };
        needs.extend(base.filter(|base| !needs.contains(base)));
        Self { machine: manifest.hash(), base, needs, changes, fresh }
    }

    /// Returns the manifest of the machine, given the base manifest. `None` if the result has another hash.
    pub fn manifest(&self, base: Manifest) -> Option<Manifest> {
        let manifest = base.changed(&self.changes).ok()?;
        (manifest.hash() == self.machine).then_some(manifest)
    }

    /// Encodes the parcel as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = BinaryWriter::new(&mut bytes);
        writer.bytes(&self.machine.0);
        let base: Vec<_> = self.base.iter().collect();
        writer.list(&base, |writer, name| writer.bytes(&name.0));
        writer.list(&self.needs, |writer, name| writer.bytes(&name.0));
        writer.bytes(&self.changes);
        let fresh: Vec<_> = self.fresh.values().collect();
        writer.list(&fresh, |writer, content| writer.bytes(content));
        bytes
    }

    /// Decodes the bytes of [`Parcel::to_bytes`]. The hashes of the files are computed from their bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Broken> {
        let mut reader = BinaryReader::new(bytes);
        let machine = reader.hash()?;
        let base = reader.list(BinaryReader::hash)?.first().copied();
        let needs = reader.list(BinaryReader::hash)?;
        let changes = reader.bytes()?.to_vec();
        let fresh = reader.list(|reader| Ok(reader.bytes()?.to_vec()))?;
        let fresh = fresh.into_iter().map(|content| (Hash::of(&content), content)).collect();
        Ok(Self { machine, base, needs, changes, fresh })
    }
}
