"""Where the objects of states live: in the machine that runs, or in one that is being built.

A home answers what its states are made of and carries changes out. ``revision`` differs after every change, so that
nobody looks at old facts. The machine itself is a value of the compiled module in both cases.
"""

from rafcon import _objects
from rafcon._bridge import native


class Running:
    """The home of all states of the machine that runs."""

    @property
    def revision(self):
        """Differs after every change of the machine."""
        return native.revision()

    def facts(self, state):
        """What a state is made of, as ``native.describe`` gives it."""
        return native.describe(state._place)

    def layout(self, state):
        """Left, top, width and height of a state, or None."""
        return native.layout_of(state._place)

    def live(self, state):
        """What a state holds and does now."""
        return native.status(state._place)

    def parent(self, state):
        """The state around a state, or the state machine."""
        above = state._facts["parent"]
        return _objects.state(above) if above >= 0 else _objects.machine()

    def machine(self, _state):
        """The state machine."""
        return _objects.machine()

    def child_ids(self, state):
        """The ids of the states inside."""
        return list(state._facts["children"])

    def has_child(self, state, state_id):
        """Whether there is a state of this id inside."""
        return state_id in state._facts["children"]

    def has_line(self, state, group, key):
        """Whether there is a transition or data flow of this id inside."""
        return key in state._facts[group]

    def child(self, state, state_id):
        """The state of this id inside; ``KeyError`` if there is none."""
        return _objects.state(state._facts["children"][state_id])

    def change(self, state, changes):
        """Carries changes (verb, arguments) out, all or none; the machine honours them at its next step."""
        path = state._facts["path"]
        native.edit([(verb, path, arguments) for verb, arguments in changes])

    def copy_of(self, state):
        """A state with everything in it as a document of its own."""
        return native.taken(state._place)

    def renamed(self, state, state_id):
        """The state has another id; its place is the same."""

    def replaced(self, container, state):
        """The object for a state that is of another kind now."""
        return _objects.state(state._place)

    def add(self, container, state):
        """Puts a state that was built by itself into a container."""
        state._store_notes()
        self.change(container, [("children.add", (state._home.document,))])
        self._settle(container, state)

    def _settle(self, container, state):
        places = native.describe(container._place)["children"]
        state._settle_running(places[state._key])

    def substitute(self, container, old, state):
        """Puts a state that was built by itself in the place of another."""
        state._store_notes()
        taken = native.taken(old._place)
        self.change(container, [("children.substitute", (old.state_id, state._home.document))])
        old._retire(taken)
        self._settle(container, state)

    def take(self, container, state):
        """Takes a state out of a container; it is built by itself from then on."""
        taken = native.taken(state._place)
        self.change(container, [("children.remove", (state.state_id,))])
        state._retire(taken)

    def group(self, container, _states, arguments):
        """Puts states into a new hierarchy, which is returned; ``arguments`` as the verb takes them."""
        self.change(container, [("children.group", arguments)])
        return self.child(container, arguments[2])

    def ungroup(self, container, group, ids):
        """Puts the states of a group into its container; ``ids`` is old to new id."""
        fresh = [new for old, new in ids.items() if old != new]
        self.change(container, [("children.ungroup", (group.state_id, fresh))])


RUNNING = Running()


