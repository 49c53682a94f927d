//! Stops a save at each operation on the disk. A load afterwards reads exactly the old or exactly the new machine, and no file of
//! the save remains.

use super::save_on;
use crate::staging::{Disk, RealDisk, is_interrupted, recover};
use crate::{Libraries, Loaded, Naming, Saved, load};
use parking_lot::Mutex;
use rafcon_model::Machine;
use rafcon_testkit::files::{fingerprint, make_files};
use rafcon_testkit::machines::{EVERY_KIND, VERSION_0_7_13, machine};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

fn loaded(dir: &Path) -> Loaded {
    load(dir, &Libraries::default()).unwrap()
}

/// A disk that fails after a number of operations. The failing operation may have done half of its work;
/// unsynced changes are lost, as after a power cut.
struct DyingDisk {
    left: AtomicUsize,
    unsynced: Mutex<Vec<PathBuf>>,
}

impl DyingDisk {
    fn after(operations: usize) -> Self {
        Self { left: AtomicUsize::new(operations), unsynced: Mutex::default() }
    }

    fn is_dead(&self) -> bool {
        self.left.load(Relaxed) == 0
    }

    fn step(&self) -> io::Result<()> {
        match self.left.load(Relaxed) {
            0 => Err(io::Error::other("the disk is dead")),
            1 => {
                self.left.store(0, Relaxed);
                for path in self.unsynced.lock().iter().filter(|path| path.is_file()) {
                    fs::write(path, "")?;
                }
                Err(io::Error::other("the disk dies"))
            }
            more => {
                self.left.store(more - 1, Relaxed);
                Ok(())
            }
        }
    }
}

impl Disk for DyingDisk {
    fn create_dir(&self, path: &Path) -> io::Result<()> {
        self.step()?;
        RealDisk.create_dir(path)
    }

    fn write(&self, path: &Path, bytes: &[u8], like: Option<&Path>) -> io::Result<()> {
        let was_dead = self.is_dead();
        self.unsynced.lock().push(path.to_owned());
        if let Err(error) = self.step() {
            if !was_dead {
                RealDisk.write(path, &bytes[..bytes.len() / 2], like)?;
            }
            return Err(error);
        }
        RealDisk.write(path, bytes, like)
    }

    fn sync(&self, paths: &[PathBuf]) -> io::Result<()> {
        self.step()?;
        self.unsynced.lock().retain(|path| !paths.contains(path));
        Ok(())
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.step()?;
        RealDisk.rename(from, to)?;
        for path in self.unsynced.lock().iter_mut() {
            if let Ok(inside) = path.strip_prefix(from) {
                *path = to.join(inside);
            }
        }
        Ok(())
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        self.step()?;
        RealDisk.remove_file(path)
    }

    fn remove_dir(&self, path: &Path) -> io::Result<()> {
        self.step()?;
        RealDisk.remove_dir(path)
    }

    fn remove_tree(&self, path: &Path) -> io::Result<()> {
        self.step()?;
        RealDisk.remove_tree(path)
    }
}

/// Content of a disk, by path.
type Bytes = Vec<(String, Vec<u8>)>;

/// A machine on disk that is to be replaced by another.
struct Scenario<'s> {
    make: &'s dyn Fn(&Path),
    new: Machine,
}

impl Scenario<'_> {
    fn start(&self) -> (tempfile::TempDir, Saved) {
        let dir = tempfile::tempdir().unwrap();
        (self.make)(dir.path());
        let saved = loaded(dir.path()).saved;
        (dir, saved)
    }

    /// Saves on `disk`, with a machine that shares nothing with the old one.
    fn save(&self, disk: &dyn Disk, dir: &Path, saved: &Saved) -> bool {
        let mut previous = saved.clone();
        previous.dir = dir.to_owned();
        save_on(disk, &self.new, dir, Some(&previous), Naming::default()).is_ok()
    }

    /// The bytes before, and after an undisturbed save.
    fn both(&self) -> (Bytes, Bytes) {
        let (dir, saved) = self.start();
        let old = fingerprint(dir.path());
        assert!(self.save(&RealDisk, dir.path(), &saved));
        let read = loaded(dir.path());
        assert_eq!(read.machine, self.new);
        assert_eq!(read.problems, []);
        (old, fingerprint(dir.path()))
    }

    /// Stops the save, then the recovery, at every step.
    fn check(&self) {
        let (old, new) = self.both();
        let mut seen = [false, false];
        for operations in 1.. {
            let (dir, saved) = self.start();
            let done = self.save(&DyingDisk::after(operations), dir.path(), &saved);
            stop_recovery(dir.path(), operations);
            loaded(dir.path());
            let now = fingerprint(dir.path());
            assert!(now == old || now == new, "neither old nor new after {operations} operations");
            seen[usize::from(now == new)] = true;
            if done {
                assert!(now == new);
                assert_eq!(seen, [true, true]);
                return;
            }
        }
    }
}

