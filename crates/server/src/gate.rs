//! Limits how many long jobs of one kind run at once, so that threads stay free for other work. Waiting jobs hold no thread.
//! Does not know the work.

use crate::Failure;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// Maximum number of running jobs.
const AT_ONCE: usize = 4;
/// Maximum number of running and waiting jobs.
const INSIDE: usize = 256;

/// Limits the threads that one kind of work uses.
#[derive(Debug)]
pub(crate) struct Gate {
    inside: Arc<Semaphore>,
    turns: Arc<Semaphore>,
}

impl Default for Gate {
    fn default() -> Self {
        Self::of(AT_ONCE)
    }
}

impl Gate {
    /// A gate that runs at most `at_once` jobs at once.
    pub(crate) fn of(at_once: usize) -> Self {
        let places = |count| Arc::new(Semaphore::new(count));
        Self { inside: places(INSIDE), turns: places(at_once) }
    }

    /// Runs the work when a slot is free. Refuses if too many jobs wait. The work keeps its slot to its end, even if the caller goes away.
    pub(crate) async fn work<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, Failure> {
        let place = Arc::clone(&self.inside).try_acquire_owned().map_err(|_full| crowded())?;
        let turn = Arc::clone(&self.turns).acquire_owned().await.map_err(|_closed| crowded())?;
        blocking(move || {
            let _held = (place, turn);
            work()
        })
        .await
    }
}

fn crowded() -> Failure {
    let message = format!("{INSIDE} others ask for the like at the moment: ask again in a second");
    let failure = Failure::too_many("too_many_at_once", message);
    failure.retry_after(1)
}

/// Runs the work on a blocking thread and awaits it.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
) -> Result<T, Failure> {
    tokio::task::spawn_blocking(work).await.unwrap_or_else(|_stopped| {
        let message = "the server could not finish this request: try again, and report it";
        Err(Failure::unavailable("not_finished", message))
    })
}

#[cfg(test)]
mod tests {
    use super::{AT_ONCE, Gate, INSIDE};
    use std::sync::Arc;
    use std::sync::mpsc::sync_channel;
    use tokio::task::JoinSet;

    #[tokio::test]
    async fn some_work_some_wait_and_the_others_are_refused() {
        let gate = Arc::new(Gate::default());
        let (begun, mut works) = tokio::sync::mpsc::unbounded_channel();
        let mut all = JoinSet::new();
        let mut ends = Vec::new();
        for _ in 0..INSIDE {
            let (end, ended) = sync_channel::<()>(1);
            ends.push(end);
            let (gate, begun) = (Arc::clone(&gate), begun.clone());
            let work = move || {
                begun.send(()).unwrap();
                ended.recv().unwrap_or_default();
                Ok(())
            };
            all.spawn(async move { gate.work(work).await });
        }
        for _ in 0..AT_ONCE {
            works.recv().await.unwrap();
        }
        while gate.inside.available_permits() > 0 {
            tokio::task::yield_now().await;
        }
        assert!(works.try_recv().is_err());
        assert_eq!(gate.work(|| Ok(())).await.unwrap_err().code(), "too_many_at_once");
        drop(ends);
        assert!(all.join_all().await.into_iter().all(|done| done.is_ok()));
        assert!(gate.work(|| Ok(())).await.is_ok());
    }
}
