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
