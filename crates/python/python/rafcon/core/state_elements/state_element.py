"""What all elements of a state have in common."""

from rafcon.core._refusals import fixed


class StateElement:
    """A part of a state, with an id that is unique in it, and the state as ``parent``.

    Elements are values: equal if kind and content are the same, whatever their parent is.
    """

    _fields = ()

    def __init__(self, parent=None):
        self._parent = parent

    @fixed
    def parent(self):
        """The state that this is a part of, or None."""
        return self._parent

    @property
    def core_element_id(self):
        """The id among the elements of this kind."""
        return self.state_element_id

    @property
    def state_element_id(self):
        """The id among the elements of this kind."""
        return getattr(self, "_" + self._fields[0]) if self._fields else None

    def _content(self):
        return tuple(getattr(self, "_" + field) for field in self._fields)

    def to_dict(self):
        """The content as a dictionary: name of the field to value."""
        return dict(zip(self._fields, self._content()))

    def __eq__(self, other):
        if type(other) is not type(self):
            return NotImplemented
        return self._content() == other._content()

    def __hash__(self):
        return hash((type(self).__name__, self.state_element_id))

    def __repr__(self):
        return f"<{self}>"
