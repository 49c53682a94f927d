"""Fields of messages, requests and responses."""


def set_field(message, key, value):
    """Sets a field; ``AttributeError`` if the message has none of this name."""
    if not hasattr(message, key):
        raise AttributeError("a %s has no field `%s`" % (type(message).__name__, key))
    setattr(message, key, value)


def get_field(message, key):
    """The value of a field; ``AttributeError`` if there is none, or no message yet."""
    if message is None:
        raise AttributeError("there is no message to take the field `%s` of" % key)
    return getattr(message, key)
