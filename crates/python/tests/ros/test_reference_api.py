"""``rafcon.utils.ros2``, the API of the reference 2.5.2, in machines whose scripts use it as they always did, against a real peer."""

import importlib.util
import pathlib
import tempfile
import textwrap
import unittest

from peers import Peer
from support import Runner, save, script, sequence

START = """
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rafcon.utils.ros2.rafcon_ros_node import RafconRosNode
from rafcon.utils.ros2.rafcon_ros_thread import ROSThread

def execute(self, inputs, outputs, gvm):
    rclpy.init()
    node = RafconRosNode("reference")
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    thread = ROSThread(executor, node)
    thread.start_thread()
    gvm.set_variable("rafcon_ros_node", node, per_reference=True)
    gvm.set_variable("rafcon_ros_thread", thread, per_reference=True)
    return 0
"""
END = """
def execute(self, inputs, outputs, gvm):
    gvm.delete_variable("rafcon_ros_node")
    gvm.delete_variable("rafcon_ros_thread")
    return 0
"""


@unittest.skipUnless(importlib.util.find_spec("rclpy"), "this API is one of rclpy")
class Reference(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.peer = Peer()
        cls.addClassCleanup(cls.peer.close)

    def start(self, body):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        text = textwrap.dedent(body)
        return Runner(save(pathlib.Path(folder.name, "m"), sequence(script(START, "S"), script(text), script(END, "E"))))

    def test_a_message_is_published(self):
        self.peer.subscribe("/reference/there")
        runner = self.start(
            """
            from std_msgs.msg import String
            from rafcon.utils.ros2.publisher import PublisherHandle

            def execute(self, inputs, outputs, gvm):
                handle = PublisherHandle(self, gvm, String, "/reference/there")
                with handle.lock:
                    handle.wait_for_sub(timeout=20)
                    handle.set_pub_msg_field_from_inputs("data", {"data": "hello"})
                    print(handle.publish_msg())
                return 0
            """
        )
        self.assertEqual(self.peer.heard("/reference/there", 1), ["hello"])
        result = runner.finish()
        self.assertEqual((result.outcome, result.logged("stdout")), ("success", ["success"]), result.logged())

    def test_a_message_is_waited_for(self):
        self.peer.publish("/reference/back", [])
        runner = self.start(
            """
            from std_msgs.msg import String
            from rafcon.utils.ros2.subscriber import SubscriberHandle

            def execute(self, inputs, outputs, gvm):
                handle = SubscriberHandle(self, gvm.get_variable("rafcon_ros_node"), String, "/reference/back")
                print(handle.wait_for_sub_msg(timeout=20), handle.get_sub_msg_field("data"))
                return 0
            """
        )
        self.peer.subscribers("/reference/back", 1)
        self.peer.publish("/reference/back", ["hello"])
        self.assertEqual(runner.finish().logged("stdout"), ["success hello"])

    def test_a_service_is_called(self):
        runner = self.start(
            """
            from std_srvs.srv import SetBool
            from rafcon.utils.ros2.service_client import ServiceClientHandle

            def execute(self, inputs, outputs, gvm):
                handle = ServiceClientHandle(self, gvm, SetBool, "/peer/set")
                with handle.lock:
                    print(handle.wait_for_srv())
                    handle.set_srv_req_field("data", True)
                    handle.call_srv()
                    print(handle.wait_until_srv_completion(), handle.get_srv_resp_field("message"))
                return 0
            """
        )
        self.assertEqual(runner.finish().logged("stdout"), ["success", "success on"])

    def test_a_service_that_never_answers_is_left_by_a_stop(self):
        count = self.peer.counted("never called", 0)
        runner = self.start(
            """
            from std_srvs.srv import Trigger
            from rafcon.utils.ros2.service_client import ServiceClientHandle

            def execute(self, inputs, outputs, gvm):
                handle = ServiceClientHandle(self, gvm, Trigger, "/peer/never")
                handle.wait_for_srv()
                handle.call_srv()
                print(handle.wait_until_srv_completion())
                return "preempted"
            """
        )
        self.peer.counted("never called", count + 1)
        runner.command("stop")
        self.assertEqual(runner.finish().logged("stdout"), ["preempted"])

    def test_a_service_is_offered(self):
        runner = self.start(
            """
            from std_srvs.srv import Trigger
            from rafcon.utils.ros2.service_server import ServiceServerHandle

            def execute(self, inputs, outputs, gvm):
                def answer(request, response):
                    response.success, response.message = True, "served"
                    return response

                handle = ServiceServerHandle(self, gvm.get_variable("rafcon_ros_node"), Trigger, "/reference/serve", answer)
                self.preemptive_wait()
                handle.destroy_service()
                return "preempted"
            """
        )
        self.assertEqual(self.peer.call("/reference/serve", 3), [[True, "served"]] * 3)
        runner.command("stop")
        self.assertEqual(runner.finish().outcome, "preempted")


if __name__ == "__main__":
    unittest.main()
