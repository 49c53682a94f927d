//! The bounds of what a robot remembers and sends of its runs.

use super::super::scanner::RunScanner;
use super::journals::{AHEAD_MAX, HASHED_AT_ONCE, OPEN_MAX};
use super::*;
use crate::short_journal::{append, begun, ended};
use rafcon_link::{Identity, KeyId, PairingKey, Profile, RunSource as _, SenderStart};
use rafcon_storage::journal::About;
use std::fs;
use std::sync::mpsc;

/// Runs of a robot on disk, and the session that sends them.
struct Robot {
    folder: tempfile::TempDir,
    session: RobotSession,
}

impl Robot {
    fn new() -> Self {
        let identity = Identity {
            key_id: KeyId(1),
            key: &PairingKey::from_bytes([7; 32]),
            robot: "scout",
            start: SenderStart::new(1, 1),
            heard: None,
        };
        let folder = tempfile::tempdir().unwrap();
        Self { folder, session: RobotSession::new(&identity, Profile::LAN) }
    }

    /// What a start of the robot makes of the runs on its disk.
    fn runs(&self) -> RobotRuns {
        let (inbox, _told) = mpsc::sync_channel(8);
        let (maker, _works) = mpsc::sync_channel(8);
        let tell: fn(&str) = |problem| panic!("{problem}");
        let (numbers, parcels) = (RunNumbers::read(&[]), SentParcels::new(maker));
        let (folder, clock) = (self.folder.path().join("runs"), SessionClock::begin());
        let place = RunsPlace { folder, inbox, tell, clock, pickle_max: usize::MAX };
        RobotRuns::new(place, numbers, parcels)
    }

    /// A scan of the disk's thread, and what the relay makes of it each second.
    fn scan(&mut self, runs: &mut RobotRuns) {
        let tell: fn(&str) = |problem| panic!("{problem}");
        let mut scanner = RunScanner::new(&runs.place.folder, runs.known(), tell);
        runs.release(&mut self.session);
        runs.go_on(&mut self.session, true);
        runs.scanned(scanner.scan(), &mut self.session);
    }

    fn folder_of(&self, id: &str) -> PathBuf {
        self.folder.path().join("runs").join(id)
    }
}

fn about(id: &str) -> About {
    About { id: id.to_owned(), ..About::default() }
}

#[test]
fn of_a_long_list_of_sent_runs_the_newest_go_on_and_the_others_come_as_older_ones() {
    let mut robot = Robot::new();
    let ids: Vec<_> = (0..LISTED_MAX + 2).map(|nth| format!("run-{nth:04}")).collect();
    for id in &ids {
        ended(&robot.folder_of(id), &about(id), 1);
    }
    let mut runs = robot.runs();
    runs.restore(&ids.join("\n"), &mut robot.session);
    assert_eq!(runs.all.keys().collect::<Vec<_>>(), ids[2..].iter().collect::<Vec<_>>());
    let older = [runs.ended.pop_older(), runs.ended.pop_older(), runs.ended.pop_older()];
    assert_eq!(older, [Some(ids[1].clone()), Some(ids[0].clone()), None]);
}

#[test]
fn new_events_are_sent_whether_they_go_ahead_or_are_too_many_for_that() {
    let mut robot = Robot::new();
    let journal = begun(&robot.folder_of("run"), &about("run"), 1);
    let mut runs = robot.runs();
    assert!(runs.begin_from("run", &robot.folder_of("run"), &mut robot.session));
    let mut last = 1;
    for more in [1, AHEAD_MAX, AHEAD_MAX + 1, 3 * AHEAD_MAX, 1] {
        append(&journal, more);
        runs.all.get_mut("run").unwrap().source = None;
        runs.happened("run", &mut robot.session);
        last += more;
        let events = runs.all["run"].events;
        assert_eq!(robot.session.progress(events), Some((last, last)));
    }
}

#[test]
fn a_run_whose_files_are_being_written_is_no_problem_and_is_sent_later() {
    let mut robot = Robot::new();
    let folder = robot.folder_of("run");
    let _journal = begun(&folder, &about("run"), 1);
    let file = folder.join("run.json");
    let text = fs::read(&file).unwrap();
    fs::remove_file(&file).unwrap();
    let mut runs = robot.runs();
    // A problem panics.
    robot.scan(&mut runs);
    assert!(runs.all.is_empty());
    fs::write(&file, text).unwrap();
    robot.scan(&mut runs);
    assert!(runs.all.contains_key("run"));
}

#[test]
fn of_many_ended_runs_only_some_journals_are_open() {
    let mut robot = Robot::new();
    let count = OPEN_MAX + HASHED_AT_ONCE;
    for nth in 0..count {
        let id = format!("run-{nth:04}");
        ended(&robot.folder_of(&id), &about(&id), 1);
    }
    let mut runs = robot.runs();
    robot.scan(&mut runs);
    let open = |runs: &RobotRuns| runs.all.values().filter(|run| run.source.is_some()).count();
    assert_eq!((runs.all.len(), open(&runs)), (count, OPEN_MAX));
    // Those that were closed are opened again when their events are sent.
    let streams: Vec<_> = runs.all.values().map(|run| run.events).collect();
    for stream in streams {
        assert_eq!(runs.events(stream, 1, 2, 1_000).map(|events| events.count), Some(2));
        assert!(open(&runs) <= OPEN_MAX);
    }
}

#[test]
fn all_runs_that_ended_at_once_are_hashed_in_steps() {
    let mut robot = Robot::new();
    for nth in 0..=HASHED_AT_ONCE {
        let id = format!("run-{nth:04}");
        ended(&robot.folder_of(&id), &about(&id), 1);
    }
    let mut runs = robot.runs();
    robot.scan(&mut runs);
    let hashed = |runs: &RobotRuns| runs.all.values().filter(|run| run.is_hashed()).count();
    assert_eq!((hashed(&runs), runs.is_busy(false)), (0, true));
    runs.go_on(&mut robot.session, true);
    assert_eq!(hashed(&runs), HASHED_AT_ONCE);
    runs.go_on(&mut robot.session, true);
    assert_eq!(hashed(&runs), HASHED_AT_ONCE + 1);
    // The rest waits for reports of the station.
    assert_eq!([false, true].map(|is_heard| runs.is_busy(is_heard)), [false, true]);
}

#[test]
fn journals_that_cannot_be_read_hold_up_no_other() {
    let mut robot = Robot::new();
    let ids: Vec<_> = (0..=HASHED_AT_ONCE).map(|nth| format!("run-{nth:04}")).collect();
    for id in &ids {
        ended(&robot.folder_of(id), &about(id), 1);
    }
    let mut runs = robot.runs();
    robot.scan(&mut runs);
    let (readable, damaged) = ids.split_last().unwrap();
    for id in damaged {
        runs.all.get_mut(id).unwrap().source = None;
        fs::remove_file(robot.folder_of(id).join("journal.db")).unwrap();
    }
    runs.go_on(&mut robot.session, true);
    assert!(runs.all[readable].is_hashed());
    // They are tried again with the next scan, not at each step.
    assert!(!runs.is_busy(false));
}
