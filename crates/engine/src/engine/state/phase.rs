//! The life of one run of a state, as a table.

use crate::WaitReason;

/// What a frame does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::engine) enum Phase {
    /// It was entered just now.
    Begun,
    /// Its script runs.
    Script,
    /// One child runs: in a hierarchy or library state.
    Child,
    /// It is held before its next child, or after its last.
    Held,
    /// The condition of a breakpoint is being evaluated before its next child, or after its last.
    Checking,
    /// It cannot continue by itself.
    Waiting(WaitReason),
    /// Its children run side by side.
    Branches,
    /// The decider of the barrier runs.
    Deciding,
}

/// What can happen to a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) enum Cause {
    /// Its script ended.
    ScriptEnded,
    /// One of its children ended.
    ChildEnded,
    /// It is asked to end.
    Preempted,
    /// What held it lets it go.
    LetGo,
}

/// What the frame does about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) enum Reaction {
    /// It ends.
    Leave,
    /// It looks what is next.
    Advance,
    /// It continues; the event was noted.
    GoOn,
    /// It cannot happen in this phase.
    Refuse,
}

/// The table. The same rows stand in `docs/semantics.md`.
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
