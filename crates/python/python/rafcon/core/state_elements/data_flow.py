"""Data flows: which port gets its value from which."""

from rafcon.core._refusals import fixed, refuses
from rafcon.core.state_elements.state_element import StateElement


@refuses("modify_origin", "modify_target")
class DataFlow(StateElement):
    """Carries a value from a port (or scoped variable) to another in the same container."""

    _fields = ("data_flow_id", "from_state", "from_key", "to_state", "to_key")

    def __init__(self, from_state, from_key, to_state, to_key, data_flow_id=None, parent=None):
        StateElement.__init__(self, parent)
        self._from_state = from_state
        self._from_key = from_key
        self._to_state = to_state
        self._to_key = to_key
        self._data_flow_id = data_flow_id

    @fixed
    def data_flow_id(self):
        """The id (``int``), unique in the container."""
        return self._data_flow_id

    @fixed
    def from_state(self):
        """The id of the state where it begins."""
        return self._from_state

    @fixed
    def from_key(self):
        """The id of the port where it begins."""
        return self._from_key

    @fixed
    def to_state(self):
        """The id of the state where it ends."""
        return self._to_state

    @fixed
    def to_key(self):
        """The id of the port where it ends."""
        return self._to_key

    def __str__(self):
        ends = f"from_state: {self._from_state}, from_key: {self._from_key}, "
        return f"Data flow - {ends}to_state: {self._to_state}, to_key: {self._to_key}, id: {self._data_flow_id}"
