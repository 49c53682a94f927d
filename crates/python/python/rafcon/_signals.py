"""Flags of a state (preempted, paused, started), and waits for them."""

import threading

from rafcon._bridge import NoRunningMachine

PREEMPTED = 1
PAUSED = 2
STARTED = 4
NUDGED = 8

#: Seconds (ten years) above which a wait is endless.
_FOREVER = 3.2e8


def seconds(timeout):
    """Convert a timeout for the compiled module: a float of at least 0, or None to wait forever."""
    if timeout is None:
        return None
    if isinstance(timeout, (str, bytes)):
        raise TypeError(f"a time must be a number of seconds, not {timeout!r}")
    timeout = float(timeout)
    return None if timeout > _FOREVER else max(timeout, 0.0)


class Idle:
    """Flags of a state that does not run. Only its own users set them."""

    def __init__(self):
        self.preempted = self.paused = self.started = self.nudged = False

    def wait(self, mask, timeout):
        """Return True if a flag of the mask is set, else False after the timeout (s).

        Raises ``NoRunningMachine`` instead of waiting without a timeout.
        """
        flags = {PREEMPTED: self.preempted, PAUSED: self.paused, STARTED: self.started, NUDGED: self.nudged}
        if any(on for flag, on in flags.items() if flag & mask):
            return True
        if timeout is None:
            raise NoRunningMachine("this state does not run, so nothing would end the wait; give a time")
        return threading.Event().wait(timeout)


class Flag:
    """One flag of a state, with the methods of ``threading.Event``."""

    __slots__ = ("_state", "_name")

    def __init__(self, state, name):
        self._state = state
        self._name = name

    def is_set(self):
        """True if the flag is set."""
        return getattr(self._state, self._name)

    isSet = is_set

    def set(self):
        """Set the flag and wake waiting threads."""
        setattr(self._state, self._name, True)

    def clear(self):
        """Clear the flag."""
        setattr(self._state, self._name, False)

    def wait(self, timeout=None):
        """Wait until the flag is set; False if the timeout (s) expired."""
        return self._state._wait(_MASKS[self._name], timeout)


class AnyFlag:
    """Several flags of a state combined: set if one of them is."""

    __slots__ = ("_state", "_names")

    def __init__(self, state, *names):
        self._state = state
        self._names = names

    def is_set(self):
        """True if one of the flags is set."""
        return any([getattr(self._state, name) for name in self._names])

    isSet = is_set

    def wait(self, timeout=None):
        """Wait until one of the flags is set; False if the timeout (s) expired."""
        return self._state._wait(sum(_MASKS[name] for name in self._names), timeout)


_MASKS = {"preempted": PREEMPTED, "paused": PAUSED, "started": STARTED}
