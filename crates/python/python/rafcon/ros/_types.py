"""Types by name, and their messages: complete, checked, with the defaults of the type."""

import difflib
import threading
from collections.abc import Mapping

from rafcon.ros._backend import MessageType, RosError, UnknownType
from rafcon.ros._values import MessageError, checked, problem, zero

_KINDS = ("msg", "srv", "action")


def full_name(name, kind="msg"):
    """Full name of a type: ``geometry_msgs/Twist`` becomes ``geometry_msgs/msg/Twist``.

    Dots are accepted instead of slashes, and classes and objects of ROS instead of a name.
    """
    if not isinstance(name, str):
        return _name_of_class(name)
    parts = [part for part in name.replace(".", "/").replace("::", "/").split("/") if part]
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or parts[1] not in _KINDS:
        raise UnknownType(f"{name!r} is no name of a type; write it as package/{kind}/Name, such as {_EXAMPLES[kind]}")
    if parts[1] != kind:
        raise UnknownType(f"{name!r} is no {_WORDS[kind]}: the name of one has /{kind}/ in it, such as {_EXAMPLES[kind]}")
    return "/".join(parts)


_EXAMPLES = {"msg": "geometry_msgs/msg/Twist", "srv": "std_srvs/srv/Trigger", "action": "nav2_msgs/action/NavigateToPose"}
_WORDS = {"msg": "message", "srv": "service", "action": "action"}


def _name_of_class(cls):
    cls = cls if isinstance(cls, type) else type(cls)
    parts = cls.__module__.split(".")
    if len(parts) < 2 or parts[1] not in _KINDS:
        raise UnknownType(f"{cls.__module__}.{cls.__qualname__} is no class that ROS has made of an interface file")
    return f"{parts[0]}/{parts[1]}/{cls.__name__}"


def is_ros_object(value):
    """True if a value is a message of a ROS class."""
    return hasattr(type(value), "get_fields_and_field_types")


class Types:
    """Cache of types; ``describe(name)`` provides missing ones."""

    def __init__(self, describe):
        self._describe = describe
        self._lock = threading.Lock()
        self._known = {}
        self._asked = set()

    def learn(self, types):
        """Add types by name."""
        with self._lock:
            self._known.update(types)

    def require(self, name):
        """Load a type (or a service, an action) with all types that it contains."""
        if name not in self._asked and name not in self._known:
            self.learn(self._describe(name))
            self._asked.add(name)

    def get(self, name):
        """Message type by name, such as ``std_srvs/srv/Trigger_Request``."""
        found = self._known.get(name)
        if found is None:
            base, _, part = name.rpartition("_")
            self.require(base if "/msg/" not in name and part else name)
            found = self._known.get(name)
        if found is None:
            raise UnknownType(f"there is no type {name}")
        return found

    def closure(self, name):
        """Type with all types that it contains, by name."""
        found = {}
        wanted = [name]
        while wanted:
            type_ = self.get(wanted.pop())
            found[type_.name] = type_
            wanted += [field.type for field in type_.fields if "/" in field.type and field.type not in found]
        return found

    def empty(self, name):
        """Message with the defaults of its type."""
        return {field.name: zero(field, self.empty) for field in self.get(name).fields}

    def build(self, name, value=None, where=None):
        """Build a complete, checked message from a mapping, a message, or its only value."""
        type_ = self.get(name)
        where = where or name
        given = self._given(type_, value, where)
        self._refuse_strangers(type_, given, where)
        return {
            field.name: checked(field, given[field.name], f"{where}.{field.name}", self.build)
            if field.name in given
            else zero(field, self.empty)
            for field in type_.fields
        }

    def _given(self, type_, value, where):
        if value is None:
            return {}
        if isinstance(value, Mapping):
            self._refuse_other_message(type_, getattr(value, "_type_name", None), where)
            return value
        if is_ros_object(value):
            self._refuse_other_message(type_, full_name(type(value), _kind(type(value))), where)
            return {field.name: _plain(field, getattr(value, field.name)) for field in type_.fields}
        if len(type_.fields) == 1:
            return {type_.fields[0].name: value}
        names = ", ".join(field.name for field in type_.fields) or "none"
        raise problem(where, f"a message with the fields {names}", value)

    @staticmethod
    def _refuse_other_message(type_, name, where):
        if name is not None and name != type_.name:
            raise MessageError(f"{where}: a message of the type {type_.name} is expected, not of {name}")

    @staticmethod
    def _refuse_strangers(type_: MessageType, given, where):
        names = [field.name for field in type_.fields]
        for name in given:
            if name not in names:
                close = difflib.get_close_matches(str(name), names, 1)
                hint = f"; is {close[0]} meant?" if close else f"; it has {', '.join(names) or 'none'}"
                raise MessageError(f"{where} has no field {name!r}{hint}")


def _kind(cls):
    return cls.__module__.split(".")[1]


def _plain(field, value):
    """Convert a field of an object of ROS, in which a byte is a ``bytes`` of length 1."""
    if field.type != "byte":
        return value
    return value[0] if field.kind == "one" else b"".join(value)


def absolute(name, namespace="/"):
    """Convert the name of a topic, service, action or node to an absolute one."""
    if not isinstance(name, str) or not name.strip("/"):
        raise RosError(f"{name!r} is no name of a topic, service, action or node; write it as /robot/scan")
    name = name if name.startswith("/") else f"{namespace.rstrip('/')}/{name}"
    bad = [part for part in name[1:].split("/") if not _is_part(part)]
    if bad:
        raise RosError(f"{name!r} is no name for ROS: its parts are letters, digits and underscores, not {bad[0]!r}")
    return name


def _is_part(part):
    return part.isascii() and part.replace("_", "a").isalnum() and not part[0].isdigit()
