"""States with states inside."""

from collections.abc import Mapping
from functools import cached_property

from rafcon import _objects
from rafcon.core._refusals import fixed, refuses
from rafcon.core.state_elements.data_flow import DataFlow
from rafcon.core.state_elements.scope import ScopedData, ScopedVariable
from rafcon.core.state_elements.transition import Transition
from rafcon.core.states.state import State


class Children(Mapping):
    """State id to state; the objects are made when they are looked up."""

    def __init__(self, places):
        self._places = places

    def __getitem__(self, state_id):
        return _objects.state(self._places[state_id])

    def __iter__(self):
        return iter(self._places)

    def __len__(self):
        return len(self._places)

    def __contains__(self, state_id):
        return state_id in self._places

    def __repr__(self):
        return "<states {}>".format(", ".join(self._places))


@refuses(
    "add_state",
    "remove_state",
    "set_start_state",
    "add_transition",
    "remove_transition",
    "add_data_flow",
    "remove_data_flow",
    "add_scoped_variable",
    "remove_scoped_variable",
    "group_states",
    "ungroup_state",
    "substitute_state",
    "change_state_type",
)
class ContainerState(State):
    """A state with states inside, connected by transitions and data flows."""

    @cached_property
    def _children(self):
        return Children(self._facts["children"])

    @fixed
    def states(self):
        """State id to state, for the states inside."""
        return self._children

    @cached_property
    def _transitions(self):
        return {key: Transition(*ends, key, self) for key, ends in self._facts["transitions"].items()}

    @fixed
    def transitions(self):
        """Id to :class:`Transition`."""
        return self._transitions

    @cached_property
    def _data_flows(self):
        return {key: DataFlow(*ends, key, self) for key, ends in self._facts["data_flows"].items()}

    @fixed
    def data_flows(self):
        """Id to :class:`DataFlow`."""
        return self._data_flows

    @cached_property
    def _scoped_variables(self):
        return self._ports("scoped_variables", ScopedVariable)

    @fixed
    def scoped_variables(self):
        """Id to :class:`ScopedVariable`."""
        return self._scoped_variables

    @property
    def scoped_data(self):
        """The values of the scoped variables and inputs now: port id and state id joined, to :class:`ScopedData`."""
        values = self._live()["scoped_data"]
        ports = [*self._inputs.items(), *self._scoped_variables.items()]
        return {
            str(key) + self.state_id: ScopedData(port.name, values[port.name], port.data_type, self.state_id, self)
            for key, port in ports
            if port.name in values
        }

    @fixed
    def start_state_id(self):
        """The id of the state that runs first, the container's own if none does; None if nothing is connected."""
        for transition in self._transitions.values():
            if transition.from_state is None:
                return transition.to_state
        return None

    def get_start_state(self, set_final_outcome=False):
        """The state that runs first, or None. ``set_final_outcome`` is accepted for old scripts."""
        return self._children.get(self.start_state_id)

    def get_transition_for_outcome(self, state, outcome):
        """The :class:`Transition` that leaves a state by an :class:`Outcome`, or None."""
        ends = (state.state_id, outcome.outcome_id)
        for transition in self._transitions.values():
            if (transition.from_state, transition.from_outcome) == ends:
                return transition
        return None

    def get_state_for_transition(self, transition):
        """The state that a :class:`Transition` leads to; this container, if it leads out."""
        return self if transition.to_outcome is not None else self._children[transition.to_state]

    def get_data_flow_id(self, from_data_port, to_data_port):
        """The id of the flow between two ports; ``AttributeError`` if there is none."""
        ends = (
            from_data_port.parent.state_id,
            from_data_port.data_port_id,
            to_data_port.parent.state_id,
            to_data_port.data_port_id,
        )
        for key, flow in self._data_flows.items():
            if (flow.from_state, flow.from_key, flow.to_state, flow.to_key) == ends:
                return key
        raise AttributeError(f"there is no data flow from {from_data_port} to {to_data_port} in {self}")

    def get_scoped_variable_from_name(self, name):
        """The id of the scoped variable of this name; ``AttributeError`` if there is none."""
        for key, variable in self._scoped_variables.items():
            if variable.name == name:
                return key
        raise AttributeError(f"{self} has no scoped variable named `{name}`")

    def get_data_port(self, state_id, port_id):
        """The port or scoped variable of a state inside, or of this container; None if there is none."""
        if state_id != self.state_id:
            return self._children[state_id].get_data_port_by_id(port_id) if state_id in self._children else None
        return self.get_data_port_by_id(port_id)

    def get_data_port_by_id(self, data_port_id):
        """The input, output or scoped variable of this id, or None."""
        return State.get_data_port_by_id(self, data_port_id) or self._scoped_variables.get(data_port_id)

    def get_outcome(self, state_id, outcome_id):
        """The :class:`Outcome` of a state inside, or of this container; None if there is none."""
        state = self if state_id == self.state_id else self._children.get(state_id)
        return None if state is None else state.outcomes.get(outcome_id)

    def get_connections_for_state(self, state_id):
        """What is connected to a state inside: a pair, transitions first, then data flows.

        Each is a dictionary of lists: ``["external"]`` has the connections in this container as ``ingoing``,
        ``outgoing`` and ``self`` (from the state to itself); ``["internal"]`` those inside the state, if it is a
        container, as ``enclosed`` (between its children), ``ingoing``, ``outgoing`` and ``self``.
        """
        state = self._children[state_id]
        inside = isinstance(state, ContainerState)
        return (
            _connections(self._transitions, state._transitions if inside else {}, state_id),
            _connections(self._data_flows, state._data_flows if inside else {}, state_id),
        )

    def __str__(self):
        return f"{State.__str__(self)} [{len(self._children)} child states]"

    def recursively_preempt_states(self):
        """Preempts this state and all states inside."""
        State.recursively_preempt_states(self)
        for state in self._children.values():
            state.recursively_preempt_states()

    def recursively_pause_states(self):
        """Holds this state and all states inside."""
        State.recursively_pause_states(self)
        for state in self._children.values():
            state.recursively_pause_states()

    def recursively_resume_states(self):
        """Lets this state and all states inside go on."""
        State.recursively_resume_states(self)
        for state in self._children.values():
            state.recursively_resume_states()

    def _groups(self):
        inside = [self._children, self._transitions, self._data_flows, self._scoped_variables]
        return State._groups(self) + [group.values() for group in inside]


def _connections(outside, inside, state_id):
    external = _sorted_by_ends(outside, state_id)
    del external["enclosed"]
    internal = _sorted_by_ends(inside, state_id)
    # Seen from inside, what begins at the state comes in.
    internal["ingoing"], internal["outgoing"] = internal["outgoing"], internal["ingoing"]
    return {"external": external, "internal": internal}


def _sorted_by_ends(elements, state_id):
    groups = {"enclosed": [], "ingoing": [], "outgoing": [], "self": []}
    kinds = {(True, True): "self", (True, False): "outgoing", (False, True): "ingoing", (False, False): "enclosed"}
    for element in elements.values():
        groups[kinds[element.from_state == state_id, element.to_state == state_id]].append(element)
    return groups
