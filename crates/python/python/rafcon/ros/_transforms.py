"""Transforms between frames, from ``/tf`` and ``/tf_static``."""

from rafcon.ros import _waits
from rafcon.ros._backend import Qos
from rafcon.ros._node import node
from rafcon.ros._transform_buffer import Buffer, NoTransform, Transform
from rafcon.ros._waits import TimedOut, Waiter

__all__ = ["Transform", "transform"]

_TYPE = "tf2_msgs/msg/TFMessage"
_QUALITIES = {"/tf": Qos(depth=100), "/tf_static": Qos(durability="transient_local", depth=100)}
_NS = 1_000_000_000


class _Heard:
    """Buffer of the node, and waiters for transforms."""

    def __init__(self, here):
        self.buffer = Buffer()
        self.waiters = set()
        self._here = here
        self._kept = [here.backend.subscription(topic, _TYPE, quality, self._hear(topic)) for topic, quality in _QUALITIES.items()]

    def _hear(self, topic):
        static = topic == "/tf_static"

        def heard(message):
            for each in message["transforms"]:
                header, moved, turn = each["header"], each["transform"]["translation"], each["transform"]["rotation"]
                stamp_ns = header["stamp"]["sec"] * _NS + header["stamp"]["nanosec"]
                numbers = (moved["x"], moved["y"], moved["z"]), (turn["x"], turn["y"], turn["z"], turn["w"])
                if not self.buffer.add(each["child_frame_id"], header["frame_id"], stamp_ns, *numbers, static):
                    text = "a transform from %r to %r on %s makes no sense and is left out: %s"
                    self._here.logger.debug(text, header["frame_id"], each["child_frame_id"], topic, numbers)
            for waiter in list(self.waiters):
                waiter.ring()

        return heard


def transform(target, source, time=None, timeout=2.0):
    """Pose of the frame ``source`` in the frame ``target``, as a :class:`Transform`.

    ``time`` (s) is a time as of :func:`now`; by default it is the newest common time of all frames
    on the path. Waits for a missing transform; the message of :class:`TimedOut` says what is
    missing. The first call subscribes to the transforms.
    """
    here = node()
    heard = here.shared(("transforms",), lambda: _Heard(here))
    stamp_ns = None if time is None else round(float(time) * _NS)
    why = []

    def look():
        here.check()
        try:
            return heard.buffer.find(target, source, stamp_ns)
        except NoTransform as error:
            why[:] = [str(error)]
            return None

    waiter = Waiter(f"the transform from {target} to {source}")
    heard.waiters.add(waiter)
    try:
        found = waiter.until(look, _waits.seconds(timeout, "timeout"))
    finally:
        heard.waiters.discard(waiter)
    if found is None:
        raise TimedOut(f"no transform from {target} to {source} within {timeout} s: {why[0]}")
    return found
