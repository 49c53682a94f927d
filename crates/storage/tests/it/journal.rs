//! Journals and the operating system: processes killed while they write, disks that are full or read-only, two processes that open
//! one run.

use rafcon_storage::journal::{
    About, Batch, Journal, JournalError, Kept, Options, Place, PlaceNumber, Reader, Record,
    writer_of,
};
use std::env;
use std::error::Error as _;
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;

/// Variable with the folder for the child process. Not set in a normal test run.
const FOLDER: &str = "RAFCON_TEST_JOURNAL";
/// Variable with the number of kills. The default is 20.
const KILLS: &str = "RAFCON_TEST_KILLS";
/// Small, so that it is full now and then.
const OPTIONS: Options = Options { size_max: u64::MAX, recorder_bytes: 1 << 16 };

/// Appends numbered entries in small batches until it is killed, and prints their number after each batch. Another thread commits
/// all the time. Has no effect in a normal test run.
#[test]
fn appends_until_it_is_killed() {
    let Some(folder) = env::var_os(FOLDER) else { return };
    let journal = Journal::create(Path::new(&folder), &About::default(), &OPTIONS).unwrap();
    thread::scope(|scope| {
        scope.spawn(|| -> ! {
            loop {
                journal.commit().unwrap();
            }
        });
        let mut batch = Batch::new(0);
        let mut out = io::stdout();
        for size in (1..40).cycle() {
            let first = u32::try_from(journal.sequence()).unwrap() + 1;
            (first..first + size).for_each(|place| entered(&mut batch, place));
            while journal.append(&batch).is_err() {
                thread::yield_now();
            }
            batch.clear();
            writeln!(out, "appended {}", journal.sequence()).and_then(|()| out.flush()).unwrap();
        }
    });
}

fn entered(batch: &mut Batch, place: u32) {
    let [inputs, outputs, scoped] = [vec![], vec![], vec![]];
    let outcomes = vec![];
    let (path, names) = (place.to_string(), String::new());
    let (is_library, is_script) = (false, false);
    let defined = Place { path, names, is_library, is_script, inputs, outputs, scoped, outcomes };
    batch.define_place(PlaceNumber(place), &defined);
    batch.entered(u64::from(place), PlaceNumber(place), [Kept::Int(7)], None);
}

/// Starts a process that executes the test of this name in `folder`.
fn child(test: &str, folder: &Path) -> Command {
    let mut command = Command::new(env::current_exe().unwrap());
    command.args(["--exact", &format!("journal::{test}"), "--nocapture"]).env(FOLDER, folder);
    command
}

/// Kills the child after it has appended `batches` batches. Returns the last number of entries that it printed.
fn killed(mut child: Child, batches: usize) -> u64 {
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let said = |line: String| line.rsplit_once("appended ")?.1.parse().ok();
    let mut count = lines.by_ref().filter_map(said).take(batches).last().unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    // Output that remains in the pipe counts as well.
    if let Some(last) = lines.filter_map(said).last() {
        count = last;
    }
    count
}

#[test]
fn what_a_killed_process_appended_is_there() {
    let kills = env::var_os(KILLS).map_or(20, |kills| kills.to_str().unwrap().parse().unwrap());
    for round in 0..kills {
        let folder = tempfile::tempdir().unwrap();
        let child =
            child("appends_until_it_is_killed", folder.path()).stdout(Stdio::piped()).spawn();
        let count = killed(child.unwrap(), 1 + round * 7 % 100);
        let reader = Reader::open(folder.path()).unwrap();
        let left: u64 = reader.last_sequence().unwrap();
        assert!(left >= count, "{left} < {count}");
        let (journal, resume_point) = Journal::resume(folder.path(), &OPTIONS).unwrap();
        assert_eq!((resume_point.sequence, resume_point.life), (left, 2));
        journal.close().unwrap();
        let mut reader = Reader::open(folder.path()).unwrap();
        let page = reader.page(1, usize::MAX).unwrap();
        assert_eq!(page.len() as u64, left);
        for (entry, number) in page.iter().zip(1_u32..) {
            let is_it = matches!(&entry.record, Record::Entered { place, .. } if place.0 == number);
            assert!(is_it && entry.sequence == u64::from(number), "{number}: {entry:?}");
        }
    }
}

#[test]
fn one_process_writes_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let mut child =
        child("appends_until_it_is_killed", folder.path()).stdout(Stdio::piped()).spawn().unwrap();
    let process = child.id();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    lines.find(|line| line.as_ref().unwrap().contains("appended")).unwrap().unwrap();
    assert_eq!(writer_of(folder.path()).unwrap(), Some(process));
    let refused = Journal::resume(folder.path(), &OPTIONS).unwrap_err();
    let expected = format!(
        "the run in {} is still active (process {process}): join it with `rafcon attach`, or end it first",
        folder.path().display()
    );
    assert_eq!(refused.to_string(), expected);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(writer_of(folder.path()).unwrap(), None);
    Journal::resume(folder.path(), &OPTIONS).unwrap();
}

/// Fills its disk up to a limit for files, reports it, continues after the limit is raised, and loses no data. Has no effect in a
/// normal test run.
#[test]
fn fills_its_disk() {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let Some(folder) = env::var_os(FOLDER) else { return };
    let journal = Journal::create(Path::new(&folder), &About::default(), &OPTIONS).unwrap();
    let mut batch = Batch::new(0);
    let refused = loop {
        let first = u32::try_from(journal.sequence()).unwrap() + 1;
        (first..first + 50).for_each(|place| entered(&mut batch, place));
        journal.append(&batch).unwrap();
        batch.clear();
        if let Err(error) = journal.commit() {
            break error;
        }
    };
    let safe = journal.disk_safe();
    assert!(journal.commit().is_err());
    let limit = Rlimit { current: None, maximum: getrlimit(Resource::Fsize).maximum };
    setrlimit(Resource::Fsize, limit).unwrap();
    assert_eq!(journal.disk_safe(), safe);
    assert_eq!(journal.commit().unwrap().sequence, journal.sequence());
    writeln!(
        io::stdout(),
        "refused: {refused}: {}\ntold {}",
        refused.source().unwrap(),
        journal.sequence()
    )
    .unwrap();
}

#[test]
fn a_full_disk_is_named_and_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let child = child("fills_its_disk", folder.path());
    // A signal that is ignored remains ignored in the program that follows.
    let limited = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -S -f 400; exec \"$0\" \"$@\""])
        .arg(child.get_program())
        .args(child.get_args())
        .env(FOLDER, folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&limited.stdout);
    assert!(limited.status.success(), "{text}{}", String::from_utf8_lossy(&limited.stderr));
    let line = |start: &str| text.lines().find_map(|line| Some(line.split_once(start)?.1)).unwrap();
    let path = folder.path().join("journal.db");
    let expected =
        format!("the database {} fails: check that its disk has room and is well", path.display());
    assert!(line("refused: ").starts_with(&expected), "{text}");
    let mut reader = Reader::open(folder.path()).unwrap();
    let page = reader.page(1, usize::MAX).unwrap();
    assert_eq!(page.len().to_string(), line("told "));
}

#[test]
fn a_folder_that_nobody_can_write_to_is_named() {
    let folder = Path::new("/sys/kernel/rafcon-run");
    let refused = Journal::create(folder, &About::default(), &OPTIONS).unwrap_err();
    assert!(matches!(refused, JournalError::ReadOnly { .. }), "{refused:?}");
    let expected = "/sys/kernel/rafcon-run cannot be written: it or its disk is read-only; make it writable, or choose another folder with --runs";
    assert_eq!(refused.to_string(), expected);
}
