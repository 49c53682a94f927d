"""Back end with the helper process ``rafcon-ros``, for interpreters without ``rclpy``."""

import array
import itertools
import math
import threading

from rafcon.ros._backend import BYTES, TYPE_CODES, BackendLost, Endpoint, Field, MessageType, Qos, RosError
from rafcon.ros._native_actions import ActionClient, ActionServer
from rafcon.ros._native_descriptions import Descriptions
from rafcon.ros._native_frames import nul_in
from rafcon.ros._native_helper import Helper
from rafcon.ros._values import MessageError


class NativeBackend:
    """Node in a separate process, whose crash does not end scripts."""

    name = "native"

    def __init__(self):
        self._helper = None
        self._listener = None
        self._handles = itertools.count(1)
        self._calls = itertools.count(1)
        self._parts = {}
        self._waiting = {}
        self._graph = None
        self._graph_version = 0
        self._lock = threading.Lock()

    @property
    def pid(self):
        """Process id of the helper."""
        return self._helper.pid

    def start(self, settings, listener):
        """Start the helper and create the node."""
        self._listener = listener
        self._helper = Helper(self._heard, self._ended)
        try:
            self._helper.ask(
                "start",
                name=settings.name,
                namespace=settings.namespace,
                domain=settings.domain,
                folders=list(settings.type_folders),
            )
        except RosError:
            self._helper.close()
            raise

    def close(self):
        """End the helper."""
        if self._helper is not None:
            self._helper.close()

    # ---- events of the helper

    def _heard(self, event):
        if "heard" in event:
            self._part(event["heard"], "_hear", event["message"])
        elif "response" in event:
            self._done(event["response"], event["message"], None)
        elif "failed" in event:
            self._done(event["failed"], None, event["why"])
        elif "request" in event:
            self._part(event["request"], "_take", event["number"], event["message"])
        elif "matched" in event:
            self._part(event["matched"], "_count", event["count"])
        elif "changed" in event:
            self._changed()
            self._listener.changed()
        elif "say" in event:
            self._listener.say(event["say"], event["text"])

    def _changed(self):
        with self._lock:
            self._graph = None
            self._graph_version += 1

    def _part(self, handle, what, *arguments):
        with self._lock:
            part = self._parts.get(handle)
        if part is not None:
            getattr(part, what)(*arguments)

    def _done(self, call, response, why):
        with self._lock:
            done = self._waiting.pop(call, None)
        if done is not None:
            done(response, why)

    def _ended(self, why):
        with self._lock:
            waiting, self._waiting = list(self._waiting.values()), {}
            parts, self._parts = list(self._parts.values()), {}
        for done in waiting:
            done(None, why)
        for part in parts:
            part._lost(why)
        self._listener.lost(why)

    # ---- requests to the helper

    def make(self, what, part, **fields):
        """Create an object in the helper, and register its part under a handle."""
        part._handle = handle = next(self._handles)
        with self._lock:
            self._parts[handle] = part
        try:
            self._helper.ask(what, handle=handle, **fields)
        except RosError:
            with self._lock:
                self._parts.pop(handle, None)
            raise
        self._changed()

    def tell(self, what, **fields):
        """Send a command to the helper."""
        self._helper.tell(what, **fields)

    def check(self):
        """Raise :class:`BackendLost` if the helper has ended."""
        self._helper.check()

    def release(self, handle):
        """Release the object of a handle."""
        with self._lock:
            part = self._parts.pop(handle, None)
        self._changed()
        if part is not None:
            try:
                self._helper.tell("close", handle=handle)
            except BackendLost:
                pass

    def call(self, handle, request, done):
        """Send a request; return the number that identifies its response."""
        call = next(self._calls)
        with self._lock:
            self._waiting[call] = done
        try:
            self._helper.tell("call", handle=handle, call=call, message=request)
        except RosError:
            with self._lock:
                self._waiting.pop(call, None)
            raise
        return call

    def at_end(self, handle, request):
        """Let the helper send a request if this process ends before :meth:`not_at_end`.

        Returns the number of the request.
        """
        number = next(self._calls)
        self._helper.tell("at_end", handle=handle, call=number, message=request)
        return number

    def not_at_end(self, number):
        """Cancel :meth:`at_end`."""
        try:
            self._helper.tell("not_at_end", call=number)
        except BackendLost:
            pass

    def forget(self, handle, call):
        """Stop waiting for a response."""
        with self._lock:
            waited = self._waiting.pop(call, None)
        if waited is not None:
            try:
                self._helper.tell("forget", handle=handle, call=call)
            except BackendLost:
                pass

    def describe(self, type_name):
        """Type with all types that it contains, by name."""
        self.check()
        descriptions = Descriptions(self, self._helper.ask, self._listener.say)
        try:
            descriptions.correct(type_name)
            told = self._helper.ask("describe", type=type_name)
        except BackendLost:
            raise
        except RosError as error:
            descriptions.complete(type_name, error)
            told = self._helper.ask("describe", type=type_name)
        return {
            name: MessageType(name, tuple(map(_field, each["fields"])), each["constants"]) for name, each in told.items()
        }

    def publisher(self, topic, type_name, qos):
        """Create a publisher."""
        return _Publisher(self, topic, type_name, qos)

    def subscription(self, topic, type_name, qos, heard):
        """Subscribe to a topic."""
        return Subscription(self, topic, type_name, qos, heard)

    def client(self, service, type_name):
        """Create a client of a service."""
        return Client(self, service, type_name)

    def service(self, name, type_name, asked):
        """Offer a service."""
        return Service(self, name, type_name, asked)

    def action_client(self, action, type_name):
        """Create a client of an action."""
        return ActionClient(self, action, type_name)

    def action_server(self, name, type_name, asked):
        """Offer an action."""
        return ActionServer(self, name, type_name, asked)

    # ---- the graph

    def _known(self):
        with self._lock:
            known, version = self._graph, self._graph_version
        if known is None:
            known = self._helper.ask("graph")
            with self._lock:
                if version == self._graph_version:
                    self._graph = known
        return known

    def _ends_of(self, topic, is_reader):
        return [
            Endpoint(node, type_name, _qos(reliable, latched, 10))
            for name, reads, node, type_name, reliable, latched in self._known()["ends"]
            if name == topic and reads == is_reader
        ]

    def publishers_of(self, topic):
        """Known publishers on a topic."""
        return self._ends_of(topic, False)

    def subscriptions_of(self, topic):
        """Known subscriptions of a topic."""
        return self._ends_of(topic, True)

    def topics(self):
        """All known topics, with their types."""
        found = {}
        for name, _reads, _node, type_name, _reliable, _latched in self._known()["ends"]:
            found.setdefault(name, set()).add(type_name)
        return {name: tuple(sorted(types)) for name, types in sorted(found.items())}

    def services(self):
        """All known services, with their types."""
        return {name: tuple(types) for name, types in self._known()["services"].items()}

    def nodes(self):
        """Names of all known nodes."""
        return list(self._known()["nodes"])


