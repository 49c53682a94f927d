//! An open machine with its history: concurrent edits in one order, each accepted once, each undone only by its author. Pure: an
//! operation is prepared first, so that it can be recorded before it is committed.

use super::merge;
use super::operation::{EditRequest, Operation, ReadOperation};
use super::places::{MachinePlace, places};
use super::refusal::OperationRefusal;
use super::revision_log::{Fingerprint, Inverse, InverseChange, RevisionLog, RevisionsPage};
use rafcon_model::edit::{Edit, apply};
use rafcon_model::{BuiltinTypes, Machine};
use rafcon_protocol::api::{MachineSteps, Revision, RevisionKind};
use rafcon_protocol::document::changes;
use std::collections::{BTreeMap, VecDeque};

/// Capacity of the known ids of operations. A repeated request gets its first answer.
const ANSWERED_MAX: usize = 100_000;

/// An operation that is ready to commit.
#[derive(Debug)]
pub(super) struct Prepared {
    machine: Machine,
    revision: Revision,
    inverse: Inverse,
    mark: Fingerprint,
}

/// A machine with its history and the known requests.
#[derive(Debug)]
pub(super) struct OpenMachine {
    machine: Machine,
    history: RevisionLog,
    answered: AnsweredRequests,
}

/// Name and result of a revision, and its inverse.
type Next = (String, Machine, InverseChange);

/// Revisions by request, with the oldest first for eviction.
#[derive(Debug, Default)]
struct AnsweredRequests {
    revisions: BTreeMap<EditRequest, u64>,
    order: VecDeque<EditRequest>,
}

impl OpenMachine {
    /// A machine without history. Its next revision follows `revision`.
    pub(super) fn new(machine: Machine, revision: u64) -> Self {
        let history = RevisionLog::of(machine.clone(), revision);
        Self { machine, history, answered: AnsweredRequests::default() }
    }

    /// Adds an earlier operation, which made this revision.
    pub(super) fn knows(&mut self, request: EditRequest, revision: u64) {
        self.answered.push(request, revision);
    }

    /// The current content of the machine.
    pub(super) fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The number of the last revision.
    pub(super) fn revision(&self) -> u64 {
        self.history.last()
    }

    /// Revisions that a reader has not seen yet; `from` is the first.
    pub(super) fn since(&self, from: u64) -> RevisionsPage {
        self.history.since(from)
    }

    /// History since the load.
    pub(super) fn steps(&self) -> MachineSteps {
        self.history.steps()
    }

    /// The revision that this request made, if it was already performed.
    pub(super) fn answered(&self, request: &EditRequest) -> Option<u64> {
        self.answered.revisions.get(request).copied()
    }

    /// Computes the result of an operation without performing it.
    pub(super) fn prepare(
        &self,
        request: EditRequest,
        at_ms: u64,
        operation: ReadOperation,
    ) -> Result<Prepared, OperationRefusal> {
        if let Operation::Jump { revision, over_others } = operation {
            self.may_jump(&request.author, revision, over_others)?;
        }
        self.prepare_again(request, at_ms, operation)
    }

    /// Prepares an operation that was already allowed. A jump may also change nothing, because libraries may have changed.
    pub(super) fn prepare_again(
        &self,
        request: EditRequest,
        at_ms: u64,
        operation: ReadOperation,
    ) -> Result<Prepared, OperationRefusal> {
        let author = &*request.author;
        let (kind, (name, machine, change)) = match operation {
            Operation::Edit { name, edit } => (RevisionKind::Edit, self.edit(name, edit)?),
            Operation::Undo => (RevisionKind::Undo, self.step(author, RevisionKind::Undo)?),
            Operation::Redo => (RevisionKind::Redo, self.step(author, RevisionKind::Redo)?),
            Operation::Replace { document } => {
                (RevisionKind::Reload, self.replace("Reload".to_owned(), document))
            }
            Operation::Jump { revision, .. } => (RevisionKind::Jump, self.jump(revision)?),
        };
        let changes = changes(&self.machine, &machine);
        let (mark, same_as) = self.history.place(&self.machine, &machine, &changes);
        let inverse = inverse(change, &machine, &self.machine);
        let (revision, EditRequest { id, author }) = (self.revision() + 1, request);
        let revision = Revision { revision, id, author, name, at_ms, kind, same_as, changes };
        Ok(Prepared { machine, revision, inverse, mark })
    }

