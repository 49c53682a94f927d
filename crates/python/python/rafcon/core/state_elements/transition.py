"""Transitions, which select the next state for an outcome."""

from rafcon.core.state_elements.state_element import StateElement, field
from rafcon.utils.type_helpers import of_type


class Transition(StateElement):
    """Connection from an outcome of a state to the next state, or to an outcome of the container.

    The start transition has neither ``from_state`` nor ``from_outcome``. Only a transition to the
    container has a ``to_outcome``.
    """

    _fields = ("transition_id", "from_state", "from_outcome", "to_state", "to_outcome")
    _group = "transitions"
    _verb = "transition"

    transition_id = field("The id (``int``), unique in the container.")

    def __init__(self, from_state, from_outcome, to_state, to_outcome, transition_id=None, parent=None):
        StateElement.__init__(self, parent, (transition_id, from_state, from_outcome, to_state, to_outcome))

    @property
    def from_state(self):
        """Id of the state that it leaves; None for the start transition."""
        return self._get("from_state")

    @from_state.setter
    def from_state(self, from_state):
        self.modify_origin(from_state, self.from_outcome)

    @property
    def from_outcome(self):
        """Id of the outcome from which it leads; None for the start transition."""
        return self._get("from_outcome")

    @from_outcome.setter
    def from_outcome(self, from_outcome):
        self.modify_origin(self.from_state, from_outcome)

    @property
    def to_state(self):
        """Id of the state that it leads to."""
        return self._get("to_state")

    @to_state.setter
    def to_state(self, to_state):
        self.modify_target(to_state, self.to_outcome)

    @property
    def to_outcome(self):
        """Id of the container's outcome that it leads to, or None."""
        return self._get("to_outcome")

    @to_outcome.setter
    def to_outcome(self, to_outcome):
        self.modify_target(self.to_state, to_outcome)

    def modify_origin(self, from_state, from_outcome):
        """Set the outcome of a state where it begins; (None, None) for the container's income."""
        of_type(from_state, str, "from_state", or_none=True)
        of_type(from_outcome, int, "from_outcome", or_none=True)
        values = {"from_state": from_state, "from_outcome": from_outcome}
        self._set("origin", values, from_state, from_outcome)

    def modify_target(self, to_state, to_outcome=None):
        """Set the state, or the outcome of the container, that it leads to."""
        of_type(to_state, str, "to_state")
        of_type(to_outcome, int, "to_outcome", or_none=True)
        self._set("target", {"to_state": to_state, "to_outcome": to_outcome}, to_state, to_outcome)

    def __str__(self):
        key, from_state, from_outcome, to_state, to_outcome = self._content()
        begin = f"from_state: {from_state}, from_outcome: {from_outcome}, "
        return f"Transition - {begin}to_state: {to_state}, to_outcome: {to_outcome}, id: {key}"
