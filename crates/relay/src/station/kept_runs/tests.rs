//! The bounds of what a station remembers of the replicas on its disk.

use super::*;
use crate::ids;
use crate::machine_lists::MachineLists;
use crate::pairing::Pairing;
use crate::short_journal::{begun, ended};
use crate::start::Start;
use std::sync::mpsc;

/// The replicas of a robot in this folder, as a start of the station finds them.
fn kept_runs(folder: &Path) -> KeptRuns {
    let (inbox, _said) = mpsc::sync_channel(8);
    let pairing = Pairing::generate("scout", None).unwrap();
    let (file, next) = (folder.join("pairing"), folder.join("next"));
    let place = Place {
        number: 0,
        robot: "scout".to_owned(),
        runs: folder.join("runs"),
        clock: SessionClock::begin(),
        inbox,
        paired: Paired { pairing, file, next },
        machines: MachineLists::default(),
    };
    let start = Start::begin(&folder.join("ground")).unwrap();
    let parcels = StationParcels::open(&folder.join("machines")).unwrap();
    KeptRuns::new(place, start, parcels)
}

/// A replica that is whole.
fn replica(folder: &Path, id: &str) {
    let robot = Some("scout".to_owned());
    let about = About { id: id.to_owned(), robot, ..About::default() };
    ended(&folder.join("runs").join(id), &about, 1);
}

#[test]
fn of_many_whole_replicas_a_start_reads_the_newest_and_those_that_the_list_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let ids: Vec<_> = (0..CHECKED_MAX + 3).map(|nth| format!("run-{nth:04}")).collect();
    for id in &ids {
        replica(folder.path(), id);
    }
    let mut kept = kept_runs(folder.path());
    assert_eq!(kept.restore().len(), CHECKED_MAX + 3);
    // One came that the list does not have.
    replica(folder.path(), "run-0001b");
    assert_eq!(kept.restore().len(), CHECKED_MAX + 1);
}

#[test]
fn of_many_refused_runs_the_late_work_of_the_newest_is_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let mut kept = kept_runs(folder.path());
    let stream = |number: usize| ids::events_of(&format!("run-{number}"));
    for number in 0..=REFUSED_MAX {
        let mut run = KeptRun::default();
        run.refuse();
        kept.all.insert(stream(number), run);
        kept.settle();
    }
    assert!(kept.all.is_empty());
    assert_eq!(kept.refused.len(), REFUSED_MAX);
    let part = || {
        Work::Part(EventBlock { first_sequence: 1, count: 1, time_before: 0, bytes: vec![0; 9] })
    };
    for number in 1..=REFUSED_MAX {
        kept.add(stream(number), part());
    }
    assert!(kept.all.is_empty());
    assert_eq!(kept.dropped, REFUSED_MAX * part().cost());
    // The forgotten one is unknown: its work waits.
    kept.add(stream(0), part());
    assert_eq!(kept.all.keys().copied().collect::<Vec<_>>(), [stream(0)]);
}

#[test]
fn a_replica_is_crashed_only_if_the_robot_said_so_also_after_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let (id, robot) = ("run-1".to_owned(), Some("scout".to_owned()));
    let about = About { id: id.clone(), robot, ..About::default() };
    let run = folder.path().join("runs").join(&id);
    let stream = ids::events_of(&id);
    begun(&run, &about, 2).close().unwrap();
    // No station receives it, and its present state is unknown.
    assert_eq!(Summary::of(&run).state, RunState::NotReceived);
    let mut kept = kept_runs(folder.path());
    assert_eq!(kept.restore().iter().filter(|run| run.is_open()).count(), 1);
    assert!(matches!(Summary::of(&run).state, RunState::Live { .. }));
    kept.add(stream, Work::Leave { is_final: false });
    kept.go_on(true);
    assert_eq!(Summary::of(&run).state, RunState::Crashed);
    drop(kept);
    let mut kept = kept_runs(folder.path());
    assert_eq!(kept.restore().iter().filter(|run| run.is_open()).count(), 0);
    assert_eq!(Summary::of(&run).state, RunState::Crashed);
}
