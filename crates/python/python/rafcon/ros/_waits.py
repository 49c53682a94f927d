"""Waits for events of back ends, with timeouts; preemption of the script's state ends them."""

import threading
import time
import weakref

from rafcon import _objects, _signals
from rafcon.core.custom_exceptions import StatePreempted
from rafcon.ros._backend import RosError

#: Polling interval (s) for conditions without an event, such as the presence of a server.
LOOK_EVERY_S = 0.05

_waiting = weakref.WeakSet()
_waiting_lock = threading.Lock()


class TimedOut(RosError, TimeoutError):
    """The timeout of a wait has expired."""


class Waiter:
    """Waits of one call on one thread; ``ring`` may be called on any thread."""

    def __init__(self, what):
        self._what = what
        self._state = _objects.current_state()
        self._signals = None if self._state is None else self._state._signals
        self._heeds = self._state is not None and not self._state._told_preempted()
        self._event = threading.Event()
        with _waiting_lock:
            _waiting.add(self)

    def ring(self):
        """Wake the waiter, because its condition may have changed."""
        self._event.set()
        if self._signals is not None:
            self._signals.nudged = True

    def heeding(self):
        """True if preemption ends a wait."""
        return self._heeds

    def heed(self, heeds):
        """Set if preemption ends waits from now on."""
        self._heeds = heeds

    def preempted(self):
        """True if the state is preempted and its script has not seen it."""
        return self._heeds and self._signals.preempted

    def until(self, come, timeout=None, look_every=None):
        """Wait for a true result of ``come()``; return it, or a false result after the timeout (s).

        ``come`` is called after each ``ring``, and every ``look_every`` seconds. Raises
        :class:`StatePreempted`.
        """
        end_s = None if timeout is None else time.monotonic() + timeout
        while True:
            # Clear first, then check, so that no later ring is lost.
            self._event.clear()
            if self._signals is not None:
                self._signals.nudged = False
            found = come()
            if found:
                return found
            if self.preempted():
                raise self.preemption()
            left_s = None if end_s is None else end_s - time.monotonic()
            if left_s is not None and left_s <= 0:
                return found
            self._sleep(min((each for each in (left_s, look_every) if each is not None), default=None))

    def _sleep(self, seconds):
        if self._signals is None:
            self._event.wait(seconds)
        else:
            mask = _signals.NUDGED | (_signals.PREEMPTED if self._heeds else 0)
            # Another wait of this state may have cleared the flag of this one.
            if not self._event.is_set():
                self._signals.wait(mask, _signals.seconds(seconds))

    def preemption(self):
        """Return the exception that ends the script, and note that the script has seen it."""
        self._state.preempted  # noqa: B018, reading it notes that
        self._heeds = False
        return StatePreempted(f"preempted while waiting for {self._what}")


def ring_all():
    """Wake all waiters, for example when the node has ended."""
    with _waiting_lock:
        waiting = list(_waiting)
    for waiter in waiting:
        waiter.ring()


def seconds(value, name):
    """Check a user's timeout (s): not negative, or None for no limit."""
    if value is None:
        return None
    value = float(value)
    if not value >= 0:
        raise ValueError(f"{name} is {value}; write a time in seconds that is not negative, or None for no limit")
    return min(value, threading.TIMEOUT_MAX)
