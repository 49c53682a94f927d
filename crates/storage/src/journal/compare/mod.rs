//! Compares two runs: where they diverge, which data differed before, and how their times differ.
//!
//! Compares concurrent branches separately, because their relative order has no meaning.

mod data;
mod digest;
mod steps;

use crate::journal::folder::JournalError;
use crate::journal::read::{Reader, outcome_of};
use rafcon_protocol::api::{Comparison, Happened, Parting, Timing};
use std::collections::BTreeSet;
use steps::{ComparedStep, Did, Key, Keys, Steps};

/// Maximum number of reported branches on which two runs diverge.
const PARTED_MAX: usize = 64;

/// Divergence of two runs on a branch: the first different step of each run, if there is one.
type Parted<'s> = (Key, Option<&'s ComparedStep>, Option<&'s ComparedStep>);

/// Compares two runs: divergence, changed data and timing.
pub fn compare(one: &mut Reader, other: &mut Reader) -> Result<Comparison, JournalError> {
    let mut keys = Keys::default();
    let (a, b) = (Steps::read(one, &mut keys)?, Steps::read(other, &mut keys)?);
    let side_by_side: BTreeSet<Key> = a.side_by_side.union(&b.side_by_side).copied().collect();
    let (by_branch_a, by_branch_b) =
        (a.by_branch(&keys, &side_by_side), b.by_branch(&keys, &side_by_side));
    let mut partings = Vec::new();
    let mut pairs = Vec::new();
    for (branch, steps_a, steps_b) in steps::both(&by_branch_a, &by_branch_b) {
        let same = |(x, y): &(&ComparedStep, &ComparedStep)| (x.key, x.did) == (y.key, y.did);
        let alike: Vec<_> = steps_a.iter().zip(steps_b).take_while(same).collect();
        let count = alike.len();
        pairs.extend(alike);
        if count < steps_a.len().max(steps_b.len()) {
            partings.push((branch, steps_a.get(count), steps_b.get(count)));
        }
    }
    partings.sort_by_key(earliest);
    let (alike, branches_parted) = (pairs.len() as u64, partings.len());
    let reported = partings.iter().take(PARTED_MAX);
    let parted = reported.map(|parted| parting([one, other], &keys, *parted)).collect();
    pairs.retain(|(x, y)| x.digest != y.digest);
    pairs.sort_by_key(|(x, _)| x.sequence);
    let changed = data::changes(one, other, &pairs)?;
    let timing = timing([one, other], &keys, [&a, &b]);
    Ok(Comparison { alike, parted, branches_parted, changed, timing })
}

/// Returns the time of the divergence, in the run in which it is earlier.
fn earliest((_, x, y): &Parted<'_>) -> (Option<u64>, Option<u64>, Option<u64>) {
    let time = [x, y].into_iter().flatten().map(|step| step.t_ns).min();
    (time, x.map(|x| x.sequence), y.map(|y| y.sequence))
}

fn parting([one, other]: [&Reader; 2], keys: &Keys, (branch, x, y): Parted<'_>) -> Parting {
    let path = keys.path(branch);
    Parting {
        branch: path.to_owned(),
        names: names(one, path).or_else(|| names(other, path)).unwrap_or_default(),
        one: x.map(|step| happened(one, keys, step)),
        other: y.map(|step| happened(other, keys, step)),
    }
}

fn happened(reader: &Reader, keys: &Keys, step: &ComparedStep) -> Happened {
    let path = keys.path(step.key);
    let places = reader.known_places();
    let place = places.number(path).and_then(|number| places.get(number));
    Happened {
        sequence: step.sequence,
        t_ns: step.t_ns,
        path: path.to_owned(),
        names: place.map_or(path, |place| &place.names).to_owned(),
        outcome: match step.did {
            Did::Entered { .. } => None,
            Did::Left { outcome, .. } => Some(outcome_of(place.map(|place| &**place), outcome)),
        },
        backwards: match step.did {
            Did::Entered { backwards } | Did::Left { backwards, .. } => backwards,
        },
    }
}

/// Returns the durations of the states in both runs, the largest difference first.
fn timing(readers: [&Reader; 2], keys: &Keys, steps: [&Steps; 2]) -> Vec<Timing> {
    let [one, other] = steps;
    let all: BTreeSet<Key> = one.times.keys().chain(other.times.keys()).copied().collect();
    let time = |steps: &Steps, key| steps.times.get(&key).copied().unwrap_or_default();
    let timing = |key| Timing {
        path: keys.path(key).to_owned(),
        names: names(readers[0], keys.path(key))
            .or_else(|| names(readers[1], keys.path(key)))
            .unwrap_or_default(),
        one: time(one, key),
        other: time(other, key),
    };
    let mut list: Vec<Timing> = all.into_iter().map(timing).collect();
    list.sort_by_key(|timing| {
        std::cmp::Reverse(timing.one.total_ns.abs_diff(timing.other.total_ns))
    });
    list
}

fn names(reader: &Reader, path: &str) -> Option<String> {
    let places = reader.known_places();
    Some(places.get(places.number(path)?)?.names.clone())
}
