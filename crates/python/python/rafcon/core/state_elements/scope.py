"""Data that belongs to a container: scoped variables and the values in its scope."""

from rafcon.core._refusals import fixed
from rafcon.core.state_elements.data_port import DataPort
from rafcon.core.state_elements.state_element import StateElement


class ScopedVariable(DataPort):
    """A variable of a container, read and written by data flows."""

    def __init__(self, name=None, data_type=None, default_value=None, scoped_variable_id=None, parent=None):
        DataPort.__init__(self, name, data_type, default_value, scoped_variable_id, parent)

    def __str__(self):
        return f"ScopedVariable '{self._name}' [{self._data_port_id}] ({self._data_type} {self._default_value})"


class ScopedData(StateElement):
    """The value that a port or scoped variable has at this moment."""

    _fields = ("name", "value", "value_type", "from_state")

    def __init__(self, name, value, value_type, from_state, parent=None):
        StateElement.__init__(self, parent)
        self._name = name
        self._value = value
        self._value_type = value_type
        self._from_state = from_state

    @fixed
    def name(self):
        """The name of the port."""
        return self._name

    @fixed
    def value(self):
        """The value itself, not a copy."""
        return self._value

    @fixed
    def value_type(self):
        """The declared type."""
        return self._value_type

    @fixed
    def from_state(self):
        """The id of the state whose port it is."""
        return self._from_state

    def __str__(self):
        return f"ScopedData '{self._name}': {self._value!r} (from {self._from_state})"
