//! Expired timers: a deadline preempts its state, and a script that exceeds its grace period ends with the process.
//! This module knows the consequences, but not the times.

use crate::drive::core::Core;
use crate::drive::ending::RunEnd;
use crate::places::timers::{Alarm, Due, TimerAction};
use crate::record::tell;
use crate::{Driver, Scripts};
use rafcon_engine::{Input, Refusal};
use rafcon_model::StatePath;
use rafcon_protocol::Event;
use std::sync::Arc;

/// The exit status of a runner that ended because a script did not end.
pub(crate) const CUT_OFF: i32 = 86;

/// Handles expired timers until the run is over.
pub(crate) fn serve<S: Scripts>(driver: &Arc<Driver<S>>) {
    while let Some(alarm) = driver.timers().next(driver.clock()) {
        match alarm {
            Alarm::Due(due) if due.what == TimerAction::Deadline => driver.deadline_passed(&due),
            Alarm::Due(due) => driver.cut_off(&due),
            Alarm::Silence => driver.look_at_ground(),
        }
    }
}

impl<S: Scripts> Driver<S> {
    /// Preempts the run of the state whose deadline expired.
    fn deadline_passed(self: &Arc<Self>, due: &Due) {
        let preempt = |core: &mut Core<S::Value>| -> Result<(), Refusal> {
            if !due.is_active() {
                return Ok(());
            }
            let path = due.place.text.to_string();
            self.record().tell(Event::DeadlinePassed { path, deadline_ms: due.ms });
            let input = Input::Preempt(StatePath::parse(&due.place.text));
            self.drive(core, input, None).map(drop)
        };
        if let Some(Err(refusal)) = self.with_core(preempt) {
            let message = format!("its deadline is over, but it cannot be preempted: {refusal}");
            self.say(due, message);
        }
        self.scripts().settle();
    }

    fn say(&self, due: &Due, message: String) {
        let path = due.place.text.to_string();
        self.record().note_until_over(tell::log(path, rafcon_protocol::LogLevel::Warning, message));
    }

    /// Ends the process, because nothing else ends a script that does not end itself.
    fn cut_off(&self, due: &Due) {
        if !due.is_active() {
            return;
        }
        let path = due.place.text.to_string();
        self.record().tell(Event::CutOff { path, grace_ms: due.ms });
        self.ending().decide(RunEnd::CutOff);
    }
}
