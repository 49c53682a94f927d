//! Edits of transitions and data flows.

use super::error::EditError;
use super::plan::container_at;
use super::step::{Set, Step};
use super::{DataFlowEdit, TransitionEdit};
use crate::rules::Part;
use crate::{DataFlow, DataFlowId, Machine, StatePath, Transition, TransitionId};

pub(super) fn transition(
    machine: &Machine,
    path: &StatePath,
    id: TransitionId,
    edit: TransitionEdit,
) -> Result<Vec<Step>, EditError> {
    let (state, container) = container_at(machine, path)?;
    let part = Part::Transition(id);
    let earlier = container.transitions.get(id);
    let found = || earlier.cloned().ok_or_else(|| EditError::no_such_element(path, part));
    let transition = match edit {
        TransitionEdit::Add { .. } if earlier.is_some() => {
            return Err(EditError::taken(path, part));
        }
        TransitionEdit::Add { from, to } => Some(Transition::new(id, from, to, &state.id)),
        TransitionEdit::SetOrigin(from) => Some(found()?.with_origin(from)),
        TransitionEdit::SetTarget(to) => Some(found()?.with_target(to, &state.id)),
        TransitionEdit::Remove => {
            found()?;
            None
        }
    };
    Ok(vec![Step::new(path, Set::Transition(id, transition))])
}

pub(super) fn data_flow(
    machine: &Machine,
    path: &StatePath,
    id: DataFlowId,
    edit: DataFlowEdit,
) -> Result<Vec<Step>, EditError> {
    let (_, container) = container_at(machine, path)?;
    let part = Part::DataFlow(id);
    let earlier = container.data_flows.get(id);
    let found = || earlier.cloned().ok_or_else(|| EditError::no_such_element(path, part));
    let flow = match edit {
        DataFlowEdit::Add { .. } if earlier.is_some() => return Err(EditError::taken(path, part)),
        DataFlowEdit::Add { from, to } => Some(DataFlow::new(id, from, to)),
        DataFlowEdit::SetSource((from_state, from_port)) => {
            Some(DataFlow { from_state, from_port, ..found()? })
        }
        DataFlowEdit::SetTarget((to_state, to_port)) => {
            Some(DataFlow { to_state, to_port, ..found()? })
        }
        DataFlowEdit::Remove => {
            found()?;
            None
        }
    };
    Ok(vec![Step::new(path, Set::DataFlow(id, flow))])
}
