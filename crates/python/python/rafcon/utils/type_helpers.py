"""Types and values parsed from text, by the rules for ports of a machine."""

from rafcon._types import convert, resolve_type


def convert_string_to_type(string_value):
    """Type with this name; a type is returned unchanged. ``ValueError`` if there is none."""
    if isinstance(string_value, type):
        return string_value
    if string_value is None:
        return type(None)
    try:
        return resolve_type(string_value)
    except (ImportError, AttributeError, TypeError) as error:
        raise ValueError(f"there is no type `{string_value}`: {error}") from error


def convert_string_value_to_type_value(string_value, data_type):
    """Parse a text as a value of a port's type. ``AttributeError`` if it is not valid."""
    try:
        return convert(string_value, f"{data_type.__module__}.{data_type.__qualname__}")
    except ValueError as error:
        raise AttributeError(str(error)) from error


def type_inherits_of_type(inheriting_type, base_type):
    """True if the first type is the second one or a subclass of it."""
    return issubclass(inheriting_type, base_type)


def type_name(data_type):
    """Dotted name of a type; a name is returned unchanged."""
    return data_type if isinstance(data_type, str) else f"{data_type.__module__}.{data_type.__qualname__}"


def port_default(value, data_type):
    """Convert a default of a port from text; ``AttributeError`` if the text is not valid.

    Raises ``TypeError`` for another value that is not of the type.
    """
    if isinstance(value, str):
        return convert_string_value_to_type_value(value, data_type)
    if value is None or data_type is type(None) or isinstance(value, data_type):
        return value
    raise TypeError(f"the default {value!r} is of type {type(value).__name__}, but the port's is {data_type.__name__}")


def named(name):
    """Return the name of an element; ``ValueError`` if it is no text or empty."""
    of_type(name, str, "a name")
    if not name:
        raise ValueError("a name must have at least one character")
    return name


def of_type(value, wanted, what, or_none=False):
    """Raise ``ValueError`` unless the value is of a type or, with ``or_none``, None."""
    if not isinstance(value, wanted) and not (or_none and value is None):
        raise ValueError(f"{what} must be of type {wanted.__name__}, not {type(value).__name__}")
