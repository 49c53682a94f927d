//! Coverage of a simulation, so that a run that tests nothing does not count as successful.

use std::fmt;

macro_rules! counts {
    ($($(#[$doc:meta])* $name:ident),+ $(,)?) => {
        /// Number of occurrences of each kind of event.
        #[derive(Debug, Clone, Default, PartialEq, Eq)]
        pub struct Counts {
            $($(#[$doc])* pub $name: u64,)+
        }

        impl Counts {
            /// Adds the counts of another run.
            pub fn add(&mut self, other: &Self) {
                $(self.$name += other.$name;)+
            }

            fn all(&self) -> Vec<(&'static str, u64)> {
                vec![$((stringify!($name), self.$name),)+]
            }
        }
    };
}

counts! {
    /// States entered, according to the engine.
    states_run,
    /// Runs that ended by themselves, before any stop.
    ended_by_themselves,
    /// Commands accepted by the engine.
    commands_taken,
    /// Commands refused without a change.
    commands_refused,
    /// States requested to end.
    preemptions,
    /// Commands to preempt one state.
    preempt_commands,
    /// Steps forward of the whole run.
    steps,
    /// Steps of one branch.
    branch_steps,
    /// Steps back, of the run or of one branch.
    steps_back,
    /// States entered or left backwards.
    backward_steps,
    /// Scripts that ran backwards.
    backward_scripts,
    /// Runs to a state that stopped there.
    held_at_targets,
    /// Branches held by policies for a lost link.
    held_by_policies,
    /// States preempted by policies for a lost link.
    recovered_states,
    /// Breakpoints that held something.
    held_breakpoints,
    /// Breakpoints passed without a hold.
    passed_breakpoints,
    /// Conditions that were evaluated.
    checks,
    /// Outcomes that were forced.
    forced_outcomes,
    /// Changes applied at once.
    applied_changes,
    /// Changes that had to wait.
    waiting_changes,
    /// Changes applied after waiting.
    changes_after_waiting,
    /// Changes refused because they would affect active states.
    refused_changes,
    /// Runs restarted from another state.
    started_again,
    /// States dropped by such a restart.
    dropped_states,
    /// Runs resumed by another engine.
    resumed,
    /// Runs resumed more than once.
    resumed_again,
    /// Runs resumed while stopping.
    resumed_stopping,
    /// Runs resumed while a state had a request to end.
    resumed_preempting,
    /// Runs resumed while a handler ran.
    resumed_handling,
    /// Runs resumed while a state was active backwards.
    resumed_backwards,
    /// Runs resumed with breakpoints.
    resumed_with_breakpoints,
    /// Runs resumed with a changed machine.
    resumed_changed,
    /// Runs that did not fit a changed machine.
    refused_changed,
    /// Past moments restored by a run.
    moments_restored,
    /// Interrupted scripts with a decision.
    recovered,
    /// Matching outputs of an uncut run and its cut and resumed twin.
    twin_answers,
    /// Further cuts of a resumed twin.
    twins_cut_again,
    /// Cuts while the run was stopping.
    twins_cut_stopping,
    /// Cuts while a state had a request to end.
    twins_cut_preempting,
    /// Cuts while a handler ran.
    twins_cut_handling,
    /// Runs resumed from events alone, while a state had a request to end.
    twins_told_preempting,
}

impl Counts {
    /// Kinds of events that occurred in less than one percent of the seeds.
    pub fn rare(&self, seeds: u64) -> Vec<&'static str> {
        let least = seeds / 100;
        self.all().into_iter().filter(|(_, count)| *count <= least).map(|(name, _)| name).collect()
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.all()
            .into_iter()
            .try_for_each(|(name, count)| writeln!(f, "{count:>12} {}", name.replace('_', " ")))
    }
}
