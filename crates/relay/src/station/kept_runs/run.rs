//! One run on its way to the station's disk: its description, machines and events, and its end. Calls may block on the disk.

use super::{KeepError, Place};
use crate::about::{AboutReader, AboutRecord, Taken};
use crate::ids;
use crate::inbox::Input;
use crate::station::checking::Checking;
use crate::station::completed_runs::CompletedRuns;
use crate::station::disk::{FromDisk, OpenRun, Work};
use crate::station::parcels::StationParcels;
use crate::station::replica_run::ReplicaRun;
use crate::station::{GivenCommand, ToStation};
use rafcon_link::StreamId;
use rafcon_protocol::LinkHealth;
use rafcon_storage::journal::folder::{CRASHED_FILE, DIVERGED_FILE, check_run_id, replace_file};
use rafcon_storage::journal::{About, EventBlock, JournalError, Pack};
use std::collections::{BTreeMap, VecDeque};
use std::fs;
use std::path::PathBuf;

/// A run of which something is under way on the disk.
#[derive(Default)]
pub(super) struct KeptRun {
    pub(super) about: Option<About>,
    pub(super) replica: Option<ReplicaRun>,
    /// Up to which part what is to be known about the run was taken.
    pub(super) taken: u64,
    reader: AboutReader,
    /// The record that the next part completed, and that the disk did not take.
    record: Option<AboutRecord>,
    pub(super) parts: VecDeque<EventBlock>,
    pub(super) todo: VecDeque<Work>,
    /// The disk refused something: it is asked again with the next sync.
    pub(super) is_stuck: bool,
    /// Number of parcels at the last failed attempt.
    needs_parcels: Option<u64>,
    pub(super) is_refused: bool,
    pub(super) checking: Checking,
    /// Events of the closed replica.
    pub(super) closed: Option<u64>,
    /// It was closed as a whole.
    pub(super) is_whole: bool,
}

impl KeptRun {
    /// A run with this description, up to which part it was taken.
    pub(super) fn new(about: About, taken: u64) -> Self {
        Self { about: Some(about), taken, ..Self::default() }
    }

    /// A run of which something new is under way, with what is known of it.
    pub(super) fn woken(
        stream: StreamId,
        place: &Place,
        completed: &CompletedRuns,
        left: &mut BTreeMap<StreamId, String>,
    ) -> Self {
        let completed_id = completed.id_of(stream);
        let is_refused = completed_id.is_some();
        let id = left.remove(&stream).or(completed_id);
        let folder = id.map(|id| place.runs.join(id));
        let about = folder.as_deref().and_then(|folder| About::read(folder).ok());
        let about = about.filter(|about| about.robot.as_ref() == Some(&place.robot));
        let Some((about, folder)) = about.zip(folder) else {
            // A run that was deleted here takes nothing more.
            return Self { is_refused, ..Self::default() };
        };
        let (taken, _) = ReplicaRun::read_taken(&folder, &about.id);
        Self::new(about, taken)
    }

    /// True if nothing of it is under way.
    pub(super) fn is_settled(&self) -> bool {
        let is_idle = self.parts.is_empty() && self.todo.is_empty() && !self.checking.goes_on();
        let is_known = self.about.is_some() || self.is_refused;
        is_known && is_idle && self.replica.is_none() && !self.is_stuck
    }

    pub(super) fn open(&mut self, place: &Place, stream: StreamId) -> Result<OpenRun, KeepError> {
        let about = self.about.clone().unwrap_or_default();
        if let Ok(there) = About::read(&place.runs.join(&about.id))
            && there.robot != about.robot
        {
            let whose = there.robot.map_or("this computer".to_owned(), |it| format!("robot {it}"));
            let why = format!(
                "there is a run of {whose} with this id here: move its folder away, and start the station again"
            );
            return Err(KeepError::Permanent(why));
        }
        let link = LinkHealth { robot: place.robot.clone(), ..LinkHealth::default() };
        let (robot, inbox) = (place.number, place.inbox.clone());
        let give = move |word| {
            let given = ToStation::Given(GivenCommand { robot, stream, word });
            inbox.try_send(Input::Other(given)).is_ok()
        };
        let replica = ReplicaRun::open(&place.runs, &about, link, give)?;
        let open = OpenRun { id: about.id, safe: replica.next() - 1, shared: replica.shared() };
        self.replica = Some(replica);
        drop(self.folder(place).map(|folder| fs::remove_file(folder.join(CRASHED_FILE))));
        Ok(open)
    }

    /// Does what is to be done, as far as the disk takes it.
    pub(super) fn work(
        &mut self,
        stream: StreamId,
        place: &Place,
        (parcels, came): (&StationParcels, u64),
        written: &mut usize,
    ) -> Option<KeepError> {
        while !self.is_stuck
            && self.needs_parcels != Some(came)
            && let Some(part) = self.parts.front().cloned()
        {
            match self.take_part(stream, &part, place, parcels) {
                Ok(true) => self.needs_parcels = None,
                Ok(false) => {
                    self.needs_parcels = Some(came);
                    break;
                }
                Err(trouble) => return Some(trouble),
            }
            *written += self.parts.pop_front().map_or(0, |part| Work::Part(part).cost());
        }
        while !self.is_stuck
            && self.about.is_some()
            && let Some(work) = self.todo.pop_front()
        {
            if matches!(work, Work::Close) && !self.parts.is_empty() {
                // Its machine is still to come.
                self.todo.push_front(work);
                break;
            }
            if let Err(trouble) = self.perform(stream, &work, place) {
                self.todo.push_front(work);
                return Some(trouble);
            }
            *written += work.cost();
            if matches!(work, Work::Leave { is_final: true }) {
                // The parcels that its machines wait for do not come.
                *written += self.drop_work();
            }
        }
        None
    }

