//! The engine's health: a report for viewers and servers, and the end of a process whose engine does not accept a stop.
//! This module knows how long the engine may be unreachable, but not who asks.

use crate::drive::core::Core;
use crate::drive::driver::Driver;
use crate::{Clock, Scripts};
use rafcon_engine::Activity;
use rafcon_protocol::EnginePulse;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The exit status of a runner whose engine did not accept a stop.
pub(crate) const UNREACHED: i32 = 88;
/// Timeout of a health check.
const ASKED_AT_MOST: Duration = Duration::from_millis(200);
/// Timeout of a stop. Tests use a short one, to see its effect.
pub(crate) const STOP_AT_MOST: Duration =
    if cfg!(test) { Duration::from_millis(300) } else { Duration::from_secs(8) };

/// Times at which the engine was last reached and last moved. Written with the engine locked, read by all.
#[derive(Debug, Default)]
pub(crate) struct Pulse {
    reached_ns: AtomicU64,
    moved_ns: AtomicU64,
}

impl Pulse {
    /// Notes that the engine has produced results.
    pub(crate) fn moved(&self, now_ns: u64) {
        self.moved_ns.store(now_ns, Ordering::Relaxed);
    }

    fn reached(&self, now_ns: u64) {
        self.reached_ns.store(now_ns, Ordering::Relaxed);
    }

    /// The time since which the engine was not reached.
    fn last_ns(&self) -> u64 {
        self.reached_ns.load(Ordering::Relaxed).max(self.moved_ns.load(Ordering::Relaxed))
    }
}

impl<S: Scripts> Driver<S> {
    /// Checks whether the engine is reachable now, and when it last moved. Waits briefly, and never for the
    /// interpreter: called on threads outside of it.
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

    /// Waits until the engine can accept a stop. If that times out, the callback may record it, and the process
    /// ends. The record up to then is complete, because it is in memory that outlives the process.
    pub(crate) fn reach_for_stop(&self, tell: impl FnOnce(String)) {
        // The holder of the engine may be waiting for a failing disk.
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

/// The number of running scripts.
fn running<D: rafcon_engine::Datum>(core: &mut Core<D>) -> u32 {
    let active = core.engine.snapshot();
    let scripts = active.iter().filter(|active| matches!(active.activity, Activity::Script));
    u32::try_from(scripts.count()).unwrap_or(u32::MAX)
}
