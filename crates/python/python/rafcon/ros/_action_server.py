"""Action servers for scripts."""

import threading

from rafcon.ros import _backend
from rafcon.ros._message import Message
from rafcon.ros._node import node
from rafcon.ros._services import Server
from rafcon.ros._types import full_name


class ReceivedGoal:
    """Goal received from a client; the callback of :func:`action_server` processes it."""

    def __init__(self, here, type_name, received):
        self._here = here
        self._type_name = type_name
        self._received = received
        self._canceling = threading.Event()
        #: The goal, a :class:`Message`.
        self.goal = Message.of(type_name + "_Goal", here.types, received.goal)

    @property
    def canceled(self):
        """True if the client has requested cancellation; the callback should then return soon."""
        return self._canceling.is_set()

    def wait(self, seconds):
        """Wait; True as soon as the client requests cancellation, False after the time (s)."""
        return self._canceling.wait(seconds)

    def feedback(self, message=None, **fields):
        """Send feedback to the client."""
        name = self._type_name + "_Feedback"
        self._received.feedback(self._here.types.build(name, {**(message or {}), **fields} if fields else message))

    def _cancel(self):
        self._canceling.set()
        return True


class ActionServer(Server):
    """Offers an action until ``close``, or until the run ends. ``with`` closes it."""

    def __init__(self, name):
        Server.__init__(self, name)
        self._at_work = 0
        self._changed = threading.Condition()

    def work(self, *arguments):
        """Process a received goal; its end has been sent when this returns."""
        self._count(1)
        try:
            _work(*arguments)
        finally:
            self._count(-1)

    def _count(self, more):
        with self._changed:
            self._at_work += more
            self._changed.notify_all()

    def join(self, timeout=None):
        """Wait until the ends of all goals have been sent; False if the timeout (s) expired."""
        with self._changed:
            return self._changed.wait_for(lambda: self._at_work == 0, timeout)


class GoalAborted(Exception):
    """Raised by the callback of an action: the goal ends as *aborted*, with ``result``."""

    def __init__(self, why="", result=None):
        Exception.__init__(self, why)
        self.result = result


def action_server(action, callback, type, accept=None):
    """Offer an action; return an :class:`ActionServer`.

    ``callback(goal)`` processes a :class:`ReceivedGoal` and returns its result. Each goal has a
    thread of its own. Returning after ``goal.canceled`` became True ends the goal as *canceled*,
    otherwise as *succeeded*. :class:`GoalAborted`, or any other exception, ends it as *aborted*.
    ``accept(goal)`` returns True to accept a goal (a :class:`Message`); by default all are
    accepted.
    """
    here = node()
    server = ActionServer(here.absolute(action))
    type_name = full_name(type, "action")
    here.types.require(type_name)

    def asked(received):
        goal = ReceivedGoal(here, type_name, received)
        threading.Thread(target=server.work, args=(here, server.name, goal, callback, accept), name=f"ros {server.name}", daemon=True).start()

    server._offered = here.backend.action_server(server.name, type_name, asked)
    return server


def _work(here, name, goal, callback, accept):
    received = goal._received
    try:
        wanted = accept is None or accept(goal.goal)
    except Exception:
        here.logger.exception("%s: `accept` failed, so the goal is rejected", name)
        wanted = False
    if not wanted:
        received.reject()
        return
    received.accept(goal._cancel)
    result_type = goal._type_name + "_Result"
    try:
        result = here.types.build(result_type, callback(goal))
        status = _backend.CANCELED if goal.canceled else _backend.SUCCEEDED
    except GoalAborted as aborted:
        here.logger.warning("%s: the goal is aborted: %s", name, aborted)
        result, status = here.types.build(result_type, aborted.result), _backend.ABORTED
    except Exception:
        here.logger.exception("%s: the callback failed, so the goal is aborted", name)
        result, status = here.types.build(result_type), _backend.ABORTED
    if here.ended is None:
        received.finish(status, result)
