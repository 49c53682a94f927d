"""Transitions: which state follows on which outcome."""

from rafcon.core._refusals import fixed, refuses
from rafcon.core.state_elements.state_element import StateElement


@refuses("modify_origin", "modify_target")
class Transition(StateElement):
    """Leads from an outcome of a state to the next state, or to an outcome of the container.

    The start transition has neither ``from_state`` nor ``from_outcome``; only a transition to the container has a
    ``to_outcome``.
    """

    _fields = ("transition_id", "from_state", "from_outcome", "to_state", "to_outcome")

    def __init__(self, from_state, from_outcome, to_state, to_outcome, transition_id=None, parent=None):
        StateElement.__init__(self, parent)
        self._from_state = from_state
        self._from_outcome = from_outcome
        self._to_state = to_state
        self._to_outcome = to_outcome
        self._transition_id = transition_id

    @fixed
    def transition_id(self):
        """The id (``int``), unique in the container."""
        return self._transition_id

    @fixed
    def from_state(self):
        """The id of the state that it leaves; None for the start transition."""
        return self._from_state

    @fixed
    def from_outcome(self):
        """The id of the outcome that it leaves by; None for the start transition."""
        return self._from_outcome

    @fixed
    def to_state(self):
        """The id of the state that it leads to."""
        return self._to_state

    @fixed
    def to_outcome(self):
        """The id of the container's outcome that it leads to, or None."""
        return self._to_outcome

    def __str__(self):
        begin = f"from_state: {self._from_state}, from_outcome: {self._from_outcome}, "
        end = f"to_state: {self._to_state}, to_outcome: {self._to_outcome}, "
        return f"Transition - {begin}{end}id: {self._transition_id}"
