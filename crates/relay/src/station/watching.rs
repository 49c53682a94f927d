//! Watched values of a replica's viewers. The robot receives one list for all, and each viewer receives its own values.

use rafcon_protocol::{ToViewer, WatchKind, WatchTarget, WatchedValue, Watching};
use std::collections::BTreeMap;

/// Capacity of the values of a run.
const VALUES_MAX: usize = 1_024;
/// Maximum number of values in a message.
const MESSAGE_MAX: usize = 256;
/// Capacity of the list of a viewer. The rest is left out, and counted.
const TARGETS_MAX: usize = 1_024;

/// Watched values of one run.
#[derive(Debug, Default)]
pub(super) struct ReplicaWatch {
    viewers: BTreeMap<u64, Vec<WatchTarget>>,
    targets: Vec<WatchTarget>,
    /// Number of the targets of viewers that the robot is not asked for.
    left_out: usize,
    /// The robot is to be asked for something else than before.
    is_list_new: bool,
    /// The robot cannot be asked for now.
    is_left_out: bool,
    watching: Watching,
    values: BTreeMap<(WatchKind, String, String), WatchedValue>,
}

impl ReplicaWatch {
    /// Sets the list of a viewer. Returns the known values for it.
    pub(super) fn watch(
        &mut self,
        viewer: u64,
        mut targets: Vec<WatchTarget>,
    ) -> Vec<(u64, ToViewer)> {
        let too_many = targets.len().saturating_sub(TARGETS_MAX);
        targets.truncate(TARGETS_MAX);
        if targets.is_empty() {
            self.viewers.remove(&viewer);
        } else {
            self.viewers.insert(viewer, targets);
        }
        let (targets, left_out) = WatchTarget::union(self.viewers.values().flatten());
        self.left_out = left_out + too_many;
        if targets != self.targets {
            self.values.retain(|_, value| is_watched(&targets, value));
            (self.targets, self.is_list_new) = (targets, true);
        }
        let known: Vec<_> = self.values.values().collect();
        self.messages(viewer, &known)
    }

    /// List for the robot, if it has changed.
    pub(super) fn take_subscription(&mut self) -> Option<Vec<WatchTarget>> {
        self.is_left_out = false;
        std::mem::take(&mut self.is_list_new).then(|| self.targets.clone())
    }

    /// The robot cannot be asked for now: nothing of what is watched is sent ahead, and what is to be asked for waits.
    pub(super) fn leave_out(&mut self) -> Vec<(u64, ToViewer)> {
        if !self.is_list_new {
            return Vec::new();
        }
        let left_out = u32::try_from(self.targets.len()).unwrap_or(u32::MAX);
        self.is_left_out = false;
        let messages = self.set_watching(&Watching { is_confirmed: true, asked_ms: 0, left_out });
        self.is_left_out = true;
        messages
    }

    /// Stores values from the robot. Older values than the present ones are dropped.
    pub(super) fn take(&mut self, values: Vec<WatchedValue>) -> Vec<(u64, ToViewer)> {
        let mut new = Vec::new();
        for value in values {
            let place = (value.kind, value.path.clone(), value.name.clone());
            let known = self.values.get(&place).map(|known| known.sequence);
            let is_room = known.is_some() || self.values.len() < VALUES_MAX;
            let is_newer = known.is_none_or(|known| known < value.sequence);
            if is_room && is_newer && is_watched(&self.targets, &value) {
                self.values.insert(place, value.clone());
                new.push(value);
            }
        }
        if new.is_empty() {
            return Vec::new();
        }
        let new: Vec<_> = new.iter().collect();
        self.viewers.keys().flat_map(|viewer| self.messages(*viewer, &new)).collect()
    }

    /// True if the robot has the list of watched values.
    pub(super) fn set_watching(&mut self, watching: &Watching) -> Vec<(u64, ToViewer)> {
        if self.is_left_out || self.watching == *watching {
            return Vec::new();
        }
        self.watching = watching.clone();
        self.viewers.keys().flat_map(|viewer| self.messages(*viewer, &[])).collect()
    }

