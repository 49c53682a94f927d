"""Conversion of users' values of fields to the form of :mod:`rafcon.ros._backend`, with checks."""

import array
import math
import operator
from collections.abc import Mapping

from rafcon.ros._backend import BYTES, TYPE_CODES, RosError

_SIGNED = {"int8": 8, "int16": 16, "int32": 32, "int64": 64}
_UNSIGNED = {"byte": 8, "char": 8, "uint8": 8, "uint16": 16, "uint32": 32, "uint64": 64}
_RANGES = {name: (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) for name, bits in _SIGNED.items()}
_RANGES.update({name: (0, (1 << bits) - 1) for name, bits in _UNSIGNED.items()})
_FLOAT32_MAX = 3.4028235677973366e38
#: Maximum length of a wrong value in a message.
_SHOWN_MAX = 60


class MessageError(RosError, TypeError, ValueError):
    """A value does not fit its field; the message names message, field, expectation and value."""


def problem(where, expected, value):
    """Create the error for a value of a field (``geometry_msgs/msg/Twist.linear.x``)."""
    shown = repr(value)
    shown = shown if len(shown) <= _SHOWN_MAX else shown[:_SHOWN_MAX] + "…"
    return MessageError(f"{where}: {expected} is expected, not {shown} ({type(value).__name__})")


def spelled(field):
    """Type of a field as in interface files, such as ``float64[36]`` or ``string<=10``."""
    text = field.type + (f"<={field.text_max}" if field.text_max else "")
    ends = {"one": "", "fixed": f"[{field.size}]", "bounded": f"[<={field.size}]", "unbounded": "[]"}
    return text + ends[field.kind]


def zero(field, message):
    """Default value of a field; ``message(name)`` creates an empty message of a type."""
    if field.default is not None:
        return list(field.default) if isinstance(field.default, list) else field.default[:] if _is_array(field.default) else field.default
    if field.kind == "one":
        return _zero_item(field.type, message)
    count = field.size if field.kind == "fixed" else 0
    if field.type in BYTES:
        return bytes(count)
    if field.type in TYPE_CODES:
        return array.array(TYPE_CODES[field.type], bytes(count * array.array(TYPE_CODES[field.type]).itemsize))
    return [_zero_item(field.type, message) for _ in range(count)]


def _is_array(value):
    return isinstance(value, array.array)


def _zero_item(name, message):
    if name == "bool":
        return False
    if name in ("string", "wstring"):
        return ""
    if name in ("float32", "float64"):
        return 0.0
    return 0 if name in _RANGES else message(name)


def checked(field, value, where, message):
    """Convert a user's value to the value of a field; :class:`MessageError` if it does not fit.

    ``message(name, value, where)`` checks nested messages.
    """
    if field.kind == "one":
        return _item(field, value, where, message)
    values = _array(field, value, where, message)
    if field.kind == "fixed" and len(values) != field.size:
        raise MessageError(f"{where}: {field.size} values are expected, not {len(values)} ({spelled(field)})")
    if field.kind == "bounded" and len(values) > field.size:
        raise MessageError(f"{where}: up to {field.size} values are expected, not {len(values)} ({spelled(field)})")
    return values


def _item(field, value, where, message):
    name = field.type
    if name in _RANGES:
        return _integer(name, value, where)
    if name in ("float32", "float64"):
        return _float(name, value, where)
    if name == "bool":
        if isinstance(value, bool) or type(value).__name__ in ("bool_", "bool"):
            return bool(value)
        raise problem(where, "bool", value)
    if name in ("string", "wstring"):
        return _text(field, value, where)
    return message(name, value, where)


def _integer(name, value, where):
    try:
        if isinstance(value, bool):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise problem(where, name, value) from None
    low, high = _RANGES[name]
    if not low <= number <= high:
        raise problem(where, f"{name} ({low} to {high})", value)
    return number


def _float(name, value, where):
    if isinstance(value, (str, bytes, bool)) or not hasattr(type(value), "__float__") and not hasattr(type(value), "__index__"):
        raise problem(where, name, value)
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise problem(where, name, value) from None
    if name == "float32" and _FLOAT32_MAX < abs(number) < math.inf:
        raise problem(where, "float32 (up to 3.4e38)", value)
    return number


def _text(field, value, where):
    if not isinstance(value, str):
        raise problem(where, spelled(field._replace(kind="one")), value)
    try:
        count = len(value.encode() if field.type == "string" else value.encode("utf-16-le")) // (1 if field.type == "string" else 2)
    except UnicodeEncodeError:
        raise problem(where, "a text without half characters", value) from None
    if field.text_max and count > field.text_max:
        raise MessageError(f"{where}: up to {field.text_max} characters are expected, not {count}")
    return str(value)


def _array(field, value, where, message):
    if isinstance(value, (str, Mapping)) or not hasattr(type(value), "__iter__") and not hasattr(type(value), "__getitem__"):
        raise problem(where, spelled(field), value)
    if field.type in BYTES:
        return _bytes(field, value, where, message)
    if field.type in TYPE_CODES:
        return _numbers(field, value, where, message)
    return _items(field, value, where, message)


def _items(field, value, where, message):
    return [_item(field, each, f"{where}[{at}]", message) for at, each in enumerate(value)]


def _bytes(field, value, where, message):
    memory = _memory(value)
    if memory is not None and memory.itemsize == 1 and memory.format in ("B", "c"):
        return memory.tobytes()
    return bytes(_items(field, value, where, message))


def _numbers(field, value, where, message):
    code = TYPE_CODES[field.type]
    if _is_array(value) and value.typecode == code:
        return value
    memory = _memory(value)
    if memory is not None and _same(memory, code):
        made = array.array(code)
        made.frombytes(memory.tobytes())
        return made
    return array.array(code, _items(field, value, where, message))


def _memory(value):
    try:
        memory = memoryview(value)
    except TypeError:
        return None
    # A big-endian array differs in its bytes from a message.
    return memory if memory.ndim == 1 and memory.format[:1] not in "<>!=" else None


def _same(memory, code):
    kinds = ("bhilq", "BHILQ", "fd")
    kind = next(kind for kind in kinds if code in kind)
    return memory.format in kind and memory.itemsize == array.array(code).itemsize
