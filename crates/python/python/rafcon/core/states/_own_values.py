"""Live dictionaries of a library state's own values; a change in place changes the state."""

from rafcon.core.states._live import LiveDict


class OwnValues(LiveDict):
    """Port id to the state's own value, or to True if that is used.

    ``set_one(port_id, value)`` changes the state. Every port has an entry, so none can be removed.
    """

    _advice = "every port of a library state has a value; choose with `use_…` whether it counts"

    def __init__(self, read, set_one):
        dict.__init__(self)
        self._read_values = read
        self._set_one = set_one

    def _read(self):
        return self._read_values()

    def __setitem__(self, port_id, value):
        if port_id not in self:
            raise KeyError(f"the library has no such port with the id {port_id!r}; it has {sorted(self)}")
        self._set_one(port_id, value)

    def update(self, *values, **named):
        """Set several entries."""
        for port_id, value in dict(*values, **named).items():
            self[port_id] = value

    def setdefault(self, port_id, default=None):
        """Return the entry of a port, which always exists."""
        if port_id not in self:
            self[port_id] = default
        return self[port_id]

    def __ior__(self, values):
        self.update(values)
        return self
