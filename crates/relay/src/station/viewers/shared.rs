//! The state of a replica that its viewers share, and the frames that wait for each of them.

use crate::station::watching::ReplicaWatch;
use parking_lot::{Condvar, Mutex};
use rafcon_protocol::api::Control;
use rafcon_protocol::{
    Answer, LinkHealth, Snapshot, ToViewer, WatchTarget, WatchedValue, Watching, encode_frame,
};
use rafcon_storage::journal::About;
use rafcon_supervisor::clock;
use std::collections::BTreeMap;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;

/// Capacity of the frames besides events that wait for a viewer.
pub(super) const FRAMES_MAX: usize = 256;

/// Content for viewers.
#[derive(Debug)]
pub(in crate::station) struct Shared {
    pub(super) folder: PathBuf,
    pub(super) loaded: ToViewer,
    shown: Mutex<Shown>,
    changed: Condvar,
}

#[derive(Debug)]
struct Outgoing {
    stream: UnixStream,
    frames: Vec<Vec<u8>>,
}

#[derive(Debug, Default)]
struct Shown {
    safe: u64,
    snapshot: Option<Snapshot>,
    /// Number of earlier snapshots.
    snapshots: u64,
    link: LinkHealth,
    control: Option<Control>,
    is_closed: bool,
    /// Lists of watched values, and the newest values.
    watched: ReplicaWatch,
    /// Other frames for each viewer, by the number of the viewer.
    viewers: BTreeMap<u64, Outgoing>,
    next_viewer: u64,
}

impl Shared {
    pub(in crate::station) fn new(
        folder: PathBuf,
        about: &About,
        safe: u64,
        link: LinkHealth,
    ) -> Self {
        let loaded = ToViewer::Loaded {
            name: about.name.clone(),
            states: about.states,
            problems: Vec::new(),
            run: about.id.clone(),
        };
        let shown = Mutex::new(Shown { safe, link, ..Shown::default() });
        Self { folder, loaded, shown, changed: Condvar::new() }
    }

    pub(in crate::station) fn set_safe(&self, safe: u64) {
        self.shown.lock().safe = safe;
        self.changed.notify_all();
    }

    pub(in crate::station) fn reported(&self, snapshot: Snapshot) {
        let mut shown = self.shown.lock();
        shown.snapshot = Some(snapshot);
        shown.snapshots += 1;
        drop(shown);
        self.changed.notify_all();
    }

    /// Sets the state of the link. Viewers receive it at once if contact, open commands or the planned contact change.
    pub(in crate::station) fn set_link(&self, link: LinkHealth) {
        let mut shown = self.shown.lock();
        let before = std::mem::replace(&mut shown.link, link);
        let is_news = before.is_heard != shown.link.is_heard
            || before.commands != shown.link.commands
            || before.contact != shown.link.contact
            || before.contacts_problem != shown.link.contacts_problem;
        drop(shown);
        if is_news {
            self.send_all(&self.pong(0));
        }
    }

    /// Control of the run is like this.
    pub(in crate::station) fn set_control(&self, control: Control) {
        let before = self.shown.lock().control.replace(control.clone());
        if before.as_ref() != Some(&control) {
            self.send_all(&ToViewer::Control(control));
        }
    }

    /// Stores the newest watched values from the robot.
    pub(in crate::station) fn watched(&self, values: Vec<WatchedValue>) {
        let messages = self.shown.lock().watched.take(values);
        self.send_each(messages);
    }

    /// True if the robot has the list of watched values.
    pub(in crate::station) fn set_watching(&self, watching: &Watching) {
        let messages = self.shown.lock().watched.set_watching(watching);
        self.send_each(messages);
    }

    fn send_each(&self, messages: Vec<(u64, ToViewer)>) {
        for (viewer, message) in messages {
            if let Ok(frame) = encode_frame(&message) {
                self.send(viewer, frame);
            }
        }
    }

    /// A viewer watches this now, or nothing any more.
    pub(in crate::station) fn watch(&self, viewer: u64, targets: Vec<WatchTarget>) {
        let messages = self.shown.lock().watched.watch(viewer, targets);
        self.send_each(messages);
    }

    /// List of watched values for the robot, if it has changed.
    pub(in crate::station) fn take_subscription(&self) -> Option<Vec<WatchTarget>> {
        self.shown.lock().watched.take_subscription()
    }

    /// The robot is asked for nothing of the run for now: it watches as many runs as it can.
    pub(in crate::station) fn leave_out(&self) {
        let messages = self.shown.lock().watched.leave_out();
        self.send_each(messages);
    }

    pub(super) fn pong(&self, id: u64) -> ToViewer {
        let link = Some(Box::new(self.shown.lock().link.clone()));
        ToViewer::Pong { id, now_ms: clock::since_1970_ms(), engine: None, link }
    }

    /// Sends an answer to all viewers: each knows what it has asked.
    pub(in crate::station) fn answer(&self, envelope: &str, answer: &Answer) {
        self.send_all(&ToViewer::Answer { id: envelope.to_owned(), answer: answer.clone() });
    }

