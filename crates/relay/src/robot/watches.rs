//! What stations watch of the runs of a robot, and the newest values of that, read from the journals: the runs do not know of it.

use crate::watch_words::{self, RUNS_MAX};
use rafcon_link::{NewestValue, RobotSession, SessionTime, StreamId, WatchSubscription};
use rafcon_protocol::{LongValue, WatchKind, WatchTarget, WatchedValue};
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::{JournalError, Kept, Moment, Reader, Stored};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Duration;

/// Shortest interval between two searches for values.
const SCAN_EVERY: Duration = Duration::from_millis(200);
/// Capacity of the values of a run.
const VALUES_MAX: usize = 1_024;

/// Watched values of a robot's runs.
#[derive(Debug)]
pub(super) struct RobotWatches {
    /// Content of the file for the next start.
    written: Vec<u8>,
    /// Silence of the station after which the list is dropped.
    age_max: Duration,
    runs: BTreeMap<StreamId, WatchedRun>,
}

#[derive(Debug, Default)]
struct WatchedRun {
    number: u64,
    targets: Vec<WatchTarget>,
    moment: Option<Moment>,
    /// Last value found for each port.
    found: BTreeMap<ValuePlace, Found>,
    next_scan_at: SessionTime,
}

type ValuePlace = (WatchKind, String, String);

#[derive(Debug)]
struct Found {
    /// Key of the session.
    key: u32,
    order: u64,
    kept: Kept,
}

/// Stored list of a run.
#[derive(Debug, Serialize, Deserialize)]
struct KeptSubscription {
    stream: u32,
    number: u64,
    /// Time of the last contact: ms since 1970, UTC.
    heard_ms: u64,
    targets: Vec<WatchTarget>,
}

impl RobotWatches {
    /// Goes on with what was watched when the robot's server ended, if that is not too long ago.
    pub(super) fn begin(
        written: Vec<u8>,
        age_max: Duration,
        now_ms: u64,
        session: &mut RobotSession,
    ) -> Self {
        let kept: Vec<KeptSubscription> = serde_json::from_slice(&written).unwrap_or_default();
        let mut watches = Self { written, age_max, runs: BTreeMap::new() };
        for KeptSubscription { stream, number, heard_ms, targets } in
            kept.into_iter().take(RUNS_MAX)
        {
            if Duration::from_millis(now_ms.saturating_sub(heard_ms)) <= watches.age_max {
                let run = WatchedRun { number, targets, ..WatchedRun::default() };
                watches.runs.insert(StreamId(stream), run);
                session.set_subscription(StreamId(stream), number);
            }
        }
        watches
    }

    /// A station watches this from now on.
    pub(super) fn take(&mut self, WatchSubscription { stream, number, body }: WatchSubscription) {
        let targets = watch_words::read_targets(&body).unwrap_or_default();
        self.runs.remove(&stream);
        if targets.is_empty() {
            return;
        }
        if self.runs.len() >= RUNS_MAX {
            self.forget_oldest();
        }
        self.runs.insert(stream, WatchedRun { number, targets, ..WatchedRun::default() });
    }

    /// A station asks for no more runs than there is room for. One that has started again asks anew, with higher numbers: the lowest is
    /// of before.
    fn forget_oldest(&mut self) {
        let oldest = self.runs.iter().min_by_key(|(_, run)| run.number).map(|(stream, _)| *stream);
        self.runs.retain(|stream, _| Some(*stream) != oldest);
    }

    /// Drops the watch of a run.
    pub(super) fn forget(&mut self, stream: StreamId) {
        self.runs.remove(&stream);
    }

    /// The list for the next start, if it has changed. It is dropped after too long a silence of the station.
    pub(super) fn take_list(
        &mut self,
        now_ms: u64,
        heard_before: Option<Duration>,
        session: &mut RobotSession,
    ) -> Option<Vec<u8>> {
        if heard_before.is_some_and(|before| before > self.age_max) {
            for (stream, run) in std::mem::take(&mut self.runs) {
                // The number remains, because the station is informed of the last list received.
                session.set_subscription(stream, run.number);
            }
        }
        // Without a word since the start, what is on the disk is as old as it was.
        let before = heard_before?;
        let heard_ms = now_ms.saturating_sub(u64::try_from(before.as_millis()).unwrap_or(0));
        let kept: Vec<_> = self
            .runs
            .iter()
            .map(|(stream, run)| KeptSubscription {
                stream: stream.0,
                number: run.number,
                heard_ms,
                targets: run.targets.clone(),
            })
            .collect();
        let text = serde_json::to_vec(&kept).ok().filter(|text| *text != self.written)?;
        self.written.clone_from(&text);
        Some(text)
    }

