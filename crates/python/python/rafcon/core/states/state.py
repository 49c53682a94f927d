"""Base class of all states; ``self`` in ``execute`` is a state.

The objects are live: they read the machine, and hold no copy of it.
"""

import os
from enum import Enum
from functools import cached_property

from rafcon import _logging, _objects, _signals
from rafcon._bridge import native
from rafcon.core.execution.execution_history import ExecutionHistory
from rafcon.core.state_elements.data_port import InputDataPort, OutputDataPort
from rafcon.core.state_elements.logical_port import Income, Outcome
from rafcon.core.states._changes import StateChanges
from rafcon.core.states._construction import StateConstruction
from rafcon.core.states._live import Parts
from rafcon.core.states._semantic_data import SemanticData
from rafcon.core.states._summary import StateSummary
from rafcon.utils.log import get_logger

#: Separates the state ids (or names) of a path.
PATH_SEPARATOR = "/"
#: Number of letters in the id of a new state.
STATE_ID_LENGTH = 6

StateExecutionStatus = Enum(
    "STATE_EXECUTION_STATE", "INACTIVE ACTIVE EXECUTE_CHILDREN WAIT_FOR_NEXT_STATE", module=__name__
)
StateType = Enum(
    "STATE_TYPE",
    "EXECUTION HIERARCHY BARRIER_CONCURRENCY PREEMPTION_CONCURRENCY LIBRARY DECIDER_STATE",
    module=__name__,
)

_PHASES = {
    "inactive": StateExecutionStatus.INACTIVE,
    "active": StateExecutionStatus.ACTIVE,
    "children": StateExecutionStatus.EXECUTE_CHILDREN,
    "waiting": StateExecutionStatus.WAIT_FOR_NEXT_STATE,
}
#: Distinguishes the run ids of this process from those of others.
_PROCESS = os.urandom(8).hex()


