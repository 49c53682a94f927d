//! Reads all folders of a machine with several threads. Finds the files and the children of each state, but does not build a tree.

use super::bounds::{Bounds, Unread};
use super::folder::{self, FileReader, FolderEntry};
use super::queue::Queue;
use super::state_files::{Node, StateFiles, StateReader};
use crate::files::{HEADER, Part, STAGING};
use crate::problem::{Fault, LoadError};
use rustix::fd::OwnedFd;
use rustix::fs::OFlags;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Deeper folders are not read.
pub(crate) const MAX_DEPTH: usize = 1024;
/// The number of waiting folders that justifies a second thread.
const WORTH_A_THREAD: usize = 24;
/// The maximum number of threads: more would only wait for the kernel.
pub(crate) const MAX_THREADS: usize = 8;

/// A folder to be read, and its open parent folder.
#[derive(Debug)]
struct FolderToRead {
    dir: Arc<Dir>,
    folder: OsString,
    parent: Option<usize>,
    linked: bool,
}

/// An open folder on the way down.
#[derive(Debug)]
struct Dir {
    fd: OwnedFd,
    inode: u64,
    depth: usize,
    /// Name of the folder, for messages.
    name: OsString,
    parent: Option<Arc<Self>>,
}

impl Dir {
    fn path(&self, name: &OsStr) -> PathBuf {
        let above = self.parent.as_ref().map(|parent| parent.path(&self.name));
        above.unwrap_or_default().join(name)
    }

    /// Returns true if the folder with this inode is this one or contains it.
    fn is_in(&self, inode: u64) -> bool {
        self.inode == inode || self.parent.as_ref().is_some_and(|around| around.is_in(inode))
    }
}

/// All states below `dir` in any order; the root is in `root_folder` (empty for `dir` itself).
/// Empty if the root's folder has no `core_data.json`.
pub(crate) fn walk(
    fd: OwnedFd,
    path: &Path,
    root_folder: &OsStr,
    bounds: Bounds<'_>,
) -> Result<Vec<Node>, LoadError> {
    let inode = folder::inode(&fd).map_err(|error| LoadError::io(path, error))?;
    let dir = Arc::new(Dir { fd, inode, depth: 0, name: OsString::new(), parent: None });
    let root = FolderToRead { dir, folder: root_folder.to_owned(), parent: None, linked: false };
    let walk = Walk { queue: Queue::new(root), next: AtomicUsize::new(0), path, bounds };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(MAX_THREADS);
    thread::scope(|scope| {
        let mut helpers = Vec::new();
        let first = walk.work(|| {
            if helpers.is_empty() && threads > 1 && walk.queue.len() >= WORTH_A_THREAD {
                helpers.extend((1..threads).map(|_| scope.spawn(|| walk.work(|| ()))));
            }
        });
        let mut nodes = first?;
        for helper in helpers {
            match helper.join() {
                Ok(more) => nodes.append(&mut more?),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok(nodes)
    })
}

struct Walk<'p> {
    queue: Queue<FolderToRead>,
    next: AtomicUsize,
    path: &'p Path,
    bounds: Bounds<'p>,
}

impl Walk<'_> {
    /// Reads waiting folders until none is left, calling `between` before each.
    fn work(&self, mut between: impl FnMut()) -> Result<Vec<Node>, LoadError> {
        let files = FileReader::new(self.bounds);
        let mut reader = WalkReader { files, states: StateReader::default() };
        let mut nodes = Vec::new();
        while let Some(item) = self.queue.next() {
            between();
            let mut children = Vec::new();
            let read = reader.node(&item, &self.next, &mut children);
            match read {
                Ok(node) => nodes.extend(node),
                Err(why) => {
                    self.queue.abandon();
                    let around = self.path.join(item.dir.path(OsStr::new("")));
                    return Err(LoadError::unread(&around, Path::new(&item.folder), why));
                }
            }
            self.queue.done(children);
        }
        Ok(nodes)
    }
}

/// The tools of one thread.
struct WalkReader<'h> {
    files: FileReader<'h>,
    states: StateReader,
}

impl WalkReader<'_> {
    /// The state in the folder of `item`, if there is one; adds the folders in it to `children`.
    fn node(
        &mut self,
        item: &FolderToRead,
        next: &AtomicUsize,
        children: &mut Vec<FolderToRead>,
    ) -> Result<Option<Node>, Unread> {
        if item.parent.is_some() && self.files.exists(&item.dir.fd, &item.folder, HEADER) {
            return Ok(None); // another machine, not a state of this one
        }
        let mut files = InFolder { files: &mut self.files, item };
        let Some(read) = self.states.read(&item.folder, &mut files)? else { return Ok(None) };
        let number = next.fetch_add(1, Ordering::Relaxed);
        let (parent, linked) = (item.parent, item.linked);
        let mut node = read.node(number, parent, item.folder.clone(), linked);
        if node.state.container().is_some() {
            self::children(item, number, children, &mut node.faults, self.files.bounds())?;
        }
        Ok(Some(node))
    }
}

/// The files of the state in one folder.
struct InFolder<'a, 'h> {
    files: &'a mut FileReader<'h>,
    item: &'a FolderToRead,
}

impl StateFiles for InFolder<'_, '_> {
    fn read(&mut self, part: Part) -> Result<Option<&[u8]>, Unread> {
        self.files.read(&self.item.dir.fd, &self.item.folder, part.file_name())
    }
}

/// Adds the folders in the folder of `item`, which may contain its children.
fn children(
    item: &FolderToRead,
    number: usize,
    children: &mut Vec<FolderToRead>,
    faults: &mut Vec<(Part, Fault)>,
    bounds: Bounds<'_>,
) -> Result<(), Unread> {
    let at: &OsStr = if item.folder.is_empty() { OsStr::new(".") } else { &item.folder };
    let fd = bounds.open(&item.dir.fd, Path::new(at), OFlags::DIRECTORY)?;
    let found: Vec<FolderEntry> = folder::folders(&fd)?;
    let depth = item.dir.depth + 1;
    if depth >= MAX_DEPTH && !found.is_empty() {
        faults.push((Part::Core, Fault::TooDeep(MAX_DEPTH)));
        return Ok(());
    }
    let inode = folder::inode(&fd)?;
    let parent = Some(Arc::clone(&item.dir));
    let dir = Arc::new(Dir { fd, inode, depth, name: item.folder.clone(), parent });
    for entry in found.into_iter().filter(|entry| entry.name != STAGING) {
        if entry.unclear && leads_back(&dir, &entry.name, bounds)? {
            faults.push((Part::Core, Fault::Loop(entry.name.to_string_lossy().as_ref().into())));
            continue;
        }
        let FolderEntry { name: folder, unclear: linked } = entry;
        children.push(FolderToRead { dir: Arc::clone(&dir), folder, parent: Some(number), linked });
    }
    Ok(())
}

/// Returns true if the entry is a folder that contains this one.
fn leads_back(dir: &Dir, name: &OsStr, bounds: Bounds<'_>) -> Result<bool, Unread> {
    match bounds.open(&dir.fd, Path::new(name), OFlags::DIRECTORY) {
        Ok(found) => Ok(folder::inode(found).is_ok_and(|inode| dir.is_in(inode))),
        Err(Unread::System(_)) => Ok(false),
        Err(Unread::Outside(link)) => Err(Unread::Outside(Path::new(&dir.name).join(link))),
        Err(Unread::Unfit(file)) => Err(Unread::Unfit(Path::new(&dir.name).join(file))),
    }
}
