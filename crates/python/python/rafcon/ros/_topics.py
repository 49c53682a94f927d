"""Topics: publishers, and subscriptions to every message, the newest or the next that fits."""

import collections
import threading

from rafcon import _objects
from rafcon.ros import _waits
from rafcon.ros._backend import Qos, RosError
from rafcon.ros._message import Message
from rafcon.ros._node import node
from rafcon.ros._types import full_name, is_ros_object
from rafcon.ros._waits import LOOK_EVERY_S, TimedOut, Waiter
from rafcon.ros._worker import Worker

#: Time (s) that a new publisher waits for a subscriber.
_MATCH_S = 1.0
#: Interval (s) of checks for a subscriber.
_NEAR_S = 0.01
#: Capacity of the queue for a slow reader; the oldest messages are dropped.
_QUEUE_MAX = 1000

_QOS = {
    "default": Qos(),
    "latched": Qos(durability="transient_local", depth=1),
    "sensor": Qos(reliability="best_effort", depth=5),
}


def qos(value, default="default"):
    """Convert a name, depth or mapping to a quality of service; one is returned unchanged."""
    if value is None:
        value = default
    if isinstance(value, Qos):
        return value
    if isinstance(value, str) and value in _QOS:
        return _QOS[value]
    if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
        return Qos(depth=value)
    if isinstance(value, dict) and set(value) <= set(Qos._fields):
        return _checked_qos(Qos(**value))
    raise RosError(f"{value!r} is no quality of service; write one of {', '.join(_QOS)}, a depth, or a ros.Qos")


def _checked_qos(made):
    if made.reliability not in ("reliable", "best_effort") or made.durability not in ("volatile", "transient_local"):
        raise RosError(f"{made} is no quality of service; reliability is reliable or best_effort, durability volatile or transient_local")
    return made


def publish(topic, message=None, type=None, qos=None, wait=_MATCH_S):
    """Publish a message; the publisher is kept for the next one.

    ``message`` is a mapping, a :class:`Message`, an object of ROS, or for a type with one field its
    value: ``publish("/chatter", "hello", "std_msgs/String")``. The default ``type`` is that of the
    message, or the one that others use on the topic. A new publisher waits up to ``wait`` (s) for a
    subscription. At the start of a run it waits until its node has discovered all others (3.5 s),
    because the first message would be lost.
    """
    here = node()
    topic = here.absolute(topic)
    type_name = _type_of(here, topic, type, message, wait)
    values = here.types.build(type_name, message)
    made = _quality_of(qos)
    publisher = here.shared(("publisher", topic, type_name, made), lambda: _Published(here, topic, type_name, made))
    publisher.publish(values, wait)


class _Published:
    """Publisher that all states share."""

    def __init__(self, here, topic, type_name, quality):
        self._here = here
        self._publisher = here.backend.publisher(topic, type_name, quality)
        self._topic = topic
        self._type_name = type_name
        self._new = True
        _warn_of_other_types(here, topic, type_name, here.backend.subscriptions_of(topic))

    def publish(self, values, wait):
        """Send a message."""
        if self._new:
            waiter = Waiter(f"somebody who hears {self._topic}")
            wait = self._here.find_s(_waits.seconds(wait, "wait"), _MATCH_S)
            waiter.until(self._publisher.subscribers, wait, _NEAR_S)
            self._new = False
        self._publisher.publish(values)


def _type_of(here, topic, given, message, timeout):
    """Full name of the type for a topic."""
    if given is not None:
        return full_name(given)
    if isinstance(message, Message):
        return message._type_name
    if is_ros_object(message):
        return full_name(message)
    return type_on(here, topic, timeout)


def type_on(here, topic, timeout):
    """Find the type that others use on a topic; wait until it is known."""

    def look():
        known = here.backend.topics().get(topic, ())
        return known or [each.type_name for each in here.backend.publishers_of(topic) + here.backend.subscriptions_of(topic)]

    known = sorted(set(Waiter(f"the type of {topic}").until(look, timeout, LOOK_EVERY_S) or ()))
    if not known:
        raise TimedOut(f"nobody uses the topic {topic}, so its type is not known; give it: type=\"package/Name\"")
    if len(known) > 1:
        raise RosError(f"the topic {topic} has several types, {' and '.join(known)}; say which is meant: type=\"{known[0]}\"")
    return known[0]


def _warn_of_other_types(here, topic, type_name, endpoints):
    others = sorted({(each.type_name, each.node) for each in endpoints if each.type_name != type_name})
    for other, owner in others:
        here.logger.warning("%s is used as %s here and as %s by %s: the two do not hear each other", topic, type_name, other, owner or "another node")


def unfit_publishers(here, topic, quality):
    """Describe publishers whose quality of service does not match; empty if there are none."""
    words = []
    for each in here.backend.publishers_of(topic):
        owner = each.node or "another node"
        if quality.reliability == "reliable" and each.qos.reliability == "best_effort":
            words.append(f"{owner} publishes with best effort, and this subscription is reliable")
        if quality.durability == "transient_local" and each.qos.durability == "volatile":
            words.append(f"{owner} keeps no messages, and this subscription is latched")
    return "; ".join(sorted(set(words))) + ": leave `qos` out" if words else ""


def heard_quality(here, topic, value):
    """Quality of service of a subscription: ``value``, or one that all publishers match."""
    if value is not None:
        return qos(value)
    publishers = here.backend.publishers_of(topic)
    best_effort = any(each.qos.reliability == "best_effort" for each in publishers)
    latched = publishers and all(each.qos.durability == "transient_local" for each in publishers)
    return Qos("best_effort" if best_effort else "reliable", "transient_local" if latched else "volatile", 10)


