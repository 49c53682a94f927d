//! Large values on their way from one robot into the folders of its replicas.

use super::value_disk::{FromValueDisk, OpenedValue, Rest, ValueDisk};
use super::{StationSettings, ToStation};
use crate::inbox::Input;
use crate::value_fetch_broker::{LinkRate, Request, ValueFetchBroker, ValueKey};
use rafcon_link::{NoValue, SessionTime, StationSession, ValueId, ValueName};
use rafcon_protocol::api::ValueFetch;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

/// File in the folder of a robot with its requests, for the next start.
const WANTED_FILE: &str = "wanted-values";

/// Said of a value that finds no room at the disk.
const STUCK: &str = "too much waits for the station's disk: fetch it again";
/// Averaging period of rates.
const RATE_OVER: Duration = Duration::from_secs(2);

/// Requested large values of one robot.
#[derive(Debug)]
pub(super) struct StationValues {
    robot: String,
    fetches: ValueFetchBroker,
    disk: ValueDisk,
    /// Values that are being searched on the disk.
    opening: BTreeMap<ValueKey, Budget>,
    coming: BTreeMap<ValueId, Coming>,
    /// Received bytes, those before the last measurement, and its time.
    came: u64,
    measured: (u64, SessionTime),
    per_s: u64,
}

/// Budget of a value in bytes.
#[derive(Debug, Clone, Copy)]
enum Budget {
    /// Beside those that are here.
    More(u64),
    /// With those that are here.
    Whole(u64),
}

impl Budget {
    /// Remaining budget with this many received bytes.
    fn left(self, here: u64) -> u64 {
        match self {
            Self::More(bytes) => bytes,
            Self::Whole(bytes) => bytes.saturating_sub(here),
        }
    }
}

#[derive(Debug)]
struct Coming {
    key: ValueKey,
    name: ValueName,
    length: u64,
    /// Bytes came that are not noted on the disk.
    is_new: bool,
    /// All bytes are received, and the disk verifies them.
    is_whole: bool,
}

impl StationValues {
    /// Resumes the requests of the previous start.
    pub(super) fn begin(
        settings: &StationSettings,
        name: &str,
        number: usize,
        inbox: SyncSender<Input<ToStation>>,
    ) -> io::Result<Self> {
        let fetches = settings.value_fetches.clone();
        let wanted = settings.folder.join(name).join(WANTED_FILE);
        let text = fs::read_to_string(&wanted).unwrap_or_default();
        let disk = ValueDisk::begin(settings.runs.clone(), wanted, number, inbox)?;
        let (opening, coming) = (BTreeMap::new(), BTreeMap::new());
        let (came, measured, per_s) = (0, (0, SessionTime::BEGIN), 0);
        let robot = name.to_owned();
        let mut values = Self { robot, fetches, disk, opening, coming, came, measured, per_s };
        for line in text.lines() {
            if let Some((key, whole)) = read_line(line) {
                values.begin_one(key, Budget::Whole(whole));
            }
        }
        Ok(values)
    }

    /// Does what the server has asked for.
    pub(super) fn handle_requests(&mut self, session: &mut StationSession) {
        for Request { key, budget, .. } in self.fetches.take(&self.robot) {
            let coming = self.coming.values().find(|coming| coming.key == key && !coming.is_whole);
            match (budget, coming) {
                (Some(budget), Some(Coming { name, length, .. })) => {
                    let here = session.fetch_progress(name.id).map(|it| it.here.clone());
                    session.fetch(*name, *length, here.unwrap_or_default(), budget);
                }
                (Some(budget), None) => self.begin_one(key, Budget::More(budget)),
                (None, _) => self.cancel(&key, session),
            }
            self.keep_wanted(session);
        }
    }

    fn begin_one(&mut self, key: ValueKey, budget: Budget) {
        if !self.disk.open(key.clone()) {
            return self.fail(&key, 0, budget.left(0), STUCK);
        }
        self.opening.insert(key, budget);
    }

    /// Applies an event of the disk.
    pub(super) fn on_disk_event(&mut self, event: FromValueDisk, session: &mut StationSession) {
        match event {
            FromValueDisk::Opened(value) => self.opened(value, session),
            FromValueDisk::Here(key) => {
                self.opening.remove(&key);
                self.fetches.set_here(&key);
            }
            FromValueDisk::NotOpened(key, why) => {
                let budget = self.opening.remove(&key).map_or(0, |budget| budget.left(0));
                self.fail(&key, 0, budget, &why);
            }
            FromValueDisk::Failed(id, why) => return self.end(id, session, &why),
            FromValueDisk::Finished(id, is_right) => {
                let Some(Coming { key, .. }) = self.coming.remove(&id) else { return };
                if is_right {
                    self.fetches.set_here(&key);
                } else {
                    let why =
                        "what came is not the value, by its hash, and was dropped: fetch it again";
                    self.fail(&key, 0, 0, why);
                }
            }
        }
        self.keep_wanted(session);
    }

