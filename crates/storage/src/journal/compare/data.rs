//! Finds values that differ between two runs. Uses records of entries and ends of states.

use super::digest::Digests;
use super::steps::{ComparedStep, Did};
use crate::journal::folder::JournalError;
use crate::journal::read::{Entry, Reader, place_of};
use crate::journal::record::{Kept, Record};
use rafcon_protocol::api::{DataChange, DataKind};
use serde_json::Value;
use smol_str::SmolStr;
use std::collections::BTreeSet;

/// Maximum number of reported differences.
const CHANGES_MAX: usize = 100;

/// Returns the differences in the values of these pairs: only the first for each state's entries and ends.
pub(super) fn changes(
    one: &mut Reader,
    other: &mut Reader,
    pairs: &[(&ComparedStep, &ComparedStep)],
) -> Result<Vec<DataChange>, JournalError> {
    let mut changes = Vec::new();
    let mut reported = BTreeSet::new();
    for (x, y) in pairs {
        if changes.len() >= CHANGES_MAX {
            break;
        }
        if !reported.insert((x.key, matches!(x.did, Did::Entered { .. }))) {
            continue;
        }
        let (x, y) = (one.page(x.sequence, 1)?, other.page(y.sequence, 1)?);
        if let ([x], [y]) = (&x[..], &y[..]) {
            let (mut x, mut y) = (ComparedSide::new(one, x), ComparedSide::new(other, y));
            changes.extend(differences(&mut x, &mut y)?);
        }
    }
    changes.truncate(CHANGES_MAX);
    Ok(changes)
}

/// A record in its run.
struct ComparedSide<'r> {
    reader: &'r Reader,
    entry: &'r Entry,
    digests: Digests,
    /// Values of the record, by kind and port.
    values: Vec<(DataKind, SmolStr, &'r Kept)>,
}

impl<'r> ComparedSide<'r> {
    fn new(reader: &'r Reader, entry: &'r Entry) -> Self {
        let place = place_of(&entry.record).and_then(|place| reader.known_places().get(place));
        let named = |kind, ports: &[(u64, SmolStr)], values: &'r [Kept]| {
            let ports: Vec<SmolStr> = ports.iter().map(|(_, name)| name.clone()).collect();
            let there = ports.into_iter().zip(values).filter(|(_, value)| **value != Kept::Absent);
            there.map(|(port, value)| (kind, port, value)).collect::<Vec<_>>()
        };
        let values = match (&entry.record, place) {
            (Record::Entered { inputs, .. }, Some(place)) => {
                named(DataKind::Input, &place.inputs, inputs)
            }
            (Record::Left { outputs, error, .. }, Some(place)) => {
                let mut values = named(DataKind::Output, &place.outputs, outputs);
                values.extend(
                    error.as_ref().map(|error| (DataKind::Error, SmolStr::default(), error)),
                );
                values
            }
            _ => Vec::new(),
        };
        Self { reader, entry, digests: Digests::default(), values }
    }

    fn value(&self, kind: DataKind, port: &str) -> Option<&'r Kept> {
        let found = self.values.iter().find(|(k, p, _)| *k == kind && p == port);
        found.map(|(_, _, value)| *value)
    }

    fn digest(&mut self, value: Option<&Kept>) -> Result<Option<u64>, JournalError> {
        value.map(|value| self.digests.of_value(self.reader, value)).transpose()
    }

    fn view(&self, value: Option<&Kept>) -> Result<Option<Value>, JournalError> {
        value.map(|value| self.reader.view(value)).transpose()
    }
}

fn differences(
    x: &mut ComparedSide<'_>,
    y: &mut ComparedSide<'_>,
) -> Result<Vec<DataChange>, JournalError> {
    let mut ports: Vec<(DataKind, SmolStr)> = Vec::new();
    for (kind, port, _) in x.values.iter().chain(&y.values) {
        if !ports.contains(&(*kind, port.clone())) {
            ports.push((*kind, port.clone()));
        }
    }
    let place = place_of(&x.entry.record).and_then(|place| x.reader.known_places().get(place));
    let mut changes = Vec::new();
    for (kind, port) in ports {
        let (a, b) = (x.value(kind, &port), y.value(kind, &port));
        if x.digest(a)? != y.digest(b)? {
            changes.push(DataChange {
                path: place.map(|place| place.path.clone()).unwrap_or_default(),
                names: place.map(|place| place.names.clone()).unwrap_or_default(),
                kind,
                port: port.to_string(),
                one_sequence: x.entry.sequence,
                one: x.view(a)?,
                other_sequence: y.entry.sequence,
                other: y.view(b)?,
            });
        }
    }
    Ok(changes)
}
