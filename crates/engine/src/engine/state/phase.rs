//! The life of one run of a state, as a table of phases and causes.

use crate::WaitReason;

/// The current activity of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::engine) enum Phase {
    /// The state was just entered.
    Begun,
    /// The script of the state runs.
    Script,
    /// One child of a hierarchy or library state runs.
    Child,
    /// The frame is held before its next child, or after its last.
    Held,
    /// The condition of a breakpoint is being evaluated before the next child, or after the last.
    Checking,
    /// The frame cannot continue by itself.
    Waiting(WaitReason),
    /// The children of a concurrency state run in parallel.
    Branches,
    /// The decider of the barrier runs.
    Deciding,
}

/// Events that a frame reacts to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) enum Cause {
    /// The script of the state ended.
    ScriptEnded,
    /// One child of the frame ended.
    ChildEnded,
    /// The state was asked to end.
    Preempted,
    /// The hold or check of the frame was released.
    LetGo,
}

/// The reaction of a frame to a cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) enum Reaction {
    /// The frame ends by its result.
    Leave,
    /// The frame selects its next step.
    Advance,
    /// The frame continues; the cause was recorded.
    GoOn,
    /// The cause is impossible in this phase.
    Refuse,
}

/// Returns the reaction to a cause. `docs/semantics.md` has the table.
pub(in crate::engine) fn react(phase: &Phase, cause: Cause) -> Reaction {
    match (phase, cause) {
        (Phase::Script, Cause::ScriptEnded) => Reaction::Leave,
        (Phase::Child | Phase::Branches | Phase::Deciding, Cause::ChildEnded)
        | (Phase::Held | Phase::Checking | Phase::Waiting(_), Cause::Preempted)
        | (Phase::Held | Phase::Checking, Cause::LetGo) => Reaction::Advance,
        (
            Phase::Begun | Phase::Script | Phase::Child | Phase::Branches | Phase::Deciding,
            Cause::Preempted,
        )
        | (
            Phase::Begun
            | Phase::Script
            | Phase::Child
            | Phase::Waiting(_)
            | Phase::Branches
            | Phase::Deciding,
            Cause::LetGo,
        ) => Reaction::GoOn,
        (
            Phase::Begun
            | Phase::Child
            | Phase::Held
            | Phase::Checking
            | Phase::Waiting(_)
            | Phase::Branches
            | Phase::Deciding,
            Cause::ScriptEnded,
        )
        | (
            Phase::Begun | Phase::Script | Phase::Held | Phase::Checking | Phase::Waiting(_),
            Cause::ChildEnded,
        ) => Reaction::Refuse,
    }
}

#[cfg(test)]
mod tests {
    use super::{Cause, Phase, react};
    use crate::WaitReason;
    use expect_test::expect;

    #[test]
    fn the_table() {
        let phases = [
            Phase::Begun,
            Phase::Script,
            Phase::Child,
            Phase::Held,
            Phase::Checking,
            Phase::Waiting(WaitReason::NoStart),
            Phase::Branches,
            Phase::Deciding,
        ];
        let causes = [Cause::ScriptEnded, Cause::ChildEnded, Cause::Preempted, Cause::LetGo];
        let rows = phases.iter().map(|phase| {
            let reactions = causes.map(|cause| format!("{:?}", react(phase, cause)));
            format!("{phase:?}: {}\n", reactions.join(", "))
        });
        expect![[r"
            Begun: Refuse, Refuse, GoOn, GoOn
            Script: Leave, Refuse, GoOn, GoOn
            Child: Refuse, Advance, GoOn, GoOn
            Held: Refuse, Refuse, Advance, Advance
            Checking: Refuse, Refuse, Advance, Advance
            Waiting(NoStart): Refuse, Refuse, Advance, GoOn
            Branches: Refuse, Advance, GoOn, GoOn
            Deciding: Refuse, Advance, GoOn, GoOn
        "]]
        .assert_eq(&rows.collect::<Vec<_>>().concat());
    }
}
