//! Edits of a state itself and of its runtime values.

use super::error::EditError;
use super::kind;
use super::plan::state_at;
use super::step::{Field, Set, Step};
use super::{RuntimeValueEdit, StateEdit};
use crate::rules::{Part, Rule};
use crate::{Kind, Machine, PortId, PortKind, RuntimeValue, StatePath};

pub(super) fn plan(
    machine: &Machine,
    path: &StatePath,
    edit: StateEdit,
) -> Result<Vec<Step>, EditError> {
    let state = state_at(machine, path)?;
    let field = |field| Ok(vec![Step::new(path, Set::Field(field))]);
    match edit {
        StateEdit::SetName(name) => field(Field::Name(name)),
        StateEdit::SetDescription(text) => {
            field(Field::Description(text.filter(|text| !text.is_empty())))
        }
        StateEdit::SetSemanticData(data) => field(Field::SemanticData(data)),
        StateEdit::SetScript(text) => match &state.kind {
            Kind::Execution(_) | Kind::Decider(_) => field(Field::Script(text)),
            Kind::Hierarchy(_) | Kind::Barrier(_) | Kind::Preemptive(_) | Kind::Library(_) => {
                let what = format!("a state of the kind {} has no script", state.kind.name());
                Err(EditError::state(path, Rule::WrongKind, what))
            }
        },
        StateEdit::SetId(id) if id == state.id => Ok(Vec::new()),
        StateEdit::SetId(id) => Ok(vec![Step::new(path, Set::Id(id))]),
        StateEdit::SetKind(kind) => kind::plan(path, state, kind),
    }
}

pub(super) fn runtime_value(
    machine: &Machine,
    path: &StatePath,
    kind: PortKind,
    id: PortId,
    edit: RuntimeValueEdit,
) -> Result<Vec<Step>, EditError> {
    let state = state_at(machine, path)?;
    let Kind::Library(library) = &state.kind else {
        let what = format!("a state of the kind {} has no runtime values", state.kind.name());
        return Err(EditError::state(path, Rule::WrongKind, what));
    };
    let earlier = match kind {
        PortKind::Input => library.inputs.get(&id),
        PortKind::Output => library.outputs.get(&id),
        PortKind::ScopedVariable => None,
    };
    let missing = || EditError::no_such_element(path, Part::RuntimeValue(kind, id));
    let value = match edit {
        RuntimeValueEdit::Set(value) => Some(RuntimeValue { value, used: true }),
        RuntimeValueEdit::SetUsed(used) => {
            Some(RuntimeValue { used, ..earlier.ok_or_else(missing)?.clone() })
        }
        RuntimeValueEdit::Remove => {
            earlier.ok_or_else(missing)?;
            None
        }
    };
    Ok(vec![Step::new(path, Set::RuntimeValue(kind, id, value))])
}
