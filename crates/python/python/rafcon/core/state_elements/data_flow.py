"""Data flows, which carry values from port to port."""

from rafcon.core.state_elements.state_element import StateElement, field
from rafcon.utils.type_helpers import of_type


class DataFlow(StateElement):
    """Flow of values between two ports (or scoped variables) of one container and its states."""

    _fields = ("data_flow_id", "from_state", "from_key", "to_state", "to_key")
    _group = "data_flows"
    _verb = "flow"

    data_flow_id = field("The id (``int``), unique in the container.")

    def __init__(self, from_state, from_key, to_state, to_key, data_flow_id=None, parent=None):
        StateElement.__init__(self, parent, (data_flow_id, from_state, from_key, to_state, to_key))

    @property
    def from_state(self):
        """Id of the state where it begins."""
        return self._get("from_state")

    @from_state.setter
    def from_state(self, from_state):
        self.modify_origin(from_state, self.from_key)

    @property
    def from_key(self):
        """Id of the port where it begins."""
        return self._get("from_key")

    @from_key.setter
    def from_key(self, from_key):
        self.modify_origin(self.from_state, from_key)

    @property
    def to_state(self):
        """Id of the state where it ends."""
        return self._get("to_state")

    @to_state.setter
    def to_state(self, to_state):
        self.modify_target(to_state, self.to_key)

    @property
    def to_key(self):
        """Id of the port where it ends."""
        return self._get("to_key")

    @to_key.setter
    def to_key(self, to_key):
        self.modify_target(self.to_state, to_key)

    def modify_origin(self, from_state, from_key):
        """Set the port (or scoped variable) of a state at which the flow begins."""
        of_type(from_state, str, "from_state")
        of_type(from_key, int, "from_key")
        self._set("origin", {"from_state": from_state, "from_key": from_key}, from_state, from_key)

    def modify_target(self, to_state, to_key):
        """Set the port (or scoped variable) of a state at which the flow ends."""
        of_type(to_state, str, "to_state")
        of_type(to_key, int, "to_key")
        self._set("target", {"to_state": to_state, "to_key": to_key}, to_state, to_key)

    def __str__(self):
        key, from_state, from_key, to_state, to_key = self._content()
        ends = f"from_state: {from_state}, from_key: {from_key}, to_state: {to_state}, to_key: {to_key}"
        return f"Data flow - {ends}, id: {key}"
