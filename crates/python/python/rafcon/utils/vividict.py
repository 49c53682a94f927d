"""Nested dictionaries that grow on access, such as semantic data."""


class Vividict(dict):
    """Dictionary with ``str`` keys that creates missing entries as nested dictionaries.

    ``data["tool"]["gripper"] = "open"`` works on an empty one. Dictionaries that are added are
    converted to this class.
    """

    def __init__(self, dictionary=None):
        dict.__init__(self)
        for key, value in (dictionary or {}).items():
            self[key] = value

    def __missing__(self, key):
        value = self[key] = type(self)()
        return value

    def __setitem__(self, key, value):
        if not isinstance(key, str):
            raise TypeError(f"a key must be a str, not {type(key).__name__}")
        if isinstance(value, dict) and not isinstance(value, Vividict):
            value = Vividict(value)
        dict.__setitem__(self, key, value)

    def update(self, *dictionaries, **named):
        """Update as ``dict.update``; dictionaries inside are converted."""
        for key, value in dict(*dictionaries, **named).items():
            self[key] = value

    def setdefault(self, key, default=None):
        """Set a default as ``dict.setdefault``; a dictionary is converted."""
        if key not in self:
            self[key] = default
        return self[key]

    def set_dict(self, new_dict):
        """Replace the whole content."""
        self.clear()
        self.update(new_dict)

    def to_dict(self):
        """Copy as plain dictionaries."""
        return Vividict.vividict_to_dict(self)

    @classmethod
    def from_dict(cls, dictionary):
        """Create one with the content of a dictionary."""
        return cls(dictionary)

    @staticmethod
    def vividict_to_dict(vividict, native_strings=False):
        """Copy as plain dictionaries; ``native_strings`` has no effect: texts are ``str``."""
        return {
            key: Vividict.vividict_to_dict(value) if isinstance(value, Vividict) else value
            for key, value in vividict.items()
        }

    def __deepcopy__(self, memo):
        import copy

        return type(self)({key: copy.deepcopy(value, memo) for key, value in self.items()})

    def __reduce__(self):
        return (type(self), (dict(self),))
