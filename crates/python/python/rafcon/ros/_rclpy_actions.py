"""Actions with ``rclpy``."""

import math
import threading

import rclpy.action
from action_msgs.srv import CancelGoal
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.qos import qos_profile_action_status_default
from rclpy.task import Future
from unique_identifier_msgs.msg import UUID

from rafcon.ros import _backend
from rafcon.ros._rclpy_messages import interface

#: Delay (s) before the result of an ended goal is requested again.
_ASK_AGAIN_S = 0.5


class ActionClient:
    """Client of ``rclpy`` that also has states of goals, and cancellation before the acceptance."""

    def __init__(self, backend, name, type_name):
        from action_msgs.msg import GoalStatusArray

        from rafcon.ros._rclpy import Servers, services

        self._backend = backend
        self._parts = {part: backend.classes.known(f"{type_name}_{part}") for part in ("Goal", "Result", "Feedback")}
        self._goals = {}
        self._lock = threading.Lock()
        node, group = backend.node, ReentrantCallbackGroup()
        names = ("goal_service", "result_service", "cancel_service", "feedback_sub")
        qualities = {f"{each}_qos_profile": services() for each in names}
        self._client = rclpy.action.ActionClient(node, interface(type_name), name, callback_group=group, **qualities)
        cancel = f"{name}/_action/cancel_goal"
        self._cancels = node.create_client(CancelGoal, cancel, qos_profile=services(), callback_group=group)
        states = f"{name}/_action/status"
        profile = qos_profile_action_status_default
        self._states = node.create_subscription(GoalStatusArray, states, self._hear_states, profile, callback_group=group)
        self._servers = Servers(backend, f"{name}/_action/send_goal", self._is_ready)

    def _is_ready(self):
        return self._client.server_is_ready() and self._cancels.service_is_ready()

    def servers(self, sent_s=math.inf):
        """Processes of the servers."""
        return self._servers.alive(sent_s)

    def send(self, goal, events):
        """Send a goal with a new id."""
        from rafcon.ros._rclpy import new_goal_id

        sent = _Goal(self, events, new_goal_id())
        self._backend.post(self._send, sent, self._parts["Goal"].made(goal))
        with self._lock:
            self._goals[sent.goal_id] = sent
        return sent

    def _send(self, sent, goal):
        """Send on the node's thread, so that the goal is registered before any response."""
        if not sent.open:
            return
        id_ = UUID(uuid=list(sent.goal_id))

        def tell(message):
            sent.tell("feedback", self._parts["Feedback"].plain(message.feedback))

        future = self._client.send_goal_async(goal, feedback_callback=tell, goal_uuid=id_)
        future.add_done_callback(lambda _future: self._answered(sent, future))

    def _answered(self, sent, future):
        if future.exception() is not None:
            self._finish(sent, "failed", str(future.exception()))
            return
        handle = future.result()
        if not handle.accepted:
            self._finish(sent, "rejected")
            return
        sent.handle = handle
        self._ask_for_result(sent)
        sent.tell("accepted")

    def _ask_for_result(self, sent):
        if sent.open:
            result = sent.handle.get_result_async()
            result.add_done_callback(lambda _future: self._ended(sent, result))

    def _ended(self, sent, future):
        if future.exception() is not None:
            self._finish(sent, "failed", str(future.exception()))
        elif not future.cancelled() and sent.open:
            answer = future.result()
            self._finish(sent, "result", answer.status, self._parts["Result"].plain(answer.result))

    def _finish(self, sent, what, *arguments):
        with self._lock:
            self._goals.pop(sent.goal_id, None)
        sent.tell(what, *arguments)
        sent.open = False

    def _hear_states(self, message):
        for each in message.status_list:
            with self._lock:
                sent = self._goals.get(bytes(each.goal_info.goal_id.uuid))
            if sent is not None:
                sent.tell("status", each.status)
                if each.status >= _backend.SUCCEEDED and sent.handle is not None and not sent.asked_again:
                    # A server drops the oldest of many requests and responses; this goal has ended, so its result is
                    # available.
                    sent.asked_again = True
                    again = threading.Timer(_ASK_AGAIN_S, self._ask_again, (sent,))
                    again.daemon = True
                    again.start()

    def _ask_again(self, sent):
        if sent.open and not self._backend._closed:
            self._backend.post(self._ask_for_result, sent)

    def cancel(self, goal_id, done):
        """Request cancellation of a goal from the server."""
        request = CancelGoal.Request()
        request.goal_info.goal_id = UUID(uuid=list(goal_id))
        future = self._cancels.call_async(request)

        def come(_future):
            error = future.exception()
            done(*((future.result().return_code, None) if error is None else (None, str(error))))

        future.add_done_callback(come)

    def forget(self, goal_id):
        """Stop waiting for a goal."""
        with self._lock:
            self._goals.pop(goal_id, None)

    def close(self):
        """Release the client; active goals fail."""
        with self._lock:
            goals, self._goals = list(self._goals.values()), {}
        for sent in goals:
            sent.tell("failed", "its client was closed")
            sent.open = False
        if not self._backend._closed:
            self._backend.post(self._destroy)

    def _destroy(self):
        self._client.destroy()
        self._backend.node.destroy_client(self._cancels)
        self._backend.node.destroy_subscription(self._states)


