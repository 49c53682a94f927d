"""The thread that serves a ROS 2 node."""

import threading

import rclpy  # noqa: F401, without ROS 2 this module says so when it is imported


class ROSThread:
    """Spins an executor for a node until ``stop_thread``."""

    def __init__(self, executor, node):
        self._executor = executor
        self._node = node
        self._thread = threading.Thread(target=executor.spin, name="ros", daemon=True)

    def start_thread(self):
        """Begins."""
        self._thread.start()

    def stop_thread(self):
        """Ends the executor and waits for its thread."""
        self._executor.shutdown()
        self._thread.join()
