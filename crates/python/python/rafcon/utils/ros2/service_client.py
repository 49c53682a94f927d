"""Calling services from a script."""

from rafcon._wakeup import Wakeup
from rafcon.utils.ros2._message import get_field, set_field
from rafcon.utils.ros2._shared import forget, shared

_CLIENTS = "ros_clients"
#: ROS 2 does not tell when a service comes, so it is asked this often.
_ASK_EVERY_S = 0.05


class ServiceClientHandle:
    """Calls one service; the client stays for the next run.

    ``rafcon`` is the script's ``self``. ``srv_req`` is the request to fill, ``srv_resp`` the response or None;
    ``with handle.lock:`` keeps other states from using the client meanwhile.
    """

    def __init__(self, rafcon, gvm, srv_def, srv_name, callback_group=None):
        self._state = rafcon
        self._gvm = gvm
        self._name = srv_name
        self._node = gvm.get_variable("rafcon_ros_node")
        options = {} if callback_group is None else {"callback_group": callback_group}
        self.client, self.lock = shared(
            gvm, _CLIENTS, srv_name, lambda: self._node.create_client(srv_def, srv_name, **options)
        )
        self.srv_req = srv_def.Request()
        self.srv_resp = None
        self._future = None

    def wait_for_srv(self):
        """Waits for the service: ``"success"`` or ``"preempted"``."""
        while not self.client.service_is_ready():
            if self._state.preemptive_wait(_ASK_EVERY_S):
                return "preempted"
        return "success"

    def set_srv_req(self, srv_req):
        """Takes a whole request."""
        self.srv_req = srv_req

    def set_srv_req_field(self, key, value):
        """Sets a field of the request."""
        set_field(self.srv_req, key, value)

    def set_srv_req_field_from_inputs(self, key, inputs):
        """Sets a field of the request from the input of the same name."""
        set_field(self.srv_req, key, inputs[key])

    def call_srv(self):
        """Sends the request and does not wait."""
        self.srv_resp = None
        self._future = self.client.call_async(self.srv_req)

    def wait_until_srv_completion(self):
        """Waits for the response: ``"success"``, ``"preempted"``, or ``"aborted"`` if the call failed."""
        wakeup = Wakeup(self._state)
        self._future.add_done_callback(lambda _future: wakeup.wake())
        if not wakeup.wait():
            self._future.cancel()
            return "preempted"
        error = self._future.exception()
        if error is not None:
            self._state.logger.error("The service '%s' failed: %s", self._name, error)
            return "aborted"
        self.srv_resp = self._future.result()
        return "success"

    def get_srv_resp(self):
        """The response, or None."""
        return self.srv_resp

    def get_srv_resp_field(self, key):
        """A field of the response."""
        return get_field(self.srv_resp, key)

    def destroy_client(self):
        """Removes the client; the next handle makes a new one."""
        forget(self._gvm, _CLIENTS, self._name)
        self._node.destroy_client(self.client)
