//! Which states are active, as far as a run has told.

use rafcon_protocol::{Event, ToViewer};

/// Paths of the states that are active.
#[derive(Debug, Default)]
pub(crate) struct Active(Vec<String>);

impl Active {
    /// Takes in what the run says.
    pub(crate) fn told(&mut self, message: &ToViewer) {
        match message {
            ToViewer::Event { event: Event::Entered { path, .. }, .. } => self.0.push(path.clone()),
            ToViewer::Event { event: Event::Left { path, .. }, .. } => {
                if let Some(index) = self.0.iter().rposition(|active| active == path) {
                    self.0.remove(index);
                }
            }
            ToViewer::Snapshot(snapshot) => {
                self.0 = snapshot.active.iter().map(|state| state.path.clone()).collect();
            }
            _ => {}
        }
    }

    /// The paths, a parent before its children.
    pub(crate) fn paths(&self) -> &[String] {
        &self.0
    }
}
