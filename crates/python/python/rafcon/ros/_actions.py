"""Action clients: goals are sent, awaited, and cancelled if their state is preempted."""

import collections
import threading
import time
from dataclasses import dataclass
from typing import Any

from rafcon.ros import _backend, _waits
from rafcon.ros._backend import RosError
from rafcon.ros._gate import Gate
from rafcon.ros._message import Message
from rafcon.ros._node import FIND_S, node
from rafcon.ros._services import Gone, NoServer, find_server
from rafcon.ros._types import full_name
from rafcon.ros._waits import LOOK_EVERY_S, Waiter

#: Timeout (s) for the acceptance of a goal.
_ACCEPT_S = 5.0
#: Time (s) that a preempted state waits for the end of its goal.
CANCEL_WAIT_S = 2.0
#: Timeout (s) of the result after the end of its goal; megabytes take seconds on a busy computer.
_RESULT_S = 10.0
#: Interval (s) of retries for an unanswered cancellation.
_CANCEL_AGAIN_S = 0.5
#: Responses to a cancellation.
_REFUSED, _UNKNOWN = 1, 2
#: Minimum interval (s) of feedback in the log.
_LOG_EVERY_S = 1.0

_OUTCOMES = {_backend.SUCCEEDED: "succeeded", _backend.CANCELED: "canceled", _backend.ABORTED: "aborted"}


@dataclass(frozen=True)
class ActionResult:
    """Result of a goal."""

    #: ``succeeded``, ``aborted``, ``canceled``, ``rejected`` or ``timed_out``.
    outcome: str
    #: The result, a :class:`Message`; None if none came.
    result: Any = None
    #: The last feedback, a :class:`Message`, or None.
    feedback: Any = None
    #: Reason, if the outcome alone does not explain the end.
    why: str = ""


class _SentGoal:
    """Goal that was sent; the back end calls the callback methods on its thread."""

    def __init__(self, here, name):
        self._here = here
        self._name = name
        self._sends, self._cancels = (here.shared(("gate", name, what), Gate) for what in ("send", "cancel"))
        self._send_key = self._cancel_key = None
        self._cancel_sent_s = None
        self._open = _open_goals(here)
        self._open.add(self)
        self._waiter = None
        self._feedback_waiting = collections.deque(maxlen=1)
        self._unwanted = False
        self.goal = None
        self.is_accepted = False
        self.last_feedback = None
        self.cancel_answer = None
        #: (status, values) at the end; status 0 is a rejection, and None a failure with a text as values.
        self.end = None
        #: Final state and its time of arrival, from the topic of states.
        self.told = None

    def send(self, client, values):
        """Send the goal, as soon as the gate admits it."""

        def start():
            # Another goal's thread may open the gate, so report errors to this goal.
            try:
                if self.end is None and not self._unwanted:
                    self.goal = client.send(values, self)
                else:
                    self.failed("it was not wanted any more")
            except RosError as error:
                self.failed(str(error))

        self._send_key = self._sends.submit(start)

    def pump(self):
        """Send waiting requests that the gate admits; repeat an unanswered cancellation."""
        self._sends.pump()
        self._cancels.pump()
        unanswered = self._cancel_sent_s is not None and self.cancel_answer is None
        if unanswered and self.is_accepted and time.monotonic() - self._cancel_sent_s >= _CANCEL_AGAIN_S:
            self._cancels.answered(self._cancel_key)
            self._send_cancel()

    def accepted(self):
        """Handle the acceptance by the server."""
        self.is_accepted = True
        self._open.tell()
        self._sends.answered(self._send_key)
        if self._unwanted:
            self._send_cancel()
        self._ring()

    def rejected(self):
        """Handle the rejection by the server."""
        self._finish((0, None))

    def feedback(self, message):
        """Store feedback of the server."""
        self.last_feedback = message
        self._feedback_waiting.append(message)
        self._ring()

    def status(self, status):
        """Handle a state of the goal from the topic of states."""
        if status in _OUTCOMES and self.told is None:
            self.told = status, time.monotonic()
            self._ring()

    def result(self, status, message):
        """Handle the end of the goal."""
        self._finish((status, message))

    def failed(self, why):
        """Handle a failure on this side; no other callbacks follow."""
        self._finish((None, why))

    def _finish(self, end):
        self.end = end
        self._open.discard(self)
        self._sends.answered(self._send_key)
        self._cancels.answered(self._cancel_key)
        self._ring()

    def _ring(self):
        waiter = self._waiter
        if waiter is not None:
            waiter.ring()

    def wait_with(self, waiter):
        """Set the waiter that is woken by events."""
        self._waiter = waiter

    def take_feedback(self):
        """Newest feedback that has not been taken, or None."""
        try:
            return self._feedback_waiting.popleft()
        except IndexError:
            return None

    def cancel(self):
        """Request cancellation from the server; repeated when the goal is accepted later."""
        self._unwanted = True
        self._send_cancel()

    def _send_cancel(self):
        self._cancel_key = self._cancels.submit(self._pass_cancel)

    def _pass_cancel(self):
        self._cancel_sent_s = time.monotonic()
        # Also during shutdown of the node: its back end stays until the last goal is cancelled.
        if self.goal is not None and self.end is None:
            try:
                self.goal.cancel(self._cancelled)
            except RosError as error:
                self._here.logger.debug("%s: %s", self._name, error)

    def _cancelled(self, code, why):
        self._cancels.answered(self._cancel_key)
        if code == _UNKNOWN and not self.is_accepted:
            return
        self.cancel_answer = code, why
        if code == _REFUSED:
            self._here.logger.warning("%s: the server refuses to cancel its goal", self._name)
        self._ring()

    def leave(self):
        """Stop waiting: cancel a goal that has not ended, at the latest when it is accepted."""
        self._waiter = None
        if self.end is None and not self._unwanted:
            self.cancel()

    def ended(self):
        """True if the end is known, with its result or after the timeout of the result."""
        self._here.check()
        self.pump()
        if self.end is not None:
            return True
        return self.told is not None and time.monotonic() - self.told[1] >= _RESULT_S


