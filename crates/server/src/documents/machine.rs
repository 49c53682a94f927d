//! An open machine as a value with a past: edits of several people in one order, each taken once, each taken back by its own
//! author only. Pure: what is done is prepared first, so that it can be written down, and made then.

use super::history_tree::{self, MachineHistoryTree};
use super::log::{EncodedRevision, Log, RevisionsPage};
use super::merge;
use super::places::{MachinePlace, places};
use super::steps::{Step, StepDirection, StepRefusal, StepUndo, Steps};
use crate::Failure;
use axum::http::StatusCode;
use rafcon_model::edit::{Edit, EditError, apply};
use rafcon_model::{BuiltinTypes, Machine, Rule};
use rafcon_protocol::api::{MachineStep, MachineSteps, Revision, RevisionKind};
use rafcon_protocol::document::{Change, changes};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// So many ids of what was done are known, so that whoever asks again gets the same answer.
const ANSWERED_MAX: usize = 100_000;

/// What somebody wants to do.
#[derive(Debug, Clone)]
pub(super) enum MachineOperation {
    /// An edit, under a name for people.
    Edit(String, Edit),
    /// One's own last step back, or again.
    Step(StepDirection),
    /// The machine becomes another one: the files are read again.
    Replace(Box<Machine>),
    /// The machine becomes what it was at a revision.
    Jump {
        /// The revision.
        revision: u64,
        /// Also if that takes steps of others away.
        over_others: bool,
    },
    /// A jump that a server made that ended: also if it changes nothing now, for libraries are not what they were.
    JumpAgain(u64),
}

/// Who does it, and under which id.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct EditRequest {
    pub(super) author: String,
    pub(super) id: String,
}

/// Something that can be done now.
#[derive(Debug)]
pub(super) struct Prepared {
    machine: Machine,
    changes: Vec<Change>,
    name: String,
    kind: RevisionKind,
    same_as: Option<u64>,
    /// Where it belongs in the past.
    place: history_tree::Fingerprint,
    mark: HistoryMove,
}

#[derive(Debug)]
enum HistoryMove {
    New(Step),
    Moved(u64, StepDirection, Step),
}

/// A machine that several people edit.
#[derive(Debug)]
pub(super) struct OpenMachine {
    machine: Machine,
    revision: u64,
    steps: Steps,
    past: MachineHistoryTree,
    /// Of the machine, in the past.
    place: history_tree::Fingerprint,
    answered: AnsweredRequests,
    log: Log,
}

/// What was done under which id.
#[derive(Debug, Default)]
struct AnsweredRequests {
    revisions: BTreeMap<EditRequest, u64>,
    order: VecDeque<EditRequest>,
}

impl OpenMachine {
    /// A machine that has no past; its next revision follows `revision`.
    pub(super) fn new(machine: Machine, revision: u64) -> Self {
        Self {
            past: MachineHistoryTree::of(machine.clone(), revision),
            place: history_tree::Fingerprint::default(),
            machine,
            revision,
            steps: Steps::default(),
            answered: AnsweredRequests::default(),
            log: Log::after(revision),
        }
    }

    /// Something was done before, and answered by this revision.
    pub(super) fn knows(&mut self, request: EditRequest, revision: u64) {
        self.answered.push(request, revision);
    }

    /// The machine as it is now.
    pub(super) fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The number of the last revision.
    pub(super) fn revision(&self) -> u64 {
        self.revision
    }

    /// What a reader has not seen whose next revision is `from`.
    pub(super) fn since(&self, from: u64) -> RevisionsPage {
        self.log.since(from)
    }

    /// What was done to it since it was read.
    pub(super) fn steps(&self) -> MachineSteps {
        self.past.steps()
    }

    /// The revision that this request has made already.
    pub(super) fn answered(&self, request: &EditRequest) -> Option<u64> {
        self.answered.revisions.get(request).copied()
    }

