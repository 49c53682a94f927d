//! Queue of work that creates more work, shared by threads until it is empty.

use parking_lot::{Condvar, Mutex};

/// The waiting items, the newest first, so that few folders are open at a time.
#[derive(Debug)]
pub(crate) struct Queue<T> {
    state: Mutex<Waiting<T>>,
    changed: Condvar,
}

#[derive(Debug)]
struct Waiting<T> {
    items: Vec<T>,
    /// The number of items in progress, which may add more.
    busy: usize,
    abandoned: bool,
}

impl<T> Queue<T> {
    pub(crate) fn new(first: T) -> Self {
        let state = Waiting { items: vec![first], busy: 0, abandoned: false };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

    /// The number of waiting items.
    pub(crate) fn len(&self) -> usize {
        self.state.lock().items.len()
    }

    /// The next item, to be followed by [`Queue::done`]; `None` when all work is done or abandoned.
    pub(crate) fn next(&self) -> Option<T> {
        let mut state = self.state.lock();
        loop {
            if state.abandoned {
                return None;
            }
            if let Some(item) = state.items.pop() {
                state.busy += 1;
                return Some(item);
            }
            if state.busy == 0 {
                return None;
            }
            self.changed.wait(&mut state);
        }
    }

    /// Marks an item as done, and adds `more`.
    pub(crate) fn done(&self, more: Vec<T>) {
        let mut state = self.state.lock();
        state.busy -= 1;
        let wake = !more.is_empty() || state.busy == 0;
        state.items.extend(more);
        drop(state);
        if wake {
            self.changed.notify_all();
        }
    }

    /// Stops handing out items.
    pub(crate) fn abandon(&self) {
        self.state.lock().abandoned = true;
        self.changed.notify_all();
    }
}