    /// Selects these values for a viewer. `None` if it watches none.
    fn messages(&self, viewer: u64, values: &[&WatchedValue]) -> Vec<(u64, ToViewer)> {
        let Some(targets) = self.viewers.get(&viewer) else { return Vec::new() };
        let left_out = u32::try_from(self.left_out).unwrap_or(u32::MAX);
        let left_out = self.watching.left_out.saturating_add(left_out);
        let watching = Watching { left_out, ..self.watching.clone() };
        let values = values.iter().filter(|value| is_watched(targets, value));
        let values: Vec<_> = values.map(|value| (*value).clone()).collect();
        let message = |values: &[WatchedValue]| {
            (viewer, ToViewer::Watched { watching: watching.clone(), values: values.to_vec() })
        };
        if values.is_empty() {
            return vec![message(&[])];
        }
        values.chunks(MESSAGE_MAX).map(message).collect()
    }
}

fn is_watched(targets: &[WatchTarget], value: &WatchedValue) -> bool {
    targets.iter().any(|target| target.fits(value.kind, &value.path, &value.name))
}

#[cfg(test)]
mod tests {
    use super::{MESSAGE_MAX, ReplicaWatch, TARGETS_MAX, VALUES_MAX};
    use expect_test::expect;
    use rafcon_protocol::{ToViewer, WATCHED_MAX, WatchKind, WatchTarget, WatchedValue, Watching};

    fn targets(paths: &[&str]) -> Vec<WatchTarget> {
        let target = |path: &&str| {
            let (kind, path, name) = (WatchKind::State, (*path).to_owned(), String::new());
            WatchTarget { kind, path, name, priority: 0 }
        };
        paths.iter().map(target).collect()
    }

    fn value(path: &str, sequence: u64) -> WatchedValue {
        let (kind, name) = (WatchKind::Input, "x".to_owned());
        let (path, value) = (path.to_owned(), Some(sequence.into()));
        WatchedValue { kind, path, name, sequence, t_ns: 0, value, large: None }
    }

    fn told(messages: &[(u64, ToViewer)]) -> String {
        let one = |(viewer, message): &(u64, ToViewer)| {
            let ToViewer::Watched { watching, values } = message else { return String::new() };
            let values: Vec<_> =
                values.iter().map(|it| format!("{}@{}", it.path, it.sequence)).collect();
            let known = if watching.is_confirmed { " confirmed" } else { "" };
            format!("  viewer {viewer}:{known} {values:?}\n")
        };
        messages.iter().map(one).collect()
    }

    fn left_out(messages: &[(u64, ToViewer)]) -> Vec<usize> {
        let one = |(_, message): &(u64, ToViewer)| match message {
            ToViewer::Watched { watching, .. } => watching.left_out as usize,
            _ => usize::MAX,
        };
        messages.iter().map(one).collect()
    }

    fn lengths(messages: &[(u64, ToViewer)]) -> Vec<usize> {
        let one = |(_, message): &(u64, ToViewer)| match message {
            ToViewer::Watched { values, .. } => values.len(),
            _ => usize::MAX,
        };
        messages.iter().map(one).collect()
    }