class _Goal:
    """Goal that was sent."""

    def __init__(self, client, events, goal_id):
        self.goal_id = goal_id
        self.open = True
        self.handle = None
        self.asked_again = False
        self._client = client
        self._events = events

    def tell(self, what, *arguments):
        """Pass an event to the receiver."""
        if self.open:
            getattr(self._events, what)(*arguments)

    def cancel(self, done):
        """Request cancellation from the server, after the goal was sent."""
        backend = self._client._backend
        backend.post(self._client.cancel, self.goal_id, done)

    def close(self):
        """End the events of the goal."""
        self.open = False
        self._client.forget(self.goal_id)


class ActionServer:
    """Server of ``rclpy`` whose goals may end on any thread."""

    def __init__(self, backend, name, type_name, asked):
        self.backend = backend
        self._asked = asked
        self._goals = {}
        self._deciding = []
        self._open = True
        self.parts = {part: backend.classes.known(f"{type_name}_{part}") for part in ("Goal", "Result", "Feedback")}
        self.type = interface(type_name)
        self._server = rclpy.action.ActionServer(
            backend.node,
            self.type,
            name,
            self._execute,
            goal_callback=self._decide,
            handle_accepted_callback=self._accepted,
            cancel_callback=self._cancel,
            callback_group=ReentrantCallbackGroup(),
        )

    async def _decide(self, request):
        if not self._open:
            return rclpy.action.GoalResponse.REJECT
        goal = _ServerGoal(self, self.parts["Goal"].plain(request))
        self._asked(goal)
        if not await goal.decision:
            return rclpy.action.GoalResponse.REJECT
        self._deciding.append((request, goal))
        return rclpy.action.GoalResponse.ACCEPT

    def _accepted(self, handle):
        at = next(at for at, (request, _goal) in enumerate(self._deciding) if request is handle.request)
        goal = self._deciding.pop(at)[1]
        goal.goal_id = bytes(handle.goal_id.uuid)
        self._goals[goal.goal_id] = goal
        goal.begin(handle)

    async def _execute(self, handle):
        goal = self._goals.pop(bytes(handle.goal_id.uuid))
        status, result = goal.ended
        if status == _backend.SUCCEEDED:
            handle.succeed()
        elif status == _backend.CANCELED and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        return self.parts["Result"].made(result)

    def _cancel(self, handle):
        goal = self._goals.get(bytes(handle.goal_id.uuid))
        agreed = goal is not None and goal.ended is None and goal.cancel()
        return rclpy.action.CancelResponse.ACCEPT if agreed else rclpy.action.CancelResponse.REJECT

    def close(self):
        """Stop offering the action; executing goals are aborted."""
        if self._open and not self.backend._closed:
            self._open = False
            self.backend.post(self._destroy)

    def _destroy(self):
        for goal in list(self._goals.values()):
            goal.finish_now(_backend.ABORTED, self.parts["Result"].plain(self.type.Result()))
        # Tasks of the executor announce the ends of goals; they run before this one.
        self.backend.executor.create_task(self._server.destroy)


class _ServerGoal:
    """Received goal."""

    def __init__(self, server, goal):
        self.goal = goal
        self.goal_id = b""
        self.decision = Future(executor=server.backend.executor)
        self.ended = None
        self.cancel = lambda: False
        self._server = server
        self._handle = None
        self._before = []

    def accept(self, cancel):
        """Accept the goal."""
        self.cancel = cancel
        self._server.backend.post(self.decision.set_result, True)

    def reject(self):
        """Reject the goal."""
        self._server.backend.post(self.decision.set_result, False)

    def begin(self, handle):
        """Begin the accepted goal, and run the calls made before."""
        self._handle = handle
        handle._update_state(_executes())
        before, self._before = self._before, []
        for function, arguments in before:
            function(*arguments)

    def feedback(self, message):
        """Send feedback to the clients."""
        self._server.backend.post(self._when_begun, self._publish, message)

    def _publish(self, message):
        self._handle.publish_feedback(self._server.parts["Feedback"].made(message))

    def _when_begun(self, function, *arguments):
        if self._handle is None:
            self._before.append((function, arguments))
        else:
            function(*arguments)

    def finish(self, status, result):
        """End the goal."""
        self._server.backend.post(self._when_begun, self.finish_now, status, result)

    def finish_now(self, status, result):
        """End the goal, called on the node's thread."""
        if self.ended is None:
            self.ended = status, result
            self._server._server.notify_execute(self._handle, None)


def _executes():
    from rclpy.impl.implementation_singleton import rclpy_implementation

    return rclpy_implementation.GoalEvent.EXECUTE