def _open_goals(here):
    """Goals whose end is not known."""
    return here.shared(("open goals",), lambda: _OpenGoals(here))


class _OpenGoals:
    """Thread-safe set of goals."""

    def __init__(self, here):
        self._goals = set()
        here.closers["goals"] = self.close
        self._lock = threading.Lock()
        self._changed = threading.Condition(self._lock)

    def add(self, goal):
        """Add a goal."""
        with self._lock:
            self._goals.add(goal)

    def discard(self, goal):
        """Remove a goal."""
        with self._changed:
            self._goals.discard(goal)
            self._changed.notify_all()

    def tell(self):
        """Wake waiting threads, because a goal was accepted."""
        with self._changed:
            self._changed.notify_all()

    def close(self):
        """Cancel all goals at the end of the run and wait for their ends, at most 7 s.

        The wait includes the time for a server to accept a goal.
        """
        with self._changed:
            goals = list(self._goals)
            for goal in goals:
                if goal.goal is not None:
                    goal._unwanted = True
                    goal.goal.cancel(goal._cancelled)
            if goals and not self._end(CANCEL_WAIT_S) and self._undecided():
                self._changed.wait_for(lambda: not self._undecided(), _ACCEPT_S - CANCEL_WAIT_S)
                self._end(CANCEL_WAIT_S)

    def _end(self, seconds):
        return self._changed.wait_for(lambda: not self._goals, seconds)

    def _undecided(self):
        return any(goal.goal is not None and not goal.is_accepted for goal in self._goals)


def action(name, goal=None, type=None, timeout=None, feedback=None, cancel_wait_s=CANCEL_WAIT_S, find=FIND_S, accept=_ACCEPT_S):
    """Send a goal and wait for its end; return an :class:`ActionResult`.

    The default ``type`` is that of the action. ``find`` (s) is the timeout for finding a server,
    ``accept`` (s) that for the acceptance of the goal, and ``timeout`` (s) that for its end. If one
    of them expires, the outcome is *timed_out*. If the server ends before the goal, the outcome is
    *aborted*. ``feedback(message)`` is called with the newest feedback, on the thread of the
    script; feedback is also logged.

    If the state is preempted, the goal is cancelled, its end is awaited for up to ``cancel_wait_s``
    (s), and :class:`~rafcon.core.custom_exceptions.StatePreempted` is raised. A goal that is
    accepted after that, or after a *timed_out*, is cancelled as well.
    """
    here = node()
    name = here.absolute(name)
    timeout, find, accept = (_waits.seconds(each, word) for each, word in ((timeout, "timeout"), (find, "find"), (accept, "accept")))
    cancel_wait_s = _waits.seconds(cancel_wait_s, "cancel_wait_s")
    try:
        type_name = full_name(type, "action") if type is not None else type_of_action(here, name, find)
        here.types.require(type_name)
        values = here.types.build(type_name + "_Goal", goal)
        client = here.shared(("action client", name, type_name), lambda: here.backend.action_client(name, type_name))
        waiter = Waiter(f"the action {name}")
        find_server(here, waiter, client, "action", name, find)
    except NoServer as error:
        return _logged(here, ActionResult("timed_out", why=str(error)))
    running = _Running(here, name, type_name, client, waiter, feedback)
    return _logged(here, running.run(values, timeout, accept, cancel_wait_s))


