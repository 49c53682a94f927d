"""Actions built from services and topics, as ROS 2 does it."""

import math
import threading
import time
import uuid

from rafcon.ros import _backend
from rafcon.ros._backend import BackendLost, Qos

_FEEDBACK = Qos("reliable", "volatile", 100)
_STATES = Qos("reliable", "transient_local", 1)
_CANCEL = "action_msgs/srv/CancelGoal"
_STATUS = "action_msgs/msg/GoalStatusArray"
_NOW = {"sec": 0, "nanosec": 0}
#: Lifetime (s) of results.
_KEPT_S = 900.0
#: Maximum number of kept results of ended goals; the oldest is dropped for a new one.
_KEPT_MAX = 1000
#: Timeout (s) of a closing server, from the end of a goal until a client requests the result.
_TAKEN_S = 0.5
#: Time (s) that an ended goal stays in the list of states.
_LISTED_S = 10.0
#: Responses to a cancellation.
_CANCELS, _REFUSED, _UNKNOWN, _ENDED = 0, 1, 2, 3


class ActionClient:
    """Client of one action."""

    def __init__(self, backend, name, type_name):
        self._backend = backend
        self._goals = {}
        self._lock = threading.Lock()
        part = f"{name}/_action/"
        self._parts = []
        try:
            self._sends = self._kept(backend.client(part + "send_goal", type_name + "_SendGoal"))
            self._cancels = self._kept(backend.client(part + "cancel_goal", _CANCEL))
            self._results = self._kept(backend.client(part + "get_result", type_name + "_GetResult"))
            feedback = type_name + "_FeedbackMessage"
            self._kept(backend.subscription(part + "feedback", feedback, _FEEDBACK, self._hear_feedback))
            self._kept(backend.subscription(part + "status", _STATUS, _STATES, self._hear_states))
        except Exception:
            self.close()
            raise

    def _kept(self, part):
        self._parts.append(part)
        return part

    def servers(self, sent_s=math.inf):
        """``{None}`` if all parts are matched, else an empty set.

        The helper itself fails calls to servers that have ended.
        """
        return {None} if all(part.matched() for part in self._parts) else set()

    def send(self, goal, events):
        """Send a goal with a new id."""
        sent = _Goal(self, events)
        with self._lock:
            self._goals[sent.goal_id] = sent
        request = {"goal_id": {"uuid": sent.goal_id}, "goal": goal}
        try:
            # The helper outlives this process, and cancels its goals if it is killed.
            sent._cancel_at_end = self._backend.at_end(self._cancels._handle, sent._cancel_request())
            self._sends.send(request, sent._answered)
        except Exception:
            self._forget(sent.goal_id)
            sent._settle()
            raise
        return sent

    def _forget(self, goal_id):
        with self._lock:
            self._goals.pop(goal_id, None)

    def _goal(self, goal_id):
        with self._lock:
            return self._goals.get(bytes(goal_id))

    def _hear_feedback(self, message):
        sent = self._goal(message["goal_id"]["uuid"])
        if sent is not None:
            sent._tell("feedback", message["feedback"])

    def _hear_states(self, message):
        for each in message["status_list"]:
            sent = self._goal(each["goal_info"]["goal_id"]["uuid"])
            if sent is not None:
                sent._tell("status", each["status"])

    def close(self):
        """Release the client; active goals fail."""
        with self._lock:
            goals, self._goals = list(self._goals.values()), {}
        for sent in goals:
            sent._finish("failed", "its client was closed")
        for part in self._parts:
            part.close()


