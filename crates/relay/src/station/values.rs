//! Large values on their way from one robot into the folders of its replicas.

use crate::desk::{LinkRate, Request, ValueDesk, ValueKey};
use crate::ids;
use rafcon_link::{NoValue, RangeSet, StationSession, ValueId, ValueName};
use rafcon_protocol::api::ValueFetch;
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::{ContentHash, IncomingContent, Reader, ValueNumber, is_content_here};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// In the folder of a robot: the values that are wanted, for the next start.
const WANTED_FILE: &str = "wanted-values";

/// Rates are those of so long.
const RATE_OVER: Duration = Duration::from_secs(2);

/// The large values that are wanted of one robot.
#[derive(Debug)]
pub(super) struct StationValues {
    robot: String,
    runs: PathBuf,
    wanted: PathBuf,
    desk: ValueDesk,
    coming: BTreeMap<ValueId, Coming>,
    /// How many bytes came, how many of them before the rate was measured last, and when that was.
    came: u64,
    measured: (u64, Duration),
    per_s: u64,
}

/// How many bytes of a value may come.
#[derive(Debug, Clone, Copy)]
enum Budget {
    /// Beside those that are here.
    More(u64),
    /// With those that are here.
    Whole(u64),
}

impl Budget {
    /// How many may still come, if so many are here.
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
    content: IncomingContent,
    /// Bytes came that are not noted on the disk.
    is_new: bool,
}

impl StationValues {
    /// Goes on with the values that were wanted when the station ended.
    pub(super) fn begin(
        robot: &str,
        (folder, runs): (&Path, &Path),
        desk: ValueDesk,
        session: &mut StationSession,
    ) -> Self {
        let (wanted, coming) = (folder.join(WANTED_FILE), BTreeMap::new());
        let (robot, runs) = (robot.to_owned(), runs.to_owned());
        let (came, measured, per_s) = (0, (0, Duration::ZERO), 0);
        let mut values = Self { robot, runs, wanted, desk, coming, came, measured, per_s };
        let text = fs::read_to_string(&values.wanted).unwrap_or_default();
        for line in text.lines() {
            if let Some((key, whole)) = read_line(line) {
                values.begin_one(key, Budget::Whole(whole), session);
            }
        }
        values
    }

    /// Does what the server has asked for.
    pub(super) fn heed(&mut self, session: &mut StationSession) {
        let requests = self.desk.take(&self.robot);
        let is_any = !requests.is_empty();
        for Request { key, budget, .. } in requests {
            match budget {
                Some(budget) => self.begin_one(key, Budget::More(budget), session),
                None => self.cancel(&key, session),
            }
        }
        if is_any {
            self.keep_wanted(session);
        }
    }

    fn begin_one(&mut self, key: ValueKey, budget: Budget, session: &mut StationSession) {
        match self.open(&key) {
            Ok(Some((name, content, noted))) => {
                let mut here = RangeSet::default();
                for (first, last) in noted {
                    here.insert(first..=last);
                }
                let (id, budget) = (name.id, budget.left(here.count()));
                if let Some(other) = self.coming.get(&id).filter(|other| other.key != key) {
                    let (run, number) = &other.key;
                    let why = format!("the same bytes are on their way as value {number} of {run}");
                    return self.fail(&key, (0, budget), &why);
                }
                if !session.fetch(name, content.length(), here, budget) {
                    let why = "too many large values are on their way: fetch it when one is here";
                    return self.fail(&key, (0, budget), why);
                }
                self.coming.insert(id, Coming { key, name, content, is_new: true });
                self.advance(id, session);
            }
            Ok(None) => self.desk.set_here(&key),
            Err(why) => self.fail(&key, (0, budget.left(0)), &why),
        }
    }

    /// Finds a value in its replica: nothing if it is here.
    #[expect(clippy::type_complexity, reason = "the parts are taken apart at once")]
    fn open(
        &self,
        (run, number): &ValueKey,
    ) -> Result<Option<(ValueName, IncomingContent, Vec<(u64, u64)>)>, String> {
        let folder = self.runs.join(run);
        let reader = Reader::open(&folder).map_err(|error| error.to_string())?;
        let stored = reader.value(ValueNumber(*number)).map_err(|error| error.to_string())?;
        let Some(Content::File { hash, size }) = stored.map(|stored| stored.content) else {
            return Ok(None);
        };
        if is_content_here(&folder, &hash, size) {
            return Ok(None);
        }
        let hash = ContentHash::from_name(&hash).ok_or("the value has no hash to fetch it by")?;
        let full = |error| format!("the station's disk does not take it: {error}");
        let (content, noted) = IncomingContent::open(&folder, hash, size).map_err(full)?;
        let id = ids::value_id(hash);
        let name = ValueName { stream: ids::events_of(run), number: *number, id };
        Ok(Some((name, content, noted)))
    }

