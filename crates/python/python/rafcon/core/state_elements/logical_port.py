"""Where the control flow enters and leaves a state: income and outcomes."""

from rafcon.core._refusals import fixed
from rafcon.core.state_elements.state_element import StateElement


class LogicalPort(StateElement):
    """A point of a state to which a transition connects."""


class Income(LogicalPort):
    """Where a state is entered; every state has one."""

    def __str__(self):
        return "Income"


class Outcome(LogicalPort):
    """A way to leave a state. ``-1`` is *aborted*, ``-2`` is *preempted*, the others are the user's."""

    _fields = ("outcome_id", "name")

    def __init__(self, outcome_id=None, name=None, parent=None):
        LogicalPort.__init__(self, parent)
        if not isinstance(outcome_id, int):
            raise TypeError(f"outcome_id must be an int, not {type(outcome_id).__name__}")
        if not isinstance(name, str) or not name:
            raise TypeError("the name of an outcome must be a str that is not empty")
        self._outcome_id = outcome_id
        self._name = name

    @fixed
    def outcome_id(self):
        """The id (``int``), unique in the state."""
        return self._outcome_id

    @fixed
    def name(self):
        """The name (``str``), unique in the state."""
        return self._name

    def __str__(self):
        return f"Outcome '{self._name}' [{self._outcome_id}]"