class _Goal:
    """Goal that was sent."""

    def __init__(self, client, events):
        self.goal_id = uuid.uuid4().bytes
        self._client = client
        self._events = events
        self._open = True
        self._cancel_at_end = None

    def _settle(self):
        number, self._cancel_at_end = self._cancel_at_end, None
        if number is not None:
            self._client._backend.not_at_end(number)

    def _cancel_request(self):
        return {"goal_info": {"goal_id": {"uuid": self.goal_id}, "stamp": _NOW}}

    def _tell(self, what, *arguments):
        if self._open:
            getattr(self._events, what)(*arguments)

    def _finish(self, what, *arguments):
        self._client._forget(self.goal_id)
        self._settle()
        self._tell(what, *arguments)
        self._open = False

    def _answered(self, response, why):
        if not self._open:
            return
        if why is not None:
            self._finish("failed", why)
        elif not response["accepted"]:
            self._finish("rejected")
        else:
            try:
                self._client._results.send({"goal_id": {"uuid": self.goal_id}}, self._ended)
            except _backend.RosError as error:
                self._finish("failed", str(error))
            else:
                self._tell("accepted")

    def _ended(self, response, why):
        if why is not None:
            self._finish("failed", why)
        else:
            self._finish("result", response["status"], response["result"])

    def cancel(self, done):
        """Request cancellation from the server."""
        self._client._cancels.send(self._cancel_request(), lambda response, why: done(response and response["return_code"], why))

    def close(self):
        """End the events of the goal."""
        self._open = False
        self._client._forget(self.goal_id)
        self._settle()


