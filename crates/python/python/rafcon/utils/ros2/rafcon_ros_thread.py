"""Thread that serves a ROS 2 node."""

import threading

import rclpy

from rafcon.ros._delivery import deliver

#: Longest wait (s) for callbacks.
_END_S = 1.0


class ROSThread:
    """Spins an executor for a node until this object is released; then shuts down both and ROS 2.

    To end it, delete the global variable that keeps it.
    """

    def __init__(self, executor, node):
        self.executor = executor
        self.node = node
        # The thread must not hold this object, or it would never be released.
        self.rafcon_ros_thread = threading.Thread(target=executor.spin, name="ros", daemon=True)

    def start_thread(self):
        """Start the thread."""
        self.rafcon_ros_thread.start()

    def __del__(self):
        deliver(self.node.publishers)
        self.executor.shutdown(timeout_sec=_END_S)
        if self.rafcon_ros_thread.is_alive() and self.rafcon_ros_thread is not threading.current_thread():
            self.rafcon_ros_thread.join(_END_S)
        self.node.destroy_node()
        rclpy.shutdown()