    fn edit(&self, name: String, edit: Edit) -> Result<Next, OperationRefusal> {
        let mut machine = self.machine.clone();
        let back = apply(&mut machine, edit, &BuiltinTypes).map_err(OperationRefusal::Rule)?;
        Ok((name, machine, InverseChange::Edit(back)))
    }

    /// Prepares the author's own last undo or redo.
    fn step(&self, author: &str, kind: RevisionKind) -> Result<Next, OperationRefusal> {
        let (name, inverse) = self.history.inverse(author, kind)?;
        let name = name.to_owned();
        let step = || name.clone();
        let edit = match &inverse.change {
            InverseChange::Machine(machine) => return Ok(self.replace(name, machine.clone())),
            InverseChange::Edit(edit) => merge::merged(edit, &inverse.layouts, &self.machine),
        };
        let edit =
            edit.map_err(|path| OperationRefusal::MovedMeanwhile { kind, step: step(), path })?;
        let mut machine = self.machine.clone();
        let back = apply(&mut machine, edit, &BuiltinTypes);
        let back =
            back.map_err(|error| OperationRefusal::NoLongerFits { kind, step: step(), error })?;
        Ok((name, machine, InverseChange::Edit(back)))
    }

    fn replace(&self, name: String, machine: Machine) -> Next {
        (name, machine, InverseChange::Machine(self.machine.clone()))
    }

    fn may_jump(&self, author: &str, to: u64, over_others: bool) -> Result<(), OperationRefusal> {
        let node = self.history.node(to).ok_or(OperationRefusal::NotKept(to))?;
        if self.history.node(self.revision()) == Some(node) {
            return Err(OperationRefusal::AlreadyThere);
        }
        let taken = self.history.taken_away(author, self.revision(), node);
        if over_others || taken.is_empty() {
            Ok(())
        } else {
            Err(OperationRefusal::OthersEdits(taken))
        }
    }

    fn jump(&self, to: u64) -> Result<Next, OperationRefusal> {
        let (node, machine) = self.history.machine(to).ok_or(OperationRefusal::NotKept(to))?;
        let name = match self.history.name(node) {
            Some(name) => format!("Jump to \"{name}\""),
            None => "Jump to the start".to_owned(),
        };
        Ok(self.replace(name, machine.clone()))
    }

    /// Performs a prepared operation. No other may have been committed since.
    pub(super) fn commit(&mut self, prepared: Prepared) -> u64 {
        let Prepared { machine, revision, inverse, mark } = prepared;
        self.history.push(&revision, inverse, &machine, mark);
        self.machine = machine;
        let request = EditRequest { author: revision.author, id: revision.id };
        self.answered.push(request, revision.revision);
        revision.revision
    }
}

impl AnsweredRequests {
    fn push(&mut self, request: EditRequest, revision: u64) {
        self.order.push_back(request.clone());
        self.revisions.insert(request, revision);
        if self.order.len() > ANSWERED_MAX
            && let Some(oldest) = self.order.pop_front()
        {
            self.revisions.remove(&oldest);
        }
    }
}

/// The inverse of a revision from `before` to `machine`.
fn inverse(change: InverseChange, machine: &Machine, before: &Machine) -> Inverse {
    let (places, layouts) = match &change {
        InverseChange::Edit(back) => (places(back), merge::layouts(back, machine)),
        InverseChange::Machine(_) => {
            let roots = [&before.root.id, &machine.root.id];
            let places = roots.into_iter().flat_map(MachinePlace::everything).collect();
            (places, merge::Layouts::new())
        }
    };
    Inverse { places, layouts, change }
}

#[cfg(test)]
mod tests {
    use super::{ANSWERED_MAX, AnsweredRequests, EditRequest};

    fn request(number: u64) -> EditRequest {
        EditRequest { author: "ann".to_owned(), id: number.to_string() }
    }

    #[test]
    fn of_answered_requests_the_oldest_is_forgotten() {
        let mut answered = AnsweredRequests::default();
        let last = ANSWERED_MAX as u64;
        (0..last).for_each(|number| answered.push(request(number), number));
        let known =
            |answered: &AnsweredRequests, number| answered.revisions.get(&request(number)).copied();
        assert_eq!(known(&answered, 0), Some(0));
        answered.push(request(last), last);
        assert_eq!(
            [0, 1, last].map(|number| known(&answered, number)),
            [None, Some(1), Some(last)]
        );
        assert_eq!((answered.revisions.len(), answered.order.len()), (ANSWERED_MAX, ANSWERED_MAX));
    }
}
