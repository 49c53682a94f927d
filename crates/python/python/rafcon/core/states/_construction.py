"""Construction of state objects: bound to a state of the running machine, or standalone."""

from rafcon import _ids, _signals
from rafcon._bridge import native
from rafcon._homes import RUNNING, Built
from rafcon.core.decorators import lock_state_machine
from rafcon.core.state_elements.data_port import InputDataPort, OutputDataPort
from rafcon.core.state_elements.logical_port import Outcome
from rafcon.utils.type_helpers import convert_string_to_type, port_default, type_name


class StateConstruction:
    """Base class of states that holds the location of a state.

    ``_home`` is the home of the state's machine. States that are being built have the state around
    them in ``_above`` and their id there in ``_key``. States of the running machine have an index,
    ``_place``.
    """

    _kind = None
    _place = -1

    def _bind(self, place, signals):
        """Bind the object to the state at an index of the running machine."""
        self._init_run(signals)
        self._place = place
        self._home = RUNNING

    def _init_run(self, signals):
        self._signals = signals
        self._seen = None
        self._above = self._key = None
        self._inside = {}
        self._listed = {}
        self._told = 0
        self._backward = False
        if not hasattr(self, "persistent_variables"):
            #: A dictionary for the user, kept from one run of the state to the next.
            self.persistent_variables = {}

    def _build(self, name, state_id, parts):
        """Make the state standalone; ``parts`` are inputs, outputs, outcomes of a constructor."""
        self._begin(_name(type(self), name), state_id)
        inputs, outputs, outcomes = parts
        self._take_outcomes(outcomes)
        self._take_ports("inputs", InputDataPort, inputs)
        self._take_ports("outputs", OutputDataPort, outputs)

    def _begin(self, name, state_id):
        if self._kind is None:
            raise TypeError(f"{type(self).__name__} is no kind of state by itself; use a class below it")
        state_id = _ids.state_id() if state_id is None else _text(state_id, "state_id")
        self._settle_alone(native.Document.state(self._kind, state_id, name), state_id)
        self._change("state.name", name)

    def _settle_running(self, place):
        """Move the standalone state, with the states inside, to an index of the running machine."""
        inside = self._inside
        native.settle(place, self)
        places = native.describe(place)["children"]
        for state_id, state in inside.items():
            if state_id in places:
                state._settle_running(places[state_id])

    def _retire(self, document):
        """Make the state standalone after its removal from the running machine."""
        self._init_run(_signals.Idle())
        self._place = -1
        self._settle(Built(document, self), None, document.root_id())

    def _take_over(self):
        """Make the state standalone, with everything inside; leave a copy in its old location.

        Raises ``ValueError`` for a state in the running machine.
        """
        above = self.parent
        if above is None:
            return
        if self._place >= 0:
            raise ValueError(f"{self} stands in {above}, which runs; remove it there first, or add a copy")
        home = self._home
        document = home.copy_of(self)
        home.leave_copy(self)
        self._settle_alone(document, self._key)

    def _settle_alone(self, document, state_id):
        if not hasattr(self, "_signals"):
            self._init_run(_signals.Idle())
        self._settle(Built(document, self), None, state_id)

    def _settle(self, home, above, key):
        """Move the state, with the states inside, to another home."""
        if not hasattr(self, "_signals"):
            self._init_run(_signals.Idle())
        self._home, self._above, self._key, self._seen = home, above, key, None
        if above is not None:
            above._inside[key] = self
        for state_id, state in self._inside.items():
            state._settle(home, self, state_id)

    def _line(self):
        """States from the topmost one down to this one."""
        above = [] if self._above is None else self._above._line()
        return [*above, self]

    def _known_states(self):
        """This state and the states inside that have an object."""
        found = [self]
        for state in self._inside.values():
            found += state._known_states()
        return found

    def __eq__(self, other):
        """True if class and content are equal: id, name, parts, and everything inside."""
        if self is other:
            return True
        if type(self) is not type(other):
            return NotImplemented
        return self._home.copy_of(self).is_like(other._home.copy_of(other))

    __hash__ = object.__hash__

    def __copy__(self):
        """Standalone copy of the state, with everything inside."""
        document = self._home.copy_of(self)
        copied = type(self).__new__(type(self))
        copied._settle_alone(document, document.root_id())
        return copied

    def __deepcopy__(self, _memo):
        return self.__copy__()

    def _change(self, verb, *arguments):
        self._home.change(self, [(verb, arguments)])

    def _take_outcomes(self, outcomes):
        if outcomes is None:
            outcomes = [Outcome(0, "success")]
        mandatory = self._facts["outcomes"]
        for key, outcome in by_id(outcomes, "outcome_id").items():
            if key not in mandatory:
                self._change("outcome.add", key, outcome.name)
            elif mandatory[key] != outcome.name:
                self._change("outcome.rename", key, outcome.name)
            self._adopt("outcomes", key, outcome)

    def _take_ports(self, group, cls, ports):
        for key, port in by_id(ports or {}, "data_port_id").items():
            if not isinstance(port, cls):
                raise TypeError(f"{cls.__name__} expected, not {type(port).__name__}")
            self._add_port(group, port.name, port.data_type, port.default_value, key)
            self._adopt(group, key, port)

    @lock_state_machine
    def _add_port(self, group, name, data_type, default, key):
        data_type = convert_string_to_type(data_type)
        default = port_default(default, data_type)
        key = self._facts["free_port_id"] if key is None else key
        self._change("port.add", group, key, name, type_name(data_type), default)
        return key


def _name(cls, name):
    if name is None:
        return _ids.state_name(cls)
    return str(name) if isinstance(name, float) else _text(name, "the name of a state")


def _text(value, what):
    if isinstance(value, int) and not isinstance(value, bool):
        return str(value)
    if not isinstance(value, str):
        raise TypeError(f"{what} must be a str, not {type(value).__name__}")
    return value


def by_id(elements, field):
    """Id to element, from a dictionary or any other collection.

    Raises ``AttributeError`` if a key of the dictionary is not the id of its element.
    """
    if not isinstance(elements, dict):
        return {getattr(element, field): element for element in elements}
    for key, element in elements.items():
        if getattr(element, field) != key:
            raise AttributeError(f"the key {key!r} is not the id of {element}")
    return elements
