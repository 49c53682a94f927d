//! What a simulation exercised, so that a run that tests nothing does not pass for one that found nothing.

use std::fmt;

macro_rules! counts {
    ($($(#[$doc:meta])* $name:ident),+ $(,)?) => {
        /// How often each thing happened.
        #[derive(Debug, Clone, Default, PartialEq, Eq)]
        pub struct Counts {
            $($(#[$doc])* pub $name: u64,)+
        }

        impl Counts {
            /// Adds what another run did.
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
    /// States that were entered.
    states_run,
    /// Runs that ended by themselves, before any stop.
    ended_by_themselves,
    /// Commands that were taken.
    commands_taken,
    /// Commands that were refused, and changed nothing.
    commands_refused,
    /// States that were asked to end.
    preemptions,
    /// Commands to preempt one state.
    preempt_commands,
    /// Steps forward of the whole run.
    steps,
    /// Steps of one branch.
    branch_steps,
    /// Steps back, of the run or of one branch.
    steps_back,
    /// States that were entered or left backwards.
    backward_steps,
    /// Scripts that ran backwards.
    backward_scripts,
    /// Runs to a state that were held there.
    held_at_targets,
    /// Branches that policies for a lost link held.
    held_by_policies,
    /// States that policies for a lost link preempted.
    recovered_states,
    /// Breakpoints that held something.
    held_breakpoints,
    /// Breakpoints that were passed and held nothing.
    passed_breakpoints,
    /// Conditions that were evaluated.
    checks,
    /// Outcomes that were forced.
    forced_outcomes,
    /// Changes that were taken at once.
    applied_changes,
    /// Changes that waited.
    waiting_changes,
    /// Changes that were taken after they had waited.
    changes_after_waiting,
    /// Changes that would have touched what is active.
    refused_changes,
    /// Runs that were begun again elsewhere.
    started_again,
    /// States that were dropped then.
    dropped_states,
    /// Runs that were resumed by another engine.
    resumed,
    /// Runs that were resumed although they had been resumed before.
    resumed_again,
    /// Runs that were resumed while they were stopping.
    resumed_stopping,
    /// Runs that were resumed while a state had been asked to end.
    resumed_preempting,
    /// Runs that were resumed while a handler ran.
    resumed_handling,
    /// Runs that were resumed while a state was active backwards.
    resumed_backwards,
    /// Runs that were resumed with breakpoints.
    resumed_with_breakpoints,
    /// Runs that were resumed by a changed machine.
    resumed_changed,
    /// Runs that did not fit a changed machine.
    refused_changed,
    /// Moments of the past that a run went back to.
    moments_restored,
    /// Interrupted scripts about which someone decided.
    recovered,
    /// Answers that both of two runs gave, one of which had been cut and resumed.
    twin_answers,
    /// Times that the run which had been resumed was cut once more.
    twins_cut_again,
    /// Cuts while the run was stopping.
    twins_cut_stopping,
    /// Cuts while a state had been asked to end.
    twins_cut_preempting,
    /// Cuts while a handler ran.
    twins_cut_handling,
    /// Runs that continued from what events alone had said, while a state had been asked to end.
    twins_told_preempting,
}

impl Counts {
    /// What happened in less than one of a hundred seeds.
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
