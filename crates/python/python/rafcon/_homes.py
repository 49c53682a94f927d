"""Homes of state objects: the running machine, or a machine that is being built.

A home provides the facts about its states and applies changes. ``revision`` changes with every
change of the machine, so that cached facts expire. In both cases the compiled module holds the
machine.
"""

from rafcon import _objects
from rafcon._bridge import native


class Running:
    """Home of all states of the running machine."""

    @property
    def revision(self):
        """Revision of the machine; it differs after every change."""
        return native.revision()

    def facts(self, state):
        """Facts about a state, as ``native.describe`` returns them."""
        return native.describe(state._place)

    def layout(self, state):
        """Left, top, width and height of a state, or None."""
        return native.layout_of(state._place)

    def live(self, state):
        """Current data and status of a state."""
        return native.status(state._place)

    def parent(self, state):
        """Container or library state around a state, or the state machine."""
        above = state._facts["parent"]
        return _objects.state(above) if above >= 0 else _objects.machine()

    def machine(self, _state):
        """Running state machine."""
        return _objects.machine()

    def child_ids(self, state):
        """Ids of the states inside."""
        return list(state._facts["children"])

    def has_child(self, state, state_id):
        """True if a state with this id is inside."""
        return state_id in state._facts["children"]

    def has_line(self, state, group, key):
        """True if a transition or data flow with this id is inside."""
        return key in state._facts[group]

    def child(self, state, state_id):
        """State with this id inside; ``KeyError`` if there is none."""
        return _objects.state(state._facts["children"][state_id])

    def change(self, state, changes):
        """Apply changes (verb, arguments), all or none, from the machine's next step on."""
        path = state._facts["path"]
        native.edit([(verb, path, arguments) for verb, arguments in changes])

    def copy_of(self, state):
        """Copy of a state, with everything inside, as a document of its own."""
        return native.taken(state._place)

    def renamed(self, state, state_id):
        """Do nothing after a state got a new id: its index stays."""

    def replaced(self, container, state):
        """Return the object for a state whose kind has changed."""
        return _objects.state(state._place)

    def add(self, container, state):
        """Add a standalone state to a container."""
        state._store_notes()
        self.change(container, [("children.add", (state._home.document,))])
        self._settle(container, state)

    def _settle(self, container, state):
        places = native.describe(container._place)["children"]
        state._settle_running(places[state._key])

    def substitute(self, container, old, state):
        """Replace a state of a container by a standalone one."""
        state._store_notes()
        taken = native.taken(old._place)
        self.change(container, [("children.substitute", (old.state_id, state._home.document))])
        old._retire(taken)
        self._settle(container, state)

    def take(self, container, state):
        """Remove a state from its container; it becomes standalone."""
        taken = native.taken(state._place)
        self.change(container, [("children.remove", (state.state_id,))])
        state._retire(taken)

    def group(self, container, _states, arguments):
        """Move states into a new hierarchy and return it; ``arguments`` are those of the verb."""
        self.change(container, [("children.group", arguments)])
        return self.child(container, arguments[2])

    def ungroup(self, container, group, ids):
        """Move the states of a group into its container; ``ids`` maps old to new ids."""
        fresh = [new for old, new in ids.items() if old != new]
        self.change(container, [("children.ungroup", (group.state_id, fresh))])


RUNNING = Running()


class Facts(dict):
    """Facts about one state; each is requested when it is first read."""

    def __init__(self, document, state):
        dict.__init__(self)
        self._document = document
        self._state = state

    def __missing__(self, key):
        if key == "path_by_name":
            fact = "/".join(above.name for above in self._state._line())
        else:
            path = dict.get(self, "path")
            if path is None:
                path = self["path"] = "/".join(above._key for above in self._state._line())
            fact = path if key == "path" else self._document.fact(path, key)
        self[key] = fact
        return fact