    /// Runs in which values are due for a search.
    pub(super) fn due(&mut self, now: SessionTime, session: &RobotSession) -> Vec<StreamId> {
        let is_due = |(stream, run): &(&StreamId, &mut WatchedRun)| {
            run.next_scan_at <= now && session.needs_watched(now, **stream)
        };
        let due = self.runs.iter_mut().filter(is_due).map(|(stream, run)| {
            run.next_scan_at = now + SCAN_EVERY;
            *stream
        });
        due.collect()
    }

    /// Looks for values of a run that are new.
    pub(super) fn scan(
        &mut self,
        stream: StreamId,
        reader: &mut Reader,
        session: &mut RobotSession,
    ) -> Result<(), JournalError> {
        let Some(run) = self.runs.get_mut(&stream) else { return Ok(()) };
        let moment = match run.moment.take() {
            Some(before) => reader.advance(before)?,
            None => reader.moment(u64::MAX)?,
        };
        for (place, order, kept, t_ns) in values_in(&moment, &run.targets) {
            let known = run.found.get(&place);
            let is_known = known.is_some_and(|found| {
                found.order == order || place.0 == WatchKind::Global && found.kept == kept
            });
            if is_known || known.is_none() && run.found.len() >= VALUES_MAX {
                continue;
            }
            let next = u32::try_from(run.found.len()).unwrap_or(u32::MAX);
            let key = known.map_or(next, |found| found.key);
            let priority = priority(&run.targets, &place);
            let value = watched(reader, &place, order, t_ns, &kept)?;
            run.found.insert(place, Found { key, order, kept });
            if let Some(bytes) = watch_words::value(&value) {
                session.set_watched(stream, key, NewestValue { priority, sequence: order, bytes });
            }
        }
        run.moment = Some(moment);
        Ok(())
    }
}

/// The values of a moment that are watched: each with the event that it is of, and its time if that is known.
fn values_in(
    moment: &Moment,
    targets: &[WatchTarget],
) -> Vec<(ValuePlace, u64, Kept, Option<u64>)> {
    let mut values = Vec::new();
    let mut add = |kind, path: &str, name: Option<&str>, (order, t_ns), kept: &Kept| {
        let Some(name) = name.filter(|_| *kept != Kept::Absent) else { return };
        if targets.iter().any(|target| target.fits(kind, path, name)) {
            let place = (kind, path.to_owned(), name.to_owned());
            values.push((place, order, kept.clone(), t_ns));
        }
    };
    for state in moment.active() {
        let path = &state.place.path;
        for (port, kept) in &state.inputs {
            let at = (state.order, Some(state.since_ns));
            add(WatchKind::Input, path, name_of(&state.place.inputs, *port), at, kept);
        }
        for variable in &state.scoped {
            let (at, name) = ((variable.order, None), name_of(&state.place.scoped, variable.port));
            add(WatchKind::ScopedVariable, path, name, at, &variable.value);
        }
        for end in &state.ended {
            for (port, kept) in &end.outputs {
                let (at, name) = ((end.order, None), name_of(&end.place.outputs, *port));
                add(WatchKind::Output, &end.place.path, name, at, kept);
            }
        }
    }
    for (name, kept) in moment.globals() {
        let at = (moment.sequence(), Some(moment.t_ns()));
        add(WatchKind::Global, "", Some(name), at, kept);
    }
    values
}

fn name_of<N: AsRef<str>>(ports: &[(u64, N)], port: u64) -> Option<&str> {
    ports.iter().find(|(id, _)| *id == port).map(|(_, name)| name.as_ref())
}

fn priority(targets: &[WatchTarget], (kind, path, name): &ValuePlace) -> u8 {
    let fitting = targets.iter().filter(|target| target.fits(*kind, path, name));
    fitting.map(|target| target.priority).min().unwrap_or(u8::MAX)
}

fn watched(
    reader: &mut Reader,
    (kind, path, name): &ValuePlace,
    sequence: u64,
    t_ns: Option<u64>,
    kept: &Kept,
) -> Result<WatchedValue, JournalError> {
    let t_ns = match t_ns {
        Some(t_ns) => t_ns,
        None => reader.page(sequence, 1)?.first().map_or(0, |entry| entry.t_ns),
    };
    let (value, large) = match kept {
        Kept::Value(number) => match reader.value(*number)? {
            Some(stored) => (Some(stored.view.clone()), Some(long_value(&stored))),
            None => (None, None),
        },
        plain => (Some(reader.view(plain)?), None),
    };
    let (kind, path, name) = (*kind, path.clone(), name.clone());
    Ok(WatchedValue { kind, path, name, sequence, t_ns, value, large })
}

