"""The thread that serves a ROS 2 node."""

import threading

import rclpy


class ROSThread:
    """Spins an executor for a node, until nobody holds this object any more: then node, executor and ROS 2 shut down.

    So the global variable that keeps it is deleted to end it.
    """

    def __init__(self, executor, node):
        self.executor = executor
        self.node = node
        # It must not hold this object, or that would never be let go.
        self.rafcon_ros_thread = threading.Thread(target=executor.spin, name="ros", daemon=True)

    def start_thread(self):
        """Begins."""
        self.rafcon_ros_thread.start()

    def __del__(self):
        self.node.destroy_node()
        self.executor.shutdown()
        rclpy.shutdown()