    /// Returns false if the part needs a parcel that has not arrived.
    fn take_part(
        &mut self,
        stream: StreamId,
        part: &EventBlock,
        place: &Place,
        parcels: &StationParcels,
    ) -> Result<bool, KeepError> {
        if part.first_sequence <= self.taken {
            return Ok(true);
        }
        let is_whole = self.record.is_some()
            || match self.reader.take(&part.bytes) {
                Taken::Part => false,
                Taken::TooLong(what, most) => {
                    let why = format!("the {what} has more than {most} bytes, which is too long");
                    return Err(KeepError::Permanent(why));
                }
                Taken::Record(record) => {
                    self.record = record;
                    true
                }
            };
        if let Some(record) = &self.record {
            match record {
                AboutRecord::Machine(pack) => self.keep_machine(pack, place)?,
                AboutRecord::Named(machine) => match parcels.pack(*machine) {
                    Some(pack) => self.keep_machine(&pack, place)?,
                    None => return Ok(false),
                },
                AboutRecord::About(about) if self.about.is_none() => {
                    check_run_id(&about.id).map_err(|bad| KeepError::Permanent(bad.to_string()))?;
                    if !ids::is_of(stream, &about.id) {
                        let why = "the robot describes another run in its place: use one version of rafcon on both sides";
                        return Err(KeepError::Permanent(why.to_owned()));
                    }
                    let robot = Some(place.robot.clone());
                    self.about = Some(About { robot, on_crash: None, ..(**about).clone() });
                    let opened =
                        self.open(place, stream).inspect_err(|_error| self.about = None)?;
                    place.say(FromDisk::Opened(stream, opened));
                }
                AboutRecord::About(_) => {}
            }
            self.record = None;
        }
        self.taken = part.first_sequence;
        if is_whole && let Some(folder) = self.folder(place) {
            ReplicaRun::keep_taken(&folder, self.taken, stream);
        }
        Ok(true)
    }

    /// Keeps a machine of the run, also if its runner has died since.
    fn keep_machine(&self, pack: &Pack, place: &Place) -> Result<(), JournalError> {
        match (&self.replica, &self.about) {
            (Some(replica), _) => replica.keep_machine(pack),
            (None, Some(about)) => ReplicaRun::keep_machine_of(&place.runs, about, pack),
            (None, None) => Ok(()),
        }
    }

    fn perform(&mut self, stream: StreamId, work: &Work, place: &Place) -> Result<(), KeepError> {
        match work {
            Work::Part(_) => {}
            Work::Check(hash) => self.checking.set(*hash),
            Work::Events(items) => {
                if self.replica.is_none() {
                    // Resumes the replica of a crashed run.
                    let opened = self.open(place, stream)?;
                    place.say(FromDisk::Opened(stream, opened));
                }
                self.replica.as_mut().map_or(Ok(()), |replica| replica.append(items))?;
            }
            Work::Close | Work::Leave { .. } => {
                if let Some(trouble) = self.sync(stream, place) {
                    return Err(trouble);
                }
                if let Some(replica) = self.replica.take() {
                    self.closed = Some(replica.next() - 1);
                    self.is_whole = matches!(work, Work::Close);
                    if !self.is_whole
                        && let Some(folder) = self.folder(place)
                    {
                        // If this fails, the run is shown as unheard.
                        drop(replace_file(&folder.join(CRASHED_FILE), &[]));
                    }
                    // While somebody reads it, a journal cannot be closed for long.
                    self.checking.rest();
                    replica.close();
                }
                place.say(FromDisk::Closed(stream));
            }
        }
        Ok(())
    }

    pub(super) fn sync(&mut self, stream: StreamId, place: &Place) -> Option<KeepError> {
        let replica = self.replica.as_mut().filter(|replica| replica.is_unsafe())?;
        match replica.commit() {
            Ok(safe) => {
                place.say(FromDisk::Safe(stream, safe));
                None
            }
            Err(error) => Some(error.into()),
        }
    }

    pub(super) fn name(&self) -> &str {
        self.about.as_ref().map_or("a run", |about| &about.id)
    }

    /// Its folder, once it is known.
    pub(super) fn folder(&self, place: &Place) -> Option<PathBuf> {
        self.about.as_ref().map(|about| place.runs.join(&about.id))
    }

    /// Freezes the replica, over restarts too. Returns the message.
    pub(super) fn note_diverged(&self, place: &Place, why: &str) -> String {
        let folder = place.runs.join(self.name());
        let said = format!(
            "{why}: its disk was put back to an earlier day, or the replica was changed. The replica stays as it is and takes nothing \
             more; to receive the run anew, move {} away and start the station again",
            folder.display()
        );
        // Without it, the next start finds out again.
        drop(replace_file(&folder.join(DIVERGED_FILE), said.as_bytes()));
        said
    }

    pub(super) fn refuse(&mut self) {
        self.is_refused = true;
        self.replica = None;
    }

    pub(super) fn drop_work(&mut self) -> usize {
        let parts = self.parts.drain(..).map(|part| Work::Part(part).cost());
        let written: usize = parts.sum();
        written + self.todo.drain(..).map(|work| work.cost()).sum::<usize>()
    }
}
