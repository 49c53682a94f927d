"""ROS classes of interface files, and conversion of their messages to plain ones."""

import array
import importlib

from rafcon.ros._backend import BYTES, TYPE_CODES, Field, MessageType, UnknownType

#: Names of primitive types that differ between ROS and interface files.
_PRIMITIVES = {"boolean": "bool", "octet": "byte", "float": "float32", "double": "float64"}
_PARTS = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}


def interface(name):
    """Class of a message, service or action; ``UnknownType`` if it is missing."""
    package, kind, short = name.split("/")
    try:
        module = importlib.import_module(f"{package}.{kind}")
    except ModuleNotFoundError as error:
        if error.name not in (package, f"{package}.{kind}"):
            raise
        raise UnknownType(
            f"there is no type {name}: Python finds no package {package!r} with interfaces ({kind}); install it, or source its "
            f"workspace before the start"
        ) from None
    found = getattr(module, short, None)
    if found is None:
        known = ", ".join(sorted(each for each in vars(module) if each[:1].isupper())) or "none"
        raise UnknownType(f"there is no type {name}: {package}.{kind} has {known}")
    return found


def message_class(name):
    """Class of a message type, also in services and actions (``…_Request``, ``…_Goal``)."""
    if "/msg/" in name:
        return interface(name)
    base, _, part = name.rpartition("_")
    return getattr(interface(base), part)


def parts(name):
    """Names of the message types of a message, service or action."""
    return [f"{name}_{part}" for part in _PARTS.get(name.split("/")[1], ())] or [name]


class Classes:
    """Cache of classes, with their types and conversions of their messages."""

    def __init__(self):
        self._known = {}

    def describe(self, name):
        """Types of an interface with all types that they contain, by name."""
        found = {}
        wanted = parts(name)
        while wanted:
            each = wanted.pop()
            if each not in found:
                found[each] = type_ = self.known(each).type
                wanted += [field.type for field in type_.fields if "/" in field.type]
        return found

    def known(self, name):
        """:class:`_Class` of a message type."""
        found = self._known.get(name)
        if found is None:
            found = self._known[name] = _Class(self, name, message_class(name))
        return found


class _Class:
    """Class of messages."""

    def __init__(self, classes, name, cls):
        if getattr(cls, "_TYPE_SUPPORT", None) is None:
            type(cls).__import_type_support__()
        self.cls = cls
        names = list(cls.get_fields_and_field_types())
        bare = [Field(field, *_kind(slot)) for field, slot in zip(names, cls.SLOT_TYPES)]
        self._steps = [(field.name, *_steps(classes, field)) for field in bare]
        defaults = self.plain(cls())
        fields = tuple(field._replace(default=_default(field, defaults[field.name])) for field in bare)
        self.type = MessageType(name, fields, _constants(cls))

    def plain(self, message):
        """Convert an object of the class to a plain message."""
        return {name: to_plain(getattr(message, name)) for name, to_plain, _ in self._steps}

    def made(self, values):
        """Convert a plain message to an object of the class."""
        message = self.cls()
        for name, _, to_ros in self._steps:
            setattr(message, name, to_ros(values[name]))
        return message


def _constants(cls):
    names = [name for name in dir(type(cls)) if name[:1].isupper()]
    return {name: getattr(cls, name) for name in names if isinstance(getattr(cls, name), (bool, int, float, str, bytes))}


def _default(field, value):
    """Default of a field; None if it is zero, empty or false."""
    if "/" in field.type:
        return None
    if field.kind == "one":
        return value or None
    if field.kind == "fixed":
        return value if any(value) else None
    return value if len(value) else None


def _kind(slot):
    """Return (type, kind, size, text_max) of a field."""
    sort = type(slot).__name__
    if sort in ("Array", "BoundedSequence", "UnboundedSequence"):
        name, _, _, text_max = _kind(slot.value_type)
        size = getattr(slot, "size" if sort == "Array" else "maximum_size", 0)
        return name, {"Array": "fixed", "BoundedSequence": "bounded"}.get(sort, "unbounded"), size, text_max
    if sort.endswith("WString"):
        return "wstring", "one", 0, getattr(slot, "maximum_size", 0)
    if sort.endswith("String"):
        return "string", "one", 0, getattr(slot, "maximum_size", 0)
    if sort == "NamespacedType":
        return "/".join(slot.namespaced_name()), "one", 0, 0
    return _PRIMITIVES.get(slot.typename, slot.typename), "one", 0, 0


def _steps(classes, field):
    """Return the conversions from an attribute of an object to a plain value, and back."""
    if "/" in field.type:
        return _message_steps(classes, field)
    if field.kind == "one":
        return ((lambda value: value[0]), (lambda value: bytes((value,)))) if field.type == "byte" else (_same, _same)
    if field.type == "byte":
        return b"".join, lambda values: [bytes((value,)) for value in values]
    if field.type in BYTES:
        fixed = field.kind == "fixed"
        return (lambda values: values.tobytes()), _fixed("uint8") if fixed else lambda values: array.array("B", values)
    if field.type in TYPE_CODES:
        code = TYPE_CODES[field.type]
        if field.kind != "fixed":
            return (lambda values: values[:]), _same
        return (lambda values: _array(code, values.tobytes())), _fixed(field.type)
    return list, _same


def _message_steps(classes, field):
    inside = lambda: classes.known(field.type)  # noqa: E731, a type may hold itself only through others, so it is known in time
    if field.kind == "one":
        return (lambda value: inside().plain(value)), (lambda value: inside().made(value))
    return (lambda values: list(map(inside().plain, values))), (lambda values: list(map(inside().made, values)))


def _fixed(name):
    """Conversion of fixed arrays to ``numpy``, which ROS installs."""

    def made(values):
        import numpy

        return numpy.array(memoryview(values), dtype=name)

    return made


def _array(code, content):
    made = array.array(code)
    made.frombytes(content)
    return made


def _same(value):
    return value


def filled(cls, values):
    """Create an object of a class with the values of a plain message of its type."""
    package, kind, *_ = cls.__module__.split(".")
    return _Class(Classes(), f"{package}/{kind}/{cls.__name__}", cls).made(values)
