"""A machine to stand on, for tests of the Python package alone: the answers of ``rafcon._native`` from a table.

Import this module before anything of ``rafcon``. Tests of both together start the real binary instead.
"""

import pathlib
import sys
import threading
import types

PACKAGE = pathlib.Path(__file__).resolve().parent.parent / "python"


class Signals:
    """Flags with a condition, as the extension has them."""

    _MASKS = {"preempted": 1, "paused": 2, "started": 4, "nudged": 8}

    def __init__(self):
        self.flags = 0
        self.waits = []
        self.changed = threading.Condition()

    def __getattr__(self, name):
        return bool(self.flags & self._MASKS[name])

    def __setattr__(self, name, value):
        if name not in self._MASKS:
            return object.__setattr__(self, name, value)
        with self.changed:
            self.flags = self.flags | self._MASKS[name] if value else self.flags & ~self._MASKS[name]
            self.changed.notify_all()

    def wait(self, mask, timeout):
        with self.changed:
            self.waits.append((mask, timeout))
            self.changed.notify_all()
            return self.changed.wait_for(lambda: self.flags & mask != 0, timeout)

    def until_waited_on(self):
        """Returns once somebody waits."""
        with self.changed:
            self.changed.wait_for(lambda: self.waits)


def described(kind, state_id, name, path, parent=-1, **more):
    """What the extension says of a state; ``more`` replaces what is empty here."""
    facts = {
        "kind": kind,
        "state_id": state_id,
        "name": name,
        "description": None,
        "path": path,
        "path_by_name": path.lower(),
        "parent": parent,
        "children": {},
        "outcomes": {-1: "aborted", -2: "preempted", 0: "success"},
        "inputs": {},
        "outputs": {},
        "scoped_variables": {},
        "transitions": {},
        "data_flows": {},
        "semantic_data": {},
        "script": None,
        "file_system_path": None,
        "library": None,
    }
    return {**facts, **more}


class Taken:
    """What a machine has given away."""

    def __init__(self, root_id):
        self.root_id = lambda: root_id


class Native(types.ModuleType):
    """The table, and what was sent to the machine."""

    VERSION = "0.1.0"
    Signals = Signals

    def __init__(self):
        types.ModuleType.__init__(self, "rafcon._native")
        self.here = threading.local()
        self.clear([])

    def clear(self, table):
        self.table = table
        self.live = {}
        self.objects = {}
        self.sent = []
        self.commands = []
        self.edits = []
        self.before = {}
        self.happened = []
        self.doing = "running"

    def current_path(self):
        return getattr(self.here, "path", -1)

    def describe(self, path):
        return self.table[path]

    def status(self, path):
        idle = {"active": True, "phase": "active", "final_outcome": None, "run_count": 1, "entered_ns": 0}
        return {**idle, "input_data": {}, "output_data": {}, "scoped_data": {}, **self.live.get(path, {})}

    def run_status(self):
        return self.doing

    def machine(self):
        return {"file_system_path": "/m", "version": None, "creation_time": "2026-01-31 12:00:00", "root": 0}

    def state_object(self, path):
        from rafcon import _runtime

        if path not in self.objects:
            self.objects[path] = _runtime.new_state(path, self.table[path]["kind"], Signals())
        return self.objects[path]

    def emit(self, path, stream, level, message):
        self.sent.append((path, stream, level, message))

    def command(self, name, path=None, sequence=0):
        self.commands.append(" ".join([name] + [str(more) for more in (path, sequence) if more]))

    def past(self):
        return self.happened

    def revision(self):
        return len(self.edits)

    def edit(self, changes):
        self.edits += changes

    def taken(self, path):
        return Taken(self.table[path]["state_id"])

    def last_left(self, path):
        return self.before.get(path, -1)


native = sys.modules.setdefault("rafcon._native", Native())
if str(PACKAGE) not in sys.path:
    sys.path.insert(0, str(PACKAGE))

from rafcon import _objects  # noqa: E402, it needs what stands above

_objects.become_host()


def enter(path):
    """From now on this thread runs the script of the state at this path; returns the state."""
    native.here.path = path
    return native.state_object(path)


def leave():
    """This thread runs no script any more."""
    native.here.path = -1
