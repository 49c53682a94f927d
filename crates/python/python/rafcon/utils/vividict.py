"""Nested dictionaries that grow as they are read; semantic data is one."""


class Vividict(dict):
    """A dictionary with ``str`` keys whose missing entries appear as further ones.

    ``data["tool"]["gripper"] = "open"`` works on an empty one. Dictionaries put in become of this class too.
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
        """As ``dict.update``; dictionaries inside are converted."""
        for key, value in dict(*dictionaries, **named).items():
            self[key] = value

    def setdefault(self, key, default=None):
        """As ``dict.setdefault``; a dictionary is converted."""
        if key not in self:
            self[key] = default
        return self[key]

    def set_dict(self, new_dict):
        """Replaces the whole content."""
        self.clear()
        self.update(new_dict)

    def to_dict(self):
        """A copy of plain dictionaries."""
        return Vividict.vividict_to_dict(self)

    @classmethod
    def from_dict(cls, dictionary):
        """One with the content of a dictionary."""
        return cls(dictionary)

    @staticmethod
    def vividict_to_dict(vividict, native_strings=False):
        """A copy of plain dictionaries; ``native_strings`` means nothing: texts are ``str``."""
        return {
            key: Vividict.vividict_to_dict(value) if isinstance(value, Vividict) else value
            for key, value in vividict.items()
        }

    def __deepcopy__(self, memo):
        import copy

        return type(self)({key: copy.deepcopy(value, memo) for key, value in self.items()})

    def __reduce__(self):
        return (type(self), (dict(self),))