    #[test]
    fn what_several_watch_is_asked_for_once_and_each_is_sent_its_part() {
        let mut run = ReplicaWatch::default();
        let mut said = String::new();
        let mut watch = |run: &mut ReplicaWatch, viewer, paths: &[&str]| {
            let message = run.watch(viewer, targets(paths));
            let targets = run.take_subscription();
            let targets =
                targets.map(|targets| targets.iter().map(|it| it.path.clone()).collect::<Vec<_>>());
            said.extend([format!("asks {targets:?}\n"), told(&message)]);
        };
        watch(&mut run, 1, &["R/ARM"]);
        watch(&mut run, 2, &["R/ARM", "R/EYE"]);
        watch(&mut run, 3, &["R/EYE"]);
        watch(&mut run, 4, &[]);
        let new = run.take(vec![value("R/ARM/A", 5), value("R/EYE", 6), value("R/LEG", 7)]);
        let old = run.take(vec![value("R/ARM/A", 4), value("R/ARM/A", 5)]);
        let watching = Watching { is_confirmed: true, ..Watching::default() };
        let known = run.set_watching(&watching);
        let again = run.set_watching(&watching);
        let news = [new, old, known, again].map(|messages| told(&messages));
        watch(&mut run, 5, &["R/ARM"]);
        watch(&mut run, 2, &[]);
        watch(&mut run, 3, &[]);
        said.push_str(&news.join("then\n"));
        expect![[r#"
            asks Some(["R/ARM"])
              viewer 1: []
            asks Some(["R/ARM", "R/EYE"])
              viewer 2: []
            asks None
              viewer 3: []
            asks None
            asks None
              viewer 5: confirmed ["R/ARM/A@5"]
            asks None
            asks Some(["R/ARM"])
              viewer 1: ["R/ARM/A@5"]
              viewer 2: ["R/ARM/A@5", "R/EYE@6"]
              viewer 3: ["R/EYE@6"]
            then
            then
              viewer 1: confirmed []
              viewer 2: confirmed []
              viewer 3: confirmed []
            then
        "#]]
        .assert_eq(&said);
    }

    #[test]
    fn while_the_robot_cannot_be_asked_a_viewer_is_told_what_is_left_out() {
        let mut run = ReplicaWatch::default();
        let known = Watching { is_confirmed: true, asked_ms: 5, left_out: 0 };
        let mut said = Vec::new();
        run.watch(1, targets(&["R/ARM", "R/EYE"]));
        said.extend(run.leave_out());
        said.extend(run.leave_out());
        // Meanwhile reports about earlier requests do not count.
        said.extend(run.set_watching(&known));
        run.watch(1, targets(&["R/ARM"]));
        said.extend(run.leave_out());
        assert_eq!(run.take_subscription().expect("a list").len(), 1);
        said.extend(run.set_watching(&known));
        said.extend(run.leave_out());
        assert_eq!(left_out(&said), [2, 1, 0]);
    }

    #[test]
    fn ten_thousand_values_and_wishes_have_their_bounds() {
        let mut run = ReplicaWatch::default();
        let paths: Vec<_> = (0..10_000).map(|nth| format!("R/{nth}")).collect();
        let paths: Vec<_> = paths.iter().map(String::as_str).collect();
        let told = run.watch(1, targets(&paths));
        assert_eq!(run.viewers[&1].len(), TARGETS_MAX);
        assert_eq!(run.take_subscription().expect("a list").len(), WATCHED_MAX);
        assert_eq!(left_out(&told), [10_000 - WATCHED_MAX]);
        run.watch(1, targets(&["R"]));
        let told = run.take((0..10_000).map(|nth| value(&format!("R/{nth}"), 1)).collect());
        assert_eq!(run.values.len(), VALUES_MAX);
        // Several messages bring all values that are known.
        assert_eq!(lengths(&told), [MESSAGE_MAX; VALUES_MAX / MESSAGE_MAX]);
        assert_eq!(lengths(&run.watch(2, targets(&["R"]))), lengths(&told));
        // A newer one of a known value replaces it; another finds no room.
        let told = run.take(vec![value("R/0", 2), value("R/other", 2)]);
        assert_eq!(lengths(&told), [1, 1]);
        // A shorter list of a viewer makes room.
        run.watch(2, Vec::new());
        run.watch(1, targets(&["R/other"]));
        assert_eq!(lengths(&run.take(vec![value("R/other", 3)])), [1]);
        assert_eq!(left_out(&run.watch(1, targets(&["R/other"]))), [0]);
    }
}
