"""The ROS 2 handles, with a node that only keeps what it is asked for."""

import sys
import threading
import types
import unittest

import stage
from rafcon.core.global_variable_manager import GlobalVariableManager


class Recorded:
    """Keeps what it was made with."""

    def __init__(self, *arguments, **named):
        self.made_with = arguments, named


def module(name, **content):
    made = sys.modules[name] = types.ModuleType(name)
    vars(made).update(content)
    return made


class RclpyNode(Recorded):
    pass


if "rclpy" not in sys.modules:
    rclpy = module("rclpy", shut_down=[])
    rclpy.shutdown = lambda: rclpy.shut_down.append(True)
    rclpy.duration = module("rclpy.duration", Duration=lambda seconds: f"{seconds} s")
    rclpy.node = module("rclpy.node", Node=RclpyNode)
    module("tf2_ros")
    module("tf2_ros.buffer", Buffer=Recorded)
    module("tf2_ros.transform_listener", TransformListener=Recorded)

from rafcon.utils.ros2.publisher import PublisherHandle  # noqa: E402
from rafcon.utils.ros2.rafcon_ros_node import RafconRosNode  # noqa: E402
from rafcon.utils.ros2.rafcon_ros_thread import ROSThread  # noqa: E402
from rafcon.utils.ros2.service_client import ServiceClientHandle  # noqa: E402
from rafcon.utils.ros2.service_server import ServiceServerHandle  # noqa: E402
from rafcon.utils.ros2.subscriber import SubscriberHandle  # noqa: E402
from rafcon.utils.ros2.tf_utilities import tf_from_stamped  # noqa: E402


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
                self.assertEqual((handle.wait_for_sub(), handle.publish_msg()), (None, "success"))
        self.assertEqual(self.node.published, ["one", "two"])
        handle.destroy_publisher()
        self.assertEqual(self.node.made, [("create", "publisher"), ("wait", "for_all_acked"), ("destroy", "publisher")])
        for key, inputs in (("nothing", {"nothing": 1}), ("data", {})):
            with self.assertRaises(AttributeError):
                handle.set_pub_msg_field_from_inputs(key, inputs)
        self.assertEqual((handle.pub, handle.node, handle.rafcon), (self.node, self.node, self.state))

    def test_nobody_subscribes(self):
        self.node.subscribers = 0
        handle = PublisherHandle(self.state, self.gvm, Message, "chatter")
        with self.assertLogs("rafcon", "ERROR"):
            self.assertIsNone(handle.wait_for_sub(timeout=0))
        self.later(self.preempt)
        self.assertIsNone(handle.wait_for_sub(timeout=1000))

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

    def test_a_response_says_that_the_service_failed(self):
        handle = self.client()
        answer = Message()
        answer.error_message = "no such robot"
        self.later(self.node.future.answered, answer)
        with self.assertLogs("rafcon", "ERROR") as logged:
            self.assertEqual(handle.wait_until_srv_completion(), "aborted")
        self.assertIn("no such robot", logged.output[0])
        self.assertIs(handle.get_srv_resp(), answer)
        self.assertEqual((handle.cli, handle.srv_future), (self.node, self.node.future))

    def test_without_a_node_they_say_what_must_run_first(self):
        self.gvm.delete_variable("rafcon_ros_node")
        for make in (
            lambda: PublisherHandle(self.state, self.gvm, Message, "chatter"),
            lambda: ServiceClientHandle(self.state, self.gvm, Service, "add"),
            lambda: SubscriberHandle(self.state, None, Message, "chatter"),
            lambda: ServiceServerHandle(self.state, None, Service, "add", print),
        ):
            with self.assertRaisesRegex(RuntimeError, "init_ros2_node"):
                make()

    def test_a_call_ends_by_preemption(self):
        handle = self.client()
        self.later(self.preempt)
        self.assertEqual(handle.wait_until_srv_completion(), "preempted")
        self.assertTrue(self.node.future.cancelled)

    def test_a_message_comes_before_or_during_the_wait(self):
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        self.node.callback(Message())
        self.state._signals.nudged = False  # another wait silenced the bell
        self.assertEqual(handle.wait_for_sub_msg(-1), "success")
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        self.state._signals.waits.clear()
        callback = self.node.callback
        self.later(lambda: (self.state._signals.until_waited_on(), callback(Message())))
        self.assertEqual(handle.wait_for_sub_msg(timeout=1000), "success")
        self.assertEqual(handle.get_sub_msg_field("data"), "")

    def test_no_message_comes(self):
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        with self.assertLogs("rafcon", "WARNING"):
            self.assertEqual(handle.wait_for_sub_msg(timeout=0), "preempted")
        self.assertEqual(self.node.made[-1], ("destroy", "subscription"))
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        self.later(self.preempt)
        self.assertEqual(handle.wait_for_sub_msg(timeout=-1), "preempted")

    def test_without_a_timeout_five_seconds_count_and_the_log_says_so(self):
        handle = SubscriberHandle(self.state, self.node, Message, "chatter")
        self.later(self.preempt)
        with self.assertLogs("rafcon", "WARNING") as logged:
            self.assertEqual(handle.wait_for_sub_msg(), "preempted")
        self.assertIn("5 s", logged.output[0])
        _mask, seconds = self.state._signals.waits[0]
        self.assertTrue(4 < seconds <= 5)

    def test_a_service_is_offered_and_withdrawn(self):
        ServiceServerHandle(
            self.state, self.node, Service, "add", lambda _request, response: response
        ).destroy_service()
        self.assertEqual(self.node.made, [("create", "service"), ("destroy", "service")])

    def test_text_comes_in_one_line(self):
        self.assertEqual(PublisherHandle(self.state, self.gvm, Message, "chatter").replace_chars("a\nb"), "achar(10)b")

    def test_a_node_keeps_transforms(self):
        node = RafconRosNode("robot")
        self.assertEqual(node.made_with, (("robot",), {"namespace": ""}))
        self.assertEqual(node.tf_buffer.made_with, ((), {"cache_time": "60 s"}))
        self.assertEqual(node.tf_listener.made_with, ((node.tf_buffer, node), {}))

    def test_transforms_are_numbers(self):
        place, turn = types.SimpleNamespace(x=1, y=2, z=3), types.SimpleNamespace(x=0, y=0, z=0, w=1)
        stamped = types.SimpleNamespace(transform=types.SimpleNamespace(translation=place, rotation=turn))
        self.assertEqual(tf_from_stamped(stamped), ([1, 2, 3], [0, 0, 0, 1]))

    def test_deleting_the_variable_with_the_thread_shuts_ros_down(self):
        spun = threading.Event()
        executor = types.SimpleNamespace(
            spin=spun.set, shutdown=lambda timeout_sec: self.node.made.append(("shutdown", "executor"))
        )
        self.node.publishers = iter([self.node])
        thread = ROSThread(executor, self.node)
        thread.start_thread()
        spun.wait()
        self.gvm.set_variable("ros_thread", thread, per_reference=True)
        del thread
        before = len(sys.modules["rclpy"].shut_down)
        self.gvm.delete_variable("ros_thread")
        # The last messages arrive, and nothing is served any more when the node goes.
        self.assertEqual(self.node.made, [("wait", "for_all_acked"), ("shutdown", "executor"), ("destroy", "node")])
        self.assertEqual(len(sys.modules["rclpy"].shut_down), before + 1)


if __name__ == "__main__":
    unittest.main()
