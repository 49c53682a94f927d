"""Offering services from a script."""


class ServiceServerHandle:
    """Offers one service until ``destroy_service``: ``srv_callback(request, response)`` returns the response.

    ``rafcon`` is the script's ``self``, ``node`` the node in the global variable ``rafcon_ros_node``.
    """

    def __init__(self, rafcon, node, srv_def, srv_name, srv_callback, callback_group=None):
        self._state = rafcon
        self._node = node
        options = {} if callback_group is None else {"callback_group": callback_group}
        self.service = node.create_service(srv_def, srv_name, srv_callback, **options)

    def destroy_service(self):
        """Offers the service no longer."""
        self._node.destroy_service(self.service)
