"""Service servers for scripts."""

from rafcon.utils.ros2._message import replace_chars
from rafcon.utils.ros2._shared import available


class ServiceServerHandle:
    """Offers a service until ``destroy_service``; ``srv_callback(request, response)`` responds.

    ``rafcon`` is the script's ``self``. ``node`` is the node in the global variable
    ``rafcon_ros_node``.
    """

    def __init__(self, rafcon, node, srv_def, srv_name, srv_callback, callback_group=None):
        self.rafcon = rafcon
        self.node = available(node)
        self.srv_def = srv_def
        self.srv_name = srv_name
        self.srv_callback = srv_callback
        self.callback_group = callback_group
        self.ser = node.create_service(srv_def, srv_name, srv_callback, callback_group=callback_group)

    def destroy_service(self):
        """Stop offering the service."""
        self.node.destroy_service(self.ser)

    def replace_chars(self, message):
        """Convert a text to one line: line ends become ``char(10)``."""
        return replace_chars(message)
