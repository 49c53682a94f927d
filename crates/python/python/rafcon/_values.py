"""Values as text, in the encoding of state machine files and in that of displayed results.

``decode`` reads values of files, and ``decode_plain`` values from clients. ``encode`` converts any
value to JSON for display.
"""

import json
import math

from rafcon._types import resolve_type

#: Maximum depth of nested values, and maximum lengths of the texts of objects and exceptions.
_DEPTH_MAX = 64
_REPRESENTATION_MAX = 200
_MESSAGE_MAX = 16 * 1024
#: Maximum number of digits of a key that becomes an integer; longer ones remain texts.
_DIGITS_MAX = 18
#: Largest integer that every JSON reader keeps exactly, and maximum number of bits of a larger one.
_EXACT_MAX = 2**53 - 1
_INT_BITS_MAX = 3400
#: Objects with one of these keys are not plain dictionaries.
_TAGS = ("__tuple__", "__set__", "__dict__", "__int__", "__float__", "__exc__", "__type__", "__repr__")
#: Types of objects in files that need no import.
_PLAIN_COLLECTIONS = {
    "__builtin__.tuple": tuple,
    "builtins.tuple": tuple,
    "__builtin__.set": set,
    "builtins.set": set,
}
#: Values whose ``__len__`` is their number of items instead of the length of their text.
_SIZED = (bytes, bytearray, set, frozenset)
#: Types that a client may name.
_PLAIN_TYPES = {kind.__name__: kind for kind in (bool, bytes, complex, dict, float, int, list, set, str, tuple, type(None))}


def decode(text):
    """Object of a JSON text in the encoding of state machine files.

    ``{"__jsonqualname__": …}`` is a tuple, a set, an array or an object of a class with
    ``from_dict``; ``{"__type__": …}`` is a type. Keys of a plain object become ``int`` if all of
    them are texts of integers. Raises ``ValueError`` for invalid JSON, and ``ImportError`` or
    ``AttributeError`` for a missing class.
    """
    return json.loads(text, object_hook=_decode_object)


def _decode_object(members):
    if "__jsonqualname__" in members:
        rest = {key: value for key, value in members.items() if key != "__jsonqualname__"}
        return _decode_qualified(members["__jsonqualname__"], rest)
    if "__type__" in members:
        return resolve_type(members["__type__"])
    if members and all(_is_integer(key) for key in members):
        return {int(key): value for key, value in members.items()}
    return members


def decode_plain(text):
    """Value of a JSON text from a client: an input, an answer, data of a start.

    Accepts the encoding of ``encode``, and plain data in that of ``decode``: tuples, sets and
    Python's own types of values. Imports no module and constructs no object. Raises ``ValueError``
    for anything else that names a class.
    """
    return json.loads(text, object_hook=_decode_plain_object)


def _decode_plain_object(members):
    if len(members) == 1:
        ((tag, inner),) = members.items()
        if tag in _DECODERS:
            return _decode_tagged(tag, inner)
    if members.keys() == {"__repr__", "__class__"} and members["__class__"] == "float":
        return _decode_tagged("__float__", members["__repr__"])
    if "__jsonqualname__" in members:
        name = members["__jsonqualname__"]
        items = members.get("items")
        if isinstance(name, str) and name in _PLAIN_COLLECTIONS and isinstance(items, list):
            return _PLAIN_COLLECTIONS[name](items)
    elif "__type__" in members:
        name = members["__type__"]
        module, _dot, attribute = name.rpartition(".") if isinstance(name, str) else (None, None, None)
        if module in ("", "builtins", "__builtin__") and attribute in _PLAIN_TYPES:
            return _PLAIN_TYPES[attribute]
    else:
        return _decode_object(members)
    raise ValueError(
        f"a client's value names the class {name!r}, and no class is imported for a client: send plain JSON, "
        "and let a script make the object"
    )


#: Values that JSON lacks, by their tag.
_DECODERS = {
    "__int__": (int, str),
    "__float__": (float, str),
    "__tuple__": (tuple, list),
    "__set__": (set, list),
    "__dict__": (dict, list),
}


