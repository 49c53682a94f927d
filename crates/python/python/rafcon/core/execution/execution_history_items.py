"""Kinds of history entries."""

import json
from enum import Enum

from rafcon import _objects

CallType = Enum("METHOD_NAME", "EXECUTE CONTAINER", module=__name__)


class HistoryItem:
    """Something that happened to a state."""

    def __init__(self, sequence, timestamp, path, data, backward):
        #: The number of the event in the journal of the run.
        self.sequence = sequence
        #: When it happened: s since 1970.
        self.timestamp = timestamp
        #: The path of the state: ids joined by ``/``.
        self.path = path
        #: Whether it undoes an earlier entry: a step back.
        self.backward = backward
        self._data = data

    @property
    def history_item_id(self):
        """Unique in the run (``str``)."""
        return str(self.sequence)

    @property
    def state_reference(self):
        """The state; None if it is not there any more."""
        return _objects.machine().get_state_by_path(self.path, as_check=True)

    @property
    def state_type(self):
        """The name of the state's class."""
        return type(self.state_reference).__name__

    @property
    def call_type(self):
        """``EXECUTE`` for states with a script, ``CONTAINER`` for the others."""
        is_container = hasattr(self.state_reference, "states") or hasattr(self.state_reference, "state_copy")
        return CallType["CONTAINER" if is_container else "EXECUTE"]

    @property
    def input_output_data(self):
        """Name of the port to value, as people see it: JSON. Values that are not kept are missing."""
        return json.loads(self._data)

    def __repr__(self):
        return f"<{type(self).__name__} {self.path}>"


class CallItem(HistoryItem):
    """A state was entered."""

    #: It has no outcome yet.
    outcome = None


class ReturnItem(HistoryItem):
    """A state was left."""

    def __init__(self, sequence, timestamp, path, outcome, data, backward):
        HistoryItem.__init__(self, sequence, timestamp, path, data, backward)
        self._outcome = outcome

    @property
    def outcome(self):
        """The :class:`~rafcon.core.state_elements.logical_port.Outcome` that it was left by."""
        from rafcon.core.state_elements.logical_port import Outcome

        return Outcome(*self._outcome)


def item(sequence, timestamp, path, outcome, data, backward):
    """The item of an event as the compiled module tells it."""
    if outcome is None:
        return CallItem(sequence, timestamp, path, data, backward)
    return ReturnItem(sequence, timestamp, path, outcome, data, backward)