class Built:
    """Home of the states of one document: a machine, or a standalone state."""

    def __init__(self, document, top):
        self.document = document
        self.top = top
        self.revision = 0
        #: The state machine, if the topmost state is the root of one.
        self.owner = None
        #: The last running machine started from this one.
        self.run = None

    def facts(self, state):
        """Facts about a state."""
        return Facts(self.document, state)

    def layout(self, state):
        """Left, top, width and height of a state, or None."""
        return self.document.fact(state._facts["path"], "layout")

    def live(self, state):
        """Data and status of a state in the last run."""
        if self.run is not None:
            return self.run.live(state)
        idle = {"active": False, "phase": "inactive", "final_outcome": None, "run_count": 0, "entered_ns": 0}
        return {**idle, "input_data": {}, "output_data": {}, "scoped_data": {}}

    def parent(self, state):
        """Container or library state around a state, the state machine, or None."""
        return self.owner if state._above is None else state._above

    def machine(self, _state):
        """State machine, or None."""
        return self.owner

    def child_ids(self, state):
        """Ids of the states inside."""
        return state._facts["children"]

    def has_child(self, state, state_id):
        """True if a state with this id is inside."""
        return isinstance(state_id, str) and self.document.has_child(state._facts["path"], state_id)

    def has_line(self, state, group, key):
        """True if a transition or data flow with this id is inside."""
        return self.document.has_line(state._facts["path"], group, key)

    def child(self, state, state_id):
        """State with this id inside; ``KeyError`` if there is none."""
        known = state._inside.get(state_id)
        if known is None:
            if not self.has_child(state, state_id):
                raise KeyError(state_id)
            kind = self.document.fact(f"{state._facts['path']}/{state_id}", "kind")
            known = _objects.blank_state(kind)
            known._settle(self, state, state_id)
        return known

    def change(self, state, changes):
        """Apply changes (verb, arguments), all or none."""
        if not changes:
            return
        path = state._facts["path"]
        self.document.edit([(verb, path, arguments) for verb, arguments in changes])
        self.touch()

    def touch(self):
        """Count a change: raise the revision, and mark the machine as unsaved."""
        self.revision += 1
        if self.owner is not None:
            self.owner._marked_dirty = True

    def add(self, container, state):
        """Add a standalone state to a container."""
        self.change(container, [("children.add", (state._home.document,))])
        state._settle(self, container, state._key)

    def substitute(self, container, old, state):
        """Replace a state of a container by a standalone one."""
        taken = self.document.taken(old._facts["path"])
        self.change(container, [("children.substitute", (old.state_id, state._home.document))])
        self._release(container, old, taken)
        state._settle(self, container, state._key)

    def take(self, container, state):
        """Remove a state from its container; it becomes standalone."""
        taken = self.document.taken(state._facts["path"])
        self.change(container, [("children.remove", (state.state_id,))])
        self._release(container, state, taken)

    def copy_of(self, state):
        """Copy of a state, with everything inside, as a document of its own."""
        for known in state._known_states():
            known._store_notes()
        return self.document.taken(state._facts["path"])

    def leave_copy(self, state):
        """Give up the object of a state, which moves elsewhere; a new one takes over here."""
        above = state._above
        if above is not None:
            above._inside.pop(state._key, None)
            return
        self.top = copy = _objects.blank_state(state._kind)
        copy._settle(self, None, state._key)
        self.owner._root = copy

    def renamed(self, state, state_id):
        """Update the object of a state that got a new id."""
        above = state._above
        if above is not None:
            above._inside.pop(state._key, None)
        state._settle(self, above, state_id)

    def replaced(self, container, state):
        """Return a new object for a state whose kind has changed; the old one is standalone."""
        inside, taken = dict(state._inside), self.document.taken(state._facts["path"])
        fresh = self._fresh(container, state)
        ids = set(self.child_ids(fresh))
        for key in ids & set(inside):
            state._inside.pop(key)
            inside[key]._settle(self, fresh, key)
        state._settle(Built(taken, state), None, state._key)
        return fresh

    def _fresh(self, container, state):
        if container is not None:
            container._inside.pop(state._key, None)
            return self.child(container, state._key)
        self.top = fresh = _objects.blank_state(state._facts["kind"])
        fresh._settle(self, None, state._key)
        return fresh

    def _release(self, container, state, document):
        container._inside.pop(state._key, None)
        state._settle(Built(document, state), None, state._key)

    def group(self, container, states, arguments):
        """Move states into a new hierarchy and return it; ``arguments`` are those of the verb."""
        self.change(container, [("children.group", arguments)])
        group = self.child(container, arguments[2])
        for state in states:
            container._inside.pop(state._key, None)
            state._settle(self, group, state._key)
        return group

    def ungroup(self, container, group, ids):
        """Move the states of a group into its container; ``ids`` maps old to new ids."""
        inside, taken = dict(group._inside), self.document.taken(group._facts["path"])
        fresh = [new for old, new in ids.items() if old != new]
        self.change(container, [("children.ungroup", (group._key, fresh))])
        for key, state in inside.items():
            if key in ids:
                group._inside.pop(key)
                state._settle(self, container, ids[key])
        self._release(container, group, taken)

    def store_notes(self):
        """Copy notes that users changed in place to the document."""
        for state in self.top._known_states():
            state._store_notes()

