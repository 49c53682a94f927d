//! Timers for deadlines of states and the ends of grace periods. This module knows times and entries, but not the
//! consequences.

use crate::places::limits::Limits;
use crate::{Clock, Place};
use rafcon_engine::{NodeId, PathId, Program};
use rafcon_locks::{Condvar, Mutex, RwLock};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// An expired timer of the run.
#[derive(Debug)]
pub(crate) enum Alarm {
    /// The timer of a state.
    Due(Due),
    /// The ground may have been silent for a named time.
    Silence,
}

/// An expired timer of a state.
#[derive(Debug, Clone)]
pub(crate) struct Due {
    pub(crate) what: TimerAction,
    pub(crate) place: Arc<Place>,
    /// The run of the state to which the timer applies.
    pub(crate) run: u32,
    /// Duration of the timer.
    pub(crate) ms: u64,
}

/// The kinds of timers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum TimerAction {
    /// The deadline of a state.
    Deadline,
    /// The grace period of a script.
    Grace,
}

/// The timers of a run, served by one thread.
#[derive(Debug, Default)]
pub(crate) struct Timers {
    limits: RwLock<Limits>,
    /// True if any state has limits; most machines have none.
    any: AtomicBool,
    queue: Mutex<Queue>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Queue {
    /// For each alarm, an entry at its time or earlier. It may be early, because the alarm may have been set again
    /// since.
    times: BinaryHeap<Reverse<(u64, PathId, TimerAction)>>,
    alarms: BTreeMap<(PathId, TimerAction), (u64, Due)>,
    /// Time of the next check of the ground's silence.
    silence_at_ns: Option<u64>,
    closed: bool,
}

impl Timers {
    /// Switches to the limits of this program.
    pub(crate) fn adopt<D>(&self, program: &Program<D>) {
        let limits = Limits::of(program);
        self.any.store(!limits.is_empty(), Ordering::Relaxed);
        *self.limits.write() = limits;
    }

    /// True if any state has limits.
    pub(crate) fn any(&self) -> bool {
        self.any.load(Ordering::Relaxed)
    }

    /// Starts the deadline of a state at its entry.
    pub(crate) fn entered(&self, place: &Arc<Place>, node: NodeId, now_ns: u64) {
        if let Some(ms) = self.limits.read().deadline_ms(node) {
            self.set(TimerAction::Deadline, place, ms, now_ns);
        }
    }

    /// Starts the grace period of a script that is asked to end.
    pub(crate) fn asked_to_end(&self, place: &Arc<Place>, now_ns: u64) {
        if !self.any() {
            return;
        }
        if let Some(ms) = self.limits.read().grace_ms(place.node) {
            self.set(TimerAction::Grace, place, ms, now_ns);
        }
    }

    fn set(&self, what: TimerAction, place: &Arc<Place>, ms: u64, now_ns: u64) {
        let at_ns = now_ns.saturating_add(ms.saturating_mul(1_000_000));
        let due = Due { what, place: Arc::clone(place), run: place.runs(), ms };
        let mut queue = self.queue.lock();
        let before = queue.alarms.insert((place.path, what), (at_ns, due));
        if before.is_none_or(|(before_ns, _)| at_ns < before_ns) {
            queue.times.push(Reverse((at_ns, place.path, what)));
            self.changed.notify_all();
        }
    }

    /// Times of silence that policies name: [`Limits::silences`].
    pub(crate) fn silences(&self) -> [Vec<u64>; 2] {
        self.limits.read().silences().clone()
    }

    /// Schedules the next check of the ground's silence; `None` cancels it.
    pub(crate) fn look_at_silence(&self, at_ns: Option<u64>) {
        self.queue.lock().silence_at_ns = at_ns;
        self.changed.notify_all();
    }

    /// Waits for the next expired timer; `None` after [`Self::close`].
    pub(crate) fn next(&self, clock: Clock) -> Option<Alarm> {
        let mut queue = self.queue.lock();
        loop {
            if queue.closed {
                return None;
            }
            let now_ns = clock.now_ns();
            if let Some(due) = queue.ring(now_ns) {
                return Some(Alarm::Due(due));
            }
            if queue.silence_at_ns.take_if(|at_ns| *at_ns <= now_ns).is_some() {
                return Some(Alarm::Silence);
            }
            match queue.next_ns().and_then(|at_ns| clock.instant(at_ns)) {
                Some(moment) => drop(self.changed.wait_until(&mut queue, moment)),
                None => self.changed.wait(&mut queue),
            }
        }
    }

