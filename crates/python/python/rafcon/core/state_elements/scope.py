"""Data of a container: scoped variables and current values."""

import time

from rafcon.core.state_elements.data_port import DataPort
from rafcon.core.state_elements.state_element import StateElement, field


class ScopedVariable(DataPort):
    """Variable of a container, read and written by data flows."""

    _group = "scoped_variables"

    def __init__(self, name=None, data_type=None, default_value=None, scoped_variable_id=None, parent=None):
        DataPort.__init__(self, name, data_type, default_value, scoped_variable_id, parent)

    def __str__(self):
        key, name, data_type, default = self._content()
        return f"ScopedVariable '{name}' [{key}] ({data_type} {default})"


def generate_time_stamp():
    """Current time (µs since 1970)."""
    return int(time.time() * 1_000_000)


class ScopedData(StateElement):
    """Present value of a port or scoped variable."""

    _fields = ("name", "value", "value_type", "from_state", "data_port_type")

    name = field("The name of the port.")
    value = field("The value itself, not a copy.")
    value_type = field("The declared type.")
    from_state = field("The id of the state whose port it is.")
    data_port_type = field("The class of the port: ``InputDataPort``, ``OutputDataPort`` or ``ScopedVariable``.")

    def __init__(self, name, value, value_type, from_state, data_port_type, parent=None):
        StateElement.__init__(self, parent, (name, value, value_type, from_state, data_port_type))

    def __str__(self):
        return f"ScopedData '{self.name}': {self.value!r} (from {self.from_state})"