def _decode_tagged(tag, inner):
    make, kind = _DECODERS[tag]
    try:
        if isinstance(inner, kind):
            return make(inner)
    except (TypeError, ValueError) as error:
        raise ValueError(f"`{tag}` of a client's value cannot be read: {error}") from None
    raise ValueError(f"`{tag}` of a client's value holds no {kind.__name__}")


def _is_integer(key):
    digits = key[1:] if key.startswith("-") else key
    if not (digits.isascii() and digits.isdigit()) or len(digits) > _DIGITS_MAX:
        return False
    return str(int(key)) == key


def _decode_qualified(name, members):
    if name in _PLAIN_COLLECTIONS:
        return _PLAIN_COLLECTIONS[name](members["items"])
    if name == "numpy.ndarray":
        import numpy

        return numpy.array(members["items"])
    found = resolve_type(name)
    return found.from_dict(members) if hasattr(found, "from_dict") else members


def encode(value):
    """Convert a value to JSON types.

    An exception is ``{"__exc__": class, "msg": first 16,384 characters}``, a tuple ``{"__tuple__":
    […]}``, a type ``{"__type__": name}``, an integer beyond ±(2^53 - 1) ``{"__int__": digits}``,
    negative zero ``{"__float__": "-0.0"}``. A dictionary whose keys are not all plain texts is
    ``{"__dict__": [[key, value], …]}``. Anything else is ``{"__repr__": first 200 characters,
    "__class__": class}``, with ``__len__`` if the text was cut.
    """
    return _encode(value, _DEPTH_MAX)


def _encode(value, depth):
    if value is None or isinstance(value, (bool, int, str)):
        return _plain(value)
    if isinstance(value, float):
        return _encode_float(value)
    if isinstance(value, BaseException):
        return {"__exc__": type(value).__name__, "msg": _message(value)}
    if isinstance(value, type):
        return {"__type__": value.__name__}
    if depth == 0:
        return _represent(value)
    if isinstance(value, tuple):
        return {"__tuple__": [_encode(item, depth - 1) for item in value]}
    if isinstance(value, list):
        return [_encode(item, depth - 1) for item in value]
    if isinstance(value, dict):
        if _has_plain_keys(value):
            return {str.__str__(key): _encode(item, depth - 1) for key, item in value.items()}
        return {"__dict__": [[_encode(key, depth - 1), _encode(item, depth - 1)] for key, item in value.items()]}
    return _represent(value)


def _has_plain_keys(value):
    """True if a JSON object keeps the keys: ``decode`` makes integers of texts of integers."""
    if not all(isinstance(key, str) and key not in _TAGS and _is_utf8(key) for key in value):
        return False
    return not value or not all(map(_is_integer, value))


def _plain(value):
    """Convert an instance of a user's subclass of ``int`` or ``str`` to a plain value."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int):
        return _encode_int(int(value))
    text = str.__str__(value)
    return text if _is_utf8(text) else _represent(text)


def _encode_int(value):
    if -_EXACT_MAX <= value <= _EXACT_MAX:
        return value
    if value.bit_length() <= _INT_BITS_MAX:
        return {"__int__": str(value)}
    return {"__repr__": f"an int of {value.bit_length()} bits", "__class__": "int"}


def _encode_float(value):
    value = float(value)
    if not math.isfinite(value):
        return _represent(value)
    is_negative_zero = value == 0.0 and math.copysign(1.0, value) < 0
    return {"__float__": "-0.0"} if is_negative_zero else value


def _represent(value):
    text = _text(value, repr)
    shown = {"__repr__": text[:_REPRESENTATION_MAX], "__class__": type(value).__name__}
    if len(text) > _REPRESENTATION_MAX:
        shown["__len__"] = len(value) if type(value) in _SIZED else len(text)
    return shown


def _message(exception):
    """Text of an exception, cut to its first characters if it is very long."""
    text = _text(exception, str)
    return text if len(text) <= _MESSAGE_MAX else f"{text[:_MESSAGE_MAX]}… ({len(text)} characters)"


def _text(value, function):
    """Result of ``str`` or ``repr`` for a user's object, or a placeholder if that raises."""
    try:
        return _utf8(function(value))
    except Exception as error:
        return f"<{type(value).__name__} whose {function.__name__} fails: {type(error).__name__}>"


def _is_utf8(text):
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True


def _utf8(text):
    return text.encode("utf-8", "backslashreplace").decode("utf-8")
