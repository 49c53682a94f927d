"""The ROS 2 handles, with a node that only keeps what it is asked for."""

import sys
import threading
import types
import unittest

import stage
from rafcon.core.global_variable_manager import GlobalVariableManager

sys.modules.setdefault("rclpy", types.ModuleType("rclpy"))

from rafcon.utils.ros2.publisher import PublisherHandle  # noqa: E402
from rafcon.utils.ros2.service_client import ServiceClientHandle  # noqa: E402
from rafcon.utils.ros2.service_server import ServiceServerHandle  # noqa: E402
from rafcon.utils.ros2.subscriber import SubscriberHandle  # noqa: E402


class Message:
    def __init__(self):
        self.data = ""


class Service:
    Request = Message
    Response = Message


class Future:
    def __init__(self):
        self.answer = None
        self.cancelled = False
        self.asked = threading.Event()

    def add_done_callback(self, callback):
        self.callback = callback
        self.asked.set()

    def answered(self, answer):
        self.asked.wait()
        self.answer = answer
        self.callback(self)

    def exception(self):
        return self.answer if isinstance(self.answer, Exception) else None

    def result(self):
        return self.answer

    def cancel(self):
        self.cancelled = True


class Node:
    def __init__(self):
        self.made = []
        self.subscribers = 1
        self.published = []
        self.future = Future()

    def __getattr__(self, name):
        verb, _, kind = name.partition("_")

        def call(*arguments, **_named):
            self.made.append((verb, kind))
            self.callback = arguments[2] if kind == "subscription" and verb == "create" else None
            return self

        return call

    def get_subscription_count(self):
        return self.subscribers

    def publish(self, message):
        self.published.append(message.data)

    def service_is_ready(self):
        return True

    def call_async(self, request):
        self.request = request
        return self.future


class Handles(unittest.TestCase):
    def setUp(self):
        stage.native.clear([stage.described("execution", "A", "a", "A")])
        self.state = stage.native.state_object(0)
        self.gvm = GlobalVariableManager()
        self.node = Node()
        self.gvm.set_variable("rafcon_ros_node", self.node, per_reference=True)

    def later(self, function, *arguments):
        thread = threading.Thread(target=function, args=arguments)
        thread.start()
        self.addCleanup(thread.join)

    def preempt(self):
        self.state._signals.until_waited_on()
        self.state._signals.preempted = True

    def test_a_publisher_is_made_once(self):
        for text in ("one", "two"):
            handle = PublisherHandle(self.state, self.gvm, Message, "chatter")
            with handle.lock:
                handle.set_pub_msg_field_from_inputs("data", {"data": text})
                self.assertEqual((handle.wait_for_sub(), handle.publish_msg()), ("success", "success"))
        self.assertEqual(self.node.published, ["one", "two"])
        handle.destroy_publisher()
        self.assertEqual(self.node.made, [("create", "publisher"), ("destroy", "publisher")])
        with self.assertRaises(AttributeError):
            handle.set_pub_msg_field("nothing", 1)

    def test_nobody_subscribes(self):
        self.node.subscribers = 0
        handle = PublisherHandle(self.state, self.gvm, Message, "chatter")
        with self.assertLogs("rafcon", "WARNING"):
            self.assertEqual(handle.wait_for_sub(timeout=0), "aborted")
        self.later(self.preempt)
        self.assertEqual(handle.wait_for_sub(timeout=1000), "preempted")

    def client(self):
        handle = ServiceClientHandle(self.state, self.gvm, Service, "add")
        self.assertEqual(handle.wait_for_srv(), "success")
        handle.set_srv_req_field("data", "1 + 1")
        handle.call_srv()
        return handle

    def test_a_service_answers(self):
        handle = self.client()
        answer = Message()
        answer.data = "2"
        self.later(self.node.future.answered, answer)
        self.assertEqual(handle.wait_until_srv_completion(), "success")
        self.assertEqual((self.node.request.data, handle.get_srv_resp_field("data")), ("1 + 1", "2"))

    def test_a_service_fails(self):
        handle = self.client()
        self.later(self.node.future.answered, ValueError("no"))
        with self.assertLogs("rafcon", "ERROR"):
            self.assertEqual(handle.wait_until_srv_completion(), "aborted")

    def test_a_call_ends_by_preemption(self):
        handle = self.client()
        self.later(self.preempt)
        self.assertEqual(handle.wait_until_srv_completion(), "preempted")
        self.assertTrue(self.node.future.cancelled)

    def test_a_message_comes_before_or_during_the_wait(self):
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        self.node.callback(Message())
        self.state._signals.nudged = False  # another wait silenced the bell
        self.assertEqual(handle.wait_for_sub_msg(), "success")
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        self.state._signals.waits.clear()
        callback = self.node.callback
        self.later(lambda: (self.state._signals.until_waited_on(), callback(Message())))
        self.assertEqual(handle.wait_for_sub_msg(timeout=1000), "success")
        self.assertEqual(handle.get_sub_msg_field("data"), "")

    def test_no_message_comes(self):
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        with self.assertLogs("rafcon", "WARNING"):
            self.assertEqual(handle.wait_for_sub_msg(timeout=0), "aborted")
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        self.later(self.preempt)
        self.assertEqual(handle.wait_for_sub_msg(), "preempted")

    def test_a_service_is_offered_and_withdrawn(self):
        ServiceServerHandle(
            self.state, self.node, Service, "add", lambda _request, response: response
        ).destroy_service()
        self.assertEqual(self.node.made, [("create", "service"), ("destroy", "service")])


if __name__ == "__main__":
    unittest.main()
