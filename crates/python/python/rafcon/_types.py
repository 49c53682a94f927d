"""Python types by name, and values parsed from text.

A file names a port's type by a dotted name, and often its default by a text. This module resolves
both.
"""

import builtins
import importlib

_LITERAL_TYPES = (list, dict, tuple)


def resolve_type(name):
    """Type of a dotted name such as ``builtins.int``, ``numpy.ndarray`` or ``package.Outer.Inner``.

    ``__builtin__.int`` and a bare ``int`` are accepted too. Raises ``ImportError`` or
    ``AttributeError`` if there is no such module or name, and ``TypeError`` if it is not a type.
    """
    if name == "None" or name.rpartition(".")[2] == "NoneType":
        return type(None)
    module, dot, attribute = name.rpartition(".")
    if not dot or module in ("builtins", "__builtin__"):
        found = getattr(builtins, attribute)
    else:
        found = _attribute(name)
    if not isinstance(found, type):
        raise TypeError(f"`{name}` is a {type(found).__name__}, not a type")
    return found


def _attribute(name):
    """Object of a dotted name: the longest importable module, and attributes of it."""
    parts = name.split(".")
    for end in range(len(parts) - 1, 0, -1):
        module = ".".join(parts[:end])
        try:
            found = importlib.import_module(module)
        except ModuleNotFoundError as error:
            if end > 1 and error.name and (module + ".").startswith(error.name + "."):
                continue
            raise
        for part in parts[end:]:
            found = getattr(found, part)
        return found
    raise ImportError(f"`{name}` names no module")


def convert(value, type_name):
    """Convert a text to a value of a port's type; other values are returned unchanged.

    ``"None"`` becomes None. ``"$name"`` (a reference to a global variable) is returned unchanged.
    Raises ``ValueError`` with the reason if the text is not a value of the type.
    """
    if not isinstance(value, str):
        return value
    if value == "None":
        return None
    if len(value) > 1 and value.startswith("$"):
        return value
    return _from_text(value, resolve_type(type_name))


def _from_text(text, data_type):
    try:
        return _rule(data_type)(text, data_type)
    except Exception as error:
        reason = str(error) or type(error).__name__
        raise ValueError(f"{text!r} is no {data_type.__name__}: {reason}") from error


def _rule(data_type):
    if data_type in (str, type(None)):
        return lambda text, _type: text
    if data_type is bool:
        return lambda text, _type: bool(_evaluated(text))
    if data_type in _LITERAL_TYPES:
        return _literal
    if data_type is object:
        return _literal_or_text
    return lambda text, constructor: constructor(text)


def _literal(text, data_type):
    value = _evaluated(text)
    if type(value) is not data_type:
        raise TypeError(f"it is a {type(value).__name__}")
    return value


def _literal_or_text(text, _data_type):
    try:
        return _evaluated(text)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return text


def _evaluated(text):
    import ast  # as late as this, for it takes long to load and is rarely wanted

    return ast.literal_eval(text)
