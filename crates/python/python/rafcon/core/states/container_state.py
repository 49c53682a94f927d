"""States that contain other states."""

from collections.abc import Mapping

from rafcon.core.state_elements.data_flow import DataFlow
from rafcon.core.state_elements.scope import ScopedData, ScopedVariable
from rafcon.core.state_elements.transition import Transition
from rafcon.core.states._construction import by_id
from rafcon.core.states._container_changes import ContainerChanges
from rafcon.core.states.state import State


class Children(Mapping):
    """Live mapping of state ids to states; objects are created on first access."""

    def __init__(self, container):
        self._container = container

    def __getitem__(self, state_id):
        return self._container._home.child(self._container, state_id)

    def __iter__(self):
        return iter(list(self._container._home.child_ids(self._container)))

    def __len__(self):
        return len(self._container._home.child_ids(self._container))

    def __contains__(self, state_id):
        return self._container._home.has_child(self._container, state_id)

    def __repr__(self):
        return "<states {}>".format(", ".join(self))


class ContainerState(ContainerChanges, State):
    """State with states inside, connected by transitions and data flows.

    ``states``, ``transitions``, ``data_flows`` and ``scoped_variables`` are dictionaries of id to
    object, or lists. An object of this class itself runs, and is saved, as a hierarchy.
    """

    _kind = "hierarchy"

    def __init__(
        self,
        name=None,
        state_id=None,
        input_data_ports=None,
        output_data_ports=None,
        income=None,
        outcomes=None,
        states=None,
        transitions=None,
        data_flows=None,
        start_state_id=None,
        scoped_variables=None,
        safe_init=True,
    ):
        self._build(name, state_id, (input_data_ports, output_data_ports, outcomes))
        self._take_ports("scoped_variables", ScopedVariable, scoped_variables)
        for state in by_id(states or {}, "state_id").values():
            self._put_in(state)
        self._complete()
        for key, transition in by_id(transitions or {}, "transition_id").items():
            self.add_transition(*transition._content()[1:], key)
            self._adopt("transitions", key, transition)
        for key, flow in by_id(data_flows or {}, "data_flow_id").items():
            self.add_data_flow(*flow._content()[1:], key)
            self._adopt("data_flows", key, flow)
        if start_state_id is not None:
            self.start_state_id = start_state_id

    def _put_in(self, state):
        self.add_state(state)

    def _complete(self):
        """Add the states that a container of this kind always has."""

    @classmethod
    def from_dict(cls, dictionary):
        """Create an empty container; also return the dictionary's transitions and data flows."""
        return State.from_dict.__func__(cls, dictionary), dictionary["transitions"], dictionary["data_flows"]

    @property
    def states(self):
        """State id to state, for all states inside."""
        return Children(self)

    @property
    def transitions(self):
        """Id to :class:`Transition`."""
        return self._parts("transitions", Transition)

    @property
    def data_flows(self):
        """Id to :class:`DataFlow`."""
        return self._parts("data_flows", DataFlow)

    @property
    def scoped_variables(self):
        """Id to :class:`ScopedVariable`."""
        return self._parts("scoped_variables", ScopedVariable)

    @property
    def scoped_data(self):
        """Values in the container now, or at the end of its last run.

        They are its inputs, its scoped variables, and the outputs of the states inside that have
        ended in this run. Maps port id and state id, joined, to :class:`ScopedData`.
        """
        live = self._live()
        found = self._scoped(self, self.input_data_ports, live["input_data"])
        found.update(self._scoped(self, self.scoped_variables, live["scoped_data"]))
        for state in self.states.values() if live["run_count"] else ():
            ended = state._live()
            if ended["final_outcome"] and not ended["active"] and ended["entered_ns"] >= live["entered_ns"]:
                found.update(self._scoped(state, state.output_data_ports, ended["output_data"]))
        return found

    def _scoped(self, state, ports, values):
        key = state.state_id
        return {
            str(port_id) + key: ScopedData(port.name, values[port.name], port.data_type, key, type(port), self)
            for port_id, port in ports.items()
            if port.name in values
        }

    @property
    def start_state_id(self):
        """Id of the state that runs first, or None if nothing is connected.

        It is the container's own id if the start leads to one of its outcomes.
        """
        for from_state, _outcome, to_state, _to_outcome in self._facts["transitions"].values():
            if from_state is None:
                return to_state
        return None

    @start_state_id.setter
    def start_state_id(self, state_id):
        self._set_start(state_id)

    def get_start_state(self, set_final_outcome=False):
        """State that runs first, or None. ``set_final_outcome`` is accepted for old scripts."""
        return self.states.get(self.start_state_id)

    def get_transition_for_outcome(self, state, outcome):
        """:class:`Transition` that leaves a state by an :class:`Outcome`, or None."""
        ends = (state.state_id, outcome.outcome_id)
        for transition in self.transitions.values():
            if (transition.from_state, transition.from_outcome) == ends:
                return transition
        return None

    def get_state_for_transition(self, transition):
        """State to which a :class:`Transition` leads; this container, if it leads out."""
        return self if transition.to_outcome is not None else self.states[transition.to_state]

    def get_data_flow_id(self, from_data_port, to_data_port):
        """Id of the flow between two ports; ``AttributeError`` if there is none."""
        ends = (
            from_data_port.parent.state_id,
            from_data_port.data_port_id,
            to_data_port.parent.state_id,
            to_data_port.data_port_id,
        )
        for key, flow in self.data_flows.items():
            if (flow.from_state, flow.from_key, flow.to_state, flow.to_key) == ends:
                return key
        raise AttributeError(f"there is no data flow from {from_data_port} to {to_data_port} in {self}")

    def get_scoped_variable_from_name(self, name):
        """Id of the scoped variable with this name; ``AttributeError`` if there is none."""
        for key, variable in self.scoped_variables.items():
            if variable.name == name:
                return key
        raise AttributeError(f"{self} has no scoped variable named `{name}`")

    def get_data_port(self, state_id, port_id):
        """Port or scoped variable of a state inside or of this container; None if missing."""
        if state_id != self.state_id:
            return self.states[state_id].get_data_port_by_id(port_id) if state_id in self.states else None
        return self.get_data_port_by_id(port_id)

    def get_data_port_by_id(self, data_port_id):
        """Input, output or scoped variable with this id, or None."""
        return State.get_data_port_by_id(self, data_port_id) or self.scoped_variables.get(data_port_id)

    def get_outcome(self, state_id, outcome_id):
        """:class:`Outcome` of a state inside, or of this container; None if there is none."""
        state = self if state_id == self.state_id else self.states.get(state_id)
        return None if state is None else state.outcomes.get(outcome_id)

    def get_connections_for_state(self, state_id):
        """Connections of a state inside: a pair of dictionaries, for transitions and data flows.

        Each contains dictionaries of lists. ``["external"]`` has the connections in this container
        as ``ingoing``, ``outgoing`` and ``self`` (from the state to itself). ``["internal"]`` has
        those inside the state, if it is a container, as ``enclosed`` (between its children),
        ``ingoing``, ``outgoing`` and ``self``.
        """
        state = self.states[state_id]
        inside = isinstance(state, ContainerState)
        return (
            _connections(self.transitions, state.transitions if inside else {}, state_id),
            _connections(self.data_flows, state.data_flows if inside else {}, state_id),
        )

    def get_connections_for_state_and_scoped_variables(self, state_ids, scoped_variables):
        """Connections of states inside and scoped variables.

        A pair of dictionaries of lists, for transitions and for data flows: ``enclosed`` between
        the given elements, ``ingoing`` and ``outgoing`` at their border.
        """
        states, variables = set(state_ids), set(scoped_variables)

        def given(state_id, key):
            return state_id in states or (state_id == self.state_id and key in variables)

        lines, flows = ({"enclosed": [], "ingoing": [], "outgoing": []} for _ in range(2))
        ends = {(True, True): "enclosed", (True, False): "outgoing", (False, True): "ingoing"}
        for line in self.transitions.values():
            found = ends.get((line.from_state in states, line.to_state in states))
            lines.get(found, []).append(line)
        for flow in self.data_flows.values():
            found = ends.get((given(flow.from_state, flow.from_key), given(flow.to_state, flow.to_key)))
            flows.get(found, []).append(flow)
        return lines, flows

    def __str__(self):
        return f"{State.__str__(self)} [{len(self.states)} child states]"

    def recursively_preempt_states(self):
        """Preempt this state and all states inside."""
        State.recursively_preempt_states(self)
        for state in self.states.values():
            state.recursively_preempt_states()

    def recursively_pause_states(self):
        """Hold this state and all states inside."""
        State.recursively_pause_states(self)
        for state in self.states.values():
            state.recursively_pause_states()

    def recursively_resume_states(self):
        """Resume this state and all states inside."""
        State.recursively_resume_states(self)
        for state in self.states.values():
            state.recursively_resume_states()

    def _groups(self):
        inside = [self.states, self.transitions, self.data_flows, self.scoped_variables]
        return State._groups(self) + [group.values() for group in inside]


def _connections(outside, inside, state_id):
    external = _sorted_by_ends(outside, state_id)
    del external["enclosed"]
    internal = _sorted_by_ends(inside, state_id)
    # From inside, lines that begin at the state are incoming.
    internal["ingoing"], internal["outgoing"] = internal["outgoing"], internal["ingoing"]
    return {"external": external, "internal": internal}


def _sorted_by_ends(elements, state_id):
    groups = {"enclosed": [], "ingoing": [], "outgoing": [], "self": []}
    kinds = {(True, True): "self", (True, False): "outgoing", (False, True): "ingoing", (False, False): "enclosed"}
    for element in elements.values():
        groups[kinds[element.from_state == state_id, element.to_state == state_id]].append(element)
    return groups
