//! Lists that are released, with a thread in the place of the station's.

use super::*;
use rafcon_protocol::ListFate;
use rafcon_protocol::{CommandStage, LISTED_MAX};
use std::thread;

fn store(folder: &Path) -> CommandListStore {
    let store = CommandListStore::new(|_| Right::Command);
    store.receive("scout", folder);
    store
}

fn pauses(count: usize) -> Vec<ListedCommand> {
    let run = "r".to_owned();
    let pause = ListedCommand { run, command: Command::Pause, not_before: None, expiry: None };
    vec![pause; count]
}

/// Does something while the questions to the station are answered by `answer`; returns the result.
fn with_station<T: Send>(
    store: &CommandListStore,
    answers: usize,
    answer: impl Fn(usize, &ListQuestion) -> Vec<LineReport> + Send,
    act: impl FnOnce() -> T,
) -> T {
    thread::scope(|scope| {
        let station = move || {
            let mut nth = 0;
            while nth < answers {
                for question in store.take("scout") {
                    let reports = answer(nth, &question);
                    question.answer(reports);
                    nth += 1;
                }
                thread::yield_now();
            }
        };
        thread::Builder::new().spawn_scoped(scope, station).unwrap();
        act()
    })
}

fn good(question: &ListQuestion) -> Vec<LineReport> {
    let fate = question.author.as_ref().map(|_| ListFate::Open { stage: CommandStage::Sent });
    let times = ListTimes { not_before_ms: None, expiry_ms: Some(9) };
    vec![LineReport { times, fate, ..LineReport::default() }; question.list.commands().len()]
}

fn bad(question: &ListQuestion) -> Vec<LineReport> {
    let mut reports = good(question);
    reports[0].fault = Some("no room".to_owned());
    reports
}

fn request(revision: &str) -> ListRequest {
    let (revision, user) = (revision.to_owned(), "ana".to_owned());
    ListRequest { revision, user, lines: Vec::new() }
}

#[test]
fn a_release_is_on_the_disk_with_its_times_before_anything_is_sent() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path());
    let list =
        with_station(&store, 1, |_, it| good(it), || store.set("scout", pauses(2), None).unwrap());
    let file = CommandListFile::in_folder(folder.path());
    let answer = |_, question: &ListQuestion| {
        let on_disk = file.read().unwrap();
        assert_eq!(on_disk.is_released(), question.author.is_some());
        assert_eq!(on_disk, question.list);
        good(question)
    };
    let release = || store.release("scout", &request(&list.revision)).unwrap();
    let released = with_station(&store, 2, answer, release);
    assert_eq!(released.released.as_ref().map(|it| it.user.as_str()), Some("ana"));
    assert!(released.lines.iter().all(|line| line.fate.is_some()));
    let times = file.read().unwrap().times(&rafcon_protocol::ContactPlan::default(), 0);
    assert_eq!(times[1].as_ref().unwrap().expiry_ms, Some(9));
    // A second release sends the same ids.
    let ids = file.read().unwrap().ids();
    let same = |_, question: &ListQuestion| {
        assert_eq!(question.list.ids(), ids);
        good(question)
    };
    with_station(&store, 2, same, || store.release("scout", &request(&list.revision)).unwrap());
}

#[test]
fn a_list_with_a_fault_is_not_released_and_keeps_no_mark() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path());
    let list =
        with_station(&store, 1, |_, it| good(it), || store.set("scout", pauses(2), None).unwrap());
    // The fault is there before the mark, or comes between the mark and the send.
    for faulty in [0, 1] {
        let answer = |nth, question: &ListQuestion| match nth {
            nth if nth == faulty => bad(question),
            _ => good(question),
        };
        let release = || store.release("scout", &request(&list.revision)).unwrap_err();
        let why = with_station(&store, faulty + 1, answer, release);
        assert_eq!(
            why.to_string(),
            "nothing was sent, because of these faults:\nline 1 (pause of run r): no room"
        );
        assert!(!CommandListFile::in_folder(folder.path()).read().unwrap().is_released());
    }
    // A fault that the server has found counts, too.
    let fault = Some("you may not".to_owned());
    let lines = vec![LineRequest::default(), LineRequest { fault, is_settled: false }];
    let request = ListRequest { lines, ..request(&list.revision) };
    let release = || store.release("scout", &request).unwrap_err();
    let why = with_station(&store, 1, |_, it| good(it), release);
    assert!(why.to_string().ends_with("line 2 (pause of run r): you may not"), "{why}");
}

#[test]
fn another_list_than_the_reviewed_one_is_not_released() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path());
    let set = || store.set("scout", pauses(1), None).unwrap().revision;
    let [before, now] = [(); 2].map(|()| with_station(&store, 1, |_, it| good(it), set));
    let refused = |revision: &str| store.release("scout", &request(revision)).unwrap_err();
    assert!(matches!(refused(&before), CommandListError::Stale));
    assert!(matches!(store.list("mule"), Err(CommandListError::NotReceived)));
    with_station(&store, 1, |_, it| good(it), || store.set("scout", Vec::new(), None).unwrap());
    assert!(matches!(refused(&now), CommandListError::Stale));
    let empty = CommandListFile::in_folder(folder.path()).read().unwrap().revision();
    assert!(matches!(refused(&empty), CommandListError::Empty));
}

#[test]
fn so_many_questions_wait_for_the_station() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path());
    let list = CommandListFile::in_folder(folder.path()).set(pauses(LISTED_MAX), None).unwrap();
    let mut robots = store.shared.robots.lock();
    let robot = robots.get_mut("scout").unwrap();
    let question = |number| ListQuestion {
        number,
        list: list.clone(),
        rights: Vec::new(),
        settled: Vec::new(),
        author: None,
        reply: sync_channel(1).0,
    };
    robot.questions = (0..QUESTIONS_MAX as u64).map(question).collect();
    drop(robots);
    assert!(matches!(store.list("scout"), Err(CommandListError::Busy)));
    assert!(store.withdraw("scout", 0) && !store.withdraw("scout", 0));
    with_station(
        &store,
        QUESTIONS_MAX,
        |_, question| vec![LineReport::default(); question.list.commands().len()],
        || assert_eq!(store.list("scout").unwrap().lines.len(), LISTED_MAX),
    );
}
