"""Messages for scripts: fields as attributes and keys, checked on assignment."""

import array
import copy
from collections.abc import Mapping

from rafcon.ros._types import Types
from rafcon.ros._values import MessageError, checked


class Message(Mapping):
    """Message of a type: ``message.linear.x`` is equivalent to ``message["linear"]["x"]``.

    Create it by ``Message("geometry_msgs/Twist", linear={"x": 0.1})``. Assigned values are checked
    against the type at once. Missing fields have their defaults. A message can be compared, copied,
    pickled and used as a mapping. Arrays of numbers are ``bytes`` or ``array.array``.
    """

    __slots__ = ("_type_name", "_types", "_values")

    def __init__(self, type_name, values=None, **fields):
        from rafcon.ros._node import types_for
        from rafcon.ros._types import full_name

        name = full_name(type_name)
        types = types_for(name)
        made = types.build(name, values)
        self._bind(name, types, types.build(name, {**made, **fields}) if fields else made)

    @classmethod
    def of(cls, type_name, types, values):
        """Create a message from complete and valid values."""
        message = cls.__new__(cls)
        message._bind(type_name, types, values)
        return message

    def _bind(self, type_name, types, values):
        object.__setattr__(self, "_type_name", type_name)
        object.__setattr__(self, "_types", types)
        object.__setattr__(self, "_values", values)

    @property
    def type_name(self):
        """Full name of the type."""
        return self._type_name

    def as_dict(self):
        """Copy of the values as plain dictionaries and lists."""
        return _plain(self._values)

    def to(self, cls):
        """Convert to an object of the type's ROS class; needs ``rclpy``."""
        from rafcon.ros._rclpy_messages import filled

        return filled(cls, self._types.build(self._type_name, self))

    def _field(self, name):
        for field in self._types.get(self._type_name).fields:
            if field.name == name:
                return field
        raise MessageError(f"{self._type_name} has no field {name!r}; it has {', '.join(self._values) or 'none'}")

    def __getitem__(self, name):
        value = self._values[name]
        if isinstance(value, dict):
            value = self._values[name] = Message.of(self._field(name).type, self._types, value)
        elif isinstance(value, list) and any(isinstance(each, dict) for each in value):
            type_name = self._field(name).type
            value[:] = [Message.of(type_name, self._types, each) if isinstance(each, dict) else each for each in value]
        return value

    def __getattribute__(self, name):
        # Fields take precedence over methods, because some types have a field `values` or `keys`.
        if name[:1] != "_" and name in object.__getattribute__(self, "_values"):
            return self[name]
        return object.__getattribute__(self, name)

    def __getattr__(self, name):
        if name[:1] == "_":
            raise AttributeError(name)
        constants = self._types.get(self._type_name).constants
        if name in constants:
            return constants[name]
        raise AttributeError(f"{self._type_name} has no field {name!r}; it has {', '.join(self._values) or 'none'}")

    def __setitem__(self, name, value):
        field = self._field(name)
        self._values[name] = checked(field, value, f"{self._type_name}.{name}", self._types.build)

    def __setattr__(self, name, value):
        try:
            self[name] = value
        except MessageError as error:
            if name not in self._values:
                raise AttributeError(str(error)) from None
            raise

    def __iter__(self):
        return iter(self._values)

    def __len__(self):
        return len(self._values)

    def __bool__(self):
        return True

    def __dir__(self):
        return [*object.__dir__(self), *self._values]

    def __eq__(self, other):
        if isinstance(other, Message) and other._type_name != self._type_name:
            return False
        return isinstance(other, Mapping) and _plain(self._values) == _plain(other)

    __hash__ = None

    def __repr__(self):
        return f"{self._type_name}({', '.join(f'{name}={_shown(self[name])}' for name in self)})"

    def __copy__(self):
        return Message.of(self._type_name, self._types, dict(self._values))

    def __deepcopy__(self, _memo):
        return Message.of(self._type_name, self._types, _plain(self._values))

    def __reduce__(self):
        return _restored, (self._type_name, self._types.closure(self._type_name), _plain(self._values))


def _restored(type_name, types, values):
    """Restore a message from a pickle, without ROS."""
    known = Types(_nothing_more)
    known.learn(types)
    return Message.of(type_name, known, values)


def _nothing_more(name):
    return {}


def _plain(value):
    if isinstance(value, Mapping):
        return {name: _plain(each) for name, each in (value._values if isinstance(value, Message) else value).items()}
    if isinstance(value, list):
        return [_plain(each) for each in value]
    return copy.copy(value) if isinstance(value, array.array) else value


#: Maximum number of array items to show.
_ITEMS_MAX = 8


def _shown(value):
    if isinstance(value, (bytes, array.array, list)) and len(value) > _ITEMS_MAX:
        begin = ", ".join(repr(each) for each in list(value[:_ITEMS_MAX]))
        return f"[{begin}, … {len(value)} in all]"
    return repr(list(value) if isinstance(value, (bytes, array.array)) else value)
