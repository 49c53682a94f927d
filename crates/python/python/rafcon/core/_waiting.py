"""Waiting for one's turn at a locked global variable, ended by the turn or by a preemption, and never by polling."""

from rafcon import _objects
from rafcon._wakeup import Wakeup
from rafcon.core.custom_exceptions import StatePreempted


class Waiter:
    """One blocked call. ``act`` is what it wants to do once the variable is free.

    Whoever frees the variable carries ``act`` out for the waiter, so the waiters are served in the order of their
    arrival. ``finish`` is called under the manager's lock, all else without it.
    """

    def __init__(self, act):
        self.done = False
        self._act = act
        self._result = None
        self._error = None
        self._state = _objects.current_state()
        self._wakeup = Wakeup(self._state)

    def finish(self, variable):
        """Carries the call out on a variable that is free (None: it is gone) and wakes the caller."""
        try:
            self._result = self._act(variable)
        except Exception as error:
            self._error = error
        self.done = True
        self._wakeup.wake()

    def sleep(self):
        """Until the turn has come: True; False if the state was preempted first."""
        told = self._state is None or self._state._told_preempted()
        return self._wakeup.wait(heed_preemption=not told)

    def result(self):
        """What the call returns or raises."""
        if self._error is not None:
            raise self._error
        return self._result

    def preemption(self, key):
        """The exception that ends the script; from now on the script has been told."""
        self._state.preempted  # noqa: B018, reading it notes that
        return StatePreempted(f"preempted while waiting for the locked global variable `{key}`")
