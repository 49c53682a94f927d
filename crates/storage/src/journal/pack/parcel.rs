//! A machine on its way to someone who has some of its files: what is new, and which other parcels have the rest.
//!
//! Knows manifests and bytes. Knows nothing of who sends them, or where they are kept.

use super::{Hash, Manifest};
use crate::journal::record::binary::{BinaryReader, BinaryWriter, Broken};
use std::collections::BTreeMap;

/// A machine as it is sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parcel {
    /// The hash of the machine's manifest.
    pub machine: Hash,
    /// The name of the parcel whose manifest the changes are from; that one has its own as a whole.
    pub base: Option<Hash>,
    /// The names of all parcels of which this one needs something.
    pub needs: Vec<Hash>,
    /// The manifest, as changes of that of the base.
    changes: Vec<u8>,
    /// The content of the files that no other parcel has.
    pub fresh: BTreeMap<Hash, Vec<u8>>,
}

impl Parcel {
    /// The parcel of a machine with the files `fresh`; those in `needs` have the others. `base` has a manifest that is nearly the same.
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

    /// The manifest of the machine, from that of the base; nothing if it is not the right one.
    pub fn manifest(&self, base: Manifest) -> Option<Manifest> {
        let manifest = base.changed(&self.changes).ok()?;
        (manifest.hash() == self.machine).then_some(manifest)
    }

    /// The parcel as bytes.
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

    /// The parcel that [`Parcel::to_bytes`] wrote. Each file has the hash of the bytes that are there.
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
