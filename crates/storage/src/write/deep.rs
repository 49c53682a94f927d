//! Room for machines that nest so deep that walking them needs more stack than a thread usually has. Knows threads and
//! depth, nothing of saving.

use rafcon_model::State;
use std::io;
use std::sync::Arc;
use std::thread;

/// Up to here any thread's stack is enough.
const USUAL: usize = 100;
/// What one level takes at most.
const BYTES_PER_LEVEL: usize = 16 * 1024;

/// Does `work` on this thread, or on one with a stack that is large enough for `depth` levels.
pub(crate) fn with_room<T: Send>(
    depth: usize,
    work: impl FnOnce() -> io::Result<T> + Send,
) -> io::Result<T> {
    if depth <= USUAL {
        return work();
    }
    thread::scope(|scope| {
        let builder = thread::Builder::new().name("deep save".to_owned());
        let builder = builder.stack_size((depth + USUAL) * BYTES_PER_LEVEL);
        match builder.spawn_scoped(scope, work)?.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// How many states contain each other in the deepest place of `root`; what it shares with `old` is not looked at.
pub(crate) fn depth(root: &Arc<State>, old: Option<&Arc<State>>) -> usize {
    let mut deepest = 0;
    let mut waiting = vec![(root, old, 1)];
    while let Some((state, old, depth)) = waiting.pop() {
        deepest = deepest.max(depth);
        let (Some(container), false) =
            (state.container(), old.is_some_and(|old| Arc::ptr_eq(old, state)))
        else {
            continue;
        };
        let before = old.and_then(|old| old.container());
        for (id, child) in container.states.iter() {
            let old = before.and_then(|before| before.states.get(id));
            waiting.push((child, old, depth + 1));
        }
    }
    deepest
}
