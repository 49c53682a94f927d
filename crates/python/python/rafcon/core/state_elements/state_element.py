"""Base class of all elements of a state."""


class StateElement:
    """Element of a state, with an id that is unique in the state, and the state as ``parent``.

    An element of a state reads its content from the state, and assignments change the state. An
    element without a parent holds its own content. Elements are equal if their kind and content are
    equal, whatever their parents are.
    """

    _fields = ()
    #: Key of the elements of this kind in a state's facts.
    _group = None
    #: Prefix of the verbs of changes for this kind.
    _verb = None

    def __init__(self, parent=None, values=()):
        self._parent = parent
        self._values = values

    @classmethod
    def _of(cls, parent, key):
        """Create the element with this id of a state."""
        element = cls.__new__(cls)
        element._parent = parent
        element._values = (key,)
        element._content()
        return element

    @staticmethod
    def _read(fact):
        """Fields after the id, from the state's facts about the element."""
        return fact

    @property
    def parent(self):
        """State that contains the element, or None."""
        return self._parent

    @property
    def core_element_id(self):
        """Id among the elements of this kind."""
        return self.state_element_id

    @property
    def state_element_id(self):
        """Id among the elements of this kind."""
        return self._values[0] if self._fields else None

    def _content(self):
        facts = getattr(self._parent, "_facts", None) if self._group else None
        if facts is not None:
            key = self._values[0]
            fact = facts[self._group].get(key)
            if fact is not None:
                self._values = (key, *self._read(fact))
        return self._values

    def _get(self, field):
        return self._content()[self._fields.index(field)]

    def _set(self, change, values, *arguments):
        """Change the element in its state, or its own content; ``values`` is field to content."""
        if self._parent is not None:
            self._parent._change(f"{self._verb}.{change}", *self._address(), *arguments)
        else:
            self._values = tuple(values.get(field, old) for field, old in zip(self._fields, self._values))

    def _address(self):
        """Arguments that identify the element in changes of its state."""
        return (self._values[0],)

    def _detach(self):
        """Detach the element from its state; its last content stays readable."""
        self._content()
        self._parent = None

    def to_dict(self):
        """Content as a dictionary: field name to value."""
        return dict(zip(self._fields, self._content()))

    def __eq__(self, other):
        if type(other) is not type(self):
            return NotImplemented
        return self._content() == other._content()

    def __hash__(self):
        return hash((type(self).__name__, self.state_element_id))

    def __repr__(self):
        return f"<{self}>"


class field(property):  # noqa: N801, it is used like `property`
    """Read-only field of an element."""

    def __init__(self, doc):
        property.__init__(self, lambda element: element._get(self._name), doc=doc)

    def __set_name__(self, owner, name):
        self._name = name

    def __set__(self, instance, value):
        raise AttributeError(f"`{self._name}` of {instance} cannot be assigned; remove the element and add another")