fn long_value(stored: &Stored) -> LongValue {
    let type_name = stored.type_name.to_string();
    let (bytes, hash) = match &stored.content {
        Content::Pickle(pickle) => {
            (pickle.len() as u64, Some(rafcon_storage::journal::ContentHash::of(pickle).name()))
        }
        Content::File { hash, size } => (*size, Some(hash.clone())),
        Content::View | Content::Nothing(_) => (stored.view.to_string().len() as u64, None),
    };
    LongValue { type_name, bytes, hash }
}

/// Lifetime of a list without contact, by the profile of the link.
pub(super) fn age_max(profile: &rafcon_link::Profile) -> Duration {
    // The slower the link, the longer its silences.
    profile.silence() * 10_000
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pairing::Pairing;
    use crate::start::Start;
    use rafcon_link::Profile;
    use rafcon_storage::journal::{About, Journal, Options};
    use rafcon_testkit::journal_notation;
    use std::path::Path;

    /// Nothing is watched yet.
    fn none(folder: &Path) -> (RobotWatches, RobotSession) {
        let pairing = Pairing::generate("scout", None).unwrap();
        let start = Start::begin(folder).unwrap();
        let mut session = RobotSession::new(&start.identity(&pairing), Profile::LAN);
        let watches = RobotWatches::begin(Vec::new(), Duration::MAX, 0, &mut session);
        (watches, session)
    }

    fn watch(watches: &mut RobotWatches, stream: u32, number: u64, target: &WatchTarget) {
        let body = watch_words::write_targets(std::slice::from_ref(target));
        watches.take(WatchSubscription { stream: StreamId(stream), number, body });
    }

    #[test]
    fn of_more_runs_than_a_robot_can_watch_the_one_asked_for_first_makes_room() {
        let folder = tempfile::tempdir().unwrap();
        let (mut watches, _session) = none(folder.path());
        let target = WatchTarget {
            kind: WatchKind::State,
            path: "R".to_owned(),
            name: String::new(),
            priority: 0,
        };
        let runs = u32::try_from(RUNS_MAX).unwrap();
        (1..=runs).for_each(|nth| watch(&mut watches, nth, u64::from(nth), &target));
        // Asked for anew, the first run is not the oldest any more.
        watch(&mut watches, 1, 1_000, &target);
        assert_eq!(watches.runs.len(), RUNS_MAX);
        watch(&mut watches, runs + 1, 1_001, &target);
        let has = |stream| watches.runs.contains_key(&StreamId(stream));
        assert_eq!(watches.runs.len(), RUNS_MAX);
        assert_eq!([1, 2, 3, runs + 1].map(has), [true, false, true, true]);
    }

    #[test]
    fn so_many_values_of_a_run_are_followed_and_those_that_are_known_stay_new() {
        let folder = tempfile::tempdir().unwrap();
        let (mut watches, mut session) = none(folder.path());
        let run = folder.path().join("r");
        let journal = Journal::create(&run, &About::default(), &Options::default()).unwrap();
        let ports: Vec<_> = (0..=VALUES_MAX).map(|number| format!("p{number:04}")).collect();
        let values: Vec<_> = ports.iter().map(|port| format!("{port}=1")).collect();
        let place = format!("place R \"R\" in {} outcome done\n", ports.join(","));
        let record = |text: &str, before| {
            let batch = journal_notation::batch(&format!("{place}{text}\n"), before);
            let batch = batch.unwrap();
            journal.append(&batch).unwrap();
            journal.commit().unwrap();
            batch.t_last()
        };
        let enter = format!("enter R {}", values.join(" "));
        let before = record(&enter, 0);
        let target = |kind, name: &str| WatchTarget {
            kind,
            path: "R".to_owned(),
            name: name.to_owned(),
            priority: 0,
        };
        watch(&mut watches, 1, 1, &target(WatchKind::State, ""));
        let mut reader = Reader::open(&run).unwrap();
        watches.scan(StreamId(1), &mut reader, &mut session).unwrap();
        assert_eq!(watches.runs[&StreamId(1)].found.len(), VALUES_MAX);
        record(&format!("leave R done\n{enter}"), before);
        watches.scan(StreamId(1), &mut reader, &mut session).unwrap();
        let found = &watches.runs[&StreamId(1)].found;
        assert_eq!(found.len(), VALUES_MAX);
        assert!(found.values().all(|found| found.order == 3));
        // A shorter list makes room for the last value.
        watch(&mut watches, 1, 2, &target(WatchKind::Input, &ports[VALUES_MAX]));
        watches.scan(StreamId(1), &mut reader, &mut session).unwrap();
        assert_eq!(watches.runs[&StreamId(1)].found.len(), 1);
    }
}
