"""Wait that ends when another thread wakes it, or when the script's state is preempted."""

import threading
import time

from rafcon import _signals


class Wakeup:
    """One wait of one thread; ``state`` is the state whose script runs on it, or None."""

    def __init__(self, state):
        self._signals = None if state is None else state._signals
        self._event = threading.Event()

    def wake(self):
        """End the wait, even if it has not begun."""
        self._event.set()
        if self._signals is not None:
            self._signals.nudged = True

    def wait(self, timeout=None, heed_preemption=True):
        """Wait; True once woken, False if the state is preempted or the timeout (s) expires."""
        if self._signals is None:
            return self._event.wait(timeout)
        mask = _signals.NUDGED | (_signals.PREEMPTED if heed_preemption else 0)
        end_s = None if timeout is None else time.monotonic() + timeout
        # Other users share the flag: clear it before the event is checked.
        self._signals.nudged = False
        while not self._event.is_set():
            left_s = None if end_s is None else end_s - time.monotonic()
            rung = self._signals.wait(mask, _signals.seconds(left_s))
            if not rung or (heed_preemption and self._signals.preempted):
                break
            self._signals.nudged = False
        return self._event.is_set()
