//! Refusals of operations on an open machine. Knows the rules of concurrent editing, and maps each refusal to its HTTP response.

use crate::Failure;
use rafcon_model::edit::EditError;
use rafcon_model::{Rule, StatePath};
use rafcon_protocol::api::RevisionKind;
use std::collections::BTreeMap;

/// Reason why an operation is refused.
#[derive(Debug, thiserror::Error)]
pub(super) enum OperationRefusal {
    /// The edit breaks a rule, or names something that does not exist.
    #[error("{0}")]
    Rule(EditError),
    /// The author has no step to undo or redo.
    #[error("there is no step of yours to be {}", done(*.0))]
    NoStep(RevisionKind),
    /// Another user built on the author's step.
    #[error(
        "`{step}` cannot be {}: {by} has changed {place} since (`{later}`); ask for that to be taken back first, or change it by hand",
        done(*.kind)
    )]
    BuiltUpon { kind: RevisionKind, step: String, by: String, later: String, place: String },
    /// Another user moved the element as well.
    #[error(
        "`{step}` cannot be {}: another user has moved this part of {path} since; move it by hand",
        done(*.kind)
    )]
    MovedMeanwhile { kind: RevisionKind, step: String, path: StatePath },
    /// The inverse of the step now breaks a rule.
    #[error("`{step}` cannot be {}, for others have changed the machine since: {error}", done(*.kind))]
    NoLongerFits { kind: RevisionKind, step: String, error: EditError },
    /// The machine is already at that revision.
    #[error("the machine already is what it was then")]
    AlreadyThere,
    /// The revision is no longer stored, or never existed.
    #[error("revision {0} of the machine is no longer kept: choose one from the list of steps")]
    NotKept(u64),
    /// A jump would revert steps of other users; the count is per author.
    #[error(
        "this reverts {}: ask them first, or set `over_others`; a jump can be taken back",
        counted(.0)
    )]
    OthersEdits(BTreeMap<String, usize>),
}

fn done(kind: RevisionKind) -> &'static str {
    if kind == RevisionKind::Redo { "made again" } else { "taken back" }
}

fn counted(steps: &BTreeMap<String, usize>) -> String {
    let counted = |(author, count): (&String, &usize)| {
        format!("{count} step{} of {author}", if *count == 1 { "" } else { "s" })
    };
    steps.iter().map(counted).collect::<Vec<_>>().join(" and ")
}

impl From<OperationRefusal> for Failure {
    fn from(refusal: OperationRefusal) -> Self {
        let message = refusal.to_string();
        match refusal {
            OperationRefusal::Rule(error) => match error.rule {
                Rule::NoSuchState | Rule::NoSuchElement | Rule::IdTaken => {
                    Self::conflict("edit_refused", message)
                }
                _ => Self::unprocessable("edit_refused", message),
            },
            OperationRefusal::NoStep(_) | OperationRefusal::AlreadyThere => {
                Self::conflict("nothing_to_do", message)
            }
            OperationRefusal::BuiltUpon { .. }
            | OperationRefusal::MovedMeanwhile { .. }
            | OperationRefusal::NoLongerFits { .. } => Self::conflict("built_upon", message),
            OperationRefusal::NotKept(_) => Self::conflict("not_kept", message),
            OperationRefusal::OthersEdits(_) => Self::conflict("others_edits", message),
        }
    }
}
