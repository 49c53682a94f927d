"""Publishers for scripts."""

from rafcon.ros._delivery import deliver
from rafcon.utils.ros2._message import replace_chars, set_field_from_inputs
from rafcon.utils.ros2._shared import available, forget, shared

_PUBLISHERS = "ros_publishers"
#: Polling interval; ROS 2 does not announce subscribers.
_ASK_EVERY_S = 0.05


class PublisherHandle:
    """Publishes messages of one type on one topic; the publisher ``pub`` is kept for the next run.

    ``rafcon`` is the script's ``self``. ``pub_msg`` is the message to fill. ``with handle.lock:``
    keeps other states from using the publisher.
    """

    def __init__(self, rafcon, gvm, pub_msg_def, pub_topic, qos_profile=10, callback_group=None):
        self.rafcon = rafcon
        self.gvm = gvm
        self.pub_msg_def = pub_msg_def
        self.pub_topic = pub_topic
        self.qos_profile = qos_profile
        self.callback_group = callback_group
        self.node = available(gvm.get_variable("rafcon_ros_node"))
        self.pub, self.lock = shared(gvm, _PUBLISHERS, pub_topic, self._make)
        self.pub_msg = pub_msg_def()

    def _make(self):
        options = {"callback_group": self.callback_group}
        return self.node.create_publisher(self.pub_msg_def, self.pub_topic, self.qos_profile, **options)

    def set_pub_msg(self, pub_msg):
        """Set the whole message."""
        self.pub_msg = pub_msg

    def set_pub_msg_field(self, key, value):
        """Set a field of the message."""
        setattr(self.pub_msg, key, value)

    def set_pub_msg_field_from_inputs(self, key, inputs):
        """Set a field of the message from the input with its name."""
        set_field_from_inputs(self.pub_msg, key, inputs)

    def wait_for_sub(self, timeout=1):
        """Wait for a subscriber, at most ``timeout`` (s), or until preempted; log if none came."""
        left_s = timeout
        while self.pub.get_subscription_count() == 0:
            if left_s <= 0:
                self.rafcon.logger.error("Nobody has subscribed to '%s' within %s s", self.pub_topic, timeout)
                return
            if self.rafcon.preemptive_wait(min(_ASK_EVERY_S, left_s)):
                return
            left_s -= _ASK_EVERY_S

    def publish_msg(self):
        """Publish the message; return ``"success"``."""
        self.pub.publish(self.pub_msg)
        return "success"

    def destroy_publisher(self):
        """Remove the publisher; the next handle creates a new one."""
        forget(self.gvm, _PUBLISHERS, self.pub_topic)
        deliver([self.pub])
        self.node.destroy_publisher(self.pub)

    def replace_chars(self, message):
        """Convert a text to one line: line ends become ``char(10)``."""
        return replace_chars(message)
