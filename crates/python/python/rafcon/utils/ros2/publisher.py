"""Publishing messages from a script."""

from rafcon.utils.ros2._message import set_field
from rafcon.utils.ros2._shared import forget, shared

_PUBLISHERS = "ros_publishers"
#: ROS 2 does not tell when a subscriber comes, so it is asked this often.
_ASK_EVERY_S = 0.05


class PublisherHandle:
    """Publishes messages of one type on one topic; the publisher stays for the next run.

    ``rafcon`` is the script's ``self``. ``pub_msg`` is the message to fill; ``with handle.lock:`` keeps other states
    from using the publisher meanwhile.
    """

    def __init__(self, rafcon, gvm, pub_msg_def, pub_topic, qos_profile=10, callback_group=None):
        self._state = rafcon
        self._gvm = gvm
        self._topic = pub_topic
        node = gvm.get_variable("rafcon_ros_node")
        options = {} if callback_group is None else {"callback_group": callback_group}
        self.publisher, self.lock = shared(
            gvm, _PUBLISHERS, pub_topic, lambda: node.create_publisher(pub_msg_def, pub_topic, qos_profile, **options)
        )
        self._node = node
        self.pub_msg = pub_msg_def()

    def set_pub_msg(self, pub_msg):
        """Takes a whole message."""
        self.pub_msg = pub_msg

    def set_pub_msg_field(self, key, value):
        """Sets a field of the message."""
        set_field(self.pub_msg, key, value)

    def set_pub_msg_field_from_inputs(self, key, inputs):
        """Sets a field of the message from the input of the same name."""
        set_field(self.pub_msg, key, inputs[key])

    def wait_for_sub(self, timeout=1):
        """Waits (s) for a subscriber: ``"success"``, ``"preempted"``, or ``"aborted"`` if none came."""
        left_s = timeout
        while self.publisher.get_subscription_count() == 0:
            if left_s <= 0:
                self._state.logger.warning("Nobody has subscribed to '%s'", self._topic)
                return "aborted"
            if self._state.preemptive_wait(min(_ASK_EVERY_S, left_s)):
                return "preempted"
            left_s -= _ASK_EVERY_S
        return "success"

    def publish_msg(self):
        """Publishes the message: ``"success"``."""
        self.publisher.publish(self.pub_msg)
        return "success"

    def destroy_publisher(self):
        """Removes the publisher; the next handle makes a new one."""
        forget(self._gvm, _PUBLISHERS, self._topic)
        self._node.destroy_publisher(self.publisher)
