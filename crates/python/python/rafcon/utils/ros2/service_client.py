"""Service clients for scripts."""

from rafcon._wakeup import Wakeup
from rafcon.utils.ros2._message import get_field, replace_chars, set_field_from_inputs
from rafcon.utils.ros2._shared import available, forget, shared

_CLIENTS = "ros_clients"
#: Polling interval; ROS 2 does not announce services.
_ASK_EVERY_S = 0.05


class ServiceClientHandle:
    """Calls one service; the client ``cli`` is kept for the next run.

    ``rafcon`` is the script's ``self``. ``srv_req`` is the request to fill, ``srv_resp`` the
    response or None. ``with handle.lock:`` keeps other states from using the client.
    """

    def __init__(self, rafcon, gvm, srv_def, srv_name, callback_group=None):
        self.rafcon = rafcon
        self.gvm = gvm
        self.srv_def = srv_def
        self.srv_name = srv_name
        self.callback_group = callback_group
        self.node = available(gvm.get_variable("rafcon_ros_node"))
        self.cli, self.lock = shared(gvm, _CLIENTS, srv_name, self._make)
        self.srv_req = srv_def.Request()
        self.srv_resp = None
        self.srv_future = None

    def _make(self):
        return self.node.create_client(self.srv_def, self.srv_name, callback_group=self.callback_group)

    def wait_for_srv(self):
        """Wait for the service: ``"success"`` or ``"preempted"``."""
        while not self.cli.service_is_ready():
            if self.rafcon.preemptive_wait(_ASK_EVERY_S):
                return "preempted"
        return "success"

    def set_srv_req(self, srv_req):
        """Set the whole request."""
        self.srv_req = srv_req

    def set_srv_req_field(self, key, value):
        """Set a field of the request."""
        setattr(self.srv_req, key, value)

    def set_srv_req_field_from_inputs(self, key, inputs):
        """Set a field of the request from the input with its name."""
        set_field_from_inputs(self.srv_req, key, inputs)

    def call_srv(self):
        """Send the request without waiting for the response."""
        self.srv_resp = None
        self.srv_future = self.cli.call_async(self.srv_req)

    def wait_until_srv_completion(self):
        """Wait for the response: ``"success"``, ``"preempted"``, or ``"aborted"`` on failure.

        A response with a text in its field ``error_message`` counts as failed, and stays readable.
        """
        wakeup = Wakeup(self.rafcon)
        self.srv_future.add_done_callback(lambda _future: wakeup.wake())
        if not wakeup.wait():
            self.srv_future.cancel()
            return "preempted"
        error = self.srv_future.exception()
        if error is None:
            self.srv_resp = self.srv_future.result()
            error = getattr(self.srv_resp, "error_message", None)
        if error:
            self.rafcon.logger.error("The service '%s' failed: %s", self.srv_name, error)
            return "aborted"
        return "success"

    def get_srv_resp(self):
        """Response, or None."""
        return self.srv_resp

    def get_srv_resp_field(self, key):
        """Field of the response."""
        return get_field(self.srv_resp, key)

    def destroy_client(self):
        """Remove the client; the next handle creates a new one."""
        forget(self.gvm, _CLIENTS, self.srv_name)
        self.node.destroy_client(self.cli)

    def replace_chars(self, message):
        """Convert a text to one line: line ends become ``char(10)``."""
        return replace_chars(message)
