"""Fields of messages, requests and responses."""


def set_field_from_inputs(message, key, inputs):
    """Set a field from the input with its name; ``AttributeError`` if one of them is missing."""
    if not hasattr(message, key):
        raise AttributeError(f"a {type(message).__name__} has no field `{key}`")
    if key not in inputs:
        raise AttributeError(f"the state has no input `{key}` to set the field of the {type(message).__name__} by")
    setattr(message, key, inputs[key])


def get_field(message, key):
    """Value of a field; ``AttributeError`` if there is no such field, or no message yet."""
    if message is None:
        raise AttributeError(f"there is no message to take the field `{key}` of")
    return getattr(message, key)


def replace_chars(message):
    """Convert a text to one line: line ends become ``char(10)``."""
    return str(message).replace("\n", "char(10)")
