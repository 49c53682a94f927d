"""History of the run for scripts."""

from rafcon import _objects
from rafcon._bridge import native
from rafcon.core.custom_exceptions import CommandNotSupported
from rafcon.core.execution import execution_history_items
from rafcon.core.execution.execution_history_items import CallType


class HistoryItem:
    """State that has run: ``state_reference``, its ``path``, and the ``outcome`` it left by."""

    def __init__(self, state):
        self.state_reference = state
        self.path = state.get_path()
        self.outcome = state.final_outcome


class ExecutionHistory:
    """States entered and left in the run, oldest first: ``CallItem`` and ``ReturnItem`` objects.

    A container inside another one has two items each time: one as a state of the outer container,
    and one for the states inside.

    The history covers the last 20,000 events or so, which are kept in memory. The journal of the
    run has all events. Each access reads the events again.
    """

    def __init__(self, state):
        self._state = state

    def get_last_history_item(self):
        """:class:`HistoryItem` of the preceding state in the container of this one, or None."""
        before = native.last_left(self._state._place)
        return HistoryItem(_objects.state(before)) if before >= 0 else None

    def _items(self):
        kinds, found = {}, []
        for told in native.past():
            path = told[2]
            if path not in kinds:
                kinds[path] = _call_types(path)
            found += execution_history_items.items(told, kinds[path])
        return found

    def __len__(self):
        return len(self._items())

    def __iter__(self):
        return iter(self._items())

    def __getitem__(self, index):
        return self._items()[index]

    def pop_last_item(self):
        """Raise ``CommandNotSupported``: the history cannot be changed."""
        raise CommandNotSupported("ExecutionHistory.pop_last_item")


def _call_types(path):
    state = _objects.machine().get_state_by_path(path, as_check=True)
    if not hasattr(state, "states"):
        return (CallType.EXECUTE,)
    stands_alone = state.is_root_state or state.is_root_state_of_library
    return (CallType.CONTAINER,) if stands_alone else (CallType.EXECUTE, CallType.CONTAINER)