/// Stops the recovery of the save in `dir` at a step that changes with `operations`.
fn stop_recovery(dir: &Path, operations: usize) {
    if is_interrupted(&RealDisk, dir) {
        let stopped = recover(&DyingDisk::after(1 + operations % 7), dir);
        assert!(stopped.is_ok() || is_interrupted(&RealDisk, dir));
    }
}

fn saved_machine(text: &'static str) -> impl Fn(&Path) {
    move |dir| {
        save_on(&RealDisk, &machine(text), dir, None, Naming::default()).unwrap();
        make_files(dir, "== notes.txt\nmine\n== all_at_once_BARRIE/.git/x\nmine\n");
    }
}

/// [`EVERY_KIND`] with a state less, a state more, a state of another kind and another name, and less text.
const CHANGED: &str = r#"
machine
  version "2"
  created "2020-02-02 02:02:02"
  writer "2.2.0"
hierarchy ROOTID "The root"
  outcome success
  start -> FIRSTX
  FIRSTX.done -> .success
  hierarchy FIRSTX "first and last"
    outcome done
    hierarchy CCCCCC "slow"
      execution DDDDDD "inner"
        script "d = 2\n"
  execution LASTXX "renamed"
    in cup: str
  execution NEWXXX "new"
    script "n = 1\n"
"#;

#[test]
fn a_kill_at_any_moment_leaves_the_old_or_the_new_machine() {
    Scenario { make: &saved_machine(EVERY_KIND), new: machine(CHANGED) }.check();
}

#[test]
fn a_kill_leaves_old_or_new_also_the_other_way_round() {
    Scenario { make: &saved_machine(CHANGED), new: machine(EVERY_KIND) }.check();
}

#[test]
fn a_kill_while_one_file_changes_leaves_old_or_new() {
    let new = EVERY_KIND.replace("c = 1", "c = 2");
    Scenario { make: &saved_machine(EVERY_KIND), new: machine(&new) }.check();
}

#[test]
fn a_kill_while_an_old_layout_is_converted_leaves_old_or_new() {
    let make = |dir: &Path| {
        make_files(dir, VERSION_0_7_13);
    };
    let dir = tempfile::tempdir().unwrap();
    make(dir.path());
    let mut new = loaded(dir.path()).machine;
    new.header.used_rafcon_version = Some("2.2.0".into());
    Scenario { make: &make, new }.check();
}

#[test]
fn a_first_save_is_whole_or_not_there() {
    for operations in 1.. {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("new");
        let new = machine(EVERY_KIND);
        let disk = DyingDisk::after(operations);
        let done = save_on(&disk, &new, &target, None, Naming::default()).is_ok();
        match load(&target, &Libraries::default()) {
            Ok(read) => assert_eq!(read.machine, new),
            Err(_) => assert!(!done && fingerprint(dir.path()).is_empty()),
        }
        if done {
            return;
        }
    }
}

#[test]
fn a_save_after_an_interrupted_one_does_not_mix_them() {
    let scenario = Scenario { make: &saved_machine(EVERY_KIND), new: machine(CHANGED) };
    for operations in 1.. {
        let (dir, saved) = scenario.start();
        if scenario.save(&DyingDisk::after(operations), dir.path(), &saved) {
            return;
        }
        let third = machine(&EVERY_KIND.replace("who is first", "third"));
        save_on(&RealDisk, &third, dir.path(), Some(&saved), Naming::default()).unwrap();
        assert_eq!(loaded(dir.path()).machine, third, "after {operations} operations");
    }
}

#[test]
fn a_load_beside_a_running_save_sees_the_old_or_the_new_machine() {
    let dir = tempfile::tempdir().unwrap();
    let machines = [machine(EVERY_KIND), machine(CHANGED)];
    let mut saved = save_on(&RealDisk, &machines[0], dir.path(), None, Naming::default()).unwrap();
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            for _ in 0..30 {
                let read = loaded(dir.path());
                assert_eq!(read.problems, []);
                assert!(machines.contains(&read.machine));
            }
        });
        for machine in machines.iter().cycle().skip(1).take(30) {
            saved =
                save_on(&RealDisk, machine, dir.path(), Some(&saved), Naming::default()).unwrap();
        }
        reader.join().unwrap();
    });
}