def _logged(here, result):
    if result.why:
        here.logger.warning("%s: %s", result.outcome, result.why)
    return result


class _Running:
    """Call of :func:`action`."""

    def __init__(self, here, name, type_name, client, waiter, feedback):
        self._here = here
        self._name = name
        self._type_name = type_name
        self._waiter = waiter
        self._feedback = feedback
        self._gone = Gone(client)
        self._client = client
        self._logged_s = -_LOG_EVERY_S
        self._sent = _SentGoal(here, name)

    def run(self, values, timeout, accept, cancel_wait_s):
        """Send the goal and follow it to its end; return an :class:`ActionResult`."""
        sent = self._sent
        sent.wait_with(self._waiter)
        end_s = None if timeout is None else time.monotonic() + timeout
        try:
            self._gone.sent()
            sent.send(self._client, values)
            accept = accept if timeout is None else timeout if accept is None else min(accept, timeout)
            if not self._waiter.until(self._answered, accept, LOOK_EVERY_S):
                return self._too_late(f"its server has not accepted the goal within {accept} s", 0)
            left_s = None if end_s is None else max(end_s - time.monotonic(), 0)
            if not self._waiter.until(self._over, left_s, LOOK_EVERY_S):
                return self._too_late(f"the goal has not ended within {timeout} s", cancel_wait_s)
            return self._result()
        except BaseException:
            self._cancel(cancel_wait_s)
            raise
        finally:
            sent.leave()

    def _answered(self):
        return self._sent.is_accepted or self._over()

    def _over(self):
        message = self._sent.take_feedback()
        if message is not None:
            self._tell(message)
        return self._sent.ended() or self._gone()

    def _tell(self, values):
        message = self._message("Feedback", values)
        now_s = time.monotonic()
        if now_s - self._logged_s >= _LOG_EVERY_S:
            self._logged_s = now_s
            self._here.logger.info("%s: %s", self._name, message)
        if self._feedback is not None:
            self._feedback(message)

    def _message(self, part, values):
        return None if values is None else Message.of(f"{self._type_name}_{part}", self._here.types, values)

    def _cancel(self, wait_s):
        """Cancel the goal and wait for its end; preemption does not end the wait."""
        self._sent.cancel()
        self._waiter.heed(False)
        try:
            self._waiter.until(lambda: self._sent.ended() or self._gone(), wait_s, LOOK_EVERY_S)
        except RosError as error:
            self._here.logger.debug("%s: %s", self._name, error)

    def _too_late(self, why, wait_s):
        heeded = self._waiter.heeding()
        self._cancel(wait_s)
        if self._sent.end is not None and self._sent.end[0] == _backend.SUCCEEDED:
            return self._result()
        self._waiter.heed(heeded)
        if self._waiter.preempted():
            raise self._waiter.preemption()
        result = self._sent.end[1] if self._sent.end and self._sent.end[0] else None
        return ActionResult("timed_out", self._message("Result", result), self._last(), f"{self._name}: {why}")

    def _last(self):
        return self._message("Feedback", self._sent.last_feedback)

    def _result(self):
        sent = self._sent
        if sent.end is None and sent.told is not None:
            why = f"{self._name}: the goal has ended, and its server has sent no result"
            return ActionResult(_OUTCOMES[sent.told[0]], None, self._last(), why)
        if sent.end is None:
            return ActionResult("aborted", None, self._last(), f"{self._name}: its server has ended")
        status, values = sent.end
        if status == 0:
            return ActionResult("rejected", None, None, f"{self._name}: its server rejected the goal")
        if status is None:
            return ActionResult("aborted", None, self._last(), f"{self._name}: {values}")
        if status not in _OUTCOMES:
            return ActionResult("aborted", None, self._last(), f"{self._name}: its server does not know the goal any more")
        return ActionResult(_OUTCOMES[status], self._message("Result", values), self._last())


def type_of_action(here, name, find):
    """Find the type of an action; wait until it is known."""
    end = "/_action/send_goal"

    def look():
        return [each[: -len("_SendGoal")] for each in here.backend.services().get(name + end, ()) if each.endswith("_SendGoal")]

    known = here.shared(("types of", name + end), dict)
    if not known:
        found = sorted(set(Waiter(f"the action {name}").until(look, here.find_s(find), LOOK_EVERY_S) or ()))
        if not found:
            raise NoServer(f"nobody offers the action {name} (looked for {find} s): start its node, or correct the name")
        if len(found) > 1:
            raise RosError(f"the action {name} has several types, {' and '.join(found)}; say which is meant: type=…")
        known["type"] = found[0]
    return known["type"]
