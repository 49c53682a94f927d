"""The ROS 2 node of a state machine."""

from rclpy.node import Node


class RafconRosNode(Node):
    """A node that all states share: a first state makes it and puts it into ``rafcon_ros_node``, by reference."""

    def __init__(self, node_name, namespace=None):
        Node.__init__(self, node_name, namespace=namespace)