    /// Cancels all timers of the run.
    pub(crate) fn close(&self) {
        self.queue.lock().closed = true;
        self.changed.notify_all();
    }
}

impl Queue {
    fn next_ns(&self) -> Option<u64> {
        let first = self.times.peek().map(|Reverse((at_ns, ..))| *at_ns);
        [first, self.silence_at_ns].into_iter().flatten().min()
    }

    /// Removes and returns an expired timer that still applies.
    fn ring(&mut self, now_ns: u64) -> Option<Due> {
        while let Some(&Reverse((at_ns, path, what))) = self.times.peek() {
            if at_ns > now_ns {
                return None;
            }
            self.times.pop();
            let Some((at_ns, due)) = self.alarms.remove(&(path, what)) else { continue };
            if at_ns > now_ns && due.is_active() {
                self.alarms.insert((path, what), (at_ns, due));
                self.times.push(Reverse((at_ns, path, what)));
            } else if due.is_active() {
                return Some(due);
            }
        }
        None
    }
}

impl Due {
    /// True if the run of the state to which the timer applies is active.
    pub(crate) fn is_active(&self) -> bool {
        self.place.is_active() && self.place.runs() == self.run
    }
}

#[cfg(test)]
mod tests {
    use super::{Queue, TimerAction, Timers};
    use crate::Place;
    use expect_test::{Expect, expect};
    use rafcon_engine::{NodeId, PathId};
    use rafcon_model::OutcomeId;
    use std::sync::Arc;

    const MS: u64 = 1_000_000;

    fn place(number: u32) -> Arc<Place> {
        let place = Place::new(PathId(number), NodeId(0), None, format!("S{number}").into());
        place.enter(0, None);
        Arc::new(place)
    }

    /// Timers that expire until `now_ms`.
    fn check(queue: &mut Queue, now_ms: u64, expect: &Expect) {
        let mut rung = Vec::new();
        while let Some(due) = queue.ring(now_ms * MS) {
            rung.push(format!("{} {:?} {}", due.place.text, due.what, due.ms));
        }
        expect.assert_eq(&rung.join(", "));
    }

    #[test]
    fn what_is_due_rings_in_order_if_its_state_is_still_active() {
        let timers = Timers::default();
        let [first, second, gone] = [1, 2, 3].map(place);
        timers.set(TimerAction::Deadline, &second, 20, 0);
        timers.set(TimerAction::Deadline, &first, 10, 0);
        timers.set(TimerAction::Grace, &first, 15, 0);
        timers.set(TimerAction::Deadline, &gone, 5, 0);
        gone.leave(OutcomeId(0), None);
        let mut queue = timers.queue.lock();
        check(&mut queue, 9, &expect![""]);
        check(&mut queue, 15, &expect!["S1 Deadline 10, S1 Grace 15"]);
        check(&mut queue, 99, &expect!["S2 Deadline 20"]);
    }

    #[test]
    fn an_alarm_that_is_set_anew_rings_at_its_new_time() {
        let timers = Timers::default();
        let place = place(1);
        timers.set(TimerAction::Deadline, &place, 10, 0);
        place.leave(OutcomeId(0), None);
        place.enter(8 * MS, None);
        timers.set(TimerAction::Deadline, &place, 10, 8 * MS);
        let mut queue = timers.queue.lock();
        check(&mut queue, 10, &expect![""]);
        check(&mut queue, 18, &expect!["S1 Deadline 10"]);
        check(&mut queue, 99, &expect![""]);
    }

    #[test]
    fn a_deadline_that_was_made_shorter_counts_from_the_next_entry_on() {
        let timers = Timers::default();
        let place = place(1);
        timers.set(TimerAction::Deadline, &place, 1000, 0);
        place.leave(OutcomeId(0), None);
        place.enter(5 * MS, None);
        timers.set(TimerAction::Deadline, &place, 10, 5 * MS);
        let mut queue = timers.queue.lock();
        check(&mut queue, 15, &expect!["S1 Deadline 10"]);
        check(&mut queue, 2000, &expect![""]);
    }
}