def _stamp():
    now_ns = time.time_ns()
    return {"sec": now_ns // 1_000_000_000, "nanosec": now_ns % 1_000_000_000}


class ActionServer:
    """Server of one action."""

    def __init__(self, backend, name, type_name, asked):
        self._asked = asked
        self._goals = {}
        self._lock = threading.RLock()
        #: Notified when a client has received its result.
        self._taken = threading.Condition(self._lock)
        self._open = True
        part = f"{name}/_action/"
        self._parts = []
        try:
            self._feedback = self._kept(backend.publisher(part + "feedback", type_name + "_FeedbackMessage", _FEEDBACK))
            self._states = self._kept(backend.publisher(part + "status", _STATUS, _STATES))
            self._kept(backend.service(part + "get_result", type_name + "_GetResult", self._take_result))
            self._kept(backend.service(part + "cancel_goal", _CANCEL, self._take_cancel))
            self._kept(backend.service(part + "send_goal", type_name + "_SendGoal", self._take_goal))
        except Exception:
            self.close()
            raise

    def _kept(self, part):
        self._parts.append(part)
        return part

    def _take_goal(self, request):
        goal_id = bytes(request.request["goal_id"]["uuid"])
        goal = _ServerGoal(self, request, goal_id)
        with self._lock:
            if self._open and goal_id not in self._goals:
                self._goals[goal_id] = goal
                self._drop_old()
            else:
                goal = None
        if goal is None:
            request.answer({"accepted": False, "stamp": _stamp()})
        else:
            self._asked(goal)

    def _drop_old(self):
        ended = [goal for goal in self._goals.values() if goal.ended_s is not None]
        oldest_s = time.monotonic() - _KEPT_S
        for at, goal in enumerate(ended):
            if goal.ended_s < oldest_s or len(ended) - at > _KEPT_MAX:
                del self._goals[goal.goal_id]

    def _take_result(self, request):
        with self._lock:
            goal = self._goals.get(bytes(request.request["goal_id"]["uuid"]))
            if goal is not None and goal.ended_s is None:
                goal.waiting.append(request)
                return
        if goal is None:
            request.answer({"status": 0, "result": {}})
        else:
            goal.answer([request])

    def _take_cancel(self, request):
        info = request.request["goal_info"]
        goal_id = bytes(info["goal_id"]["uuid"])
        stamp = info["stamp"]["sec"], info["stamp"]["nanosec"]
        with self._lock:
            named = self._goals.get(goal_id)
            all_of_them = not any(goal_id) and stamp == (0, 0)
            wanted = [
                goal
                for goal in self._goals.values()
                if goal is named or all_of_them or (stamp != (0, 0) and goal.stamp_pair() <= stamp)
            ]
        canceling = [goal for goal in wanted if goal._ask_to_cancel()]
        if canceling:
            code = _CANCELS
            self._tell_states()
        elif any(goal_id) and named is None:
            code = _UNKNOWN
        elif named is not None and named.ended_s is not None:
            code = _ENDED
        else:
            code = _REFUSED if wanted else _CANCELS
        request.answer({"return_code": code, "goals_canceling": [goal.info() for goal in canceling]})

    def _tell_states(self):
        with self._lock:
            after_s = time.monotonic() - _LISTED_S
            listed = [
                {"goal_info": goal.info(), "status": goal.status}
                for goal in self._goals.values()
                if goal.status and (goal.ended_s is None or goal.ended_s > after_s)
            ]
            try:
                self._states.publish({"status_list": listed})
            except BackendLost:
                pass

    def close(self):
        """Stop offering the action; executing goals are aborted."""
        with self._lock:
            if not self._open:
                return
            self._open = False
            goals = list(self._goals.values())
        for goal in goals:
            if goal.status:
                goal.finish(_backend.ABORTED, {})
        self._wait_taken(goals)
        for part in reversed(self._parts):
            part.close()

    def _wait_taken(self, goals):
        """Wait until results of just ended goals are requested; clients request them late."""
        with self._taken:
            for goal in goals:
                if goal.ended_s is not None and not goal.is_taken:
                    left_s = goal.ended_s + _TAKEN_S - time.monotonic()
                    self._taken.wait_for(lambda goal=goal: goal.is_taken, max(left_s, 0))


class _ServerGoal:
    """Received goal."""

    def __init__(self, server, request, goal_id):
        self.goal_id = goal_id
        self.goal = request.request["goal"]
        self.stamp = _stamp()
        #: 0 until it is accepted.
        self.status = 0
        self.result = {}
        self.waiting = []
        self.ended_s = None
        #: True if the result was sent to a client.
        self.is_taken = False
        self._cancel = lambda: False
        self._server = server
        self._request = request

    def info(self):
        """Id and time of acceptance."""
        return {"goal_id": {"uuid": self.goal_id}, "stamp": self.stamp}

    def stamp_pair(self):
        """Time of acceptance as a pair (s, ns), for comparison."""
        return self.stamp["sec"], self.stamp["nanosec"]

    def accept(self, cancel):
        """Accept the goal; it executes from now on."""
        with self._server._lock:
            self._cancel = cancel
            self.stamp = _stamp()
            self.status = _backend.EXECUTING
        self._request.answer({"accepted": True, "stamp": self.stamp})
        self._server._tell_states()

    def reject(self):
        """Reject the goal."""
        with self._server._lock:
            self._server._goals.pop(self.goal_id, None)
            waiting, self.waiting = self.waiting, []
        self._request.answer({"accepted": False, "stamp": _stamp()})
        for request in waiting:
            request.answer({"status": 0, "result": {}})

    def _ask_to_cancel(self):
        if self.status == _backend.CANCELING:
            return True
        if self.status != _backend.EXECUTING or not self._cancel():
            return False
        with self._server._lock:
            if self.status == _backend.EXECUTING:
                self.status = _backend.CANCELING
        return True

    def feedback(self, message):
        """Send feedback to the clients."""
        self._server._feedback.publish({"goal_id": {"uuid": self.goal_id}, "feedback": message})

    def finish(self, status, result):
        """End the goal."""
        with self._server._lock:
            if self.ended_s is not None:
                return
            canceled_without_being_asked = status == _backend.CANCELED and self.status != _backend.CANCELING
            self.status = _backend.ABORTED if canceled_without_being_asked else status
            self.result = result
            self.ended_s = time.monotonic()
            waiting, self.waiting = self.waiting, []
        self._server._tell_states()
        self.answer(waiting)

    def answer(self, requests):
        """Send the result in response to the requests."""
        for request in requests:
            request.answer({"status": self.status, "result": self.result})
        if requests:
            with self._server._taken:
                self.is_taken = True
                self._server._taken.notify_all()
