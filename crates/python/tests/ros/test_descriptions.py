"""Types that nobody here has a file of, and the time of a simulation, against a real peer."""

import os
import unittest

from peers import WithPeer

from rafcon import ros
from rafcon.ros import _node

NATIVE = os.environ.get("RAFCON_ROS_BACKEND") == "native"


@unittest.skipUnless(NATIVE, "rclpy has the types that its interpreter has")
class Described(WithPeer):
    """``rafcon-ros`` without the files of ``test_msgs``: the peer describes its types."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folders = os.environ.pop("RAFCON_ROS_TYPES", None)
        if folders is not None:
            cls.addClassCleanup(os.environ.__setitem__, "RAFCON_ROS_TYPES", folders)

    def test_a_message(self):
        self.peer.strange("/types/nested")
        message = ros.wait_for("/types/nested", timeout=20, qos="latched")
        self.assertEqual((message.type_name, message.basic_types_value.int32_value, message.basic_types_value.float64_value), ("test_msgs/msg/Nested", 7, 0.5))

    def test_a_message_whose_type_is_named(self):
        self.peer.strange("/types/named")
        self.assertEqual(ros.wait_for("/types/named", "test_msgs/Nested", timeout=20, qos="latched").basic_types_value.int32_value, 7)

    def test_a_service_is_not_described_and_that_is_said(self):
        with self.assertRaisesRegex(ros.UnknownType, "there is no type test_msgs/srv/BasicTypes: .*RAFCON_ROS_TYPES"):
            ros.call("/peer/echo", {"int32_value": 1}, find=20)

    def test_a_type_that_nobody_uses(self):
        with self.assertRaisesRegex(ros.UnknownType, "there is no type no_msgs/msg/Thing: .*RAFCON_ROS_TYPES"):
            ros.publish("/types/none", {}, "no_msgs/Thing")


class Simulation(WithPeer):
    def setUp(self):
        ros.close()
        self.addCleanup(_node._wanted.pop, "use_sim_time", None)
        self.addCleanup(ros.close)
        ros.configure(use_sim_time=True)

    def test_time_is_that_of_the_simulation(self):
        self.peer.time(10)
        later = lambda message: message.clock.sec == 20  # noqa: E731
        with ros.subscribe("/clock", "rosgraph_msgs/Clock") as heard:
            heard.next(20)
            self.assertEqual(ros.now(), 10.5)
            self.peer.time(20)
            heard.next(20, later)
        ros.wait_for("/clock", "rosgraph_msgs/Clock", later, 20)
        self.assertEqual(ros.stamp(), {"sec": 20, "nanosec": 500_000_000})

    def test_no_simulation_is_an_error_with_a_way_out(self):
        with self.assertRaisesRegex(ros.TimedOut, "nobody publishes it on /clock; start it, or call configure"):
            ros.now()


if __name__ == "__main__":
    unittest.main()
