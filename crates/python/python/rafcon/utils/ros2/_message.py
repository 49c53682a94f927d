"""Fields of messages, requests and responses."""


def set_field(message, key, value):
    """Sets a field; ``AttributeError`` if the message has none of this name."""
    if not hasattr(message, key):
        raise AttributeError(f"a {type(message).__name__} has no field `{key}`")
    setattr(message, key, value)


def get_field(message, key):
    """The value of a field; ``AttributeError`` if there is none, or no message yet."""
    if message is None:
        raise AttributeError(f"there is no message to take the field `{key}` of")
    return getattr(message, key)
