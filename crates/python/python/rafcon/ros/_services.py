"""Services: clients and servers."""

import collections
import math
import time

from rafcon.ros import _waits
from rafcon.ros._backend import RosError
from rafcon.ros._gate import Gate
from rafcon.ros._message import Message
from rafcon.ros._node import FIND_S, node
from rafcon.ros._types import full_name
from rafcon.ros._waits import LOOK_EVERY_S, TimedOut, Waiter
from rafcon.ros._worker import Worker

#: Delay (s) before a vanished server ends the wait: some restart at once.
GONE_S = 0.3
#: Age (s) up to which a found server still counts as present.
_FOUND_S = 0.5
_REQUESTS_MAX = 1000


class NoServer(RosError):
    """The service or action has no server, or its server has ended."""


def call(service, request=None, type=None, timeout=10.0, find=FIND_S):
    """Call a service; return the response as a :class:`Message`.

    The default ``type`` is that of the service. ``find`` is the timeout (s) for finding a server.
    At the start of a run it is extended, until the node has discovered all others.
    :class:`NoServer` is raised if it expires, or if the server ends during the call.
    :class:`TimedOut` is raised if no response arrives within ``timeout`` (s).
    """
    here = node()
    service = here.absolute(service)
    type_name = full_name(type, "srv") if type is not None else type_of_service(here, service, find)
    here.types.require(type_name)
    values = here.types.build(type_name + "_Request", request)
    client = here.shared(("client", service, type_name), lambda: here.backend.client(service, type_name))
    waiter = Waiter(f"the service {service}")
    find_server(here, waiter, client, "service", service, find)
    gate = here.shared(("gate", service), Gate)
    response = _Call(here, client, waiter, gate).result(service, values, timeout)
    return Message.of(type_name + "_Response", here.types, response)


def type_of_service(here, service, find):
    """Find the type of a service; wait until it is known."""
    look = lambda: here.backend.services().get(service, ())  # noqa: E731
    known = here.shared(("types of", service), dict)
    if not known:
        found = Waiter(f"the service {service}").until(look, here.find_s(_waits.seconds(find, "find")), LOOK_EVERY_S)
        if not found:
            raise NoServer(f"nobody offers the service {service} (looked for {find} s): start its node, or correct the name")
        if len(set(found)) > 1:
            raise RosError(f"the service {service} has several types, {' and '.join(sorted(set(found)))}; say which is meant: type=…")
        known["type"] = found[0]
    return known["type"]


def find_server(here, waiter, client, kind, name, find):
    """Wait for a server; :class:`NoServer` if there is none.

    A server found within the last 0.5 s is not checked again, because that takes longer than a
    call.
    """
    found = here.shared(("found", kind, name), dict)
    if time.monotonic() - found.get("at_s", -_FOUND_S) < _FOUND_S:
        return

    def look():
        here.check()
        return client.servers()

    if not look() and not waiter.until(look, here.find_s(_waits.seconds(find, "find")), LOOK_EVERY_S):
        raise NoServer(f"nobody offers the {kind} {name} (looked for {find} s): start its node, or correct the name")
    found["at_s"] = time.monotonic()


class Gone:
    """Detects that all servers of a request have been missing for a while.

    A server that started later does not respond to the request.
    """

    def __init__(self, client):
        self._client = client
        self._sent_s = math.inf
        self._had = {None}
        self._looked_s = time.monotonic()
        self._since_s = None

    def sent(self):
        """Note that the request is sent now."""
        self._sent_s = time.monotonic()
        self._had = {None}

    def __call__(self):
        """True if none of the servers has been available for 0.3 s."""
        now_s = time.monotonic()
        if now_s - self._looked_s < LOOK_EVERY_S:
            return False
        self._looked_s = now_s
        alive = self._client.servers(self._sent_s)
        if None in self._had and alive:
            self._had = alive
        if None in alive or self._had & alive:
            self._since_s = None
            return False
        self._since_s = now_s if self._since_s is None else self._since_s
        return now_s - self._since_s >= GONE_S


class _Call:
    """Service call."""

    def __init__(self, here, client, waiter, gate):
        self._here = here
        self._client = client
        self._waiter = waiter
        self._gate = gate
        self._pending = None
        self._answers = collections.deque(maxlen=1)
        self._gone = Gone(client)

    def result(self, service, values, timeout):
        """Send the request; return the response."""
        key = self._gate.submit(lambda: self._send(values))
        try:
            answer = self._waiter.until(self._come, _waits.seconds(timeout, "timeout"), LOOK_EVERY_S)
        finally:
            self._gate.answered(key)
            if self._pending is not None:
                self._pending.close()
        if not answer:
            raise TimedOut(f"the service {service} has not answered within {timeout} s")
        response, why = answer
        if response is None:
            raise NoServer(f"the service {service}: {why}")
        return response

    def _send(self, values):
        # Another call's thread may open the gate, so report errors to this call.
        self._gone.sent()
        try:
            self._pending = self._client.send(values, self._done)
        except RosError as error:
            self._done(None, str(error))

    def _done(self, response, why):
        self._answers.append((response, why))
        self._waiter.ring()

    def _come(self):
        if self._answers:
            return self._answers[0]
        self._here.check()
        self._gate.pump()
        return (None, "its server has ended") if self._gone() else None


class Server:
    """Offers a service or an action until ``close``, or until the run ends. ``with`` closes it."""

    def __init__(self, name):
        self.name = name
        self._offered = None
        self._worker = None

    def close(self):
        """Stop offering it."""
        if self._offered is not None:
            self._offered.close()
        if self._worker is not None:
            self._worker.close()

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        self.close()


def serve(service, callback, type):
    """Offer a service; return a :class:`Server`.

    ``callback(request)`` returns the response, as a mapping or a :class:`Message`. It is called on
    a thread of its own. If it raises, the error is logged. If the response has a field ``success``,
    False is sent, with the error in ``message``. Otherwise the caller gets no response.
    """
    here = node()
    server = Server(here.absolute(service))
    type_name = full_name(type, "srv")
    here.types.require(type_name)

    def answer(request):
        message = Message.of(type_name + "_Request", here.types, request.request)
        try:
            response = here.types.build(type_name + "_Response", callback(message))
        except Exception as error:
            here.logger.exception("the callback of the service %s failed", server.name)
            names = [field.name for field in here.types.get(type_name + "_Response").fields]
            if "success" not in names:
                return
            said = {"success": False, **({"message": f"{error.__class__.__name__}: {error}"} if "message" in names else {})}
            response = here.types.build(type_name + "_Response", said)
        request.answer(response)

    server._worker = Worker(f"ros {server.name}", answer, _REQUESTS_MAX)
    server._offered = here.backend.service(server.name, type_name, server._worker.put)
    return server
