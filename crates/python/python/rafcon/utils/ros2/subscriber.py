"""Subscribers for scripts."""

import threading

import rclpy  # noqa: F401, without ROS 2 this module says so when it is imported

from rafcon._wakeup import Wakeup
from rafcon.utils.ros2._message import get_field, replace_chars
from rafcon.utils.ros2._shared import available

_TIMEOUT_S = 5


class SubscriberHandle:
    """Receives messages of one type on one topic; ``sub_msg`` is the last one, or None.

    ``rafcon`` is the script's ``self``. ``node`` is the node in the global variable
    ``rafcon_ros_node``.
    """

    def __init__(self, rafcon, node, sub_msg_def, sub_topic, qos_profile=10, callback_group=None):
        self.rafcon = rafcon
        self.node = available(node)
        self.sub_msg_def = sub_msg_def
        self.sub_topic = sub_topic
        self.qos_profile = qos_profile
        self.callback_group = callback_group
        self.sub_msg = None
        self.sub_msg_lock = threading.Lock()
        self._wakeup = Wakeup(rafcon)
        options = {"callback_group": callback_group}
        self.sub = node.create_subscription(sub_msg_def, sub_topic, self.sub_callback, qos_profile, **options)

    def sub_callback(self, msg):
        """Store a message; called by ROS 2."""
        with self.sub_msg_lock:
            self.sub_msg = msg
        self._wakeup.wake()

    def wait_for_sub_msg(self, timeout=None):
        """Wait for a message, then end the subscription: ``"success"`` or ``"preempted"``.

        ``timeout`` is in s: 5 by default, and endless if negative. The result is ``"preempted"`` if
        the state is preempted, or if no message arrived in time.
        """
        if timeout is None:
            timeout = _TIMEOUT_S
            self.rafcon.logger.warning("wait_for_sub_msg has no timeout; it waits for %s s", timeout)
        come = self._wakeup.wait(None if timeout < 0 else timeout)
        if not come and not self.rafcon.preempted:
            self.rafcon.logger.warning("No message came on '%s' in %s s", self.sub_topic, timeout)
        self.node.destroy_subscription(self.sub)
        return "success" if come else "preempted"

    def get_sub_msg(self):
        """Last message, or None."""
        with self.sub_msg_lock:
            return self.sub_msg

    def get_sub_msg_field(self, key):
        """Field of the last message."""
        return get_field(self.get_sub_msg(), key)

    def replace_chars(self, message):
        """Convert a text to one line: line ends become ``char(10)``."""
        return replace_chars(message)
