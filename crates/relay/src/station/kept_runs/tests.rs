//! The list of refused runs of a station's disk is bounded.

use super::*;
use crate::pairing::Pairing;
use crate::start::Start;
use std::sync::mpsc;

#[test]
fn of_many_refused_runs_the_late_work_of_the_newest_is_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let (inbox, _said) = mpsc::sync_channel(8);
    let pairing = Pairing::generate("scout", None).unwrap();
    let (file, next) = (folder.path().join("pairing"), folder.path().join("next"));
    let place = Place {
        number: 0,
        robot: "scout".to_owned(),
        runs: folder.path().join("runs"),
        clock: SessionClock::begin(),
        inbox,
        paired: Paired { pairing, file, next },
    };
    let start = Start::begin(&folder.path().join("ground")).unwrap();
    let parcels = StationParcels::open(&folder.path().join("machines")).unwrap();
    let mut kept = KeptRuns::new(place, start, parcels);
    let stream = |number: usize| ids::events_of(&format!("run-{number}"));
    for number in 0..=REFUSED_MAX {
        kept.all.insert(stream(number), KeptRun { is_refused: true, ..KeptRun::default() });
        kept.settle();
    }
    assert!(kept.all.is_empty());
    assert_eq!(kept.refused.len(), REFUSED_MAX);
    let part = || Work::Part(EventItems { first: 1, count: 1, t_before: 0, bytes: vec![0; 9] });
    for number in 1..=REFUSED_MAX {
        kept.add(stream(number), part());
    }
    assert!(kept.all.is_empty());
    assert_eq!(kept.dropped, REFUSED_MAX * part().cost());
    // The forgotten one is unknown: its work waits.
    kept.add(stream(0), part());
    assert_eq!(kept.all.keys().copied().collect::<Vec<_>>(), [stream(0)]);
}
