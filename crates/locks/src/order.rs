//! Locks held by each thread, and the observed lock order. Knows kinds of locks, not their implementation.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::panic::Location;

/// A position in the source.
pub(crate) type At = &'static Location<'static>;

/// All locks that are made at one place in the source, for one type of content.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Kind {
    pub(crate) made: At,
    pub(crate) content: &'static str,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the lock of {} made at {}", self.content, self.made)
    }
}

/// A lock that a thread holds.
#[derive(Debug, Clone, Copy)]
struct HeldLock {
    kind: Kind,
    address: usize,
    taken: At,
}

/// Positions of a pair: where the first lock was held, and where the second was taken inside it.
type Seen = (At, At);

/// For each kind of lock the kinds that were taken inside it.
#[derive(Debug, Default)]
struct Orders(BTreeMap<Kind, BTreeMap<Kind, Seen>>);

static ORDERS: parking_lot::Mutex<Orders> = parking_lot::Mutex::new(Orders(BTreeMap::new()));

thread_local! {
    static HELD: RefCell<Vec<HeldLock>> = const { RefCell::new(Vec::new()) };
    /// Pairs that this thread has already checked.
    static KNOWN: RefCell<BTreeSet<(Kind, Kind)>> = const { RefCell::new(BTreeSet::new()) };
}

impl Orders {
    /// Records that `inner` was taken inside `outer`. The error names the contradicting order.
    fn note(&mut self, outer: Kind, inner: Kind, seen: Seen) -> Result<(), String> {
        if let Some(way) = self.way(inner, outer) {
            let steps = way.iter().map(|(kind, (held, taken))| {
                format!("\n  inside the lock taken at {held}, {kind} was taken at {taken}")
            });
            return Err(format!(
                "locks are taken in contradicting orders: {inner} is taken at {} inside {outer}, taken at {}; before that:{}",
                seen.1,
                seen.0,
                steps.collect::<String>()
            ));
        }
        self.0.entry(outer).or_default().entry(inner).or_insert(seen);
        Ok(())
    }

    /// The chain of locks by which `to` was taken inside `from`.
    fn way(&self, from: Kind, to: Kind) -> Option<Vec<(Kind, Seen)>> {
        let mut ways = vec![(from, Vec::new())];
        let mut visited = BTreeSet::new();
        while let Some((kind, way)) = ways.pop() {
            if !visited.insert(kind) {
                continue;
            }
            for (inner, seen) in self.0.get(&kind).into_iter().flatten() {
                let mut further: Vec<(Kind, Seen)> = way.clone();
                further.push((*inner, *seen));
                if *inner == to {
                    return Some(further);
                }
                ways.push((*inner, further));
            }
        }
        None
    }
}

/// This thread is about to wait for a lock; panics if it could wait for ever.
pub(crate) fn before(kind: Kind, address: usize, at: At) {
    // A thread that ends has forgotten what it holds.
    let checked = HELD
        .try_with(|held| held.borrow().iter().try_for_each(|held| inside(held, kind, address, at)));
    if let Ok(Err(why)) = checked
        && !std::thread::panicking()
    {
        fail(&why);
    }
}

fn inside(held: &HeldLock, kind: Kind, address: usize, at: At) -> Result<(), String> {
    let HeldLock { kind: outer, address: other, taken } = *held;
    if other == address {
        return Err(format!("{kind} is taken at {at} by a thread that holds it since {taken}"));
    }
    if outer == kind {
        return Err(format!(
            "two locks of one kind are taken, at {taken} and inside it at {at}: {kind}"
        ));
    }
    let is_new = KNOWN.try_with(|known| !known.borrow().contains(&(outer, kind)));
    if is_new != Ok(true) {
        return Ok(());
    }
    ORDERS.lock().note(outer, kind, (taken, at))?;
    KNOWN.try_with(|known| known.borrow_mut().insert((outer, kind))).unwrap_or_default();
    Ok(())
}

#[expect(clippy::panic, reason = "a defect of ours, found by a test before it stops a run")]
fn fail(why: &str) -> ! {
    panic!("{why}")
}

/// This thread has got a lock.
pub(crate) fn taken(kind: Kind, address: usize, at: At) {
    let held = HeldLock { kind, address, taken: at };
    HELD.try_with(|all| all.borrow_mut().push(held)).unwrap_or_default();
}

/// This thread lets a lock go.
pub(crate) fn left(address: usize) {
    let forget = |held: &RefCell<Vec<HeldLock>>| {
        let mut held = held.borrow_mut();
        if let Some(index) = held.iter().rposition(|held| held.address == address) {
            held.remove(index);
        }
    };
    HELD.try_with(forget).unwrap_or_default();
}
