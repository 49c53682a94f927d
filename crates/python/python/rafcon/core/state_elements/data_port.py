"""Input and output data ports of a state."""

from rafcon import _objects
from rafcon.core.state_elements.state_element import StateElement, field
from rafcon.utils.log import get_logger
from rafcon.utils.type_helpers import convert_string_to_type, named, port_default, type_name

logger = get_logger(__name__)


class DataPort(StateElement):
    """Named and typed port through which data enters or leaves a state."""

    _fields = ("data_port_id", "name", "data_type", "default_value")
    _verb = "port"

    data_port_id = field("The id (``int``), unique among inputs, outputs and scoped variables of the state.")

    def __init__(self, name=None, data_type=None, default_value=None, data_port_id=None, parent=None):
        StateElement.__init__(self, parent, (data_port_id, name, data_type, default_value))
        if data_type is not None:
            data_type = convert_string_to_type(data_type)
            self._values = (data_port_id, name, data_type, port_default(default_value, data_type))

    @staticmethod
    def _read(fact):
        name, data_type, default = fact
        return name, _objects.port_type(data_type), default

    def _address(self):
        return (self._group, self._values[0])

    @property
    def name(self):
        """Name (``str``), which is the key in ``inputs`` or ``outputs``."""
        return self._get("name")

    @name.setter
    def name(self, name):
        self._set("rename", {"name": named(name)}, name)

    @property
    def data_type(self):
        """Declared type, or its name (``str``) if it cannot be imported."""
        return self._get("data_type")

    @data_type.setter
    def data_type(self, data_type):
        self.change_data_type(data_type)

    @property
    def default_value(self):
        """Value that is used if no data flow provides one. Text is converted to the type.

        Assigning it at a port of a library state sets a value of that state, not of the library.
        """
        own = getattr(self._parent, "_own_default", None)
        is_own, default = (False, None) if own is None else own(self)
        return default if is_own else self._get("default_value")

    @default_value.setter
    def default_value(self, default_value):
        default = port_default(default_value, self.data_type)
        set_default = getattr(self._parent, "_set_default", None)
        if set_default is None:
            self._set("default", {"default_value": default}, default)
        else:
            set_default(self, default)

    def change_data_type(self, data_type, default_value=None):
        """Set the type and the default; without a default, convert the present one to the type.

        A default that cannot be converted is dropped, and a warning is logged.
        """
        data_type = convert_string_to_type(data_type)
        if default_value is None:
            default = _converted(self.default_value, data_type)
        else:
            default = port_default(default_value, data_type)
        self._set("type", {"data_type": data_type, "default_value": default}, type_name(data_type), default)

    def __str__(self):
        key, name, data_type, default = self._content()
        return f"DataPort '{name}' [{key}] ({default} {data_type})"


#: Conversions of defaults: from old types to new ones.
_CONVERTED = {int: (float, str), float: (int, str), bool: (str,), list: (tuple,), tuple: (list,)}


def _converted(default, data_type):
    """Convert a port's default to a new type; None if that is not possible."""
    if default is None or isinstance(default, data_type):
        return default
    try:
        if isinstance(default, str):
            return port_default(default, data_type)
        if data_type in _CONVERTED.get(type(default), ()):
            return data_type(default)
    except (ArithmeticError, AttributeError, ValueError):
        pass
    logger.warning("the default %r is dropped: it cannot be converted to the type %s", default, type_name(data_type))
    return None


class InputDataPort(DataPort):
    """Port through which data enters a state."""

    _group = "inputs"


class OutputDataPort(DataPort):
    """Port through which data leaves a state."""

    _group = "outputs"
