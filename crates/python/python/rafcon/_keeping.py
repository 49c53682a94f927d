"""Values on their way into the journal of a run and out of it."""

import threading
from collections import deque


class Variable:
    """A global variable with what is declared of it, for those that are more than a value kept as a copy."""

    __slots__ = ("value", "by_reference", "data_type")

    def __init__(self, value, by_reference, data_type):
        self.value = value
        self.by_reference = by_reference
        self.data_type = data_type

    def __reduce__(self):
        return (Variable, (self.value, self.by_reference, self.data_type))


def pickle(value):
    """The pickle of a value, readable by every Python that rafcon runs on."""
    from pickle import dumps  # as late as this, for it takes long to load and plain values need none

    return dumps(value, 4)


def unpickle(data):
    """The value of a pickle."""
    from pickle import loads

    return loads(data)


class Ledger:
    """Changes of the global variables on their way into the journal, in the order in which they happened.

    ``journal`` has ``keep(value, carrier)`` and ``write(name, kept)``; without one nothing is kept.
    """

    def __init__(self, journal=None):
        self._journal = journal
        self._changes = deque()
        # Held during requests to the running machine; never acquired by a holder of the variables' lock.
        self._writing = threading.Lock()

    def keep(self, value, by_reference, data_type):
        """How the journal keeps a value. Called with no lock held: it may run code of the user."""
        if self._journal is None:
            return None
        plain = not by_reference and data_type is type(None)
        return self._journal.keep(value, None if plain else Variable(value, by_reference, data_type))

    def note(self, name, kept):
        """A variable got this value; None: it was removed. Called with the variables locked."""
        if self._journal is not None:
            self._changes.append((name, kept))

    def forget(self, name):
        """What was noted of a variable and is not written down yet is none of the run's. Called before the run begins."""
        self._changes = deque(change for change in self._changes if change[0] != name)

    def write(self):
        """Writes down what was noted. Called with no lock held."""
        if not self._changes or not self._journal.is_open():
            return
        with self._writing:
            while self._changes:
                self._journal.write(*self._changes.popleft())