def _field(told):
    name, type_name, kind, size, text_max, default = told
    if isinstance(default, list):
        if type_name in BYTES:
            default = bytes(default)
        elif type_name in TYPE_CODES:
            default = array.array(TYPE_CODES[type_name], default)
    return Field(name, type_name, kind, size, text_max, default)


def _qos(reliable, latched, depth):
    return Qos("reliable" if reliable else "best_effort", "transient_local" if latched else "volatile", depth)


def _refuse_nul(type_name, message):
    place = nul_in(message)
    if place is not None:
        raise MessageError(f"{type_name}{place}: a NUL character cannot be in a text of ROS")


class _Part:
    """Object in the helper."""

    def __init__(self, backend, what, **fields):
        backend.check()
        self._backend = backend
        self._matched = 0
        self._open = True
        backend.make(what, self, **fields)

    def _count(self, count):
        self._matched = count

    def _lost(self, why):
        self._open = False

    def matched(self):
        """Number of matched peers."""
        self._backend.check()
        return self._matched

    def close(self):
        """Release it."""
        if self._open:
            self._open = False
            self._backend.release(self._handle)


def _topic(topic, type_name, qos):
    latched = qos.durability == "transient_local"
    return {"topic": topic, "type": type_name, "reliable": qos.reliability == "reliable", "latched": latched, "depth": qos.depth}


class _Publisher(_Part):
    """Publisher on one topic."""

    def __init__(self, backend, topic, type_name, qos):
        self._type_name = type_name
        _Part.__init__(self, backend, "publisher", **_topic(topic, type_name, qos))

    def publish(self, message):
        """Send a message."""
        _refuse_nul(self._type_name, message)
        self._backend.tell("publish", handle=self._handle, message=message)

    def subscribers(self):
        """Number of matched subscriptions."""
        return self.matched()


class Subscription(_Part):
    """Subscription of one topic."""

    def __init__(self, backend, topic, type_name, qos, heard):
        self._heard = heard
        _Part.__init__(self, backend, "subscription", **_topic(topic, type_name, qos))

    def _hear(self, message):
        if self._open:
            self._heard(message)

    def publishers(self):
        """Number of matched publishers."""
        return self.matched()


class Client(_Part):
    """Client of one service."""

    def __init__(self, backend, service, type_name):
        self._type_name = type_name
        _Part.__init__(self, backend, "client", service=service, type=type_name)

    def servers(self, sent_s=math.inf):
        """``{None}`` if a server is matched, else an empty set.

        The helper itself fails calls to servers that have ended.
        """
        return {None} if self.matched() else set()

    def send(self, request, done):
        """Send a request."""
        _refuse_nul(self._type_name + "_Request", request)
        pending = _Pending(self._backend, self._handle, done)
        pending.call = self._backend.call(self._handle, request, pending._come)
        return pending


class _Pending:
    """Request that was sent."""

    def __init__(self, backend, handle, done):
        self.call = None
        self._backend = backend
        self._handle = handle
        self._done = done
        self._open = True

    def _come(self, response, why):
        if self._open:
            self._open = False
            self._done(response, why)

    def close(self):
        """Stop waiting for the response."""
        if self._open:
            self._open = False
            self._backend.forget(self._handle, self.call)


class Service(_Part):
    """Server of a service."""

    def __init__(self, backend, name, type_name, asked):
        self._asked = asked
        self._type_name = type_name
        _Part.__init__(self, backend, "service", service=name, type=type_name)

    def _take(self, number, message):
        if self._open:
            self._asked(_Request(self, number, message))

    def _answer(self, number, response):
        _refuse_nul(self._type_name + "_Response", response)
        self._backend.tell("respond", handle=self._handle, number=number, message=response)


class _Request:
    """Received request."""

    def __init__(self, service, number, request):
        self.request = request
        self._service = service
        self._number = number

    def answer(self, response):
        """Send the response."""
        self._service._answer(self._number, response)