#: :func:`qos` under a name that no parameter shadows.
_quality_of = qos


class Subscription:
    """Receives messages of a topic until ``close``; :func:`subscribe` creates it.

    ``with`` closes it.
    """

    def __init__(self, here, topic, type_name, callback, quality):
        self.topic = topic
        self.type_name = type_name
        self._here = here
        self._quality = quality
        self._messages = collections.deque(maxlen=quality.depth or _QUEUE_MAX)
        self._waiters = set()
        self._lock = threading.Lock()
        self._closed = False
        self._worker = None if callback is None else Worker(f"ros {topic}", callback, _QUEUE_MAX)
        self.latest = None
        here.types.require(type_name)
        _warn_of_other_types(here, topic, type_name, here.backend.publishers_of(topic))
        self._subscription = here.backend.subscription(topic, type_name, quality, self._hear)

    def _hear(self, values):
        message = Message.of(self.type_name, self._here.types, values)
        with self._lock:
            if self._closed:
                return
            self.latest = message
            if self._worker is None:
                self._messages.append(message)
            waiters = list(self._waiters)
        if self._worker is not None:
            self._worker.put(message)
        for waiter in waiters:
            waiter.ring()

    def next(self, timeout=10.0, condition=None):
        """Next message for which ``condition(message)`` is true; :class:`TimedOut` if none comes.

        Messages received since the last call are queued, up to the depth of the quality of service.
        Not available with a callback.
        """
        if self._worker is not None:
            raise RosError(f"the messages of {self.topic} go to the callback of this subscription, so none is left to wait for")
        waiter = Waiter(f"a message on {self.topic}")
        with self._lock:
            self._waiters.add(waiter)
        try:
            message = waiter.until(lambda: self._taken(condition), _waits.seconds(timeout, "timeout"))
        finally:
            with self._lock:
                self._waiters.discard(waiter)
        if message is None:
            unfit = unfit_publishers(self._here, self.topic, self._quality)
            what = f"no message{' that fits' if condition else ''} came on {self.topic} ({self.type_name}) in {timeout} s"
            raise TimedOut(f"{what}: {unfit}" if unfit else what)
        return message

    def _taken(self, condition):
        while self._messages:
            try:
                message = self._messages.popleft()
            except IndexError:
                break
            if condition is None or condition(message):
                return message
        self._here.check()
        if self._closed:
            raise RosError(f"this subscription of {self.topic} is closed")
        return None

    def publishers(self):
        """Number of matched publishers."""
        return self._subscription.publishers()

    def close(self):
        """End the subscription."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            waiters = list(self._waiters)
        if self._here.ended is None:
            self._subscription.close()
        if self._worker is not None:
            self._worker.close()
        for waiter in waiters:
            waiter.ring()

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        self.close()


def subscribe(topic, type=None, callback=None, qos=None, timeout=10.0):
    """Subscribe to a topic; return a :class:`Subscription`.

    With a ``callback``, it is called with each message, on a thread of its own. Without one,
    ``next`` returns the messages. The default ``type`` is the one that others use on the topic; it
    is awaited for up to ``timeout`` (s).

    The subscription ends by ``close()``, with the run, or when its state subscribes to the topic in
    its next run. So a script that does not close it leaves one subscription, not one per run.
    """
    here = node()
    topic = here.absolute(topic)
    type_name = full_name(type) if type is not None else type_on(here, topic, timeout)
    made = Subscription(here, topic, type_name, callback, heard_quality(here, topic, qos))
    _replace_earlier(here, made)
    return made


def _replace_earlier(here, made):
    state = _objects.current_state()
    if state is None:
        return
    owned = here.shared(("subscriptions of", state.get_path()), dict)
    run = state._live()["run_count"]
    earlier_run, earlier = owned.get(made.topic, (run, []))
    for each in earlier if earlier_run != run else ():
        each.close()
    owned[made.topic] = run, [*(earlier if earlier_run == run else ()), made]


def latest(topic, type=None, timeout=1.0, qos=None):
    """Newest message of a topic, or None if none arrives within ``timeout`` (s).

    The first call subscribes to the topic. Later calls only wait while there is no message at all.
    """
    here = node()
    topic = here.absolute(topic)
    try:
        type_name = full_name(type) if type is not None else here.shared(("type", topic), lambda: type_on(here, topic, timeout))
    except TimedOut:
        return None
    quality = _quality_of(qos) if qos is not None else None
    key = "latest", topic, type_name, quality
    heard = here.shared(key, lambda: Subscription(here, topic, type_name, None, heard_quality(here, topic, quality)._replace(depth=1)))
    if heard.latest is None:
        waiter = Waiter(f"a message on {topic}")
        with heard._lock:
            heard._waiters.add(waiter)
        try:
            waiter.until(lambda: heard.latest is not None, _waits.seconds(timeout, "timeout"))
        finally:
            with heard._lock:
                heard._waiters.discard(waiter)
    here.check()
    if heard.latest is None:
        unfit = unfit_publishers(here, topic, heard._quality)
        if unfit:
            here.logger.warning("no message received on %s: %s", topic, unfit)
    return None if heard.latest is None else heard.latest.__deepcopy__(None)


def wait_for(topic, type=None, condition=None, timeout=10.0, qos=None):
    """Next message of a topic for which ``condition(message)`` is true.

    Raises :class:`TimedOut` if none arrives. Messages sent before the call only count on a latched
    topic.
    """
    here = node()
    topic = here.absolute(topic)
    timeout = _waits.seconds(timeout, "timeout")
    type_name = full_name(type) if type is not None else type_on(here, topic, timeout)
    quality = heard_quality(here, topic, qos)
    with Subscription(here, topic, type_name, None, quality) as heard:
        return heard.next(timeout, condition)
