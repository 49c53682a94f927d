//! Who looks at how a run stands. Knows how many there are; must never know what they see.

use std::sync::Arc;
use tokio::sync::watch;

/// Those who look at how a run stands.
#[derive(Debug)]
pub(crate) struct Onlookers(Arc<watch::Sender<usize>>);

/// One of them, until it is dropped.
#[derive(Debug)]
pub(crate) struct Onlooker(Arc<watch::Sender<usize>>);

impl Default for Onlookers {
    fn default() -> Self {
        Self(Arc::new(watch::Sender::new(0)))
    }
}

impl Onlookers {
    /// Somebody looks on.
    pub(crate) fn join(&self) -> Onlooker {
        self.0.send_modify(|count| *count += 1);
        Onlooker(Arc::clone(&self.0))
    }

    /// Waits until somebody looks on.
    pub(super) async fn wait_for_onlooker(&self) {
        let mut count = self.0.subscribe();
        // The sender lives as long as we do.
        drop(count.wait_for(|count| *count > 0).await);
    }
}

impl Drop for Onlooker {
    fn drop(&mut self) {
        self.0.send_modify(|count| *count -= 1);
    }
}
