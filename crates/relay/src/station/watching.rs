//! What the viewers of a replica watch: the robot is asked for all of it once, and each viewer is sent what it watches.

use rafcon_protocol::{ToViewer, WatchKind, WatchTarget, WatchedValue, Watching};
use std::collections::BTreeMap;

/// So many values are kept of a run.
const VALUES_MAX: usize = 1_024;
/// So many values go in one message.
const MESSAGE_MAX: usize = 256;
/// A viewer watches at most so much; the rest is left out.
const TARGETS_MAX: usize = 1_024;

/// What is watched of one run.
#[derive(Debug, Default)]
pub(super) struct ReplicaWatch {
    viewers: BTreeMap<u64, Vec<WatchTarget>>,
    wish: Vec<WatchTarget>,
    /// The robot is to be asked for something else than before.
    is_wish_new: bool,
    /// The robot cannot be asked for now.
    is_left_out: bool,
    watching: Watching,
    values: BTreeMap<(WatchKind, String, String), WatchedValue>,
}

impl ReplicaWatch {
    /// A viewer watches this from now on. Answers what it is to be sent: what of it is known.
    pub(super) fn watch(
        &mut self,
        viewer: u64,
        mut targets: Vec<WatchTarget>,
    ) -> Option<(u64, ToViewer)> {
        targets.truncate(TARGETS_MAX);
        if targets.is_empty() {
            self.viewers.remove(&viewer)?;
        } else {
            self.viewers.insert(viewer, targets);
        }
        let (wish, _) = WatchTarget::union(self.viewers.values().flatten());
        if wish != self.wish {
            self.values.retain(|_, value| is_watched(&wish, value));
            (self.wish, self.is_wish_new) = (wish, true);
        }
        let known: Vec<_> = self.values.values().collect();
        self.message(viewer, &known)
    }

    /// What the robot is to be asked for, if that is something else than before.
    pub(super) fn take_wish(&mut self) -> Option<Vec<WatchTarget>> {
        self.is_left_out = false;
        std::mem::take(&mut self.is_wish_new).then(|| self.wish.clone())
    }

    /// The robot cannot be asked for now: nothing of what is watched is sent ahead, and what is to be asked for waits.
    pub(super) fn leave_out(&mut self) -> Vec<(u64, ToViewer)> {
        if !self.is_wish_new {
            return Vec::new();
        }
        let left_out = u32::try_from(self.wish.len()).unwrap_or(u32::MAX);
        self.is_left_out = false;
        let messages = self.set_watching(&Watching { is_confirmed: true, asked_ms: 0, left_out });
        self.is_left_out = true;
        messages
    }

    /// The robot says that these are the newest; older ones than those that are here change nothing.
    pub(super) fn take(&mut self, values: Vec<WatchedValue>) -> Vec<(u64, ToViewer)> {
        let mut new = Vec::new();
        for value in values {
            let place = (value.kind, value.path.clone(), value.name.clone());
            let known = self.values.get(&place).map(|known| known.sequence);
            let is_room = known.is_some() || self.values.len() < VALUES_MAX;
            let is_newer = known.is_none_or(|known| known < value.sequence);
            if is_room && is_newer && is_watched(&self.wish, &value) {
                self.values.insert(place, value.clone());
                new.push(value);
            }
        }
        if new.is_empty() {
            return Vec::new();
        }
        let new: Vec<_> = new.iter().collect();
        self.viewers.keys().filter_map(|viewer| self.message(*viewer, &new)).collect()
    }

    /// Whether the robot knows what is watched.
    pub(super) fn set_watching(&mut self, watching: &Watching) -> Vec<(u64, ToViewer)> {
        if self.is_left_out || self.watching == *watching {
            return Vec::new();
        }
        self.watching = watching.clone();
        self.viewers.keys().filter_map(|viewer| self.message(*viewer, &[])).collect()
    }

    /// What a viewer is told of these values; nothing if it watches nothing.
    fn message(&self, viewer: u64, values: &[&WatchedValue]) -> Option<(u64, ToViewer)> {
        let targets = self.viewers.get(&viewer)?;
        let values = values.iter().filter(|value| is_watched(targets, value));
        let values = values.take(MESSAGE_MAX).map(|value| (*value).clone()).collect();
        Some((viewer, ToViewer::Watched { watching: self.watching.clone(), values }))
    }
}

fn is_watched(targets: &[WatchTarget], value: &WatchedValue) -> bool {
    targets.iter().any(|target| target.fits(value.kind, &value.path, &value.name))
}

#[cfg(test)]
mod tests {
    use super::ReplicaWatch;
    use expect_test::expect;
    use rafcon_protocol::{ToViewer, WatchKind, WatchTarget, WatchedValue, Watching};

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

    #[test]
    fn what_several_watch_is_asked_for_once_and_each_is_sent_its_part() {
        let mut run = ReplicaWatch::default();
        let mut said = String::new();
        let mut watch = |run: &mut ReplicaWatch, viewer, paths: &[&str]| {
            let message: Vec<_> = run.watch(viewer, targets(paths)).into_iter().collect();
            let wish = run.take_wish();
            let wish = wish.map(|wish| wish.iter().map(|it| it.path.clone()).collect::<Vec<_>>());
            said.extend([format!("asks {wish:?}\n"), told(&message)]);
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
        // Of what was asked before, nothing counts meanwhile.
        said.extend(run.set_watching(&known));
        run.watch(1, targets(&["R/ARM"]));
        said.extend(run.leave_out());
        assert_eq!(run.take_wish().expect("a wish").len(), 1);
        said.extend(run.set_watching(&known));
        said.extend(run.leave_out());
        let left_out = |(_, message): &(u64, ToViewer)| match message {
            ToViewer::Watched { watching, .. } => watching.left_out,
            _ => u32::MAX,
        };
        assert_eq!(said.iter().map(left_out).collect::<Vec<_>>(), [2, 1, 0]);
    }

    #[test]
    fn ten_thousand_values_and_wishes_have_their_bounds() {
        let mut run = ReplicaWatch::default();
        let paths: Vec<_> = (0..10_000).map(|nth| format!("R/{nth}")).collect();
        let paths: Vec<_> = paths.iter().map(String::as_str).collect();
        run.watch(1, targets(&paths));
        assert_eq!(run.take_wish().expect("a wish").len(), 256);
        run.watch(1, targets(&["R"]));
        run.take((0..10_000).map(|nth| value(&format!("R/{nth}"), 1)).collect());
        assert_eq!(run.values.len(), 1_024);
    }
}
