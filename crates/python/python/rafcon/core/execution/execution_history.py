"""What ran before a state, as far as scripts can see it."""

from rafcon import _objects
from rafcon._bridge import native
from rafcon.core.custom_exceptions import CommandNotSupported


class HistoryItem:
    """A state that has run: ``state_reference``, its ``path``, and the ``outcome`` it was left by."""

    def __init__(self, state):
        self.state_reference = state
        self.path = state.get_path()
        self.outcome = state.final_outcome


class ExecutionHistory:
    """The states that ran in the container of one state; only the last of them is offered."""

    def __init__(self, state):
        self._state = state

    def get_last_history_item(self):
        """The :class:`HistoryItem` of the state that ran before, or None."""
        before = native.last_left(self._state._place)
        return HistoryItem(_objects.state(before)) if before >= 0 else None

    def __len__(self):
        return 0 if self.get_last_history_item() is None else 1

    def __iter__(self):
        item = self.get_last_history_item()
        return iter(() if item is None else (item,))

    def __getitem__(self, index):
        return list(self)[index]

    def pop_last_item(self):
        """Would change the history: refused."""
        raise CommandNotSupported("ExecutionHistory.pop_last_item")
