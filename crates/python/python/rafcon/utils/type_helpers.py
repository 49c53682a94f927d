"""Types and values from text, as ports of a machine take them."""

from rafcon._types import convert, resolve_type


def convert_string_to_type(string_value):
    """The type of a name; a type is returned as it is. ``ValueError`` if there is no such type."""
    if isinstance(string_value, type):
        return string_value
    if string_value is None:
        return type(None)
    try:
        return resolve_type(string_value)
    except (ImportError, AttributeError, TypeError) as error:
        raise ValueError(f"there is no type `{string_value}`: {error}") from error


def convert_string_value_to_type_value(string_value, data_type):
    """The value that a text stands for in a port of a type. ``AttributeError`` if it stands for none."""
    try:
        return convert(string_value, f"{data_type.__module__}.{data_type.__qualname__}")
    except ValueError as error:
        raise AttributeError(str(error)) from error


def type_inherits_of_type(inheriting_type, base_type):
    """Whether the first type is the second, or inherits from it."""
    return issubclass(inheriting_type, base_type)


def type_name(data_type):
    """The dotted name of a type; a name is returned as it is."""
    return data_type if isinstance(data_type, str) else f"{data_type.__module__}.{data_type.__qualname__}"


def port_default(value, data_type):
    """The default of a port of a type: text is converted, ``AttributeError`` if it cannot be.

    ``TypeError`` for another value that is not of the type.
    """
    if isinstance(value, str):
        return convert_string_value_to_type_value(value, data_type)
    if value is None or data_type is type(None) or isinstance(value, data_type):
        return value
    raise TypeError(f"the default {value!r} is of type {type(value).__name__}, but the port's is {data_type.__name__}")


def named(name):
    """The name of an element, which is a text that is not empty."""
    of_type(name, str, "a name")
    if not name:
        raise ValueError("a name must have at least one character")
    return name


def of_type(value, wanted, what, or_none=False):
    """Raises ``ValueError`` unless the value is of a type (or, if that is allowed, None)."""
    if not isinstance(value, wanted) and not (or_none and value is None):
        raise ValueError(f"{what} must be of type {wanted.__name__}, not {type(value).__name__}")
