//! Handles the results of an input: records its events and carries out its effects. Called with the engine locked;
//! starts no thread and passes no input to the engine.

use crate::Scripts;
use crate::drive::core::{Core, InputOutcome};
use crate::drive::driver::Driver;
use crate::drive::ending::RunEnd;
use crate::drive::record_events::{self, ExtraRecords};
use crate::places::signals::PREEMPTED;
use crate::record::tell;
use rafcon_engine::{Effect, Event, Finish, Input, Job, NodeId, PathId};
use rafcon_protocol::LogLevel;

impl<S: Scripts> Driver<S> {
    /// Records the events of an input, and carries out its effects.
    pub(crate) fn carry_out(
        &self,
        core: &mut Core<S::Value>,
        turn: &mut InputOutcome<S::Value>,
        beside: ExtraRecords,
    ) {
        let entered = self.look_ahead(core);
        let now_ns = self.clock().now_ns();
        self.pulse().moved(now_ns);
        record_events::record(core, self.scripts(), now_ns, self.recorder(), beside);
        self.set_alarms(core, &entered);
        let mut effects = std::mem::take(&mut core.outbox.effects);
        for effect in effects.drain(..) {
            self.carry_out_one(core, turn, effect);
        }
        core.outbox.effects = effects;
        self.questions().withdraw_orphans();
    }

    fn carry_out_one(
        &self,
        core: &mut Core<S::Value>,
        turn: &mut InputOutcome<S::Value>,
        effect: Effect<S::Value>,
    ) {
        match effect {
            Effect::Run(job) => {
                let lost = self.lost_input(&job);
                let frame = job.frame;
                let begun = core.begin(job);
                if let Some(why) = lost {
                    let path = begun.place.text.to_string();
                    let line = tell::log(path, LogLevel::Error, why.clone());
                    self.record().note([line]);
                    let result = self.scripts().failure(&why);
                    return core.pending.push_back(Input::Finished { frame, result });
                }
                if begun.place.signals.any(PREEMPTED) {
                    self.timers().asked_to_end(&begun.place, self.clock().now_ns());
                }
                core.dispatch(begun, turn);
            }
            Effect::Check(check) => {
                let begun = core.begin_check(check);
                core.dispatch(begun, turn);
            }
            // A branch gets its thread with its first piece of work.
            Effect::Fork { .. } => {}
            Effect::EndBranch { branch } => core.end_branch(branch, turn),
            Effect::Preempt(path) => {
                core.signal(path);
                self.questions().withdraw(path);
                if let Some(place) = core.at(path) {
                    self.timers().asked_to_end(place, self.clock().now_ns());
                }
            }
            Effect::Paused(paused) => core.pause(paused),
            Effect::Finish(finish) => self.finish(finish),
        }
    }

    /// The reason why this script cannot run: one of its inputs is a placeholder for a lost value.
    fn lost_input(&self, job: &Job<S::Value>) -> Option<String> {
        if !self.has_lost_values() {
            return None;
        }
        let values = job.inputs.iter().chain(&job.error);
        values.into_iter().find_map(|value| self.scripts().is_lost(value))
    }

    /// Applies events to the driver before they are recorded: a change of the machine. Returns the entered states, if
    /// any state has a deadline.
    fn look_ahead(&self, core: &Core<S::Value>) -> Vec<(PathId, NodeId)> {
        let mut entered = Vec::new();
        let any = self.timers().any();
        for event in &core.outbox.events {
            match event {
                Event::Entered { path, node, .. } if any => entered.push((*path, *node)),
                Event::Changed => self.adopt(core),
                Event::ChangeWaits { path } => self.change_waits(core, *path),
                _ => {}
            }
        }
        entered
    }

    fn set_alarms(&self, core: &Core<S::Value>, entered: &[(PathId, NodeId)]) {
        for (path, node) in entered {
            if let Some(place) = core.at(*path) {
                self.timers().entered(place, *node, self.clock().now_ns());
            }
        }
    }

    pub(crate) fn finish(&self, finish: Finish<S::Value>) {
        self.questions().end();
        self.timers().close();
        self.ending().decide(RunEnd::Finished(finish));
    }
}