    fn send_all(&self, message: &ToViewer) {
        let Ok(frame) = encode_frame(message) else { return };
        let viewers: Vec<u64> = self.shown.lock().viewers.keys().copied().collect();
        for viewer in viewers {
            self.send(viewer, frame.clone());
        }
    }

    /// Queues a frame for the thread of the viewer. A viewer with a full queue is disconnected.
    pub(super) fn send(&self, viewer: u64, frame: Vec<u8>) {
        if let Some(outgoing) = self.shown.lock().viewers.get_mut(&viewer) {
            if outgoing.frames.len() >= FRAMES_MAX {
                drop(outgoing.stream.shutdown(Shutdown::Both));
            } else {
                outgoing.frames.push(frame);
            }
        }
        self.changed.notify_all();
    }

    pub(super) fn is_closed(&self) -> bool {
        self.shown.lock().is_closed
    }

    /// The last event that viewers may receive.
    pub(super) fn safe(&self) -> u64 {
        self.shown.lock().safe
    }

    /// Control of the run, if the robot has reported it.
    pub(super) fn control(&self) -> Option<Control> {
        self.shown.lock().control.clone()
    }

    pub(super) fn arrive(&self, stream: UnixStream) -> u64 {
        let mut shown = self.shown.lock();
        let viewer = shown.next_viewer;
        shown.next_viewer += 1;
        shown.viewers.insert(viewer, Outgoing { stream, frames: Vec::new() });
        viewer
    }

    pub(super) fn leave(&self, viewer: u64) {
        self.shown.lock().viewers.remove(&viewer);
        self.changed.notify_all();
    }

    /// Waits for content that a viewer lacks. `None` if it is disconnected.
    pub(super) fn wait(&self, viewer: u64, next: u64, snapshots: u64) -> Option<News> {
        let mut shown = self.shown.lock();
        loop {
            let outgoing = shown.viewers.get_mut(&viewer)?;
            let frames = std::mem::take(&mut outgoing.frames);
            let is_news = !frames.is_empty() || shown.safe >= next || shown.snapshots > snapshots;
            if is_news || shown.is_closed {
                let Shown { safe, snapshots, is_closed, .. } = *shown;
                let snapshot = shown.snapshot.clone();
                return Some(News { frames, safe, snapshot, snapshots, is_closed });
            }
            self.changed.wait(&mut shown);
        }
    }

    pub(super) fn close(&self) {
        let mut shown = self.shown.lock();
        shown.is_closed = true;
        drop(shown);
        self.changed.notify_all();
    }
}

/// Content that a viewer lacks.
pub(super) struct News {
    pub(super) frames: Vec<Vec<u8>>,
    pub(super) safe: u64,
    pub(super) snapshot: Option<Snapshot>,
    pub(super) snapshots: u64,
    pub(super) is_closed: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use rafcon_protocol::Contact;
    use std::io::{self, Read as _};

    #[test]
    fn a_viewer_that_does_not_take_its_frames_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let health = LinkHealth::default();
        let shared = Shared::new(folder.path().to_owned(), &About::default(), 0, health);
        let (ours, mut theirs) = UnixStream::pair().unwrap();
        let viewer = shared.arrive(ours);
        (0..FRAMES_MAX).for_each(|_| shared.send(viewer, vec![1]));
        theirs.set_nonblocking(true).unwrap();
        let open = theirs.read(&mut [0]).unwrap_err();
        assert_eq!(open.kind(), io::ErrorKind::WouldBlock);
        shared.send(viewer, vec![2]);
        assert_eq!(theirs.read(&mut [0]).unwrap(), 0);
        // The capacity holds, and other viewers are served.
        let news = shared.wait(viewer, 1, 0).unwrap();
        assert_eq!(news.frames.len(), FRAMES_MAX);
        let (ours, _theirs) = UnixStream::pair().unwrap();
        let other = shared.arrive(ours);
        shared.send(other, vec![3]);
        assert_eq!(shared.wait(other, 1, 0).unwrap().frames, [[3]]);
    }

    #[test]
    fn a_viewer_receives_a_change_of_the_planned_contact_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let health = LinkHealth::default();
        let shared = Shared::new(folder.path().to_owned(), &About::default(), 0, health.clone());
        let (ours, _theirs) = UnixStream::pair().unwrap();
        let viewer = shared.arrive(ours);
        let frames = || shared.shown.lock().viewers[&viewer].frames.len();
        let profile = "deep".to_owned();
        let contact = Some(Contact { begin_ms: 1, end_ms: 2, profile, note: None });
        shared.set_link(LinkHealth { up_bytes_per_s: 7, ..health.clone() });
        assert_eq!(frames(), 0);
        shared.set_link(LinkHealth { contact, ..health.clone() });
        assert_eq!(frames(), 1);
        let contacts_problem = Some("damaged".to_owned());
        shared.set_link(LinkHealth { contacts_problem, ..health });
        assert_eq!(frames(), 2);
    }
}
