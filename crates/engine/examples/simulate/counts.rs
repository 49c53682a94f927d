//! What a simulation exercised, so that a run that tests nothing does not pass for one that found nothing.

use std::fmt;

macro_rules! counts {
    ($($(#[$doc:meta])* $name:ident),+ $(,)?) => {
        /// How often each thing happened.
        #[derive(Debug, Clone, Default, PartialEq, Eq)]
        pub(crate) struct Counts {
            $($(#[$doc])* pub(crate) $name: u64,)+
        }

        impl Counts {
            /// Adds what another run did.
            pub(crate) fn add(&mut self, other: &Self) {
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
    /// States that were entered or left backwards.
    backward_steps,
    /// Scripts that ran backwards.
    backward_scripts,
    /// Runs to a state that were held there.
    held_at_targets,
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
    /// Runs that were taken up by another engine.
    taken_up,
    /// Moments of the past that a run went back to.
    moments_restored,
    /// Interrupted scripts about which somebody decided.
    recovered,
    /// Answers that both of two runs gave, one of which had been cut and taken up.
    twin_answers,
}

impl Counts {
    /// What happened in less than one of a hundred seeds.
    pub(crate) fn rare(&self, seeds: u64) -> Vec<&'static str> {
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
