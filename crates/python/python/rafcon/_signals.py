"""The flags of a state: preempted, paused, started, and waiting for them."""

import threading

from rafcon._bridge import NoRunningMachine

PREEMPTED = 1
PAUSED = 2
STARTED = 4
NUDGED = 8

#: Seconds (ten years) above which a wait is endless.
_FOREVER = 3.2e8


def seconds(timeout):
    """A waiting time as the compiled module takes it: a float that is not negative, or None for ever."""
    if timeout is None:
        return None
    if isinstance(timeout, (str, bytes)):
        raise TypeError(f"a time must be a number of seconds, not {timeout!r}")
    timeout = float(timeout)
    return None if timeout > _FOREVER else max(timeout, 0.0)


class Idle:
    """The flags of a state that does not run: they can be set, and nobody else ever sets them."""

    def __init__(self):
        self.preempted = self.paused = self.started = self.nudged = False

    def wait(self, mask, timeout):
        """Waits for a time (s); whether a flag of the mask is set. Without a time nothing would end the wait."""
        flags = {PREEMPTED: self.preempted, PAUSED: self.paused, STARTED: self.started, NUDGED: self.nudged}
        if any(on for flag, on in flags.items() if flag & mask):
            return True
        if timeout is None:
            raise NoRunningMachine("this state does not run, so nothing would end the wait; give a time")
        return threading.Event().wait(timeout)


class Flag:
    """One flag of a state, used like a ``threading.Event``."""

    __slots__ = ("_state", "_name")

    def __init__(self, state, name):
        self._state = state
        self._name = name

    def is_set(self):
        """Whether it is set."""
        return getattr(self._state, self._name)

    isSet = is_set

    def set(self):
        """Sets it; whoever waits goes on."""
        setattr(self._state, self._name, True)

    def clear(self):
        """Takes it back."""
        setattr(self._state, self._name, False)

    def wait(self, timeout=None):
        """Waits until it is set; False if the time (s) ran out."""
        return self._state._wait(_MASKS[self._name], timeout)


class AnyFlag:
    """Two flags of a state together: set if one of them is."""

    __slots__ = ("_state", "_names")

    def __init__(self, state, *names):
        self._state = state
        self._names = names

    def is_set(self):
        """Whether one of them is set."""
        return any([getattr(self._state, name) for name in self._names])

    isSet = is_set

    def wait(self, timeout=None):
        """Waits until one of them is set; False if the time (s) ran out."""
        return self._state._wait(sum(_MASKS[name] for name in self._names), timeout)


_MASKS = {"preempted": PREEMPTED, "paused": PAUSED, "started": STARTED}
