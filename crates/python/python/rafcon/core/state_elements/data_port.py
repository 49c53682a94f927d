"""Input and output data ports of a state."""

from rafcon.core._refusals import fixed, refuses
from rafcon.core.state_elements.state_element import StateElement


@refuses("change_data_type")
class DataPort(StateElement):
    """A named, typed port through which data enters or leaves a state."""

    _fields = ("data_port_id", "name", "data_type", "default_value")

    def __init__(self, name=None, data_type=None, default_value=None, data_port_id=None, parent=None):
        StateElement.__init__(self, parent)
        self._name = name
        self._data_type = data_type
        self._default_value = default_value
        self._data_port_id = data_port_id

    @fixed
    def data_port_id(self):
        """The id (``int``), unique among inputs, outputs and scoped variables of the state."""
        return self._data_port_id

    @fixed
    def name(self):
        """The name (``str``): the key in ``inputs`` or ``outputs``."""
        return self._name

    @fixed
    def data_type(self):
        """The declared type; where it cannot be imported, its name (``str``)."""
        return self._data_type

    @fixed
    def default_value(self):
        """The value that is there if no data flow brings one."""
        return self._default_value

    def __str__(self):
        return f"DataPort '{self._name}' [{self._data_port_id}] ({self._default_value} {self._data_type})"


class InputDataPort(DataPort):
    """A port through which data enters a state."""


class OutputDataPort(DataPort):
    """A port through which data leaves a state."""
