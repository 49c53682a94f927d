//! Whether the engine takes inputs: what a runner says of it to those who ask, and the end of a process whose engine does not take
//! a stop. Knows how long the engine may be out of reach, but not who asks.

use crate::drive::core::Core;
use crate::drive::driver::Driver;
use crate::{Clock, Scripts};
use rafcon_engine::Activity;
use rafcon_protocol::EnginePulse;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The exit status of a runner whose engine did not take a stop.
pub(crate) const UNREACHED: i32 = 88;
/// How long a question about the engine waits for it.
const ASKED_AT_MOST: Duration = Duration::from_millis(200);
/// How long a stop waits for the engine. Tests wait less, to see the end of it.
pub(crate) const STOP_AT_MOST: Duration =
    if cfg!(test) { Duration::from_millis(300) } else { Duration::from_secs(8) };

/// When the engine was reached, and when it moved last. Written with the engine locked, read by all.
#[derive(Debug, Default)]
pub(crate) struct Pulse {
    reached_ns: AtomicU64,
    moved_ns: AtomicU64,
}

impl Pulse {
    /// The engine has said something.
    pub(crate) fn moved(&self, now_ns: u64) {
        self.moved_ns.store(now_ns, Ordering::Relaxed);
    }

    fn reached(&self, now_ns: u64) {
        self.reached_ns.store(now_ns, Ordering::Relaxed);
    }

    /// Since when the engine has not been reached.
    fn last_ns(&self) -> u64 {
        self.reached_ns.load(Ordering::Relaxed).max(self.moved_ns.load(Ordering::Relaxed))
    }
}

impl<S: Scripts> Driver<S> {
    /// Whether the engine can be reached now, and when it moved last. Waits a little, and never for the interpreter: called on
    /// threads that are outside of it.
    pub(crate) fn engine_pulse(&self) -> EnginePulse {
        let scripts = Clock::moment(ASKED_AT_MOST).and_then(|until| self.try_core(until, running));
        let (now_ns, pulse) = (self.clock().now_ns(), self.pulse());
        if scripts.is_some() {
            pulse.reached(now_ns);
        }
        let since_ms = |then_ns: u64| now_ns.saturating_sub(then_ns) / 1_000_000;
        EnginePulse {
            unreached_ms: if scripts.is_some() { 0 } else { since_ms(pulse.last_ns()).max(1) },
            still_ms: since_ms(pulse.moved_ns.load(Ordering::Relaxed)),
            scripts,
        }
    }

    /// Waits until the engine can be given a stop; if it cannot in time, `tell` has a moment to write that down, and the process
    /// ends. What the run has written down by then is whole: it lies in memory that outlives the process.
    pub(crate) fn reach_for_stop(&self, tell: impl FnOnce(String)) {
        // Whoever holds the engine may wait for a disk that refuses.
        self.recorder().safety().end();
        let mut is_reached = false;
        self.scripts().park(&mut || {
            let reached =
                Clock::moment(STOP_AT_MOST).and_then(|until| self.try_core(until, |_| ()));
            is_reached = reached.is_some();
        });
        if !is_reached {
            tell(format!(
                "a defect of RAFCON, please report it: the engine did not take a stop within {} ms, so the process ends; \
                 the run can be resumed",
                STOP_AT_MOST.as_millis()
            ));
            signal_hook::low_level::exit(UNREACHED);
        }
    }
}

/// How many scripts run.
fn running<D: rafcon_engine::Datum>(core: &mut Core<D>) -> u32 {
    let active = core.engine.snapshot();
    let scripts = active.iter().filter(|active| matches!(active.activity, Activity::Script));
    u32::try_from(scripts.count()).unwrap_or(u32::MAX)
}