class State(StateConstruction, StateChanges, SemanticData, StateSummary):
    """State of the running machine, or of one that is being built.

    ``preempted``, ``paused`` and ``started`` may be set. Any other attribute that a script sets on
    the object lasts until the process ends, and so does ``persistent_variables``.
    """

    #: Inputs of the next runs; for the root of a machine that is being built.
    _given_inputs = None
    #: Outputs, placeholders until it runs; for such a root.
    _given_outputs = None
    #: Problems already logged; for the root of a loaded machine.
    _problems_told = frozenset()

    @property
    def _facts(self):
        home = self._home
        revision = home.revision
        if self._seen != revision:
            self._known, self._seen = home.facts(self), revision
        return self._known

    def _live(self):
        return self._home.live(self)

    # ---- identity

    @property
    def name(self):
        """Name (``str``) of the state."""
        return self._facts["name"]

    @name.setter
    def name(self, name):
        self._rename(name)

    @property
    def state_id(self):
        """Id (``str``), unique in the container."""
        return self._facts["state_id"]

    @property
    def core_element_id(self):
        """Alias of ``state_id``."""
        return self.state_id

    @property
    def description(self):
        """Description (``str``), or None."""
        return self._facts["description"] or None

    @description.setter
    def description(self, description):
        self._describe(description)

    @cached_property
    def logger(self):
        """Logger ``rafcon.<name>``, with a level ``verbose`` below ``debug``."""
        logger = get_logger("rafcon." + self.name)
        _logging.owners[logger.name] = self._place
        return logger

    @property
    def file_system_path(self):
        """Folder (``str``) in which the state is stored, or None."""
        return self._facts["file_system_path"]

    def get_path(self, appendix=None, by_name=False):
        """Path: ids (or names) from the root to here, joined by ``/``; ``appendix`` is appended."""
        path = self._facts["path_by_name" if by_name else "path"]
        return path if appendix is None else path + PATH_SEPARATOR + appendix

    def __str__(self):
        return f"{type(self).__name__} with name '{self.name}' and id '{self.state_id}'"

    def __repr__(self):
        return f"<{type(self).__name__} {self.get_path()}>"

    # ---- surroundings

    @property
    def parent(self):
        """Container, library state (of a library's root) or state machine; None if standalone."""
        return self._home.parent(self)

    def get_state_machine(self):
        """State machine of the state, or None."""
        return self._home.machine(self)

    @property
    def is_root_state(self):
        """True if the parent is the state machine."""
        from rafcon.core.state_machine import StateMachine

        return isinstance(self.parent, StateMachine)

    @property
    def is_root_state_of_library(self):
        """True if the parent is a library state."""
        from rafcon.core.states.library_state import LibraryState

        return isinstance(self.parent, LibraryState)

    def get_next_upper_library_root_state(self):
        """Root of the innermost library that contains this state (or is this state), or None."""
        roots = self._library_roots()
        return roots[0] if roots else None

    def get_uppermost_library_root_state(self):
        """Root of the outermost library that contains this state (or is this state), or None."""
        roots = self._library_roots()
        return roots[-1] if roots else None

    def _library_roots(self):
        roots, state = [], self
        while True:
            if state.is_root_state_of_library:
                roots.append(state)
            if not isinstance(state.parent, State):
                return roots
            state = state.parent

    def get_previously_executed_state(self):
        """State that ran before this one in its container; for the first, the container."""
        before = native.last_left(self._place)
        if before >= 0:
            return _objects.state(before)
        return self.parent if isinstance(self.parent, State) else None

    # ---- parts

    def _parts(self, group, cls):
        """Live mapping of ids to elements of one kind; always one object per state and kind."""
        parts = self._listed.get(group)
        if parts is None:
            parts = self._listed[group] = Parts(self, group, cls)
        return parts

    def _adopt(self, group, key, element):
        """Connect a user's element object to the element of the state."""
        self._parts(group, type(element))._adopt(key, element)

    @property
    def outcomes(self):
        """Outcome id to :class:`Outcome`; -1 is *aborted*, -2 *preempted*."""
        return self._parts("outcomes", Outcome)

    @cached_property
    def _income(self):
        return Income(self)

    @property
    def income(self):
        """Entry point of the state."""
        return self._income

    @property
    def input_data_ports(self):
        """Port id to :class:`InputDataPort`."""
        return self._parts("inputs", InputDataPort)

    @property
    def output_data_ports(self):
        """Port id to :class:`OutputDataPort`."""
        return self._parts("outputs", OutputDataPort)

    def get_data_port_ids(self):
        """Ids of all inputs and outputs."""
        return list(self.input_data_ports) + list(self.output_data_ports)

    def get_data_port_by_id(self, data_port_id):
        """Input or output with this id, or None."""
        return self.input_data_ports.get(data_port_id) or self.output_data_ports.get(data_port_id)

    def get_io_data_port_id_from_name_and_type(self, name, data_port_type, throw_exception=True):
        """Id of a port by name; ``data_port_type`` is ``InputDataPort`` or ``OutputDataPort``.

        If there is no such port, raises ``AttributeError``, or returns None if ``throw_exception``
        is False.
        """
        ports = self.input_data_ports if data_port_type is InputDataPort else self.output_data_ports
        for key, port in ports.items():
            if port.name == name:
                return key
        if throw_exception:
            raise AttributeError(f"{self} has no {data_port_type.__name__} named `{name}`")
        return None

    def __contains__(self, item):
        return any(item is part for group in self._groups() for part in group)

    def _groups(self):
        ports = [self.input_data_ports.values(), self.output_data_ports.values()]
        return [self.outcomes.values(), *ports, [self._income]]

    # ---- run

    @property
    def preempted(self):
        """True if this run should end early. Reading True is noted: see ``StatePreempted``."""
        if self._signals.preempted:
            self._told = self._live()["run_count"]
            return True
        return False

    @preempted.setter
    def preempted(self, preempted):
        self._signals.preempted = _flag_value(preempted)

    @property
    def paused(self):
        """True if the machine is held."""
        return self._signals.paused

    @paused.setter
    def paused(self, paused):
        self._signals.paused = _flag_value(paused)

    @property
    def started(self):
        """True if the machine was resumed since it was last held."""
        return self._signals.started

    @started.setter
    def started(self, started):
        self._signals.started = _flag_value(started)

    @property
    def _preempted(self):
        return _signals.Flag(self, "preempted")

    @property
    def _paused(self):
        return _signals.Flag(self, "paused")

    @property
    def _started(self):
        return _signals.Flag(self, "started")

    @property
    def _interrupted(self):
        return _signals.AnyFlag(self, "preempted", "paused")

    @property
    def _unpaused(self):
        return _signals.AnyFlag(self, "preempted", "started")

    def _wait(self, mask, timeout):
        come = self._signals.wait(mask, _signals.seconds(timeout))
        if come and mask & _signals.PREEMPTED:
            self.preempted  # noqa: B018, reading it notes that the script has been told
        return come

    def _told_preempted(self):
        """True if the script of this run has seen that it is preempted."""
        return self._told == self._live()["run_count"]

    def preemptive_wait(self, time=None):
        """Wait for a time (s), None for ever; True if preempted, False if the time has passed."""
        return self._wait(_signals.PREEMPTED, time)

    def wait_for_interruption(self, timeout=None):
        """Wait until the state is preempted or paused; False if the timeout (s) expired."""
        return self._wait(_signals.PREEMPTED | _signals.PAUSED, timeout)

    def wait_for_unpause(self, timeout=None):
        """Wait until the state is preempted or the machine resumed; False on timeout (s)."""
        return self._wait(_signals.PREEMPTED | _signals.STARTED, timeout)

    def recursively_preempt_states(self):
        """Preempt this state and all states inside."""
        self.preempted = True

    def recursively_pause_states(self):
        """Hold this state and all states inside."""
        self.started = False
        self.paused = True

    def recursively_resume_states(self):
        """Resume this state and all states inside."""
        self.paused = False
        self.started = True

    @property
    def state_execution_status(self):
        """Current ``StateExecutionStatus`` of the state."""
        live = self._live()
        if not live["active"] and live["phase"] != "waiting":
            return StateExecutionStatus.INACTIVE
        return _PHASES.get(live["phase"], StateExecutionStatus.ACTIVE)

    @property
    def active(self):
        """True if the state is running."""
        return self._live()["active"]

    @property
    def input_data(self):
        """Inputs of the last run: port name to value.

        For the root of a machine that is being built, assign the inputs of its next runs.
        """
        live = self._live()
        return live["input_data"] if live["run_count"] else self._given_inputs or {}

    @input_data.setter
    def input_data(self, input_data):
        self._given_inputs = self._given(input_data, "inputs")

    @property
    def output_data(self):
        """Outputs of the last run: port name to value.

        At the root of a machine that is being built, assigned values apply until it runs.
        """
        live = self._live()
        return live["output_data"] if live["run_count"] else self._given_outputs or {}

    @output_data.setter
    def output_data(self, output_data):
        self._given_outputs = self._given(output_data, "outputs")

    def _given(self, data, what):
        if not isinstance(data, dict):
            raise TypeError(f"the {what} must be a dict, not {type(data).__name__}")
        if self._place >= 0:
            raise AttributeError(f"{self} runs, and has its {what}; they change with the next entry")
        return dict(data)

    @property
    def final_outcome(self):
        """:class:`Outcome` by which the state was last left, or None."""
        left_by = self._live()["final_outcome"]
        return None if left_by is None else Outcome(left_by[0], left_by[1], self)

    @property
    def run_id(self):
        """Unique id (``str``) of the current or last run of the state; None before the first."""
        count = self._live()["run_count"]
        return f"{_PROCESS}.run_id.{self._place:010}{count:010}" if count else None

    @property
    def backward_execution(self):
        """True if ``backward_execute`` is running."""
        return self._backward

    @property
    def execution_history(self):
        """History of the run."""
        return ExecutionHistory(self)


def _flag_value(value):
    if not isinstance(value, bool):
        raise TypeError(f"a flag is True or False, not {type(value).__name__}")
    return value
