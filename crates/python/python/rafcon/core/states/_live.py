"""Live dictionaries for the collections of a state."""


class LiveDict(dict):
    """Dictionary that reads its content again on each access. Loops use the content of their start.

    ``_read`` returns the content. It returns an identical object until something changes.
    """

    _seen = None
    #: Advice in errors about assignments.
    _advice = "it changes with its state; use the methods of the state that add and remove"

    def _read(self):
        raise NotImplementedError

    def _fill(self, content):
        """Return the entries for new content."""
        return content

    def _now(self):
        content = self._read()
        if content is not self._seen:
            entries = self._fill(content)
            dict.clear(self)
            dict.update(self, entries)
            self._seen = content
        return self

    def __getitem__(self, key):
        return dict.__getitem__(self._now(), key)

    def __contains__(self, key):
        return dict.__contains__(self._now(), key)

    def __len__(self):
        return dict.__len__(self._now())

    def __iter__(self):
        return iter(self.copy())

    def __reversed__(self):
        return reversed(self.copy())

    def __eq__(self, other):
        return self.copy() == (other.copy() if isinstance(other, LiveDict) else other)

    def __ne__(self, other):
        return not self == other

    __hash__ = None

    def __or__(self, other):
        return {**self.copy(), **other} if isinstance(other, dict) else NotImplemented

    def __ror__(self, other):
        return {**other, **self.copy()} if isinstance(other, dict) else NotImplemented

    def __repr__(self):
        return repr(self.copy())

    def __reduce__(self):
        return (dict, (self.copy(),))

    def copy(self):
        """Plain dictionary of the present content."""
        entries = {}
        dict.update(entries, dict.items(self._now()))
        return entries

    def get(self, key, default=None):
        """Entry of a key, or the default."""
        return dict.get(self._now(), key, default)

    def keys(self):
        """The keys."""
        return self.copy().keys()

    def values(self):
        """The entries."""
        return self.copy().values()

    def items(self):
        """Pairs of key and entry."""
        return self.copy().items()

    def _refuse(self, *_arguments, **_named):
        raise TypeError(f"this dictionary cannot be changed: {self._advice}")

    __setitem__ = __delitem__ = __ior__ = update = setdefault = pop = popitem = clear = _refuse


class Parts(LiveDict):
    """Live mapping of ids to elements of one kind; an element keeps its identity while it exists."""

    def __init__(self, state, group, cls):
        dict.__init__(self)
        self._state, self._group, self._cls = state, group, cls

    def _read(self):
        return self._state._facts[self._group]

    def _fill(self, content):
        return {key: dict.get(self, key) or self._cls._of(self._state, key) for key in content}

    def _adopt(self, key, element):
        """Connect a user's element object to the element of the state."""
        element._parent = self._state
        dict.__setitem__(self, key, element)
        self._seen = None