    /// What doing it would come to. Nothing has changed yet.
    pub(super) fn prepare(
        &self,
        author: &str,
        deed: MachineOperation,
    ) -> Result<Prepared, Failure> {
        match deed {
            MachineOperation::Edit(name, edit) => self.edit(author, name, edit),
            MachineOperation::Step(along) => self.along(author, along),
            MachineOperation::Replace(machine) => {
                Ok(self.replace(author, "Reload".to_owned(), RevisionKind::Reload, *machine))
            }
            MachineOperation::Jump { revision, over_others } => {
                self.may_jump(author, revision, over_others)?;
                self.jump(author, revision)
            }
            MachineOperation::JumpAgain(revision) => self.jump(author, revision),
        }
    }

    fn edit(&self, author: &str, name: String, edit: Edit) -> Result<Prepared, Failure> {
        let mut machine = self.machine.clone();
        let back = apply(&mut machine, edit, &BuiltinTypes).map_err(|error| refused(&error))?;
        let step = step(author, &name, StepUndo::Edit(back), &machine, &self.machine);
        Ok(self.prepared(machine, name, RevisionKind::Edit, HistoryMove::New(step)))
    }

    fn along(&self, author: &str, along: StepDirection) -> Result<Prepared, Failure> {
        let (number, own) =
            self.steps.next(author, along).map_err(|stuck| hindered(along, &stuck))?;
        let name = own.name.clone();
        let (machine, way) = match &own.way {
            StepUndo::Whole(machine) => (machine.clone(), StepUndo::Whole(self.machine.clone())),
            StepUndo::Edit(edit) => {
                let mut machine = self.machine.clone();
                let edit = merge::merged(edit, &own.layouts, &machine);
                let edit = edit.map_err(|path| moved_meanwhile(along, &name, &path.to_string()))?;
                let back = apply(&mut machine, edit, &BuiltinTypes);
                let back = back.map_err(|error| no_longer_fits(along, &name, &error))?;
                (machine, StepUndo::Edit(back))
            }
        };
        let step = step(author, &name, way, &machine, &self.machine);
        let kind = match along {
            StepDirection::Undo => RevisionKind::Undo,
            StepDirection::Redo => RevisionKind::Redo,
        };
        Ok(self.prepared(machine, name, kind, HistoryMove::Moved(number, along, step)))
    }

    fn replace(
        &self,
        author: &str,
        name: String,
        kind: RevisionKind,
        machine: Machine,
    ) -> Prepared {
        let way = StepUndo::Whole(self.machine.clone());
        let step = step(author, &name, way, &machine, &self.machine);
        self.prepared(machine, name, kind, HistoryMove::New(step))
    }

    fn may_jump(&self, author: &str, to: u64, over_others: bool) -> Result<(), Failure> {
        let node = self.past.node(to).ok_or_else(|| not_kept(to))?;
        if self.past.node(self.revision) == Some(node) {
            let message = "the machine already is what it was then";
            return Err(Failure::conflict("nothing_to_do", message));
        }
        let taken = self.past.taken_away(author, self.revision, node);
        if over_others || taken.is_empty() { Ok(()) } else { Err(others_edits(&taken)) }
    }

    fn jump(&self, author: &str, to: u64) -> Result<Prepared, Failure> {
        let (node, machine) = self.past.machine(to).ok_or_else(|| not_kept(to))?;
        let name = match self.past.name(node) {
            Some(name) => format!("Jump to \"{name}\""),
            None => "Jump to the start".to_owned(),
        };
        Ok(self.replace(author, name, RevisionKind::Jump, machine.clone()))
    }

    fn prepared(
        &self,
        machine: Machine,
        name: String,
        kind: RevisionKind,
        mark: HistoryMove,
    ) -> Prepared {
        let changes = changes(&self.machine, &machine);
        let place = self.place.after(&self.machine, &machine, &changes);
        let same_as = self.past.same_as(&machine, place);
        Prepared { machine, changes, name, kind, same_as, place, mark }
    }

