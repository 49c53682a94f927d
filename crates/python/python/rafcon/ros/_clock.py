"""Time of ROS: that of the computer, or of ``/clock`` in a simulation."""

import time

from rafcon.ros._node import node
from rafcon.ros._waits import TimedOut, Waiter

_NS = 1_000_000_000
#: Timeout (s) for the first message of a simulation.
_FIRST_S = 2.0


def now_ns():
    """Current time (ns)."""
    here = node()
    return here.shared(("clock",), lambda: _SimClock(here))() if here.use_sim_time else time.time_ns()


def now():
    """Current time (s): of the computer, or with ``use_sim_time`` of the topic ``/clock``.

    :func:`configure` sets ``use_sim_time``.
    """
    return now_ns() / _NS


def stamp(seconds=None):
    """Time (s, default: now) as ``builtin_interfaces/msg/Time``, for the ``stamp`` of a header."""
    sec, nanosec = divmod(now_ns() if seconds is None else round(float(seconds) * _NS), _NS)
    return {"sec": sec, "nanosec": nanosec}


class _SimClock:
    """Newest time of ``/clock``, in ns."""

    def __init__(self, here):
        from rafcon.ros._topics import Subscription, heard_quality

        self._heard = Subscription(here, "/clock", "rosgraph_msgs/msg/Clock", None, heard_quality(here, "/clock", "sensor"))

    def __call__(self):
        if self._heard.latest is None:
            waiter = Waiter("the time of the simulation")
            self._heard._waiters.add(waiter)
            try:
                waiter.until(lambda: self._heard.latest is not None, _FIRST_S)
            finally:
                self._heard._waiters.discard(waiter)
        message = self._heard.latest
        if message is None:
            raise TimedOut("the time is that of a simulation (use_sim_time), and nobody publishes it on /clock; start it, or call configure(use_sim_time=False)")
        return message["clock"]["sec"] * _NS + message["clock"]["nanosec"]
