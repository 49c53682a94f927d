"""ROS 2 node of a state machine."""

import rclpy
import rclpy.duration
from rclpy.node import Node

from rafcon.utils.log import get_logger

try:
    from tf2_ros.buffer import Buffer
    from tf2_ros.transform_listener import TransformListener
except ImportError as error:
    Buffer = None
    _MISSING = error

#: Lifetime (s) of transforms.
_TRANSFORMS_S = 60


class RafconRosNode(Node):
    """Node that all states share; the first state stores it, by reference, in ``rafcon_ros_node``.

    ``tf_buffer`` keeps the transforms that ``tf_listener`` receives. If ``tf2_ros`` is not
    installed, both are None, and a warning is logged.
    """

    def __init__(self, node_name, namespace=""):
        Node.__init__(self, node_name, namespace=namespace)
        self.tf_buffer = self.tf_listener = None
        if Buffer is None:
            get_logger("ros").warning("the node %s has no transforms: %s", node_name, _MISSING)
            return
        self.tf_buffer = Buffer(cache_time=rclpy.duration.Duration(seconds=_TRANSFORMS_S))
        self.tf_listener = TransformListener(self.tf_buffer, self)