    /// Does what was prepared, and nothing since.
    pub(super) fn commit(&mut self, prepared: Prepared, request: EditRequest, at_ms: u64) -> u64 {
        let Prepared { machine, changes, name, kind, same_as, place, mark } = prepared;
        self.revision += 1;
        (self.machine, self.place) = (machine, place);
        match mark {
            HistoryMove::New(step) => self.steps.done(step, self.revision),
            HistoryMove::Moved(number, along, step) => {
                self.steps.moved(number, along, step, self.revision);
            }
        }
        let (revision, EditRequest { id, author }) = (self.revision, request.clone());
        let revision = Revision { revision, id, author, name, at_ms, kind, same_as, changes };
        self.past.push(alone(&revision), &self.machine, place);
        // Everything in it came from JSON or from text, so that it is JSON.
        let text = serde_json::to_string(&revision).unwrap_or_default();
        self.log.push(Arc::new(EncodedRevision { number: self.revision, text }));
        self.answered.push(request, self.revision);
        self.revision
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

/// A revision without what it changed.
fn alone(revision: &Revision) -> MachineStep {
    let Revision { revision, id, author, name, at_ms, kind, same_as, changes: _ } = revision;
    MachineStep {
        revision: *revision,
        id: id.clone(),
        author: author.clone(),
        name: name.clone(),
        at_ms: *at_ms,
        kind: *kind,
        same_as: *same_as,
        is_kept: true,
    }
}

/// The step that leads to `machine`, and back by `way` to what there was before.
fn step(author: &str, name: &str, way: StepUndo, machine: &Machine, before: &Machine) -> Step {
    let (places, layouts) = match &way {
        StepUndo::Edit(back) => (places(back), merge::layouts(back, machine)),
        StepUndo::Whole(_) => {
            let roots = [&before.root.id, &machine.root.id];
            let places = roots.into_iter().flat_map(MachinePlace::everything).collect();
            (places, merge::Layouts::new())
        }
    };
    Step { author: author.to_owned(), name: name.to_owned(), places, layouts, way }
}

/// An edit that breaks a rule, or is about something that is no longer there.
fn refused(error: &EditError) -> Failure {
    let status = match error.rule {
        Rule::NoSuchState | Rule::NoSuchElement | Rule::IdTaken => StatusCode::CONFLICT,
        _ => StatusCode::UNPROCESSABLE_ENTITY,
    };
    Failure::new(status, "edit_refused", error.to_string())
}

fn words(along: StepDirection) -> &'static str {
    match along {
        StepDirection::Undo => "taken back",
        StepDirection::Redo => "made again",
    }
}

fn hindered(along: StepDirection, stuck: &StepRefusal) -> Failure {
    let words = words(along);
    match stuck {
        StepRefusal::Nothing => {
            let message = format!("there is no step of yours to be {words}");
            Failure::conflict("nothing_to_do", message)
        }
        StepRefusal::BuiltUpon { step, by, later, place } => {
            let message = format!(
                "`{step}` cannot be {words}: {by} has changed {place} since (`{later}`); ask for that to be taken back first, or change it by hand"
            );
            Failure::conflict("built_upon", message)
        }
    }
}

fn not_kept(revision: u64) -> Failure {
    let message = format!(
        "the machine as it was at revision {revision} is not kept any more: the steps tell which ones are"
    );
    Failure::conflict("not_kept", message)
}

fn others_edits(taken: &BTreeMap<&str, usize>) -> Failure {
    let counted = |(author, count): (&&str, &usize)| {
        format!("{count} step{} of {author}", if *count == 1 { "" } else { "s" })
    };
    let taken: Vec<_> = taken.iter().map(counted).collect();
    let message = format!(
        "this takes {} away: ask them, or say `over_others`; a jump can be taken back",
        taken.join(" and ")
    );
    Failure::conflict("others_edits", message)
}

fn moved_meanwhile(along: StepDirection, name: &str, path: &str) -> Failure {
    let message = format!(
        "`{name}` cannot be {}: somebody else has moved the same part of {path} since; move it by hand",
        words(along)
    );
    Failure::conflict("built_upon", message)
}

fn no_longer_fits(along: StepDirection, name: &str, error: &EditError) -> Failure {
    let message = format!(
        "`{name}` cannot be {}, for others have changed the machine since: {error}",
        words(along)
    );
    Failure::conflict("built_upon", message)
}
