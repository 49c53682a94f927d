"""Waits for a locked global variable, ended by the release or a preemption, never by polling."""

from rafcon import _objects
from rafcon._wakeup import Wakeup
from rafcon.core.custom_exceptions import StatePreempted


class Waiter:
    """One blocked call. ``act`` is the operation to run once the variable is free.

    The thread that frees the variable runs ``act`` for the waiter, so waiters are served in the
    order of their arrival. ``finish`` is called under the manager's lock, everything else without
    it.
    """

    def __init__(self, act):
        self.done = False
        self._act = act
        self._result = None
        self._error = None
        self._state = _objects.current_state()
        self._wakeup = Wakeup(self._state)

    def finish(self, variable):
        """Run the call on a free variable (None if it was removed) and wake the caller."""
        try:
            self._result = self._act(variable)
        except Exception as error:
            self._error = error
        self.done = True
        self._wakeup.wake()

    def sleep(self):
        """Wait until the call has run: True; False if the state was preempted first."""
        told = self._state is None or self._state._told_preempted()
        return self._wakeup.wait(heed_preemption=not told)

    def result(self):
        """Return the result of the call, or raise its exception."""
        if self._error is not None:
            raise self._error
        return self._result

    def preemption(self, key):
        """Return the exception that ends the script, and note that the script has seen it."""
        self._state.preempted  # noqa: B018, reading it notes that
        return StatePreempted(f"preempted while waiting for the locked global variable `{key}`")