class Facts(dict):
    """The facts about one state, asked for one by one."""

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
    """The home of the states of one document: a machine, or a state that stands in none yet."""

    def __init__(self, document, top):
        self.document = document
        self.top = top
        self.revision = 0
        #: The state machine, if the topmost state is the root of one.
        self.owner = None
        #: The last running machine started from this one.
        self.run = None

    def facts(self, state):
        """What a state is made of."""
        return Facts(self.document, state)

    def layout(self, state):
        """Left, top, width and height of a state, or None."""
        return self.document.fact(state._facts["path"], "layout")

    def live(self, state):
        """What a state held and did in the last run."""
        if self.run is not None:
            return self.run.live(state)
        idle = {"active": False, "phase": "inactive", "final_outcome": None, "run_count": 0, "entered_ns": 0}
        return {**idle, "input_data": {}, "output_data": {}, "scoped_data": {}}

    def parent(self, state):
        """The state around a state, the state machine, or None."""
        return self.owner if state._above is None else state._above

    def machine(self, _state):
        """The state machine, or None."""
        return self.owner

    def child_ids(self, state):
        """The ids of the states inside."""
        return state._facts["children"]

    def has_child(self, state, state_id):
        """Whether there is a state of this id inside."""
        return isinstance(state_id, str) and self.document.has_child(state._facts["path"], state_id)

    def has_line(self, state, group, key):
        """Whether there is a transition or data flow of this id inside."""
        return self.document.has_line(state._facts["path"], group, key)

    def child(self, state, state_id):
        """The state of this id inside; ``KeyError`` if there is none."""
        known = state._inside.get(state_id)
        if known is None:
            if not self.has_child(state, state_id):
                raise KeyError(state_id)
            kind = self.document.fact(f"{state._facts['path']}/{state_id}", "kind")
            known = _objects.blank_state(kind)
            known._settle(self, state, state_id)
        return known

    def change(self, state, changes):
        """Carries changes (verb, arguments) out, all or none."""
        if not changes:
            return
        path = state._facts["path"]
        self.document.edit([(verb, path, arguments) for verb, arguments in changes])
        self.touch()

    def touch(self):
        """Something has changed."""
        self.revision += 1
        if self.owner is not None:
            self.owner._marked_dirty = True

    def add(self, container, state):
        """Puts a state that was built by itself into a container."""
        self.change(container, [("children.add", (state._home.document,))])
        state._settle(self, container, state._key)

    def substitute(self, container, old, state):
        """Puts a state that was built by itself in the place of another."""
        taken = self.document.taken(old._facts["path"])
        self.change(container, [("children.substitute", (old.state_id, state._home.document))])
        self._release(container, old, taken)
        state._settle(self, container, state._key)

    def take(self, container, state):
        """Takes a state out of a container; it is built by itself from then on."""
        taken = self.document.taken(state._facts["path"])
        self.change(container, [("children.remove", (state.state_id,))])
        self._release(container, state, taken)

    def copy_of(self, state):
        """A state with everything in it as a document of its own."""
        for known in state._known_states():
            known._store_notes()
        return self.document.taken(state._facts["path"])

    def leave_copy(self, state):
        """The object of a state goes elsewhere; another one stands for the state here."""
        above = state._above
        if above is not None:
            above._inside.pop(state._key, None)
            return
        self.top = copy = _objects.blank_state(state._kind)
        copy._settle(self, None, state._key)
        self.owner._root = copy

    def renamed(self, state, state_id):
        """The state has another id."""
        above = state._above
        if above is not None:
            above._inside.pop(state._key, None)
        state._settle(self, above, state_id)

    def replaced(self, container, state):
        """The object for a state that is of another kind now; the one before stands nowhere."""
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
        """Puts states into a new hierarchy, which is returned; ``arguments`` as the verb takes them."""
        self.change(container, [("children.group", arguments)])
        group = self.child(container, arguments[2])
        for state in states:
            container._inside.pop(state._key, None)
            state._settle(self, group, state._key)
        return group

    def ungroup(self, container, group, ids):
        """Puts the states of a group into its container; ``ids`` is old to new id."""
        inside, taken = dict(group._inside), self.document.taken(group._facts["path"])
        fresh = [new for old, new in ids.items() if old != new]
        self.change(container, [("children.ungroup", (group._key, fresh))])
        for key, state in inside.items():
            if key in ids:
                group._inside.pop(key)
                state._settle(self, container, ids[key])
        self._release(container, group, taken)

    def store_notes(self):
        """Brings the notes that users changed in place into the document."""
        for state in self.top._known_states():
            state._store_notes()

