"""Changes inside a container: states, transitions, data flows, scoped variables."""

from rafcon import _ids
from rafcon.core.decorators import lock_state_machine
from rafcon.core.state_elements.data_flow import DataFlow
from rafcon.core.state_elements.scope import ScopedVariable
from rafcon.core.state_elements.transition import Transition
from rafcon.core.states._changes import StateChanges
from rafcon.core.states.state import State
from rafcon.utils.log import get_logger
from rafcon.utils.type_helpers import of_type

logger = get_logger(__name__)


class ContainerChanges(StateChanges):
    """Base class of containers with the methods that change what is inside."""

    # ---- states

    @lock_state_machine
    def add_state(self, state, storage_load=False):
        """Add a state and return its id, a new one if its own is taken here.

        A state that belongs elsewhere moves, and leaves a copy there. In a barrier, the state's
        outcomes from 0 on get a transition to the decider.
        """
        self._check_addable(state)
        self._give_free_id(state)
        self._home.add(self, state)
        return state.state_id

    def _check_addable(self, state):
        if not isinstance(state, State):
            raise TypeError(f"a state is expected, not {type(state).__name__}")
        if any(state is above for above in self._line()):
            raise ValueError(f"{state} cannot stand in itself; {self} is a part of it")
        state._take_over()

    def _give_free_id(self, state, free=None):
        state_id = state.state_id
        if state_id == self.state_id or (state_id != free and self._home.has_child(self, state_id)):
            logger.info("the id of %s is taken in %s, so it gets a new one", state, self)
            state.change_state_id(_ids.state_id({self.state_id, *self._home.child_ids(self)}))

    def remove_state(self, state_id, recursive=True, force=False, destroy=True):
        """Remove a state, with everything inside and its connections; return it as standalone."""
        state = self._child(state_id)
        self._home.take(self, state)
        return state

    def _child(self, state_id):
        state = self.states.get(getattr(state_id, "state_id", state_id))
        if state is None:
            raise AttributeError(f"{self} has no state with the id {state_id!r}")
        return state

    def set_start_state(self, state):
        """Set the state (or id of a state) at which the container begins; None for no state."""
        self.start_state_id = getattr(state, "state_id", state)

    @lock_state_machine
    def _set_start(self, state_id):
        if state_id is None:
            self._change("children.start", None, None)
        elif state_id not in self.states:
            raise ValueError(f"{self} has no state with the id {state_id!r} to start at")
        elif self.start_state_id is None:
            self.add_transition(None, None, state_id, None)
        else:
            self._change("children.start", state_id, None)

    @lock_state_machine
    def group_states(self, state_ids, scoped_variables=None):
        """Move states (and scoped variables) into a new hierarchy and return it.

        Connections that cross its border get outcomes and ports there.
        """
        states = [self._child(state_id) for state_id in _list(state_ids)]
        group_id = _ids.state_id({self.state_id, *self._home.child_ids(self)})
        ids = [state.state_id for state in states]
        arguments = (ids, _list(scoped_variables), group_id, _ids.state_name(_hierarchy()))
        return self._home.group(self, states, arguments)

    @lock_state_machine
    def ungroup_state(self, state_id):
        """Replace a container by the states inside it; return the container."""
        group = self._child(state_id)
        taken = {self.state_id, *self._home.child_ids(self)}
        ids = {}
        for key in sorted(self._home.child_ids(group)):
            ids[key] = _ids.state_id(taken) if key in taken else key
            taken.add(ids[key])
        self._home.ungroup(self, group, ids)
        return group

    @lock_state_machine
    def substitute_state(self, state_id, state):
        """Replace a state by another and return the new one; connections follow by name."""
        old = self._child(state_id)
        self._check_addable(state)
        self._give_free_id(state, free=old.state_id)
        self._home.substitute(self, old, state)
        return state

    def change_state_type(self, state, new_state_class):
        """Change the class of a state and return the new object for it.

        Name, id, outcomes and ports stay. From container to container the states inside stay, too,
        but not their transitions.
        """
        state._change("state.kind", new_state_class._kind)
        return self._home.replaced(self, state)

    # ---- transitions

    @lock_state_machine
    def add_transition(self, from_state_id, from_outcome, to_state_id, to_outcome, transition_id=None):
        """Add a transition and return its id.

        A transition is the start if ``from_state_id`` and ``from_outcome`` are None. ``to_outcome``
        is an outcome of this container, or None for a transition to a state inside.
        """
        of_type(from_outcome, int, "from_outcome", or_none=True)
        of_type(to_outcome, int, "to_outcome", or_none=True)
        from_state_id, to_state_id = _id(from_state_id), _id(to_state_id)
        if transition_id is None:
            transition_id = _ids.transition_id(lambda key: self._home.has_line(self, "transitions", key))
        self._change("transition.add", transition_id, from_state_id, from_outcome, to_state_id, to_outcome)
        return transition_id

    def remove_transition(self, transition_id, destroy=True):
        """Remove a transition and return it."""
        return self._remove_part(self.transitions, transition_id, "transition.remove", transition_id)

    # ---- data flows

    @lock_state_machine
    def add_data_flow(self, from_state_id, from_data_port_id, to_state_id, to_data_port_id, data_flow_id=None):
        """Add a data flow between two ports (or scoped variables) and return its id."""
        of_type(from_data_port_id, int, "from_data_port_id")
        of_type(to_data_port_id, int, "to_data_port_id")
        from_state_id, to_state_id = _id(from_state_id), _id(to_state_id)
        if data_flow_id is None:
            data_flow_id = _ids.data_flow_id(lambda key: self._home.has_line(self, "data_flows", key))
        self._change("flow.add", data_flow_id, from_state_id, from_data_port_id, to_state_id, to_data_port_id)
        return data_flow_id

    def remove_data_flow(self, data_flow_id, destroy=True):
        """Remove a data flow and return it."""
        return self._remove_part(self.data_flows, data_flow_id, "flow.remove", data_flow_id)

    # ---- scoped variables

    def add_scoped_variable(self, name, data_type=None, default_value=None, scoped_variable_id=None):
        """Add a scoped variable and return its id."""
        return self._add_port("scoped_variables", name, data_type, default_value, scoped_variable_id)

    def remove_scoped_variable(self, scoped_variable_id, destroy=True):
        """Remove a scoped variable with its data flows, and return it."""
        arguments = ("port.remove", "scoped_variables", scoped_variable_id)
        return self._remove_part(self.scoped_variables, scoped_variable_id, *arguments)

    def _removals(self):
        return [
            (State, self.remove_state),
            (Transition, self.remove_transition),
            (DataFlow, self.remove_data_flow),
            (ScopedVariable, self.remove_scoped_variable),
            *StateChanges._removals(self),
        ]


def _id(state_id):
    """Id of a state as text; an integer is converted."""
    return str(state_id) if isinstance(state_id, int) else state_id


def _list(ids):
    if ids is None:
        return []
    return [ids] if isinstance(ids, (str, int)) else list(ids)


def _hierarchy():
    from rafcon.core.states.hierarchy_state import HierarchyState

    return HierarchyState
