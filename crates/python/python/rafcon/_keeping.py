"""Values written to the journal of a run and read from it."""

import threading
from collections import deque


class Variable:
    """Global variable kept by reference or with a declared type, as the journal stores it."""

    __slots__ = ("value", "by_reference", "data_type")

    def __init__(self, value, by_reference, data_type):
        self.value = value
        self.by_reference = by_reference
        self.data_type = data_type

    def __reduce__(self):
        return (Variable, (self.value, self.by_reference, self.data_type))


def pickle(value):
    """Pickle of a value, readable by every supported version of Python."""
    from pickle import dumps  # as late as this, for it takes long to load and plain values need none

    return dumps(value, 4)


def unpickle(data):
    """Value of a pickle."""
    from pickle import loads

    return loads(data)


class Ledger:
    """Queue of changes of the global variables for the journal, in chronological order.

    ``journal`` has ``keep(value, carrier)`` and ``write(name, kept)``. Without a journal nothing is
    kept.
    """

    def __init__(self, journal=None):
        self._journal = journal
        self._changes = deque()
        # Held during requests to the running machine; never acquired by a holder of the variables' lock.
        self._writing = threading.Lock()

    def keep(self, value, by_reference, data_type):
        """Return the journal's form of a value. Call it with no lock held: it may run user code."""
        if self._journal is None:
            return None
        plain = not by_reference and data_type is type(None)
        return self._journal.keep(value, None if plain else Variable(value, by_reference, data_type))

    def note(self, name, kept):
        """Queue the new value of a variable, None if removed. Called with the variables locked."""
        if self._journal is not None:
            self._changes.append((name, kept))

    def forget(self, name):
        """Discard queued changes of a variable. Called before the run begins."""
        self._changes = deque(change for change in self._changes if change[0] != name)

    def write(self):
        """Write the queued changes to the journal. Called with no lock held."""
        if not self._changes or not self._journal.is_open():
            return
        with self._writing:
            while self._changes:
                self._journal.write(*self._changes.popleft())
