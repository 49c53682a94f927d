"""A program of others for the tests of ``rafcon.ros``: a node of plain ``rclpy``, told what to do by lines on its standard input.

Each line is a JSON list of a word and its arguments, each is answered by a line with JSON.
"""

import json
import sys
import threading
import time

import rclpy
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import SetParametersResult
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger
from test_msgs.action import Fibonacci
from test_msgs.msg import BasicTypes as BasicTypesMessage
from test_msgs.msg import Nested
from test_msgs.srv import BasicTypes

#: Services and actions named so never answer.
FOR_EVER = threading.Event()


class Peer(Node):
    """What the tests talk to."""

    def __init__(self):
        Node.__init__(self, "peer")
        self.group = ReentrantCallbackGroup()
        self.heard = {}
        self.made = {}
        #: Open goals by action, and what happened to all of them.
        self.open = {}
        self.counts = {}
        self.cancelled_s = []
        self.clock = Clock()
        self.changed = threading.Condition()
        self.declare_parameter("speed", 1.5)
        self.declare_parameter("label", "a")
        self.declare_parameter("counts", [1, 2, 3])
        self.add_on_set_parameters_callback(self.judge)
        self.create_service(BasicTypes, "/peer/echo", self.echo, callback_group=self.group)
        self.create_service(SetBool, "/peer/set", self.set, callback_group=self.group)
        self.create_service(Trigger, "/peer/never", self.never, callback_group=self.group)
        for name in ("ok", "quick", "reject", "abort", "slow_accept", "never_accept", "ignores_cancel", "refuses_cancel", "forever"):
            self.serve(name)

    def judge(self, parameters):
        fast = [each for each in parameters if each.name == "speed" and each.value > 10]
        return SetParametersResult(successful=not fast, reason="too fast" if fast else "")

    def echo(self, request, response):
        for name in request.get_fields_and_field_types():
            setattr(response, name, getattr(request, name))
        return response

    def set(self, request, response):
        response.success, response.message = request.data, "on" if request.data else "off"
        return response

    def never(self, _request, response):
        self.count("never called")
        FOR_EVER.wait()
        return response

    # ---- actions

    def serve(self, name):
        def decide(goal):
            self.count(name + " asked")
            if name == "slow_accept":
                time.sleep(goal.order / 1000)
            if name == "never_accept":
                FOR_EVER.wait()
            return GoalResponse.REJECT if name == "reject" else GoalResponse.ACCEPT

        def accepted(handle):
            with self.changed:
                self.open.setdefault(name, set()).add(bytes(handle.goal_id.uuid))
            self.count(name + " accepted")
            handle.execute()

        def cancel(_handle):
            self.cancelled_s.append(time.monotonic())
            self.count(name + " cancel asked")
            return CancelResponse.REJECT if name == "refuses_cancel" else CancelResponse.ACCEPT

        ActionServer(
            self,
            Fibonacci,
            "/peer/" + name,
            lambda handle: self.work(name, handle),
            goal_callback=decide,
            handle_accepted_callback=accepted,
            cancel_callback=cancel,
            callback_group=self.group,
        )

    def work(self, name, handle):
        numbers = [0, 1]
        try:
            for _ in range(handle.request.order - 2 if name in ("ok", "quick", "abort") else 0):
                numbers.append(numbers[-1] + numbers[-2])
                if name != "quick":
                    handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
            if name in ("ok", "quick"):
                handle.succeed()
            elif name == "abort":
                handle.abort()
            else:
                self.until_cancelled(name, handle)
            return Fibonacci.Result(sequence=numbers)
        finally:
            with self.changed:
                self.open[name].discard(bytes(handle.goal_id.uuid))
                self.changed.notify_all()

    def until_cancelled(self, name, handle):
        handle.publish_feedback(Fibonacci.Feedback(sequence=[7]))
        while name == "ignores_cancel" or not handle.is_cancel_requested:
            if FOR_EVER.wait(0.005):
                return
        handle.canceled()

    def count(self, what):
        with self.changed:
            self.counts[what] = self.counts.get(what, 0) + 1
            self.changed.notify_all()

    # ---- what it is told

    def do_publish(self, topic, texts, latched=False, best_effort=False):
        key = topic, latched, best_effort
        if key not in self.made:
            self.made[key] = self.create_publisher(String, topic, quality(latched, best_effort))
        for text in texts:
            self.made[key].publish(String(data=text))
        return len(texts)

    def do_time(self, sec):
        """Publishes a time of a simulation, again and again as simulations do."""
        if "/clock" not in self.made:
            self.made["/clock"] = self.create_publisher(Clock, "/clock", quality(False, False))
            self.create_timer(0.02, lambda: self.made["/clock"].publish(self.clock), callback_group=self.group)
        self.clock = Clock(clock=Time(sec=sec, nanosec=500_000_000))

    def do_strange(self, topic):
        """Publishes a message of a type that few have, latched."""
        self.made[topic] = self.create_publisher(Nested, topic, quality(True, False))
        self.made[topic].publish(Nested(basic_types_value=BasicTypesMessage(int32_value=7, float64_value=0.5)))

    def do_subscribers(self, topic, count):
        """Waits until so many hear what was published."""
        publisher = next(made for key, made in self.made.items() if key[0] == topic)
        while publisher.get_subscription_count() != count:
            time.sleep(0.01)
        return count

    def do_subscribe(self, topic, latched=False):
        heard = self.heard[topic] = []

        def hear(message):
            with self.changed:
                heard.append(message.data)
                self.changed.notify_all()

        # One after the other, or the executor's threads change their order.
        self.create_subscription(String, topic, hear, quality(latched, False, 2000), callback_group=MutuallyExclusiveCallbackGroup())

    def do_heard(self, topic, count):
        """Waits until so many messages came."""
        with self.changed:
            self.changed.wait_for(lambda: len(self.heard[topic]) >= count, 20)
        return self.heard[topic]

    def do_counted(self, what, count=1):
        """Waits until something has happened so often."""
        with self.changed:
            self.changed.wait_for(lambda: self.counts.get(what, 0) >= count, 20)
        return self.counts.get(what, 0)

    def do_open(self, name):
        """How many goals of an action are open; waits until there is none."""
        with self.changed:
            self.changed.wait_for(lambda: not self.open.get(name), 20)
        return len(self.open.get(name, ()))

    def do_cancelled(self):
        return self.cancelled_s

    def do_call(self, service, count):
        """Calls a Trigger so often."""
        client = self.create_client(Trigger, service, callback_group=self.group)
        found = client.wait_for_service(10)
        answers = [client.call(Trigger.Request(), 5) for _ in range(count if found else 0)]
        return [answer and [answer.success, answer.message] for answer in answers]

    def do_goal(self, action, order, cancel=False, feedback=0):
        """Sends a goal; its state at the end, the result, and how often feedback came.

        The result is asked for once so much feedback has come: rclpy drops what the result has overtaken.
        """
        if action not in self.made:
            self.made[action] = ActionClient(self, Fibonacci, action, callback_group=self.group)
        client = self.made[action]
        told, enough = [], threading.Event()

        def hear(message):
            told.append(message)
            if len(told) >= feedback:
                enough.set()

        client.wait_for_server(10)
        handle = wait(client.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=hear))
        if not handle.accepted:
            return ["rejected", [], 0]
        if cancel:
            wait(handle.cancel_goal_async())
        if feedback:
            enough.wait(10)
        ended = wait(handle.get_result_async())
        return [ended.status, list(ended.result.sequence), len(told)]

    def do_goals(self, action, order, count):
        return [self.do_goal(action, order)[0] for _ in range(count)]


def wait(future):
    event = threading.Event()
    future.add_done_callback(lambda _future: event.set())
    if not event.wait(10):
        raise TimeoutError("no answer")
    return future.result()


def quality(latched, best_effort, depth=2000):
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    reliability = ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE
    return QoSProfile(depth=depth, durability=durability, reliability=reliability)


def main():
    if "asleep" in sys.argv:
        # Imported is all that takes long.
        print(json.dumps("up"), flush=True)
        sys.stdin.readline()
    rclpy.init()
    peer = Peer()
    executor = MultiThreadedExecutor(64)
    executor.add_node(peer)

    def spin():
        try:
            executor.spin()
        except ExternalShutdownException:
            pass

    spinning = threading.Thread(target=spin, daemon=True)
    spinning.start()
    print(json.dumps("up"), flush=True)
    for line in sys.stdin:
        word, *arguments = json.loads(line)
        print(json.dumps(getattr(peer, "do_" + word)(*arguments)), flush=True)
    FOR_EVER.set()
    rclpy.shutdown()
    spinning.join()


if __name__ == "__main__":
    main()
