//! Which states are active, as far as a run has told.

use rafcon_protocol::{Event, ToViewer};

/// Paths of the states that are active.
#[derive(Debug, Default)]
pub(crate) struct Active {
    paths: Vec<String>,
    /// The last event that is known.
    last: u64,
}

impl Active {
    /// Takes in what the run says.
    pub(crate) fn told(&mut self, message: &ToViewer) {
        match message {
            // A snapshot may come before what happened before it.
            ToViewer::Event { sequence, event, .. } if *sequence > self.last => {
                self.last = *sequence;
                self.happened(event);
            }
            // And after what happened after it.
            ToViewer::Snapshot(snapshot) if snapshot.sequence >= self.last => {
                self.last = snapshot.sequence;
                self.paths = snapshot.active.iter().map(|state| state.path.clone()).collect();
            }
            _ => {}
        }
    }

    fn happened(&mut self, event: &Event) {
        match event {
            Event::Entered { path, .. } => self.paths.push(path.clone()),
            Event::Left { path, .. } => {
                if let Some(index) = self.paths.iter().rposition(|active| active == path) {
                    self.paths.remove(index);
                }
            }
            _ => {}
        }
    }

    /// The paths, a parent before its children.
    pub(crate) fn paths(&self) -> &[String] {
        &self.paths
    }
}
