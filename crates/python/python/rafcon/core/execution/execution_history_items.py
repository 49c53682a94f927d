"""Kinds of history items."""

import json
from enum import Enum

from rafcon import _objects

CallType = Enum("METHOD_NAME", "EXECUTE CONTAINER", module=__name__)


class HistoryItem:
    """Event of a state."""

    def __init__(self, sequence, timestamp, path, data, backward, call_type=CallType.EXECUTE):
        #: The number of the event in the journal of the run.
        self.sequence = sequence
        #: Time of the event: s since 1970.
        self.timestamp = timestamp
        #: The path of the state: ids joined by ``/``.
        self.path = path
        #: True if it undoes an earlier entry in a step back.
        self.backward = backward
        #: ``CONTAINER`` for what runs the states inside, ``EXECUTE`` for the state as its container sees it.
        self.call_type = call_type
        self._data = data

    @property
    def history_item_id(self):
        """Id (``str``), unique in the run."""
        return f"{self.sequence}.{self.call_type.name}"

    @property
    def state_reference(self):
        """State of the event; None if it was removed."""
        return _objects.machine().get_state_by_path(self.path, as_check=True)

    @property
    def state_type(self):
        """Name of the state's class."""
        return type(self.state_reference).__name__

    @property
    def input_output_data(self):
        """Port name to value, as JSON for display. Values that are not kept are missing."""
        return json.loads(self._data)

    def __repr__(self):
        return f"<{type(self).__name__} {self.path}>"


    @property
    def call_type_str(self):
        """Name of the call type."""
        return self.call_type.name

    def to_dict(self, pickled=True):
        """Content of the item, name to value; ``pickled`` has no effect: values are readable."""
        return {
            "path": self.path,
            "state_type": self.state_type,
            "timestamp": self.timestamp,
            "history_item_id": self.history_item_id,
            "item_type": type(self).__name__,
            "call_type": self.call_type_str,
            "input_output_data": self.input_output_data,
            "outcome_name": None if self.outcome is None else self.outcome.name,
            "outcome_id": None if self.outcome is None else self.outcome.outcome_id,
        }


class StateMachineStartItem(HistoryItem):
    """Start of a state machine. No history has one: the journal of the run records the start."""


class ConcurrencyItem(HistoryItem):
    """Branches of a concurrency state. No history has one: one list has all branches."""


class ScopedDataItem(HistoryItem):
    """Entry into a state, or exit from it."""


class CallItem(ScopedDataItem):
    """Entry into a state."""

    #: It has no outcome yet.
    outcome = None


class ReturnItem(ScopedDataItem):
    """Exit from a state."""

    def __init__(self, sequence, timestamp, path, outcome, data, backward, call_type=CallType.EXECUTE):
        ScopedDataItem.__init__(self, sequence, timestamp, path, data, backward, call_type)
        self._outcome = outcome

    @property
    def outcome(self):
        """:class:`~rafcon.core.state_elements.logical_port.Outcome` by which the state was left."""
        from rafcon.core.state_elements.logical_port import Outcome

        return Outcome(*self._outcome)


def items(told, call_types):
    """Items of an event from the compiled module, one for each call type, the outer one first."""
    sequence, timestamp, path, outcome, data, backward = told
    if outcome is None:
        return [CallItem(sequence, timestamp, path, data, backward, kind) for kind in call_types]
    about = (sequence, timestamp, path, outcome, data, backward)
    return [ReturnItem(*about, kind) for kind in reversed(call_types)]
