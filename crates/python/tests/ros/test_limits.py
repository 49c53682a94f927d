"""The bound of the back end ``rclpy`` that only the middleware reaches."""

import os
import threading
import unittest

from peers import STUCK_S

from rafcon.ros import _node


@unittest.skipIf(os.environ.get("RAFCON_ROS_BACKEND") == "native", "the native back end has no such queue")
class Answers(unittest.TestCase):
    """Answers to a client whose node is busy."""

    def setUp(self):
        import rclpy
        from rclpy.qos import QoSProfile
        from std_srvs.srv import Trigger

        context = rclpy.Context()
        rclpy.init(args=[], context=context)
        self.addCleanup(context.try_shutdown)
        server = rclpy.create_node("server", context=context)
        self.addCleanup(server.destroy_node)
        server.create_service(Trigger, "/limits/count", self.answer, qos_profile=QoSProfile(depth=10))
        self.executor = rclpy.executors.SingleThreadedExecutor(context=context)
        self.executor.add_node(server)
        self.requests = 0
        self.backend = _node.node().backend
        self.addCleanup(_node.close)

    def answer(self, _request, response):
        self.requests += 1
        response.message = str(self.requests)
        return response

    def test_of_too_many_answers_the_oldest_are_lost_and_a_later_call_is_answered(self):
        client = self.backend.client("/limits/count", "std_srvs/srv/Trigger")
        while not client.servers():
            self.executor.spin_once(timeout_sec=0.01)
        is_busy, may_continue, has_last = threading.Event(), threading.Event(), threading.Event()
        self.backend.post(lambda: (is_busy.set(), may_continue.wait()))
        is_busy.wait()
        come = []

        def done(response, _why):
            come.append(int(response["message"]))
            if come[-1] == 1101:
                has_last.set()

        for number in range(1101):
            if number == 1100:
                may_continue.set()
            client.send({}, done)
            while self.requests <= number:
                self.executor.spin_once()
        self.assertTrue(has_last.wait(STUCK_S))
        # The node can take some before the middleware has delivered the last ones.
        self.assertIn(come[0], range(2, 103))
        self.assertEqual(come, list(range(come[0], 1102)))


if __name__ == "__main__":
    unittest.main()