    fn opened(&mut self, value: OpenedValue, session: &mut StationSession) {
        let OpenedValue { key, name, length, here } = value;
        let other = self.coming.get(&name.id).map(|other| other.key.clone());
        let Some(budget) = self.opening.remove(&key) else {
            // It was given up meanwhile.
            if other.is_none() {
                self.disk.leave(name.id, Rest::Goes);
            }
            return;
        };
        let budget = budget.left(here.count());
        match other {
            Some(other) if other == key => return,
            Some((run, number)) => {
                let why =
                    format!("these bytes are already being fetched as value {number} of {run}");
                return self.fail(&key, 0, budget, &why);
            }
            None => {}
        }
        if !session.fetch(name, length, here, budget) {
            self.disk.leave(name.id, Rest::Stays);
            let why = "too many large values are on their way: fetch it when one is here";
            return self.fail(&key, 0, budget, why);
        }
        self.coming.insert(name.id, Coming { key, name, length, is_new: true, is_whole: false });
        self.advance(name.id, session);
    }

    fn cancel(&mut self, key: &ValueKey, session: &mut StationSession) {
        self.opening.remove(key);
        for (id, _) in self.coming.extract_if(.., |_, coming| coming.key == *key) {
            session.end_fetch(id);
            self.disk.leave(id, Rest::Goes);
        }
    }

    /// A part came.
    pub(super) fn take(
        &mut self,
        id: ValueId,
        offset: u64,
        bytes: Vec<u8>,
        session: &mut StationSession,
    ) {
        let Some(coming) = self.coming.get_mut(&id) else { return };
        let length = bytes.len() as u64;
        if !self.disk.write(id, offset, bytes) {
            return session.lose_value(id, offset + 1..=offset + length);
        }
        self.came += length;
        coming.is_new = true;
        self.advance(id, session);
    }

    /// The robot refuses a value.
    pub(super) fn refused(&mut self, id: ValueId, why: NoValue, session: &mut StationSession) {
        let why = match why {
            NoValue::Gone => "the robot does not have it any more",
            NoValue::OverBudget => "its budget is used up by lost data: fetch it again to continue",
        };
        self.end(id, session, why);
    }

    /// Has the disk close a value that is complete.
    fn advance(&mut self, id: ValueId, session: &mut StationSession) {
        let progress = session.fetch_progress(id).map(|progress| progress.here.contiguous());
        if let (Some(here), Some(coming)) = (progress, self.coming.get_mut(&id))
            && here >= coming.length
        {
            session.end_fetch(id);
            coming.is_whole = true;
            if !self.disk.finish(id) {
                self.end(id, session, STUCK);
            }
        }
    }

    fn end(&mut self, id: ValueId, session: &mut StationSession, why: &str) {
        let progress = session.fetch_progress(id).map(|progress| progress.here.clone());
        if let Some(coming) = self.coming.remove(&id) {
            let here = progress.unwrap_or_default();
            self.disk.note(id, &here);
            self.disk.leave(id, Rest::Stays);
            self.fail(&coming.key, here.count(), 0, why);
        }
        session.end_fetch(id);
        self.keep_wanted(session);
    }

    fn fail(&self, key: &ValueKey, here: u64, budget: u64, why: &str) {
        self.fetches.set_progress(key, ValueFetch { here, budget, failed: Some(why.to_owned()) });
    }

    /// Receive rate of large values in bytes per second.
    pub(super) fn bytes_per_s(&mut self, now: SessionTime) -> u64 {
        let time = now.since(self.measured.1);
        if time >= RATE_OVER {
            let per_s = u128::from(self.came - self.measured.0) * 1_000 / time.as_millis().max(1);
            (self.per_s, self.measured) =
                (u64::try_from(per_s).unwrap_or(u64::MAX), (self.came, now));
        }
        self.per_s
    }

    /// Stores the received ranges, and publishes progress and costs.
    pub(super) fn sync(&mut self, session: &StationSession, rate: LinkRate) {
        self.fetches.set_link(&self.robot, rate);
        for (id, coming) in &mut self.coming {
            let Some(progress) = session.fetch_progress(*id) else { continue };
            let (here, budget) = (progress.here.count(), progress.budget);
            self.fetches.set_progress(&coming.key, ValueFetch { here, budget, failed: None });
            if std::mem::take(&mut coming.is_new) {
                self.disk.note(*id, progress.here);
            }
        }
    }

    fn keep_wanted(&self, session: &StationSession) {
        let coming = self.coming.iter().filter_map(|(id, coming)| {
            let progress = session.fetch_progress(*id)?;
            Some((&coming.key, progress.budget.saturating_add(progress.here.count())))
        });
        // The received ranges of a value are known once its file is open.
        let opening = self.opening.iter().map(|(key, budget)| match budget {
            Budget::More(bytes) | Budget::Whole(bytes) => (key, *bytes),
        });
        let line = |((run, number), whole): (&ValueKey, u64)| format!("{run} {number} {whole}");
        let lines: Vec<_> = coming.chain(opening).map(line).collect();
        self.disk.keep_wanted(lines.join("\n"));
    }
}

fn read_line(line: &str) -> Option<(ValueKey, u64)> {
    let mut words = line.split(' ');
    let (run, number, budget) = (words.next()?, words.next()?, words.next()?);
    let is_plain = !run.is_empty() && !run.contains('/') && !run.starts_with('.');
    let key = (run.to_owned(), number.parse().ok()?);
    is_plain.then_some((key, budget.parse().ok()?))
}
