"""A node of plain ``rclpy`` that says what it has heard, and sends what it is told to, in any type.

Each line on the standard input is a JSON list of a word and its arguments, each is answered by a line with JSON.
"""

import importlib
import json
import sys
import threading

import rclpy
from plain import data, filled, given, of_rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

#: Nothing that is under way takes longer; a test that waits so long has failed (s).
STUCK_S = 60
#: One of each kind.
PARAMETERS = {
    "flag": False,
    "count": 0,
    "speed": 0.0,
    "label": "",
    "raw": [b"\0"],
    "flags": [False],
    "counts": [0],
    "speeds": [0.0],
    "labels": [""],
}


class Echo(Node):
    """What the other side is tested against."""

    def __init__(self):
        Node.__init__(self, "echo")
        self.group = ReentrantCallbackGroup()
        self.heard = {}
        self.made = {}
        self.changed = threading.Condition()
        for name, value in PARAMETERS.items():
            self.declare_parameter(name, value)

    def note(self, key, message):
        with self.changed:
            self.heard.setdefault(key, []).append(of_rclpy(message))
            self.changed.notify_all()

    # ---- topics

    def do_hear(self, topic, type_name, latched=False, best_effort=False, depth=100):
        self.heard[topic] = []
        hear = lambda message: self.note(topic, message)  # noqa: E731
        # One after the other, or the executor's threads change their order.
        group = MutuallyExclusiveCallbackGroup()
        self.made["hear", topic] = self.create_subscription(found(type_name), topic, hear, quality(latched, best_effort, depth), callback_group=group)

    def do_heard(self, topic, count):
        """Waits until so many messages came; all of them."""
        with self.changed:
            self.changed.wait_for(lambda: len(self.heard[topic]) >= count, STUCK_S)
            return self.heard[topic]

    def do_say(self, topic, type_name, messages, latched=False, best_effort=False, depth=100):
        key = "say", topic
        if key not in self.made:
            self.made[key] = self.create_publisher(found(type_name), topic, quality(latched, best_effort, depth))
        for values in messages:
            self.made[key].publish(filled(found(type_name)(), given(values)))

    def do_subscribers(self, topic, count):
        """Waits until so many hear what is said."""
        while self.made["say", topic].get_subscription_count() != count:
            threading.Event().wait(0.01)

    def do_quiet(self, topic):
        self.destroy_publisher(self.made.pop(("say", topic)))

    # ---- services

    def do_serve(self, service, type_name):
        """Answers each request with its fields."""

        def answer(request, response):
            self.note(service, request)
            for name in response.get_fields_and_field_types():
                setattr(response, name, getattr(request, name))
            return response

        self.made[service] = self.create_service(found(type_name), service, answer, callback_group=self.group)

    def do_call(self, service, type_name, values):
        client = self.made.get(("call", service)) or self.create_client(found(type_name), service, callback_group=self.group)
        self.made["call", service] = client
        if not client.wait_for_service(STUCK_S):
            return "no server"
        answer = client.call(filled(found(type_name).Request(), given(values)), 20)
        return "no answer" if answer is None else of_rclpy(answer)

    # ---- actions

    def do_act(self, action, type_name):
        """Serves goals of ``odd_msgs/Blob``: so many feedbacks of so many bytes, and the goal's data as the result."""
        kind = found(type_name)

        def work(handle):
            self.note(action, handle.request)
            for _ in range(handle.request.feedbacks):
                handle.publish_feedback(filled(kind.Feedback(), {"data": data(handle.request.size)}))
            handle.succeed()
            return kind.Result(data=handle.request.data)

        self.made[action] = ActionServer(self, kind, action, work, callback_group=self.group)

    def do_goal(self, action, type_name, values, feedbacks=0):
        """Sends a goal; its state, its result, its feedback. The result is asked for after so much feedback."""
        kind, told, enough = found(type_name), [], threading.Event()
        client = self.made.get(("goal", action)) or ActionClient(self, kind, action, callback_group=self.group)
        self.made["goal", action] = client

        def hear(message):
            told.append(of_rclpy(message.feedback))
            if len(told) >= feedbacks:
                enough.set()

        if not client.wait_for_server(STUCK_S):
            return "no server"
        handle = ended(client.send_goal_async(filled(kind.Goal(), given(values)), feedback_callback=hear))
        if handle is None or not handle.accepted:
            return "not accepted"
        if feedbacks and not enough.wait(20):
            return f"{len(told)} feedbacks"
        result = ended(handle.get_result_async())
        return "no result" if result is None else [result.status, of_rclpy(result.result), told]


def ended(future):
    event = threading.Event()
    future.add_done_callback(lambda _future: event.set())
    return future.result() if event.wait(20) else None


def found(type_name):
    package, kind, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)


def quality(latched, best_effort, depth):
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    reliability = ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE
    return QoSProfile(depth=depth, durability=durability, reliability=reliability)


def main():
    rclpy.init()
    echo = Echo()
    executor = MultiThreadedExecutor(8)
    executor.add_node(echo)

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
        print(json.dumps(getattr(echo, "do_" + word)(*arguments)), flush=True)
    rclpy.shutdown()
    spinning.join()


if __name__ == "__main__":
    main()
