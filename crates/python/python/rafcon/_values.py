"""Values as text: the encoding of state machine files, and the one in which results are shown.

``decode`` reads what stands in files; ``decode_plain`` reads what a client sends; ``encode`` makes JSON of anything for
people and programs to look at.
"""

import json
import math

from rafcon._types import resolve_type

#: How deep nested values are shown, and how much of a text representation.
_DEPTH_MAX = 64
_REPRESENTATION_MAX = 200
_MESSAGE_MAX = 16 * 1024
#: A key with more digits stays a text.
_DIGITS_MAX = 18
#: What an object of a file may be without importing anything.
_PLAIN_COLLECTIONS = {
    "__builtin__.tuple": tuple,
    "builtins.tuple": tuple,
    "__builtin__.set": set,
    "builtins.set": set,
}
#: The types that a client may name.
_PLAIN_TYPES = {kind.__name__: kind for kind in (bool, bytes, complex, dict, float, int, list, set, str, tuple, type(None))}


def decode(text):
    """The object of a JSON text in the encoding of state machine files.

    ``{"__jsonqualname__": …}`` is a tuple, a set, an array or an object of a class with ``from_dict``;
    ``{"__type__": …}`` is a type. Keys of a plain object become ``int`` if every one is the text of an integer.
    Raises ``ValueError`` for what is no JSON, and ``ImportError`` or ``AttributeError`` for a class that is not there.
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
    """The value of a JSON text that a client sends: an input, an answer, data of a start.

    Reads the encoding of ``decode`` as far as it is plain data: tuples, sets and Python's own types of values. Imports no
    module and constructs no object: raises ``ValueError`` for anything else that names a class.
    """
    return json.loads(text, object_hook=_decode_plain_object)


def _decode_plain_object(members):
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
    """The value as something that JSON has.

    An exception is ``{"__exc__": class, "msg": first 16,384 characters}``, a tuple ``{"__tuple__": […]}``, a type ``{"__type__": name}``,
    anything else ``{"__repr__": first 200 characters, "__class__": class}``. Keys of a dictionary become texts.
    """
    return _encode(value, _DEPTH_MAX)


def _encode(value, depth):
    if value is None or isinstance(value, (bool, int, str)):
        return _plain(value)
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else _represent(value)
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
        return {_text(key, str): _encode(item, depth - 1) for key, item in value.items()}
    return _represent(value)


def _plain(value):
    """Without the class of a user's ``int`` or ``str``; texts that UTF-8 cannot carry are escaped."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int):
        return int(value)
    return _utf8(str.__str__(value))


def _represent(value):
    return {"__repr__": _text(value, repr)[:_REPRESENTATION_MAX], "__class__": type(value).__name__}


def _message(exception):
    """The text of an exception, which a script makes as long as it likes: not all of what is very long."""
    text = _text(exception, str)
    return text if len(text) <= _MESSAGE_MAX else f"{text[:_MESSAGE_MAX]}… ({len(text)} characters)"


def _text(value, function):
    """``str`` or ``repr`` of a user's object, which may itself fail."""
    try:
        return _utf8(function(value))
    except Exception as error:
        return f"<{type(value).__name__} whose {function.__name__} fails: {type(error).__name__}>"


def _utf8(text):
    return text.encode("utf-8", "backslashreplace").decode("utf-8")
