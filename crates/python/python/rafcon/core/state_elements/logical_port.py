"""Logical ports, at which the control flow enters and leaves a state: income and outcomes."""

from rafcon.core.state_elements.state_element import StateElement, field
from rafcon.utils.type_helpers import named


class LogicalPort(StateElement):
    """Point of a state to which transitions connect."""


class Income(LogicalPort):
    """Entry point of a state; every state has one."""

    def __str__(self):
        return "Income"


class Outcome(LogicalPort):
    """Exit of a state. ``-1`` is *aborted*, ``-2`` is *preempted*, the others are the user's."""

    _fields = ("outcome_id", "name")
    _group = "outcomes"
    _verb = "outcome"

    outcome_id = field("The id (``int``), unique in the state.")

    def __init__(self, outcome_id=None, name=None, parent=None):
        if not isinstance(outcome_id, int):
            raise TypeError(f"outcome_id must be an int, not {type(outcome_id).__name__}")
        if not isinstance(name, str) or not name:
            raise TypeError("the name of an outcome must be a str that is not empty")
        LogicalPort.__init__(self, parent, (outcome_id, name))

    @staticmethod
    def _read(fact):
        return (fact,)

    @property
    def name(self):
        """Name (``str``), unique in the state."""
        return self._get("name")

    @name.setter
    def name(self, name):
        self._set("rename", {"name": named(name)}, name)

    def __str__(self):
        key, name = self._content()
        return f"Outcome '{name}' [{key}]"