    fn cancel(&mut self, key: &ValueKey, session: &mut StationSession) {
        for (id, coming) in self.coming.extract_if(.., |_, coming| coming.key == *key) {
            session.end_fetch(id);
            coming.content.remove();
        }
    }

    /// A part came.
    pub(super) fn take(
        &mut self,
        (id, offset): (ValueId, u64),
        bytes: &[u8],
        session: &mut StationSession,
    ) {
        let Some(coming) = self.coming.get_mut(&id) else { return };
        self.came += bytes.len() as u64;
        coming.is_new = true;
        if let Err(error) = coming.content.write(offset, bytes) {
            let why = format!("the station's disk does not take it: {error}");
            self.end(id, session, &why);
        } else {
            self.advance(id, session);
        }
    }

    /// The robot says that it does not come.
    pub(super) fn refused(&mut self, id: ValueId, why: NoValue, session: &mut StationSession) {
        let why = match why {
            NoValue::Gone => "the robot does not have it any more",
            NoValue::OverBudget => {
                "its budget is used up by what was lost on the way: fetch it again to go on"
            }
        };
        self.end(id, session, why);
    }

    /// Closes a value that is complete.
    fn advance(&mut self, id: ValueId, session: &mut StationSession) {
        let (Some(progress), Some(coming)) = (session.fetch_progress(id), self.coming.get(&id))
        else {
            return;
        };
        let length = coming.content.length();
        if progress.here.contiguous() < length {
            return;
        }
        session.end_fetch(id);
        let Some(Coming { key, content, .. }) = self.coming.remove(&id) else { return };
        match content.finish() {
            Ok(true) => self.desk.set_here(&key),
            Ok(false) => self.fail(
                &key,
                (0, 0),
                "what came is not the value, by its hash, and was dropped: fetch it again",
            ),
            Err(error) => {
                let why = format!("the station's disk does not take it: {error}");
                self.fail(&key, (length, 0), &why);
            }
        }
        self.keep_wanted(session);
    }

    fn end(&mut self, id: ValueId, session: &mut StationSession, why: &str) {
        let here = session.fetch_progress(id).map_or(0, |progress| progress.here.count());
        if let Some(coming) = self.coming.remove(&id) {
            Self::note(&coming, session);
            self.fail(&coming.key, (here, 0), why);
        }
        session.end_fetch(id);
        self.keep_wanted(session);
    }

    fn fail(&self, key: &ValueKey, (here, budget): (u64, u64), why: &str) {
        self.desk.set_progress(key, ValueFetch { here, budget, failed: Some(why.to_owned()) });
    }

    /// How many bytes of large values come in a second.
    pub(super) fn bytes_per_s(&mut self, now: Duration) -> u64 {
        let time = now.saturating_sub(self.measured.1);
        if time >= RATE_OVER {
            let per_s = u128::from(self.came - self.measured.0) * 1_000 / time.as_millis().max(1);
            (self.per_s, self.measured) =
                (u64::try_from(per_s).unwrap_or(u64::MAX), (self.came, now));
        }
        self.per_s
    }

    /// Notes what came, and says how far everything is and what more would cost.
    pub(super) fn sync(&mut self, session: &StationSession, rate: LinkRate) {
        self.desk.set_link(&self.robot, rate);
        let ids: Vec<_> = self.coming.keys().copied().collect();
        for id in ids {
            let (Some(coming), Some(progress)) = (self.coming.get(&id), session.fetch_progress(id))
            else {
                continue;
            };
            let (here, budget) = (progress.here.count(), progress.budget);
            self.desk.set_progress(&coming.key, ValueFetch { here, budget, failed: None });
            if coming.is_new {
                Self::note(coming, session);
            }
            if let Some(coming) = self.coming.get_mut(&id) {
                coming.is_new = false;
            }
        }
    }

    fn note(coming: &Coming, session: &StationSession) {
        if let Some(progress) = session.fetch_progress(coming.name.id) {
            let ranges = progress.here.ranges().map(std::ops::RangeInclusive::into_inner);
            // What is not noted is sent again.
            drop(coming.content.note(ranges));
        }
    }

    fn keep_wanted(&self, session: &StationSession) {
        let line = |(id, coming): (&ValueId, &Coming)| {
            let (run, number) = &coming.key;
            let progress = session.fetch_progress(*id)?;
            let whole = progress.budget.saturating_add(progress.here.count());
            Some(format!("{run} {number} {whole}"))
        };
        let text = self.coming.iter().filter_map(line).collect::<Vec<_>>().join("\n");
        // What is not kept can be fetched again after the next start.
        drop(fs::write(&self.wanted, text));
    }
}

fn read_line(line: &str) -> Option<(ValueKey, u64)> {
    let mut words = line.split(' ');
    let (run, number, budget) = (words.next()?, words.next()?, words.next()?);
    let is_plain = !run.is_empty() && !run.contains('/') && !run.starts_with('.');
    let key = (run.to_owned(), number.parse().ok()?);
    is_plain.then_some((key, budget.parse().ok()?))
}
