"""Receiving messages in a script."""

import rclpy  # noqa: F401, without ROS 2 this module says so when it is imported

from rafcon._wakeup import Wakeup
from rafcon.utils.ros2._message import get_field


class SubscriberHandle:
    """Receives messages of one type on one topic; ``sub_msg`` is the last one, or None.

    ``rafcon`` is the script's ``self``, ``node`` the node in the global variable ``rafcon_ros_node``.
    """

    def __init__(self, rafcon, node, sub_msg_def, sub_topic, qos_profile=10, callback_group=None):
        self._state = rafcon
        self._node = node
        self._topic = sub_topic
        self.sub_msg = None
        self._wakeup = Wakeup(rafcon)
        options = {} if callback_group is None else {"callback_group": callback_group}
        self.subscription = node.create_subscription(sub_msg_def, sub_topic, self._received, qos_profile, **options)

    def _received(self, message):
        self.sub_msg = message
        self._wakeup.wake()

    def wait_for_sub_msg(self, timeout=None):
        """Waits (s, or for ever) for a message: ``"success"``, ``"preempted"``, or ``"aborted"`` if none came."""
        come = self._wakeup.wait(timeout)
        self.destroy_subscription()
        if come:
            return "success"
        if self._state.preempted:
            return "preempted"
        self._state.logger.warning("No message came on '%s' in %s s", self._topic, timeout)
        return "aborted"

    def get_sub_msg(self):
        """The last message, or None."""
        return self.sub_msg

    def get_sub_msg_field(self, key):
        """A field of the last message."""
        return get_field(self.sub_msg, key)

    def destroy_subscription(self):
        """Receives nothing more."""
        if self.subscription is not None:
            self._node.destroy_subscription(self.subscription)
            self.subscription = None
